//! The inputs of an image: parts that agree in all of them belong together.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::metadata::Entry;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::film::checked_pixel_count;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::units::Grid;
use wavecrest_core::render::{RenderOptions, tile_edge, window};
use wavecrest_core::tile::Tile;
use wavecrest_core::wavefront::DEFAULT_BATCH;

/// With fewer tiles than this, tiles are made smaller, so that many machines can share a small
/// image.
const MIN_TILES: u32 = 1024;

/// The same for passes, each of which waits for the last tile of the one before.
const LEAST_TILES: u32 = 128;

/// The possible sides of a tile in pixels, which suit the tracers' order of pixels.
const EDGES: [u32; 4] = [8, 16, 32, 64];

/// Largest number of samples of a pixel in a scene.
const MAX_SAMPLES: u32 = 1 << 24;

/// The name of the last difference that is looked for.
const SCENE: &str = "scene";

/// The inputs of an image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// The program's version.
    pub program: String,
    /// The precision's name.
    pub precision: String,
    /// Width and height of the whole image, in pixels.
    pub image: [u32; 2],
    /// The rendered part of it: x, y, width and height, in pixels from the top left.
    pub window: [u32; 4],
    /// Camera rays for each pixel.
    pub samples: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// The side of a tile, in pixels.
    pub edge: u32,
    /// The hash of the scene, in hexadecimal: see [`PreparedScene::fingerprint`].
    pub scene: String,
}

impl Identity {
    /// The identity of a render of `scene`.
    ///
    /// # Errors
    /// If the crop has no pixels or is not within the image.
    pub fn of(scene: &PreparedScene, options: &RenderOptions) -> Result<Self> {
        let Tile { x, y, width, height } = window(scene, options.crop)?;
        Ok(Self {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            precision: scene.accel.geometry().precision.name().to_owned(),
            image: scene.camera.size(),
            window: [x, y, width, height],
            samples: scene.camera.rays_per_pixel(),
            seed: options.seed,
            edge: edge(tile_edge(scene, DEFAULT_BATCH), MIN_TILES, [width, height]),
            scene: format!("{:032x}", scene.fingerprint()),
        })
    }

    /// The metadata of the image, the program first: all its inputs, and the `command` if that is asked for, as different
    /// commands may give the same image.
    pub fn entries(&self, command: Option<String>) -> Vec<Entry> {
        let Self { image: [width, height], window, .. } = *self;
        let entry = |name, text| Some(Entry { name, text });
        let is_cropped = window != [0, 0, width, height];
        // A text that is no number was not written by this program, and means nothing.
        let scene = u128::from_str_radix(&self.scene, 16).unwrap_or_default();
        let entries = [
            entry("software", format!("wavecrest {}", self.program)),
            entry("scene", format!("{scene:032x}")),
            entry("seed", self.seed.to_string()),
            entry("samples", self.samples.to_string()),
            entry("precision", self.precision.clone()),
            entry("crop", window.map(|side| side.to_string()).join(",")).filter(|_| is_cropped),
            command.and_then(|command| entry("command", command)),
        ];
        entries.into_iter().flatten().collect()
    }

    /// The tiles, which do not depend on the options of the render.
    pub fn grid(&self) -> Grid {
        let [x, y, width, height] = self.window;
        Grid::new(Tile { x, y, width, height }, self.edge)
    }

    /// The same image in [passes](super::Passes), which may have few samples: larger tiles fill a batch with them.
    #[must_use]
    pub(super) fn of_passes(self) -> Self {
        let [.., width, height] = self.window;
        Self { edge: edge(EDGES[3], LEAST_TILES, [width, height]), ..self }
    }

    /// Checks that this identity, of `file`, is the `other`, which is that of the `owner`; `than` is what it then differs from,
    /// and there is a remedy for choices of the user and one for the scene.
    ///
    /// # Errors
    /// If it is not, with the first difference: choices of the user come before properties of files.
    pub(super) fn check_same(
        &self,
        file: &Path,
        other: &Self,
        [than, owner]: [&str; 2],
        [choices, scene]: [&str; 2],
    ) -> Result<()> {
        let all = |identity: &Self| {
            let Self { program, precision, image, window, samples, seed, .. } = identity;
            let [width, height] = image;
            let [x, y, w, h] = window;
            [
                ("version of the program", program.clone()),
                ("precision", precision.clone()),
                ("image size", format!("{width} x {height}")),
                ("part of the image", format!("{x},{y},{w},{h}")),
                ("number of samples per pixel", samples.to_string()),
                ("seed", seed.to_string()),
                ("size of tiles", identity.edge.to_string()),
                (SCENE, identity.scene.clone()),
            ]
        };
        let mut pairs = all(self).into_iter().zip(all(other));
        let Some(((what, found), (_, expected))) = pairs.find(|(one, other)| one != other) else {
            return Ok(());
        };
        let message = format!("the {what} differs from that of {than}");
        let error = Error::new(ErrorKind::Usage, message).in_file(file);
        Err(match what {
            // The text of a hash does not help.
            SCENE => error.remedy(scene),
            _ => error.value(found).remedy(format!("{owner} has {expected}; {choices}")),
        })
    }

    /// Checks that a render can have these numbers: they may come from a damaged file.
    ///
    /// # Errors
    /// If they are invalid, with the place and the value.
    pub fn check(&self) -> Result<()> {
        let wrong = |place: &str, value: String, remedy: &str| {
            Err(Error::new(ErrorKind::Syntax, "this is not a valid part of a render")
                .at(place)
                .value(value)
                .remedy(remedy))
        };
        let [width, height] = self.image;
        checked_pixel_count(width, height).map_err(|error| error.at("identity.image"))?;
        let [x, y, w, h] = self.window.map(u64::from);
        let fits = w > 0 && h > 0 && x + w <= u64::from(width) && y + h <= u64::from(height);
        if !fits {
            let remedy = "it must have pixels and lie within the image";
            return wrong("identity.window", format!("{:?}", self.window), remedy);
        }
        if self.samples == 0 || self.samples > MAX_SAMPLES {
            let remedy = "a pixel has 1 to 2^24 samples";
            return wrong("identity.samples", self.samples.to_string(), remedy);
        }
        if !EDGES.contains(&self.edge) {
            let remedy = "a tile has 8, 16, 32 or 64 pixels a side";
            return wrong("identity.edge", self.edge.to_string(), remedy);
        }
        Ok(())
    }
}

/// The side of a tile: up to the `usual` one, and smaller if there would be fewer than so many tiles.
fn edge(usual: u32, least_tiles: u32, [width, height]: [u32; 2]) -> u32 {
    let window = Tile { x: 0, y: 0, width, height };
    let fits = |edge: &&u32| **edge <= usual;
    let mut edges = EDGES.iter().rev().filter(fits).copied();
    edges.find(|edge| Grid::new(window, *edge).len() >= least_tiles).unwrap_or(EDGES[0])
}
