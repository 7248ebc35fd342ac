//! Whether two renders gave the same image by the same work.

use serde::Serialize;

use wavecrest_core::counters::Counters;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::render::Rendered;

/// A difference of a run from the first.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "what", rename_all = "kebab-case")]
pub enum Difference {
    /// In its image.
    Pixel {
        /// The first pixel that differs, row by row from the top: its column.
        x: u32,
        /// Its row.
        y: u32,
        /// Its value in the first image.
        expected: Pixel,
        /// Its value in the different image.
        found: Pixel,
    },
    /// Only in its work.
    Work {
        /// The first count that differs, by its name in [`Counters`].
        count: &'static str,
        /// That count in the first run.
        expected: u64,
        /// That count in the different run.
        found: u64,
    },
}

/// A pixel to the last bit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pixel {
    /// Red, green and blue.
    pub values: [f32; 3],
    /// The bits of each, in hexadecimal.
    pub bits: [String; 3],
}

impl Difference {
    /// The difference of `run` from the `first`, if any. In fast precision kernels and levels may
    /// differ at edges, so nothing is compared.
    pub(crate) fn of(first: &Rendered, run: &Rendered) -> Option<Self> {
        if run.precision == Precision::Fast {
            return None;
        }
        if !first.film.same_bits(&run.film) {
            return Some(first_pixel(&first.film, &run.film));
        }
        // Tiles of background alone cast no camera rays.
        let same_tiles = first.tiles == run.tiles;
        let counts = work(&first.counters).into_iter().zip(work(&run.counters));
        let mut counts = counts.filter(|((name, _), _)| same_tiles || !OF_TILES.contains(name));
        let ((count, expected), (_, found)) = counts.find(|(a, b)| a != b)?;
        Some(Self::Work { count, expected, found })
    }

    /// In words: what `name` has, against the `first`.
    pub fn words(&self, name: &str, first: &str) -> String {
        match self {
            Self::Pixel { x, y, expected, found } => format!(
                "THE IMAGES DIFFER, first at column {x}, row {y}: {name} has {}, {first} has {}",
                found.words(),
                expected.words()
            ),
            Self::Work { count, expected, found } => format!(
                "THE WORK DIFFERS: {name} counts {found} {count}, {first} {expected}; the images are \
                 equal"
            ),
        }
    }
}

impl Pixel {
    fn new(values: [f32; 3]) -> Self {
        Self { values, bits: values.map(|v| format!("{:08x}", v.to_bits())) }
    }

    fn words(&self) -> String {
        let ([r, g, b], bits) = (self.values, self.bits.join(" "));
        format!("{r:?} {g:?} {b:?} (bits {bits})")
    }
}

/// The counts that depend on the tiles.
const OF_TILES: [&str; 2] = ["primary_rays", "lens_samples"];

/// Every count except tests and kernels, which differ between the tracers.
fn work(c: &Counters) -> [(&'static str, u64); 10] {
    [
        ("primary_rays", c.primary_rays),
        ("secondary_rays", c.secondary_rays),
        ("shadow_rays", c.shadow_rays),
        ("lens_samples", c.lens_samples),
        ("light_samples", c.light_samples),
        ("colors", c.colors),
        ("texels", c.texels),
        ("footprints", c.footprints),
        ("invalid", c.invalid),
        ("lights_at_surface", c.lights_at_surface),
    ]
}

/// The first pixel that differs between two images of one size, which are known to differ.
fn first_pixel(expected: &Film, found: &Film) -> Difference {
    let same = |(a, b): (&[f32; 3], &[f32; 3])| a.map(f32::to_bits) == b.map(f32::to_bits);
    let pairs = expected.pixels().iter().zip(found.pixels());
    let index = pairs.take_while(|&pair| same(pair)).count() as u32;
    let (x, y) = (index % expected.width(), index / expected.width());
    let pixel = |film: &Film| Pixel::new(film.pixel(x, y).unwrap_or_default());
    Difference::Pixel { x, y, expected: pixel(expected), found: pixel(found) }
}
