//! The short cuts of binary bodies against the reader that takes number by number: the same mesh,
//! or the same words about the same row.

use std::ops::Range;
use std::sync::LazyLock;

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::super::body;
use super::super::header::{PropertyType, TYPE_NAMES};
use super::*;
use crate::mesh::scalar::Scalar;

/// As [`read`], number by number.
fn slowly(bytes: &[u8]) -> Result<Read> {
    let length = bytes.len() as u64;
    let header = header::read(&bytes, length)?;
    let mut numbers = Numbers::new(&bytes, &header, length, 64);
    numbers.block = 0;
    body::read(&header, numbers, false)
}

/// Sizes of the buffer, and the threads, started once.
static WAYS: LazyLock<[(usize, ThreadPool); 4]> = LazyLock::new(|| {
    [(16, 3), (100, 1), (1000, 2), (BUFFER, 4)].map(|(buffer, threads)| {
        (buffer, ThreadPoolBuilder::new().num_threads(threads).build().unwrap())
    })
});

/// Checks that every way of reading gives the same, at several sizes of the blocks that threads
/// take and on several numbers of threads.
fn check(bytes: &[u8], what: &str) -> Option<MeshData> {
    let ways = std::iter::once(None).chain(WAYS.iter().map(Some)).map(|way| (what, way));
    let read = alike(ways, |(_, way)| match way {
        None => slowly(bytes),
        Some((buffer, pool)) => pool.install(|| read(&bytes, bytes.len() as u64, *buffer, None)),
    });
    read.ok().map(|read| read.0)
}

/// The types of whole numbers, before the others.
const WHOLE: Range<usize> = 0..6;

/// Writes `value` as a number of this type.
fn put(body: &mut Bytes, kind: Scalar, value: f64) {
    match kind {
        Scalar::I8 | Scalar::U8 => body.add([value as i64 as u8]),
        Scalar::I16 | Scalar::U16 => body.add((value as i64 as u16).to_le_bytes()),
        Scalar::I32 | Scalar::U32 => body.add((value as i64 as u32).to_le_bytes()),
        Scalar::F32 => body.add((value as f32).to_le_bytes()),
        Scalar::F64 => body.add(value.to_le_bytes()),
    };
}

/// What a file of the test is like.
#[derive(Clone, Copy, Debug)]
struct Kind {
    seed: u64,
    big: bool,
    /// Whether faces have other numbers of corners than 3, and how many.
    corners: [u64; 2],
    /// Whether there are properties besides.
    extra: bool,
    /// One in so many numbers is wrong.
    wrong: u64,
}

/// A file of this kind, with types and counts by the dice.
fn random_file(kind: Kind) -> Vec<u8> {
    let mut dice = Dice(kind.seed);
    let names = ["x", "y", "z", "nx", "ny", "nz", "s", "t"];
    let kept = dice.of(&[3, 6, 8]);
    let floats = dice.one_in(2);
    let mut vertex: Vec<(String, PropertyType)> = Vec::new();
    for name in &names[..kept] {
        let scalar = if floats { Scalar::F32 } else { dice.of(&TYPE_NAMES).2 };
        if kind.extra && dice.one_in(3) {
            vertex.push((format!("e{}", vertex.len()), PropertyType::One(dice.of(&TYPE_NAMES).2)));
        }
        vertex.push(((*name).to_owned(), PropertyType::One(scalar)));
    }
    let mut face = Vec::new();
    let (count, item) = (dice.of(&TYPE_NAMES[WHOLE]).2, dice.of(&TYPE_NAMES[WHOLE]).2);
    if kind.extra && dice.one_in(2) {
        face.push(("flag".to_owned(), PropertyType::One(dice.of(&TYPE_NAMES).2)));
    }
    face.push(("vertex_indices".to_owned(), PropertyType::List { count, item }));
    if kind.extra && dice.one_in(2) {
        let list = PropertyType::List {
            count: dice.of(&TYPE_NAMES[WHOLE]).2,
            item: dice.of(&TYPE_NAMES).2,
        };
        face.push(("more".to_owned(), dice.of(&[PropertyType::One(Scalar::F32), list])));
    }
    let vertices = 1 + dice.below(120);
    let faces = dice.below(300);
    let mut body = Bytes::new(kind.big);
    for _ in 0..vertices {
        for (_, shape) in &vertex {
            let PropertyType::One(scalar) = *shape else { continue };
            let bad = kind.wrong > 0 && dice.one_in(4 * kind.wrong);
            put(&mut body, scalar, if bad { f64::NAN } else { dice.below(100) as f64 });
        }
    }
    for _ in 0..faces {
        for (name, shape) in &face {
            let (length, item) = match *shape {
                PropertyType::One(scalar) => {
                    put(&mut body, scalar, dice.below(9) as f64);
                    continue;
                }
                PropertyType::List { count, item } if name == "more" => {
                    let length = dice.below(4);
                    put(&mut body, count, length as f64);
                    (length, item)
                }
                PropertyType::List { count, item } => {
                    let [low, high] = kind.corners;
                    let bad = kind.wrong > 0 && dice.one_in(kind.wrong);
                    let length = if bad { dice.below(3) } else { low + dice.below(high - low + 1) };
                    put(&mut body, count, length as f64);
                    (length, item)
                }
            };
            for _ in 0..length {
                let bad = kind.wrong > 0 && dice.one_in(kind.wrong);
                let index = if bad { 300.0 } else { dice.below(vertices) as f64 };
                put(&mut body, item, if bad && dice.one_in(2) { -1.0 } else { index });
            }
        }
    }
    let declare = |name: &str, count, rows: &[(String, PropertyType)]| {
        let one = |scalar| TYPE_NAMES.iter().find(|k| k.2 == scalar).unwrap().0;
        let line = |(name, shape): &(String, PropertyType)| match *shape {
            PropertyType::One(scalar) => format!("property {} {name}\n", one(scalar)),
            PropertyType::List { count, item } => {
                format!("property list {} {} {name}\n", one(count), one(item))
            }
        };
        format!("element {name} {count}\n{}", rows.iter().map(line).collect::<String>())
    };
    let header = declare("vertex", vertices, &vertex) + declare("face", faces, &face).trim_end();
    file(body.format(), &header, &body.bytes)
}

#[test]
fn meshes_of_every_layout_are_read_alike() {
    let mut read = 0;
    for seed in 0..600 {
        let corners = [[3, 3], [4, 4], [3, 4], [3, 9]][seed as usize % 4];
        let kind = Kind { seed, big: seed % 3 == 0, corners, extra: seed % 2 == 0, wrong: 0 };
        read += usize::from(check(&random_file(kind), &format!("{kind:?}")).is_some());
    }
    assert!(read > 500, "{read}");
}

#[test]
fn the_first_error_is_reported_for_any_number_of_threads() {
    let mut refused = 0;
    for seed in 0..400 {
        let corners = [[3, 3], [3, 3], [3, 4], [3, 9]][seed as usize % 4];
        let wrong = [40, 400, 2000][seed as usize % 3];
        let kind = Kind { seed, big: seed % 5 == 0, corners, extra: seed % 2 == 0, wrong };
        refused += usize::from(check(&random_file(kind), &format!("{kind:?}")).is_none());
    }
    assert!((100..400).contains(&refused), "{refused}");
}

#[test]
fn garbage_and_cut_files_are_refused_alike() {
    for seed in 0..200 {
        let corners = [[3, 4], [3, 3]][seed as usize % 2];
        let kind = Kind { seed, big: seed % 3 == 0, corners, extra: seed % 4 > 0, wrong: 0 };
        let mut bytes = random_file(kind);
        let mut dice = Dice(seed);
        let length = dice.below(bytes.len() as u64) as usize;
        assert!(check(&bytes[..length], &format!("{kind:?} {length}")).is_none());
        let header = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        for _ in 0..dice.below(20) {
            let at = header as u64 + dice.below((bytes.len() - header) as u64);
            bytes[at as usize] = dice.below(256) as u8;
        }
        check(&bytes, &format!("{seed}"));
    }
}

/// What a file that another program cuts short looks like: its length is not true.
#[test]
fn a_file_that_shrinks_is_an_error() {
    for faces in [vec![&[0, 1, 2][..]; 900], vec![&[0, 1, 2, 3][..]; 900]] {
        let bytes = packed(false, &faces);
        for cut in [bytes.len() - 1, bytes.len() / 2, bytes.len() - 900 * 13 - 5] {
            let error = read(&&bytes[..cut], bytes.len() as u64, 64, None).unwrap_err().to_string();
            assert!(error.contains("the file is cut off"), "{error}");
        }
    }
}

#[test]
fn rows_that_are_passed_over_at_once_are_counted() {
    let header = format!(
        "element junk 3\nproperty short a\nproperty double b\n{}\nelement rest 2\nproperty int c",
        square_header(1)
    );
    let mut body = Bytes::new(true);
    for _ in 0..3 {
        body.add([1, 2]).add(5_f64.to_le_bytes());
    }
    let square = packed(true, &[&[0, 1, 2]]);
    body.bytes.extend(&square[square.len() - 48 - 13..]);
    body.bytes.extend([7; 8]);
    let bytes = file(body.format(), &header, &body.bytes);
    assert_eq!(check(&bytes, "junk").unwrap().positions, super::square());
    assert!(check(&bytes[..bytes.len() - 1], "cut").is_none());
}
