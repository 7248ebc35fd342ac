//! Collects the pieces of furniture.

use glam::DVec3;

use super::colour::Colour;
use super::facets::{Facets, Soup};
use super::leaf::{LEAF_TRIANGLES, Leaf};
use super::random::Random;
use crate::generate::grid::{Ends, Grid};
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
