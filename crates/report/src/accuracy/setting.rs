//! The settings of a sweep, and the families that they form.

use serde::Serialize;

use crate::summary::Uncertain;
use wavecrest_core::kernels::light::Light;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::sampling::{Points, Sampling};
use wavecrest_core::prepared::{PreparedScene, Samples};
use wavecrest_scene::components::Filter;
use wavecrest_scene::systems::overrides::Overrides;

/// One way to render a scene. `None` keeps the value of the scene's file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setting {
    /// The precision of hits, chosen before the scene is prepared.
    pub precision: Precision,
    /// Overrides of the scene's file, chosen before it is prepared.
    pub overrides: Overrides,
    /// Choices for each render.
    pub samples: Samples,
}

impl Setting {
    /// A rough measure of a render's work: points in each pixel.
    pub fn work(&self) -> u64 {
        let Samples { lights, lens, pixel } = self.samples;
        let points = [lights, lens, pixel].into_iter().flatten().map(|p| u64::from(p.count()));
        // The camera ray, and what is shaded at its hit.
        2 + points.product::<u64>()
    }

    /// A short unique description: the key of its records.
    pub fn key(&self) -> String {
        let points = |p: Points| format!("{}:{}", p.sampling.name(), p.side);
        let Samples { lights, lens, pixel } = self.samples;
        let Overrides { bounces, filter } = self.overrides;
        let values = [
            ("lights", lights.map(points)),
            ("lens", lens.map(points)),
            ("pixel", pixel.map(points)),
            ("bounces", bounces.map(|n| n.to_string())),
            ("filter", filter.map(|filter| filter.name().to_owned())),
        ];
        let words = values.into_iter().filter_map(|(name, value)| Some((name, value?)));
        let key = self.precision.name().to_owned();
        words.fold(key, |key, (name, value)| format!("{key} {name}={value}"))
    }
}

/// Whether the error of a setting with this [key](Setting::key) converges to 0 with more points.
pub fn converges(key: &str) -> bool {
    key.contains(':') && !key.contains("filter=")
}

wavecrest_base::choices! {
    /// The image to which a setting converges. Names are those in files.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Truth {
        /// The scene of the file, with any number of the samples that it has.
        #[default]
        Scene = "scene",
        /// The mean over the area of each pixel, even if the file samples its centre.
        Pixel = "pixel",
    }
}

/// Settings that differ in one property, or what was found of them.
#[derive(Clone, Debug, Serialize)]
pub struct Family<P> {
    /// Its name in files.
    pub name: &'static str,
    /// The property, as a heading.
    pub title: &'static str,
    /// The label of the count.
    pub counted: String,
    /// The target of the settings.
    pub target: Truth,
    /// The settings by their other differences.
    pub series: Vec<SettingSeries<P>>,
}

/// Settings in the order of the count.
#[derive(Clone, Debug, Serialize)]
pub struct SettingSeries<P> {
    /// Their common properties.
    pub name: String,
    /// The exponent of the mean squared error as a function of the count, once it is found.
    pub slope: Option<Uncertain>,
    /// The settings.
    pub points: Vec<P>,
}

/// A count, its label, and the setting.
pub type CountedSetting = (f64, String, Setting);

impl<P> Family<P> {
    /// The settings of all series.
    pub fn points(&self) -> impl Iterator<Item = &P> {
        self.series.iter().flat_map(|series| &series.points)
    }
}

/// The properties of a scene that can be varied.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Whether there is an image of a texture.
    pub has_textures: bool,
    /// Whether the camera has a lens.
    pub has_lens: bool,
    /// Whether a pixel has several rays.
    pub is_antialiased: bool,
    /// Where random points of lights are; empty without any.
    pub lights: &'static str,
    /// Largest number of bounces in use.
    pub bounces: u32,
}

/// Where points of lights are: with those of the sky, and with those of others.
const PLACES: [[&str; 2]; 2] =
    [["", "on each light"], ["of the sky", "on each light and of the sky"]];

impl Facts {
    /// The facts of a scene.
    pub fn of(scene: &PreparedScene) -> Self {
        // Of the sky of ambient light that is traced, or of others.
        let is_sky = |light: &Light| light.emitter.ambient_reach().is_some();
        let has = |sky| scene.lights.iter().any(|light| light.is_sampled() && is_sky(light) == sky);
        Self {
            has_textures: !scene.appearance.images.is_empty(),
            has_lens: scene.camera.has_lens(),
            is_antialiased: scene.camera.points() > 1,
            lights: PLACES[usize::from(has(true))][usize::from(has(false))],
            bounces: scene.bounces,
        }
    }

    /// Whether `target` has any random samples.
    pub fn is_sampled(&self, target: Truth) -> bool {
        *self.lights != *"" || self.has_lens || self.is_antialiased || target == Truth::Pixel
    }
}

/// The kind of samples to vary for a smaller error, with the place of points of lights: see [`Facts::lights`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Points on lights, for one ray a pixel.
    Lights(&'static str),
    /// Rays through the lens.
    Lens(&'static str),
    /// Rays through the pixel.
    Pixel(&'static str),
}

impl Axis {
    /// The axis of a scene. Without other random samples it is the pixel, as edges alias.
    pub fn of(facts: &Facts) -> Self {
        match facts {
            Facts { is_antialiased: true, lights, .. } => Self::Pixel(lights),
            Facts { has_lens: true, lights, .. } => Self::Lens(lights),
            Facts { lights: "", .. } => Self::Pixel(""),
            Facts { lights, .. } => Self::Lights(lights),
        }
    }

    /// The scene's samples with `points` along this axis. If a pixel has many rays, each takes one
    /// point of a light.
    pub fn samples(self, points: Points) -> Samples {
        let one = Some(Points { side: 1, ..points });
        let points = Some(points);
        match self {
            Self::Lights(_) => Samples { lights: points, lens: None, pixel: None },
            Self::Lens(_) => Samples { lights: one, lens: points, pixel: None },
            Self::Pixel(_) => Samples { lights: one, lens: one, pixel: points },
        }
    }

    /// What its points are.
    pub(super) fn things(self) -> String {
        match self {
            Self::Lights(place) => format!("points {place}"),
            Self::Lens(place) => format!("points on the lens{}", each("one point", place)),
            Self::Pixel(place) => format!("rays per pixel{}", each("one point", place)),
        }
    }
}

/// That each ray takes `points` of lights at a `place`; empty without any.
fn each(points: &str, place: &str) -> String {
    if place.is_empty() { String::new() } else { format!(", each with {points} {place}") }
}

/// Sides of square grids, in roughly equal ratios of their number of points.
const SIDES: [u32; 12] = [1, 2, 3, 4, 5, 6, 8, 11, 16, 23, 32, 45];

/// Sides of grids of rays in a pixel when textures are compared.
const FILTER_SIDES: [u32; 3] = [1, 2, 4];

/// Largest number of different numbers of bounces.
const MOST_BOUNCES: u32 = 16;

/// The families of a scene with these `facts`, with up to `most` points of a kind.
pub fn families(facts: &Facts, most: u32) -> Vec<Family<CountedSetting>> {
    let lights = facts.lights;
    let along = |axis: Axis| (axis.things(), sampled(most, axis));
    let of_lights = (!lights.is_empty()).then(|| along(Axis::Lights(lights)));
    let of_lens = facts.has_lens.then(|| along(Axis::Lens(lights)));
    let of_bounces = (facts.bounces > 0).then(|| ("bounces".to_owned(), bounces(facts.bounces)));
    let of_file = || format!("rays per pixel{}", each("the file's points", lights));
    let of_textures = facts.has_textures.then(|| (of_file(), filters()));
    let all = [
        ("lights", "Points on lights", Truth::Scene, of_lights),
        ("lens", "Points on the lens", Truth::Scene, of_lens),
        ("pixel", "Rays in a pixel", Truth::Pixel, Some(along(Axis::Pixel(lights)))),
        ("bounces", "Bounces", Truth::Scene, of_bounces),
        ("precision", "Precision", Truth::Scene, Some(("precision".to_owned(), precisions()))),
        ("filter", "Texture filters", Truth::Pixel, of_textures),
    ];
    let family = |(name, title, target, varied): (_, _, _, Option<(_, _)>)| {
        let (counted, series) = varied?;
        let title = if counted == "points of the sky" { "Points of the sky" } else { title };
        Some(Family { name, title, counted, target, series })
    };
    all.into_iter().filter_map(family).collect()
}

/// A series for each sampler, with up to `most` points along an axis.
fn sampled(most: u32, axis: Axis) -> Vec<SettingSeries<CountedSetting>> {
    let line = |sampling: Sampling| {
        let sides = SIDES.into_iter().filter(|side| side * side <= most);
        let point = |side| {
            let points = Points { sampling, side };
            counted(points, Setting { samples: axis.samples(points), ..Setting::default() })
        };
        series(sampling.name(), sides.map(point))
    };
    Sampling::ALL.map(line).to_vec()
}

fn bounces(all: u32) -> Vec<SettingSeries<CountedSetting>> {
    let counts = (0..all).step_by(all.div_ceil(MOST_BOUNCES) as usize).chain([all]);
    let point = |n: u32| {
        let overrides = Overrides { bounces: Some(n), ..Overrides::default() };
        (f64::from(n), n.to_string(), Setting { overrides, ..Setting::default() })
    };
    vec![series("bounces", counts.map(point))]
}

fn precisions() -> Vec<SettingSeries<CountedSetting>> {
    let point = |(i, precision): (u32, Precision)| {
        (f64::from(i), precision.name().to_owned(), Setting { precision, ..Setting::default() })
    };
    vec![series("precision", (0..).zip(Precision::ALL).map(point))]
}

fn filters() -> Vec<SettingSeries<CountedSetting>> {
    let line = |filter: Filter| {
        let overrides = Overrides { filter: Some(filter), ..Overrides::default() };
        let point = |side| {
            let points = Points { sampling: Sampling::Jittered, side };
            let samples = Samples { pixel: Some(points), ..Samples::default() };
            counted(points, Setting { overrides, samples, ..Setting::default() })
        };
        series(filter.name(), FILTER_SIDES.map(point))
    };
    Filter::ALL.map(line).to_vec()
}

fn counted(points: Points, setting: Setting) -> CountedSetting {
    (f64::from(points.count()), points.count().to_string(), setting)
}

fn series(
    name: &str,
    points: impl IntoIterator<Item = CountedSetting>,
) -> SettingSeries<CountedSetting> {
    SettingSeries { name: name.to_owned(), slope: None, points: points.into_iter().collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_named_by_what_they_are_on_and_rays_by_their_points() {
        let facts = |lights, has_lens, is_antialiased| {
            let (has_textures, bounces) = (false, 0);
            Facts { has_textures, has_lens, is_antialiased, lights, bounces }
        };
        let [[none, lights], [sky, both]] = PLACES;
        for (facts, words) in [
            (facts(none, false, false), "rays per pixel"),
            (facts(lights, false, false), "points on each light"),
            (facts(sky, false, false), "points of the sky"),
            (facts(both, false, false), "points on each light and of the sky"),
            (facts(none, true, false), "points on the lens"),
            (facts(lights, true, false), "points on the lens, each with one point on each light"),
            (facts(sky, true, true), "rays per pixel, each with one point of the sky"),
        ] {
            let axis = Axis::of(&facts);
            assert_eq!(axis.things(), words);
            // The family that a sweep answers for.
            let found = families(&facts, 4).into_iter().find(|f| f.counted == axis.things());
            assert_eq!(
                found.map(|found| found.target == Truth::Pixel),
                Some(words.contains("rays"))
            );
        }
    }
}
