//! A room holds what it is made for: giants and specks, boxes, bodies, sheets and soups.

use std::collections::HashMap;

use super::*;
use crate::generate::surface::rounded;

const SOME: u64 = 100_000;

fn room(triangles: u64, seed: u64) -> Room {
    Room::new(triangles, 0.035, seed)
}

fn corners(surface: &dyn Surface, t: u64) -> [DVec3; 3] {
    surface.triangle(t).map(|v| rounded(surface.position(u64::from(v))).as_dvec3())
}

fn areas(surface: &dyn Surface) -> impl Iterator<Item = f64> {
    (0..surface.triangles()).map(|t| {
        let [a, b, c] = corners(surface, t);
        (b - a).cross(c - a).length() / 2.0
    })
}

/// What the triangles enclose, if their fronts are outward.
fn volume(surface: &dyn Surface) -> f64 {
    let cone = |t| {
        let [a, b, c] = corners(surface, t);
        a.dot(b.cross(c)) / 6.0
    };
    (0..surface.triangles()).map(cone).sum()
}

#[test]
fn blocks_and_boards_face_outward_and_bevels_take_little() {
    let place = Place::at(0.3, 0.2, -0.1).turned(30.0).pitched(-50.0).rolled(10.0);
    let of = |bevel: f64| {
        let mut builder = Builder::default();
        builder.flat(colour::Colour::OAK, |facets| {
            facets.board(&place, [0.0; 3], [1.0, 2.0, 3.0], bevel);
        });
        builder.pieces.iter().map(|piece| volume(&*piece.surface)).sum::<f64>()
    };
    let (block, board) = (of(0.0), of(0.01));
    assert!((block - 6.0).abs() < 1e-5, "{block}");
    // Of each edge half a square of the bevel is gone, less where three edges meet.
    let gone = 4.0 * (1.0 + 2.0 + 3.0) * 0.01 * 0.01 / 2.0;
    assert!((6.0 - board - gone).abs() < 0.05 * gone, "{board}");
}

#[test]
fn areas_spread_over_more_than_six_orders_of_magnitude() {
    for triangles in [fewest_triangles(), 400_000] {
        let room = room(triangles, 1);
        let mut areas: Vec<f64> = areas(&room).collect();
        areas.sort_by(f64::total_cmp);
        let (least, most) = (areas[0], areas[areas.len() - 1]);
        // Half of the floor, 6 by 5 metres.
        assert_eq!(most, 15.0);
        assert!(least > 0.0, "a degenerate triangle");
        // Not one odd speck: one in a hundred of all is so small.
        assert!(areas[areas.len() / 100] < most / 1e6, "{}", areas[areas.len() / 100]);
        // And the two dozen largest are more than a third of all there is.
        let all: f64 = areas.iter().sum();
        let large: f64 = areas.iter().rev().take(24).sum();
        assert!(large > all / 3.0, "{large} of {all}");
    }
}

#[test]
fn triangles_are_as_many_as_asked_for() {
    let fewest = fewest_triangles();
    assert!(fewest < SOME, "{fewest}");
    for asked in [fewest, fewest + 1, SOME, 1_234_567] {
        let room = room(asked, 3);
        assert_eq!(room.triangles(), asked);
        let leaves: u64 = (room.pieces.iter())
            .filter(|(.., piece)| piece.surface.vertices() == 3 * piece.surface.triangles())
            .map(|(.., piece)| piece.surface.triangles())
            .sum();
        let share = leaves as f64 / asked as f64;
        assert!((0.19..0.3).contains(&share), "{share} of {asked} are leaves");
    }
}

#[test]
fn every_vertex_is_used_and_within_the_walls() {
    for seed in 0..4 {
        let room = room(SOME, seed);
        let mut used = vec![false; room.vertices() as usize];
        for t in 0..room.triangles() {
            room.triangle(t).iter().for_each(|&v| used[v as usize] = true);
        }
        assert!(used.iter().all(|&used| used));
        let half = DVec3::new(walls::HALF.x, 0.0, walls::HALF.y);
        for v in 0..room.vertices() {
            // Windows are in the depth of the walls.
            let (p, beyond) = (room.position(v), 0.25);
            assert!(p.x.abs() <= half.x + beyond && p.z.abs() <= half.z + beyond, "{p}");
            assert!((-1e-9..=walls::HEIGHT).contains(&p.y), "{p}");
            let uv = room.uv(v).expect("every vertex has a colour");
            assert!((0.0..1.0).contains(&uv.x) && uv.y == 0.5);
        }
    }
}

#[test]
fn bodies_are_closed_and_soups_share_nothing() {
    let room = room(SOME, 5);
    let (mut bodies, mut soups) = (0, 0);
    for (.., piece) in &room.pieces {
        let surface = &*piece.surface;
        let mut edges = HashMap::new();
        for t in 0..surface.triangles() {
            let [a, b, c] = surface.triangle(t);
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        assert!(edges.values().all(|&times| times == 1));
        let inner = edges.keys().filter(|(a, b)| edges.contains_key(&(*b, *a))).count();
        if inner == edges.len() {
            bodies += 1;
            let at = surface.position(0);
            assert!(volume(surface) > 0.0, "{:?} at {at} is inside out", piece.colour);
        } else if inner == 0 {
            soups += 1;
        }
    }
    assert!(bodies > 150 && soups > 20, "{bodies} bodies, {soups} soups");
}

#[test]
fn seeds_move_things_and_change_no_count() {
    let (one, two) = (room(SOME, 1), room(SOME, 2));
    assert_eq!((one.vertices(), one.triangles()), (two.vertices(), two.triangles()));
    let moved = (0..one.vertices()).filter(|&v| one.position(v) != two.position(v)).count();
    assert!(moved as f64 > 0.3 * one.vertices() as f64, "{moved} of {}", one.vertices());
}

#[test]
fn the_palette_has_a_texel_for_each_colour() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/large/room.pnm");
    let text = std::fs::read_to_string(path).unwrap();
    let numbers: Vec<u32> = (text.lines().skip(1).filter(|line| !line.starts_with('#')))
        .flat_map(|line| line.split_whitespace().map(|n| n.parse().unwrap()))
        .collect();
    assert_eq!(numbers[..3], [u32::from(colour::Colour::COUNT), 1, 255]);
    assert_eq!(numbers.len(), 3 + 3 * usize::from(colour::Colour::COUNT));
}
