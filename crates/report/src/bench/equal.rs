//! Whether two renders gave the same image by the same work.

use serde::Serialize;

use wavecrest_core::counters::Counters;
use wavecrest_core::film::Film;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::render::Rendered;

/// A difference of a run from the first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunDifference {
    /// What differs.
    pub label: String,
    /// The first run.
    pub over: String,
    /// Whether the images differ, or only the work.
    pub is_image: bool,
    /// The first pixel that differs, row by row from the top, or the first count.
    pub first: String,
    /// Its value in the first run, with the bits of a pixel in hexadecimal.
    pub expected: String,
    /// Its value in the different run.
    pub found: String,
}

impl RunDifference {
    /// The difference of `run` from the `first`, if any. In fast precision kernels and levels may
    /// differ at edges, so nothing is compared.
    pub(crate) fn of([label, over]: [&str; 2], run: &Rendered, first: &Rendered) -> Option<Self> {
        let of = |is_image: bool, first: String, [expected, found]: [String; 2]| {
            let (label, over) = (label.to_owned(), over.to_owned());
            Some(Self { label, over, is_image, first, expected, found })
        };
        if run.precision == Precision::Fast {
            return None;
        }
        if !first.film.same_bits(&run.film) {
            let (place, values) = first_pixel(&first.film, &run.film);
            return of(true, place, values);
        }
        // Tiles of background alone cast no camera rays.
        let same_tiles = first.tiles == run.tiles;
        let counts = work(&first.counters).into_iter().zip(work(&run.counters));
        let mut counts = counts.filter(|((name, _), _)| same_tiles || !OF_TILES.contains(name));
        let ((name, expected), (_, found)) = counts.find(|(a, b)| a != b)?;
        of(false, name.to_owned(), [expected, found].map(|count| count.to_string()))
    }

    /// In words.
    pub fn words(&self) -> String {
        let Self { label, over, is_image, first, expected, found } = self;
        match is_image {
            true => format!(
                "THE IMAGES DIFFER, first at {first}: {label} has {found}, {over} has {expected}"
            ),
            false => format!(
                "THE WORK DIFFERS: {label} counts {found} {first}, {over} {expected}; the images are equal"
            ),
        }
    }
}

/// The counts that depend on the tiles.
const OF_TILES: [&str; 2] = ["primary_rays", "lens_samples"];

/// Every count except tests and kernels, which differ between the tracers.
fn work(c: &Counters) -> [(&'static str, u64); 14] {
    [
        ("primary_rays", c.rays.primary),
        ("secondary_rays", c.rays.secondary),
        ("shadow_rays", c.rays.shadow),
        ("lens_samples", c.samples.lens),
        ("light_samples", c.samples.light),
        ("plain", c.samples.plain),
        ("mapped", c.samples.mapped),
        ("maps", c.samples.maps),
        ("colors", c.samples.colors),
        ("texels", c.samples.texels),
        ("footprints", c.samples.footprints),
        ("invalid", c.invalid),
        ("lights_at_surface", c.lights_at_surface),
        ("cut_short", c.cut_short),
    ]
}

/// The first pixel in which two images of one size differ, and its value in each.
fn first_pixel(expected: &Film, found: &Film) -> (String, [String; 2]) {
    let same = |(a, b): (&[f32; 3], &[f32; 3])| a.map(f32::to_bits) == b.map(f32::to_bits);
    let pairs = expected.pixels().iter().zip(found.pixels());
    let index = pairs.take_while(|&pair| same(pair)).count() as u32;
    let (x, y) = (index % expected.width(), index / expected.width());
    let values = [expected, found].map(|film| {
        let [r, g, b] = film.pixel(x, y).unwrap_or_default();
        let bits = [r, g, b].map(|value| format!("{:08x}", value.to_bits())).join(" ");
        format!("{r:?} {g:?} {b:?} (bits {bits})")
    });
    (format!("column {x}, row {y}"), values)
}
