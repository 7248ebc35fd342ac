//! A generated mesh as a binary little-endian PLY file (Turk 1994), streamed.
//!
//! Vertices and faces are fixed-size records, so any thread can make any part of the file in a
//! buffer. Two buffers of fixed size alternate: one is written while the other is filled. Memory is
//! bounded for any mesh and number of threads, and the bytes depend on neither.
//!
//! The file is replaced atomically (see [`wavecrest_base::replace`]).

use std::io::{self, Write};
use std::path::Path;

use super::recipe::Recipe;
use crate::write::ply_header;
use wavecrest_base::error::{Error, Result};
use wavecrest_base::parallel;
use wavecrest_base::replace::replace_file;
use wavecrest_base::words::Size;

/// The size of each of the two buffers.
const BUFFER_BYTES: usize = 8 << 20;
/// Records for each task: enough to outweigh the cost of a task, few enough to distribute.
const RECORDS_PER_TASK: usize = 4096;
/// A coordinate or an index.
const NUMBER_BYTES: usize = 4;
/// A face: the count 3, then three indices.
const FACE_BYTES: usize = 1 + 3 * NUMBER_BYTES;

/// The sizes of what [`write_ply`] wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// Vertices in the file.
    pub vertices: u64,
    /// Triangles in the file.
    pub triangles: u64,
    /// The size of the file.
    pub bytes: u64,
}

/// Writes the mesh of `recipe` to the file `path`, replacing it. `progress` is called regularly
/// with the bytes written and the total.
///
/// # Errors
/// As for [`mesh`](super::mesh), and if the file cannot be written.
pub fn write_ply(
    recipe: &Recipe,
    path: &Path,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Written> {
    let surface = recipe.surface()?;
    let (vertices, triangles) = (surface.vertices(), recipe.grid_triangles());
    let header = header(recipe, [vertices, triangles]);
    let numbers = if recipe.normals { 6 } else { 3 };
    let bytes = header.len() as u64
        + vertices * (numbers * NUMBER_BYTES) as u64
        + triangles * FACE_BYTES as u64;
    let vertex = |v: u64, record: &mut [u8]| {
        let normal = recipe.normals.then(|| surface.normal(v).as_vec3().to_array());
        let vectors = [Some(surface.position(v).as_vec3().to_array()), normal];
        let numbers = vectors.into_iter().flatten().flatten();
        for (to, number) in record.as_chunks_mut::<NUMBER_BYTES>().0.iter_mut().zip(numbers) {
            *to = number.to_le_bytes();
        }
    };
    let face = |t: u64, record: &mut [u8]| {
        record[0] = 3;
        record[1..].copy_from_slice(surface.triangle(t).map(u32::to_le_bytes).as_flattened());
    };
    replace_file(path, |file| {
        let mut written = 0;
        let mut advance = |count: usize| {
            written += count as u64;
            progress(written, bytes);
        };
        let mut write = || {
            file.write_all(header.as_bytes())?;
            advance(header.len());
            stream(file, &mut advance, vertices, numbers * NUMBER_BYTES, vertex)?;
            stream(file, &mut advance, triangles, FACE_BYTES, face)
        };
        write().map_err(|e| {
            Error::io("cannot write the mesh", path, e).remedy(format!(
                "the file needs {} free in its folder; make room, or ask for fewer triangles",
                Size(bytes)
            ))
        })
    })?;
    Ok(Written { vertices, triangles, bytes })
}

/// The header, with the recipe in a comment, so that the file can be made again.
fn header(recipe: &Recipe, counts: [u64; 2]) -> String {
    let Recipe { model, triangles: asked, seed, displacement, normals } = recipe;
    let flag = if *normals { " --normals" } else { "" };
    let comment = format!(
        "comment wavecrest generate {model} --triangles {asked} --seed {seed} \
         --displacement {displacement}{flag}\n"
    );
    let groups = [normals.then_some("nx ny nz"), None, None];
    ply_header(&comment, counts, "float", groups, "int")
}

/// Writes `count` records of `record_bytes` each, made by `make` from their number.
fn stream(
    file: &mut (impl Write + Send),
    advance: &mut impl FnMut(usize),
    count: u64,
    record_bytes: usize,
    make: impl Fn(u64, &mut [u8]) + Sync,
) -> io::Result<()> {
    let at_once = (BUFFER_BYTES / record_bytes) as u64;
    let (mut full, mut next) = (Vec::new(), Vec::new());
    let mut first = 0;
    loop {
        let records = at_once.min(count - first);
        next.resize(records as usize * record_bytes, 0);
        let chunks = next.chunks_mut(RECORDS_PER_TASK * record_bytes).enumerate();
        let fill = |(task, chunk): (usize, &mut [u8])| {
            let start = first + (task * RECORDS_PER_TASK) as u64;
            for (number, record) in (start..).zip(chunk.chunks_exact_mut(record_bytes)) {
                make(number, record);
            }
        };
        rayon::join(|| file.write_all(&full), || parallel::each(chunks, fill)).0?;
        advance(full.len());
        std::mem::swap(&mut full, &mut next);
        if records == 0 {
            return Ok(());
        }
        first += records;
    }
}
