//! What furniture is made of: boards, cushions, turned bodies, cloth and leaves.

use std::f64::consts::TAU;

use glam::{DAffine3, DQuat, DVec2, DVec3, Vec3, dvec2, dvec3};
use wavecrest_scene::mesh::{Attribute, MeshData};

/// A colour as screens show it.
pub(crate) type Colour = [u8; 3];
/// The outline of a turned body: radius and height of points in millimetres, with the outside on
/// the right.
pub(crate) type Profile = &'static [[i16; 2]];

/// A space in the room, in metres and y up.
#[derive(Clone, Copy)]
pub(crate) struct Place(DAffine3);

impl Place {
    /// The room's own axes at a point.
    pub(crate) fn at(x: f64, y: f64, z: f64) -> Self {
        Self(DAffine3::from_translation(dvec3(x, y, z)))
    }

    /// Moved along its own axes.
    pub(crate) fn moved(self, x: f64, y: f64, z: f64) -> Self {
        Self(self.0 * Self::at(x, y, z).0)
    }

    /// Scaled in its own space.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self(self.0 * DAffine3::from_scale(DVec3::splat(factor)))
    }

    /// Turned about an axis of its own, in degrees, by a function that is the same everywhere.
    pub(crate) fn turned(self, axis: DVec3, degrees: f64) -> Self {
        let (sin, cos) = libm::sincos(degrees.to_radians() / 2.0);
        Self(self.0 * DAffine3::from_quat(DQuat::from_vec4((axis * sin).extend(cos))))
    }
}

/// A surface of one colour: a point for each pair of numbers from 0 to 1. Its front is where the
/// cross product of the two derivatives points.
struct Patch {
    cells: [usize; 2],
    colour: Colour,
    at: Box<dyn Fn(f64, f64) -> DVec3>,
}

/// A room that is being furnished.
pub(crate) struct Room {
    /// Edges per metre of cloth.
    detail: f64,
    patches: Vec<Patch>,
    /// The ellipsoids that leaves fill, by their half sizes.
    crowns: Vec<(DAffine3, DVec3)>,
    pub(crate) random: Random,
}

impl Room {
    pub(crate) fn new(detail: u32) -> Self {
        let (patches, crowns) = (Vec::new(), Vec::new());
        Self { detail: f64::from(detail), patches, crowns, random: Random(1) }
    }

    /// The number of triangles without leaves.
    pub(crate) fn triangles(&self) -> usize {
        self.patches.iter().map(|patch| 2 * patch.cells[0] * patch.cells[1]).sum()
    }

    fn steps(&self, length: f64, least: usize) -> usize {
        least.max((length * self.detail) as usize)
    }

    fn patch(
        &mut self,
        cells: [usize; 2],
        colour: Colour,
        at: impl Fn(f64, f64) -> DVec3 + 'static,
    ) {
        self.patches.push(Patch { cells, colour, at: Box::new(at) });
    }

    /// The six sides of a cube from -1 to 1, as `shape` places and bends it.
    fn sides(
        &mut self,
        cells: [usize; 3],
        colour: Colour,
        shape: impl Fn(DVec3) -> DVec3 + Copy + 'static,
    ) {
        for (i, j, axis) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            // The opposite side has its axes in the other order, and so faces outward too.
            for (i, j, sign) in [(i, j, 1.0), (j, i, -1.0)] {
                self.patch([cells[i], cells[j]], colour, move |u, v| {
                    let mut p = DVec3::ZERO;
                    (p[i], p[j], p[axis]) = (2.0 * u - 1.0, 2.0 * v - 1.0, sign);
                    shape(p)
                });
            }
        }
    }

    /// A block between two corners, of twelve triangles.
    pub(crate) fn board(&mut self, place: Place, low: [f64; 3], high: [f64; 3], colour: Colour) {
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        self.sides([1; 3], colour, move |p| place.0.transform_point3(middle + p * half));
    }

    /// A cushion in a box of these half sizes. The sum of its coordinates' powers is constant:
    /// squares, as in an ellipsoid, are doubled powers once, fourth powers twice.
    pub(crate) fn cushion(&mut self, place: Place, half: [f64; 3], doubled: u32, colour: Colour) {
        let cells = half.map(|half| self.steps(3.0 * half, 2));
        self.sides(cells, colour, move |p| {
            let powers = (0..doubled).fold(p, |p, _| p * p);
            let size = (0..doubled).fold(powers.element_sum(), |sum, _| sum.sqrt());
            place.0.transform_point3(p / size * DVec3::from(half))
        });
    }

    /// The body that `profile` sweeps around the y axis of `place`.
    pub(crate) fn lathe(&mut self, place: Place, profile: Profile, colour: Colour) {
        /// Edges of turned bodies for each of cloth.
        const FINENESS: f64 = 3.0;
        /// The radius left free around the axis, so that triangles there have an area.
        const HOLE: f64 = 1e-4;
        let metres = |mm: i16| f64::from(mm) / 1000.0;
        let points = profile.iter().map(|&[r, y]| dvec2(HOLE + metres(r), metres(y)));
        let points: Vec<DVec2> = points.collect();
        let widest = points.iter().fold(0.0, |widest: f64, p| widest.max(p.x));
        let length: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let cells = [
            self.steps(FINENESS * TAU * widest, 5),
            self.steps(FINENESS * length, profile.len() - 1),
        ];
        self.patch(cells, colour, move |u, v| {
            let p = spline(&points, v);
            // Both ends of a ring have the same bits.
            let (sin, cos) = libm::sincos(TAU * (u % 1.0));
            place.0.transform_point3(dvec3(p.x * cos, p.y, -p.x * sin))
        });
    }

    /// A curtain upward and to the right from the origin of `place`, in folds.
    pub(crate) fn curtain(&mut self, place: Place, size: DVec2, colour: Colour) {
        let cells = [self.steps(2.0 * size.x, 28), self.steps(size.y, 2)];
        self.patch(cells, colour, move |u, v| {
            let fold = libm::sin(TAU * 7.0 * u + libm::sin(2.0 * v + 3.0 * u));
            place.0.transform_point3(dvec3(size.x * u, size.y * v, 0.02 * (2.0 - v) * fold))
        });
    }

    /// A cloth on a table of these half sizes, which hangs down by `drop`.
    pub(crate) fn cloth(&mut self, place: Place, half: DVec2, drop: f64, colour: Colour) {
        let size = 2.0 * (half + drop);
        self.patch([self.steps(size.x, 14), self.steps(size.y, 14)], colour, move |u, v| {
            let flat = (dvec2(u, 1.0 - v) - 0.5) * size;
            let edge = flat.clamp(-half, half);
            let (over, outward) = (flat.distance(edge), (flat - edge).normalize_or_zero());
            // At corners cloth spreads, and hangs less far.
            let corner = 4.0 * (outward.x * outward.y).powi(2);
            let along = edge.x - edge.y + 0.2 * libm::atan2(outward.y, outward.x.abs());
            let fold = 0.07 * (1.0 + libm::sin(3.5 * TAU * along)) + 0.5 * corner;
            let p = edge + outward * over * fold;
            place.0.transform_point3(dvec3(p.x, -over * (1.0 - 0.15 * corner), p.y))
        });
    }

    /// An ellipsoid of these half sizes full of leaves.
    pub(crate) fn crown(&mut self, place: Place, half: [f64; 3]) {
        self.crowns.push((place.0, half.into()));
    }

    /// The mesh, with this number of leaves.
    pub(crate) fn mesh(mut self, leaves: usize) -> MeshData {
        let (mut mesh, mut normals, mut colors) = (MeshData::default(), Vec::new(), Vec::new());
        for Patch { cells: [across, along], colour, at } in &self.patches {
            for (j, i) in (0..=*along).flat_map(|j| (0..=*across).map(move |i| (j, i))) {
                if i < *across && j < *along {
                    let a = mesh.positions.len() as u32;
                    let (b, d) = (a + 1, a + *across as u32 + 1);
                    mesh.triangles.extend([[a, b, d + 1], [a, d + 1, d]]);
                }
                let (u, v) = (i as f64 / *across as f64, j as f64 / *along as f64);
                mesh.positions.push(at(u, v).as_vec3());
                normals.push(normal(at, u, v));
                colors.push(Vec3::from(colour.map(f32::from)) / 255.0);
            }
        }
        for leaf in 0..leaves {
            let (place, half) = self.crowns[leaf % self.crowns.len()];
            let corners = self.random.leaf(half, leaves as f64 / self.crowns.len() as f64);
            let [a, b, c] = corners.map(|corner| place.transform_point3(corner).as_vec3());
            let first = mesh.positions.len() as u32;
            mesh.triangles.push([first, first + 1, first + 2]);
            mesh.positions.extend([a, b, c]);
            normals.extend([(b - a).cross(c - a).normalize(); 3]);
            let green = Vec3::new(0.2, 0.4, 0.17) * self.random.between(0.7, 1.4) as f32;
            colors.extend([green; 3]);
        }
        mesh.normals = Some(Attribute { values: normals.into(), indices: None });
        mesh.colors = Some(colors.into());
        mesh
    }
}

/// The normal of a patch, from differences within it.
fn normal(at: impl Fn(f64, f64) -> DVec3, u: f64, v: f64) -> Vec3 {
    let around = |x: f64| [(x - 1e-4).max(0.0), (x + 1e-4).min(1.0)];
    let ([left, right], [down, up]) = (around(u), around(v));
    (at(right, v) - at(left, v)).cross(at(u, up) - at(u, down)).normalize().as_vec3()
}

/// A quadratic B-spline from the first to the last of its points, through the middles of lines
/// between others. A point given twice is a corner.
fn spline(points: &[DVec2], t: f64) -> DVec2 {
    let (s, last) = (t * points.len() as f64, points.len() - 1);
    let span = (s as usize).min(last);
    let (a, b, c) = (points[span.saturating_sub(1)], points[span], points[last.min(span + 1)]);
    let (from, to, f) = (a.midpoint(b), b.midpoint(c), s - span as f64);
    from.lerp(b, f).lerp(b.lerp(to, f), f)
}

/// Random numbers by SplitMix64.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        // The upper half is enough.
        low + (high - low) * (mixed >> 32) as f64 / 4_294_967_296.0
    }

    fn direction(&mut self) -> DVec3 {
        let mut axis = || self.between(-1.0, 1.0);
        dvec3(axis(), axis(), axis()).normalize()
    }

    /// A leaf of one triangle in an ellipsoid of these half sizes. `number` such leaves have the
    /// area of its section several times.
    fn leaf(&mut self, half: DVec3, number: f64) -> [DVec3; 3] {
        let length = (24.0 * half.x * half.y / number).sqrt();
        let (out, across) = (self.direction(), self.direction() * length);
        let base = out * half * self.between(0.2, 1.0);
        let along = (out + self.direction()) * length;
        [base, base + along + across * 0.3, base + along - across * 0.3]
    }
}
