//! Collects the pieces of furniture.

use super::colour::Colour;
use super::pieces::{Facets, Foliage, Grid, Growth, LEAF_TRIANGLES, Shape};
use super::random::Random;
use crate::generate::surface::Surface;

/// A surface of one colour.
pub(super) struct Piece {
    pub(super) surface: Box<dyn Surface + Send>,
    pub(super) colour: Colour,
}

/// A plant whose leaves are not counted yet.
struct Plant {
    /// Its share of all leaves, relative to other plants.
    weight: u64,
    /// With more leaves than this each is smaller, so that the plant stays as dense.
    full_sized: u64,
    colour: Colour,
    growth: Growth,
}

/// A room under construction.
pub(super) struct Builder {
    /// Edges per metre of cloth.
    detail: u64,
    /// Depth of folds in cloth, in metres.
    pub(super) folds: f64,
    pub(super) seed: u64,
    sequences: u64,
    pub(super) pieces: Vec<Piece>,
    plants: Vec<Plant>,
}

impl Builder {
    pub(super) fn new(detail: u64, folds: f64, seed: u64) -> Self {
        Self { detail, folds, seed, sequences: 0, pieces: Vec::new(), plants: Vec::new() }
    }

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

    /// The length of an edge of cloth.
    pub(super) fn edge(&self) -> f64 {
        1.0 / self.detail as f64
    }

    pub(super) fn facets(&mut self, facets: Facets, colour: Colour) {
        self.pieces.push(Piece { surface: Box::new(facets), colour });
    }

    /// A sheet with a border, with this number of cells.
    pub(super) fn sheet(&mut self, [across, along]: [u64; 2], colour: Colour, shape: Shape) {
        let grid = Grid { across, along, is_round: false, shape };
        self.pieces.push(Piece { surface: Box::new(grid), colour });
    }

    /// A closed body, with this number of cells around and along.
    pub(super) fn body(&mut self, [across, along]: [u64; 2], colour: Colour, shape: Shape) {
        let grid = Grid { across, along, is_round: true, shape };
        self.pieces.push(Piece { surface: Box::new(grid), colour });
    }

    /// Leaves that [`Self::grow`] will count.
    pub(super) fn plant(&mut self, weight: u64, full_sized: u64, colour: Colour, growth: Growth) {
        self.plants.push(Plant { weight, full_sized, colour, growth });
    }

    /// The number of triangles that are not in leaves.
    pub(super) fn triangles(&self) -> u64 {
        self.pieces.iter().map(|piece| piece.surface.triangles()).sum()
    }

    /// Distributes this number of triangles over the plants, by their weights.
    pub(super) fn grow(&mut self, triangles: u64) {
        let all: u64 = self.plants.iter().map(|plant| plant.weight).sum();
        let mut weights = 0;
        for (number, plant) in (0..).zip(std::mem::take(&mut self.plants)) {
            let before = triangles * weights / all;
            weights += plant.weight;
            let triangles = triangles * weights / all - before;
            let leaves = triangles.div_ceil(LEAF_TRIANGLES).max(plant.full_sized);
            let scale = (plant.full_sized as f64 / leaves as f64).sqrt();
            let seed = self.seed ^ (u64::MAX - number);
            let foliage = Foliage { triangles, scale, seed, growth: plant.growth };
            self.pieces.push(Piece { surface: Box::new(foliage), colour: plant.colour });
        }
    }
}
