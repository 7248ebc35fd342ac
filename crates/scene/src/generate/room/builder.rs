//! Collects the pieces of furniture, and what they are made with: places and random numbers.

use std::f64::consts::TAU;

use glam::DVec3;

use super::colour::Colour;
use super::plants::{LEAF_TRIANGLES, Leaf};
use super::solids::{Facets, Soup};
use crate::generate::grid::{Ends, Grid};
use crate::generate::noise::mix;
use crate::generate::surface::Surface;

/// A surface of one colour.
pub(super) struct Piece {
    pub(super) surface: Box<dyn Surface + Send>,
    pub(super) colour: Colour,
}

/// Grows a plant's leaves: each from its own random numbers, at a share of their full size.
type Growth = Box<dyn Fn(&mut Random, f64) -> Leaf + Send + Sync>;

/// A plant whose leaves are not counted yet.
pub(super) struct Plant {
    /// Its share of all leaves, relative to other plants.
    weight: u64,
    /// With more leaves than this each is smaller, so that the plant stays as dense.
    full_sized: u64,
    colour: Colour,
    growth: Growth,
}

/// A room under construction.
#[derive(Default)]
pub(super) struct Builder {
    /// Edges per metre of cloth.
    pub(super) detail: u64,
    /// Depth of folds in cloth, in metres.
    pub(super) folds: f64,
    pub(super) seed: u64,
    /// The sequences of random numbers given out.
    pub(super) sequences: u64,
    pub(super) pieces: Vec<Piece>,
    pub(super) plants: Vec<Plant>,
}

impl Builder {
    /// A separate sequence of random numbers.
    pub(super) fn random(&mut self) -> Random {
        self.sequences += 1;
        Random::new(self.seed, self.sequences)
    }

    /// The steps for a length in metres, `fineness` times those of cloth, at least `least`.
    ///
    /// Lengths must not be random: seeds must not change the number of triangles.
    pub(super) fn steps(&self, length: f64, fineness: f64, least: u64) -> u64 {
        ((length * fineness * self.detail as f64) as u64).max(least)
    }

    fn add(&mut self, surface: impl Surface + Send + 'static, colour: Colour) {
        self.pieces.push(Piece { surface: Box::new(surface), colour });
    }

    /// Flat parts: first their quads, then their triangles.
    pub(super) fn flat(&mut self, colour: Colour, add: impl FnOnce(&mut Facets)) {
        let mut facets = Facets::default();
        add(&mut facets);
        for (sides, all) in [(4, facets.quads), (3, facets.triangles)] {
            if !all.is_empty() {
                let facets = all.len() as u64;
                let facet = Box::new(move |number| all[number as usize]);
                self.add(Soup { sides, facets, facet }, colour);
            }
        }
    }

    /// A sheet with a border, or a closed body, with this number of cells around and along.
    pub(super) fn grid(
        &mut self,
        ends: Ends,
        cells: [u64; 2],
        colour: Colour,
        shape: impl Fn(f64, f64) -> DVec3 + Send + Sync + 'static,
    ) {
        self.add(Grid { cells, ends, shape: Box::new(shape) }, colour);
    }

    /// Leaves that [`Self::grow`] will count.
    pub(super) fn plant(
        &mut self,
        weight: u64,
        full_sized: u64,
        colour: Colour,
        growth: impl Fn(&mut Random, f64) -> Leaf + Send + Sync + 'static,
    ) {
        self.plants.push(Plant { weight, full_sized, colour, growth: Box::new(growth) });
    }

    /// The number of triangles that are not in leaves.
    pub(super) fn triangles(&self) -> u64 {
        self.pieces.iter().map(|piece| piece.surface.triangles()).sum()
    }

    /// Distributes this number of triangles over the plants, by their weights. If that of a plant
    /// is not a multiple of [`LEAF_TRIANGLES`], its last leaf is cut.
    pub(super) fn grow(&mut self, triangles: u64) {
        let all: u64 = self.plants.iter().map(|plant| plant.weight).sum();
        let mut weights = 0;
        for (number, plant) in (0..).zip(std::mem::take(&mut self.plants)) {
            let before = triangles * weights / all;
            weights += plant.weight;
            let facets = triangles * weights / all - before;
            let leaves = facets.div_ceil(LEAF_TRIANGLES).max(plant.full_sized);
            let scale = (plant.full_sized as f64 / leaves as f64).sqrt();
            let seed = self.seed ^ (u64::MAX - number);
            let facet = Box::new(move |t| {
                let mut random = Random::new(seed, t / LEAF_TRIANGLES);
                (plant.growth)(&mut random, scale).triangle(t % LEAF_TRIANGLES)
            });
            self.add(Soup { sides: 3, facets, facet }, plant.colour);
        }
    }
}

/// A frame: the origin and the three axes of a space, in the room.
#[derive(Clone, Copy)]
pub(super) struct Place {
    origin: DVec3,
    axes: [DVec3; 3],
}

impl Place {
    /// The room's axes at a point.
    pub(super) fn at(x: f64, y: f64, z: f64) -> Self {
        Self { origin: DVec3::new(x, y, z), axes: DVec3::AXES }
    }

    /// A point of this space, in the room.
    pub(super) fn point(&self, p: DVec3) -> DVec3 {
        self.origin + self.direction(p)
    }

    /// A direction of this space, in the room.
    pub(super) fn direction(&self, d: DVec3) -> DVec3 {
        self.axes[0] * d.x + self.axes[1] * d.y + self.axes[2] * d.z
    }

    /// Moved along its own axes.
    pub(super) fn moved(self, x: f64, y: f64, z: f64) -> Self {
        Self { origin: self.point(DVec3::new(x, y, z)), ..self }
    }

    /// Scaled in its own space.
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { axes: self.axes.map(|axis| axis * factor), ..self }
    }

    /// Turned about its own x axis, in degrees: y towards z.
    pub(super) fn pitched(self, degrees: f64) -> Self {
        self.rotated(1, 2, degrees)
    }

    /// Turned about its own y axis, in degrees: z towards x.
    pub(super) fn turned(self, degrees: f64) -> Self {
        self.rotated(2, 0, degrees)
    }

    /// Turned about its own z axis, in degrees: x towards y.
    pub(super) fn rolled(self, degrees: f64) -> Self {
        self.rotated(0, 1, degrees)
    }

    /// Turned so that axis `from` goes towards axis `to`.
    fn rotated(mut self, from: usize, to: usize, degrees: f64) -> Self {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let (a, b) = (self.axes[from], self.axes[to]);
        self.axes[from] = a * cos + b * sin;
        self.axes[to] = b * cos - a * sin;
        self
    }
}

/// A sequence of random numbers.
#[derive(Clone, Copy)]
pub(super) struct Random(u64);

impl Random {
    /// Sequence `which` of `seed`.
    pub(super) fn new(seed: u64, which: u64) -> Self {
        Self(mix(mix(seed) ^ which))
    }

    /// Uniform in \[0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = mix(self.0);
        // The 53 bits of a mantissa.
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One of several, equally likely.
    pub(super) fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.unit() * all.len() as f64) as usize]
    }

    /// Uniform on the unit sphere.
    pub(super) fn direction(&mut self) -> DVec3 {
        let y = self.between(-1.0, 1.0);
        let (sin, cos) = libm::sincos(self.between(0.0, TAU));
        let radius = (1.0 - y * y).sqrt();
        DVec3::new(radius * cos, y, radius * sin)
    }
}
