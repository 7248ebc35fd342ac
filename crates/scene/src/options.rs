//! Options for loading a scene.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::format::Notes;
use framing::{Framing, LookAt};
use lighting::Lighting;
use wavecrest_core::math::sampling::Sampling;

pub mod framing;
pub mod lighting;

/// Largest side of the grid of rays in each pixel.
pub(crate) const MOST_ANTIALIAS: u32 = 64;

/// Options for loading a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// Whether unknown keys are errors instead of warnings.
    pub strict: bool,
    /// The width of the image in pixels, overriding the file's.
    pub width: Option<u32>,
    /// The height of the image in pixels, overriding the file's.
    pub height: Option<u32>,
    /// The side of the grid of rays in each pixel, overriding the file's.
    pub antialias: Option<u32>,
    /// The distribution of the rays in each pixel, overriding the file's: then each has one point on a lens.
    pub sampling: Option<Sampling>,
    /// The camera to use in files with several, by its name or number.
    pub camera: Option<String>,
    /// Whether glTF and OBJ files may refer to files outside their folder.
    pub allow_outside: bool,
    /// Framing of a mesh or glTF file, which replaces its cameras. A scene file has its own camera.
    pub framing: Framing,
    /// Where the camera is taken from its place in the file, or from that of the framing.
    pub look_at: Option<LookAt>,
    /// Lighting of files without lights.
    pub lighting: Lighting,
    /// The linear colour of a standalone mesh where it has no material.
    pub color: Option<DVec3>,
    /// An image by longitude and latitude around a standalone mesh, which lights it in place of other lights.
    pub environment: Option<PathBuf>,
    /// Whether a glTF file stands for meshes of another program, which are shown like those of mesh files: the up axis is
    /// guessed, vertex colours have the sRGB curve, edges are smoothed by their angle, and a surface without a material
    /// has the usual one of meshes, whose opacity is the alpha of its vertices.
    pub like_meshes: bool,
    /// The number of faces to read of a file, those that come first. It is an error if the file is no binary PLY or STL
    /// with more.
    pub first: Option<u64>,
}

/// The most rays per pixel, of the largest grid.
pub const MOST_SAMPLES: u32 = MOST_ANTIALIAS * MOST_ANTIALIAS;

/// The side of the smallest grid of this number of rays or more, for [`LoadOptions::antialias`].
pub fn antialias(samples: u32) -> u32 {
    let side = samples.isqrt();
    if side * side < samples { side + 1 } else { side }
}

impl LoadOptions {
    /// The side of the grid of rays in each pixel: the requested one, within the limits, or the file's `own`.
    pub(crate) fn antialias_or(&self, own: u32) -> u32 {
        self.antialias.map_or(own, |side| side.clamp(1, MOST_ANTIALIAS))
    }

    /// Empty notes on `file`.
    pub(crate) fn notes<'a>(&self, file: &'a Path) -> Notes<'a> {
        Notes::new(file, self.strict, self.allow_outside)
    }
}
