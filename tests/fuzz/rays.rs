//! Bytes become primitives and rays.

use std::path::Path;

use glam::Vec3;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::{Geometry, Quadric};
use wavecrest_core::kernels::disk::Disk;
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_core::math::ray::Ray;
use wavecrest_scene::mesh::{MeshData, validate};

/// What is asked of the tree.
pub(crate) struct Question {
    /// The primitives.
    pub(crate) geometry: Geometry,
    /// The rays.
    pub(crate) rays: Vec<Ray>,
    /// How the tree is built.
    pub(crate) preset: Preset,
    /// The kernels whose answers must be equal: the last one decides, by brute force.
    pub(crate) kernels: &'static [KernelChoice],
}

/// The most rays: five tiles of a packet.
const MOST_RAYS: usize = 320;

/// Numbers that are on the edge of something.
const SPECIAL: [f32; 24] = [
    0.0,
    -0.0,
    1e-45,
    -1e-45,
    f32::MIN_POSITIVE,
    1e-30,
    1e-20,
    -1e-20,
    1e-7,
    f32::EPSILON,
    0.999_999_94,
    1.000_000_1,
    1e6,
    -1e6,
    1e12,
    MAX_COORDINATE,
    -MAX_COORDINATE,
    1e19,
    1e30,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

/// The question that `bytes` are; `None` for a mesh that is refused.
pub(crate) fn question(bytes: &[u8]) -> Option<Question> {
    let mut bytes = Bytes(bytes);
    let first = bytes.one();
    let preset = Preset::ALL[1 + usize::from(first) % (Preset::ALL.len() - 1)];
    // The reference, which is last and slow, takes part in a quarter of them.
    let kernels: &[_] =
        if first / 6 % 4 == 2 { &KernelChoice::ALL } else { &KernelChoice::FOR_RENDERS };
    let geometry = geometry(&mut bytes)?;
    let rays = rays(&mut bytes, &geometry);
    Some(Question { geometry, rays, preset, kernels })
}

/// Bytes one after the other, and zeros after the last.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn one(&mut self) -> u8 {
        let [byte] = self.some();
        byte
    }

    fn some<const N: usize>(&mut self) -> [u8; N] {
        let (taken, rest) = self.0.split_at(N.min(self.0.len()));
        self.0 = rest;
        let mut some = [0; N];
        some[..taken.len()].copy_from_slice(taken);
        some
    }

    fn below(&mut self, end: usize) -> usize {
        usize::from(self.one()) % end
    }

    /// A multiple of a quarter, so that numbers meet, or one of [`SPECIAL`], or any bits.
    fn number(&mut self) -> f32 {
        match self.one() {
            byte @ 0..128 => (f32::from(byte) - 64.0) / 4.0,
            byte @ 128..176 => SPECIAL[usize::from(byte) % SPECIAL.len()],
            _ => f32::from_le_bytes(self.some()),
        }
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::from([(); 3].map(|()| self.number()))
    }
}

/// A number that may be a coordinate: of what cannot, the exponent is changed.
fn folded(x: f32) -> f32 {
    if x.abs() <= MAX_COORDINATE {
        return x;
    }
    f32::from_bits(x.to_bits() - (128 << 23)).clamp(-MAX_COORDINATE, MAX_COORDINATE)
}

fn geometry(bytes: &mut Bytes<'_>) -> Option<Geometry> {
    let folds = !bytes.one().is_multiple_of(4);
    let vertices = bytes.below(64);
    let [triangles, quads, spheres] = [96, 6, 6].map(|most| bytes.below(most));
    let copies = 1 + bytes.below(12);
    let mut positions: Vec<Vec3> = (0..vertices).map(|_| bytes.vector()).collect();
    if folds {
        positions.iter_mut().for_each(|p| *p = Vec3::from(p.to_array().map(folded)));
    }
    let corner = |bytes: &mut Bytes<'_>| match bytes.one() {
        byte @ 0..254 => u32::from(byte) % vertices.max(1) as u32,
        _ if folds => 0,
        _ => u32::from_le_bytes(bytes.some()),
    };
    let triangles = (0..triangles).map(|_| [(); 3].map(|()| corner(bytes))).collect();
    let mesh = MeshData { positions: positions.into(), triangles, ..MeshData::default() };
    let sound = mesh.positions.iter().all(|p| p.abs().max_element() <= MAX_COORDINATE)
        && !mesh.positions.iter().any(|p| p.is_nan())
        && mesh.triangles.as_flattened().iter().all(|&i| (i as usize) < vertices);
    assert_eq!(validate(&mesh, Path::new("mesh")).is_ok(), sound, "{mesh:?}");
    if !sound {
        return None;
    }
    let MeshData { positions, triangles, .. } = mesh;
    let quads = if vertices > 0 { quads } else { 0 };
    let quads = (0..quads).map(|_| [(); 4].map(|()| bytes.below(vertices) as u32)).collect();
    let mut geometry = Geometry { positions, triangles, quads, ..Geometry::default() };
    repeat(&mut geometry, copies, bytes);
    for _ in 0..spheres {
        let (center, radius) = (bytes.vector(), bytes.number().abs());
        if radius > 0.0 && radius <= MAX_COORDINATE {
            let center = Vec3::from(center.to_array().map(folded));
            let normal = bytes.vector().normalize_or_zero();
            geometry.quadrics.push(match normal == Vec3::ZERO {
                true => Quadric::Sphere(center, radius),
                false => Quadric::Disk(Disk { center, normal, radius }),
            });
        }
    }
    lights(&mut geometry, bytes);
    Some(geometry)
}

/// The triangles again and again, each time moved a little farther: large trees from few bytes.
fn repeat(geometry: &mut Geometry, copies: usize, bytes: &mut Bytes<'_>) {
    let step = bytes.vector();
    let (vertices, triangles) = (geometry.positions.len(), geometry.triangles.len());
    for copy in 1..copies {
        for i in 0..vertices {
            let moved = geometry.positions[i] + step * copy as f32;
            geometry.positions.push(Vec3::from(moved.to_array().map(folded)));
        }
        for i in 0..triangles {
            let before = (vertices * copy) as u32;
            let moved = geometry.triangles[i].map(|v| v + before);
            geometry.triangles.push(moved);
        }
    }
}

/// Some primitives become the shapes of lights.
fn lights(geometry: &mut Geometry, bytes: &mut Bytes<'_>) {
    let mut start = 0;
    for _ in 0..bytes.below(4) {
        start += bytes.below(32) as u32;
        let end = (start + 1 + bytes.below(16) as u32).min(geometry.len() as u32);
        if start < end {
            geometry.passed.push(start..end);
        }
        start = end.max(start);
    }
}

/// Bundles of rays that share a start, a target or nothing.
fn rays(bytes: &mut Bytes<'_>, geometry: &Geometry) -> Vec<Ray> {
    let mut rays = Vec::new();
    for _ in 0..1 + bytes.below(12) {
        let [kind, count, size] = bytes.some();
        let origin = bytes.vector();
        let target = match geometry.positions.len() {
            0 => bytes.vector(),
            count if kind & 1 == 0 => geometry.positions[bytes.below(count)],
            _ => bytes.vector(),
        };
        let mut ray = Ray::new(origin, if kind & 2 == 0 { target - origin } else { target });
        if kind & 4 != 0 {
            (ray.t_min, ray.t_max) = (bytes.number(), bytes.number());
        }
        let spread = 2.0_f32.powi(-i32::from(size % 32)) * target.abs().max_element();
        for i in 0..1 + usize::from(count) % 80 {
            // Over a square of eight by eight, as camera rays are.
            let (x, y) = ((i % 8) as f32 - 4.0, (i / 8) as f32 - 4.0);
            let moved = Vec3::new(x, y, if kind & 8 == 0 { x * y } else { 0.0 }) * spread;
            let mut ray = ray;
            if kind & 16 == 0 {
                ray.direction += moved;
            } else {
                ray.origin += moved;
            }
            rays.push(ray);
        }
    }
    rays.truncate(MOST_RAYS);
    rays
}
