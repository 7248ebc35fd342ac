//! Layers for compositing and inspection: data of the camera ray hits of each pixel.
//!
//! A separate pass over the render's camera rays, the same to the last bit and through the same
//! kernels, computes them. It runs only for requested layers, and sums only these. Every value is a
//! function of scene, seed and pixel, independent of threads and crops.
//!
//! | layer | channels | value |
//! |---|---|---|
//! | depth | `depth.Z` | distance along the view axis, the mean of the samples that hit; 0 if none does |
//! | normal | `N.X`, `N.Y`, `N.Z` | the shading normal on the viewer's side: the mean, not normalised again |
//! | albedo | `albedo.R`, `.G`, `.B` | the diffuse colour or the texture's; for a light its visible colour: the mean |
//! | position | `P.X`, `P.Y`, `P.Z` | the point in the space of the scene: the mean |
//! | object | `object.id` | number of the shape that the first sample shows, from 1; 0 for nothing |
//! | material | `material.id` | number of its material, from 1; equal materials have one number; 0 for nothing and lights |
//! | alpha | `A` | one minus the share of the background that comes straight through; colours count as multiplied by it |
//! | samples | `samples.count` | samples of the pixel |
//! | invalid | `invalid.mask` | 1 if a sample was not finite and counts as black, else 0 |
//!
//! Layers lack what the plan skips, such as a texture that no light shows.
//!
//! A sample shows the first surface that sends it any light of its own: not what is cut out, or where opacity is 0. Means are
//! over the samples that show something. The entries `objects` and `materials` list as
//! JSON the shapes and materials of the numbers that occur.

use std::collections::{BTreeSet, HashMap};
use std::sync::atomic::{AtomicU64, Ordering};

use serde_json::Value;

use crate::camera_rays::{CameraRays, HitSums};
use crate::metadata::{ALPHA, Channel, Entry, Values};
use wavecrest_base::error::Result;
use wavecrest_base::memory;
use wavecrest_base::parallel;
use wavecrest_core::prepared::{Appearance, Class, Map, PreparedScene};
use wavecrest_core::render::{self, RenderOptions, TracerKind, Watch, work};
use wavecrest_core::tile::{Tile, Unit};

wavecrest_base::choices! {
    /// A layer.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Layer {
        /// Distance along the view axis.
        Depth = "depth",
        /// The normal that surfaces are lit with.
        Normal = "normal",
        /// Diffuse colour or texture.
        Albedo = "albedo",
        /// The point in the scene.
        Position = "position",
        /// The number of the shape.
        Object = "object",
        /// The number of the material.
        Material = "material",
        /// One minus the share of the background that comes straight through. What is bent or mirrored is covered.
        Alpha = "alpha",
        /// The number of samples.
        Samples = "samples",
        /// Where samples were not finite.
        Invalid = "invalid",
    }
}

impl Layer {
    /// The names of its channels, as in compositing programs.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Depth => &["depth.Z"],
            Self::Normal => &["N.X", "N.Y", "N.Z"],
            Self::Albedo => &["albedo.R", "albedo.G", "albedo.B"],
            Self::Position => &["P.X", "P.Y", "P.Z"],
            Self::Object => &["object.id"],
            Self::Material => &["material.id"],
            Self::Alpha => &[ALPHA],
            Self::Samples => &["samples.count"],
            Self::Invalid => &["invalid.mask"],
        }
    }
}

/// A request for layers.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// The layers; repeated ones count once.
    pub layers: &'a [Layer],
    /// The part of the image; all of it if `None`.
    pub crop: Option<Tile>,
    /// The seed of the render.
    pub seed: u64,
    /// The number of samples of the render that were not finite. If it is not 0, [`Layer::Invalid`]
    /// locates them.
    pub invalid: u64,
}

/// The layers of an image.
#[derive(Clone, Debug, Default)]
pub struct Layers {
    /// The channels.
    pub channels: Vec<Channel>,
    /// The shapes and materials of the numbers.
    pub entries: Vec<Entry>,
}

/// Computes the layers of `scene` on the threads of the current rayon pool. If `watch` cancels that,
/// they have no meaning.
///
/// # Errors
/// If the crop is not within the image, there is no memory for the channels, or an image cannot be
/// decoded.
pub fn layers(scene: &PreparedScene, request: &Request<'_>, watch: &dyn Watch) -> Result<Layers> {
    let mut layers = request.layers.to_vec();
    layers.sort_unstable();
    layers.dedup();
    let window = render::window(scene, request.crop)?;
    let names = ShapeNumbers::of(scene);
    let axes = |&layer: &Layer| (0..layer.channels().len()).map(move |axis| (layer, axis));
    let places: Vec<(Layer, usize)> = layers.iter().flat_map(axes).collect();
    let channel = |&(layer, axis): &(Layer, usize)| {
        let values = room(layer, window.len())?;
        Ok(Channel { name: layer.channels()[axis].to_owned(), values })
    };
    let mut channels = places.iter().map(channel).collect::<Result<Vec<_>>>()?;
    if layers.iter().any(|layer| !matches!(layer, Layer::Samples | Layer::Invalid)) {
        let samples = scene.camera.rays_per_pixel();
        let rays = CameraRays { scene, window, seed: request.seed, watch };
        rays.sum(|hit| hit.albedo.to_array(), &mut |at, sums| {
            for (&(layer, axis), channel) in places.iter().zip(&mut channels) {
                let value = value(layer, axis, sums, samples, &names);
                match &mut channel.values {
                    Values::Floats(values) => values[at] = value as f32,
                    Values::Integers(values) => values[at] = value as u32,
                }
            }
        });
    }
    scene.appearance.check()?;
    let mut entries = Vec::new();
    for ((layer, _), channel) in places.iter().zip(&mut channels) {
        match (layer, &mut channel.values) {
            (Layer::Samples, Values::Integers(all)) => all.fill(scene.camera.rays_per_pixel()),
            (Layer::Invalid, Values::Floats(mask)) if request.invalid > 0 => {
                mark_invalid(scene, &window, request, watch, mask);
            }
            (Layer::Object, Values::Integers(numbers)) => {
                entries.push(Entry { name: "objects", text: names.objects(numbers) });
            }
            (Layer::Material, Values::Integers(numbers)) => {
                entries.push(Entry { name: "materials", text: names.materials(numbers) });
            }
            _ => {}
        }
    }
    Ok(Layers { channels, entries })
}

/// A channel of zeros.
fn room(layer: Layer, pixels: usize) -> Result<Values> {
    fn zeros<T: Copy + Default>(count: usize) -> Result<Vec<T>> {
        let mut values = memory::reserve(count, "a layer")
            .map_err(|error| error.remedy("use fewer layers, or --crop"))?;
        values.resize(count, T::default());
        Ok(values)
    }
    if matches!(layer, Layer::Object | Layer::Material | Layer::Samples) {
        zeros(pixels).map(Values::Integers)
    } else {
        zeros(pixels).map(Values::Floats)
    }
}

/// The result of a pixel's samples along an axis of a layer.
fn value(layer: Layer, axis: usize, sums: &HitSums, samples: u32, names: &ShapeNumbers<'_>) -> f64 {
    let mean = |sum: f64| if sums.hits == 0 { 0.0 } else { sum / f64::from(sums.hits) };
    match layer {
        Layer::Alpha => (f64::from(samples) - sums.passed) / f64::from(samples),
        Layer::Depth => mean(sums.depth),
        Layer::Normal => mean(sums.normal[axis]),
        Layer::Albedo => mean(sums.color[axis]),
        Layer::Position => mean(sums.position[axis]),
        Layer::Object => sums.shape.into(),
        Layer::Material => names.material(sums.shape).into(),
        Layer::Samples => samples.into(),
        Layer::Invalid => 0.0,
    }
}

/// Sets the `mask` to 1 at the pixels of `window` with samples that were not finite.
///
/// A render only counts them. To find their pixels, the recursive tracer renders the pixels once
/// more, with the same results as the wavefront: only if the count is not 0, and only until that
/// many are found.
fn mark_invalid(
    scene: &PreparedScene,
    window: &Tile,
    request: &Request<'_>,
    watch: &dyn Watch,
    mask: &mut [f32],
) {
    let left = AtomicU64::new(request.invalid);
    let (tracer, seed) = (TracerKind::Recursive, request.seed);
    let options = RenderOptions { tracer, seed, ..RenderOptions::default() };
    let rows = mask.chunks_mut(window.width as usize).enumerate();
    parallel::with_state(
        rows,
        || work::tracer(scene, &options),
        |tracer, (row, mask)| {
            for (column, marked) in mask.iter_mut().enumerate() {
                if left.load(Ordering::Relaxed) == 0 {
                    return;
                }
                let (x, y) = (window.x + column as u32, window.y + row as u32);
                let tile = Tile { x, y, width: 1, height: 1 };
                let pixel = Unit { tile, samples: 0..scene.camera.rays_per_pixel() };
                let before = tracer.counters().invalid;
                tracer.render(scene, &pixel, &mut [[0.0; 3]], &|| watch.cancelled());
                let found = tracer.counters().invalid - before;
                if found > 0 {
                    *marked = 1.0;
                    left.fetch_sub(found, Ordering::Relaxed);
                }
            }
        },
    );
}

/// The numbers of a scene's shapes and materials.
struct ShapeNumbers<'a> {
    appearance: &'a Appearance,
    /// For each shape the number of its material; 0 for lights.
    materials: Vec<u32>,
    /// For each material, from 1 on, the first shape with it.
    first: Vec<usize>,
    /// The number of shapes of each name.
    counts: HashMap<&'a str, usize>,
}

impl<'a> ShapeNumbers<'a> {
    fn of(scene: &'a PreparedScene) -> Self {
        let appearance = &scene.appearance;
        let mut names =
            Self { appearance, materials: Vec::new(), first: Vec::new(), counts: HashMap::new() };
        let mut known = HashMap::new();
        for (index, shape) in appearance.shapes.iter().enumerate() {
            if shape.light.is_some() {
                names.materials.push(0);
                continue;
            }
            let Class { material, transparency, maps, .. } = appearance.class(shape);
            // Without coordinates, in which shapes differ.
            let maps = maps.iter().map(|Map { property, texture }| {
                let look_up = texture.as_ref().map(|t| (t.image, t.filter, t.wrap));
                format!("{property:?} {look_up:?}")
            });
            // As text, numbers are as good as their bits.
            let text = format!("{material:?} {transparency:?} {:?}", maps.collect::<Vec<_>>());
            let number = *known.entry(text).or_insert_with(|| {
                names.first.push(index);
                names.first.len() as u32
            });
            names.materials.push(number);
        }
        for name in appearance.names.iter().flatten() {
            *names.counts.entry(name.as_str()).or_default() += 1;
        }
        names
    }

    /// The number of the material of the shape with this number; 0 for nothing.
    fn material(&self, shape: u32) -> u32 {
        let shape = (shape as usize).checked_sub(1);
        shape.and_then(|shape| self.materials.get(shape)).copied().unwrap_or_default()
    }

    /// The shapes that occur, as JSON: for each number its name or place in the scene.
    fn objects(&self, numbers: &[u32]) -> String {
        table(numbers, |number| self.place(number as usize - 1))
    }

    /// The materials that occur, as JSON: for each number its first place in the scene.
    fn materials(&self, numbers: &[u32]) -> String {
        table(numbers, |number| {
            let shape = self.first.get(number as usize - 1).copied().unwrap_or_default();
            format!("{}.material", self.place(shape))
        })
    }

    /// The name of a shape, or else its place in the scene, which also tells shapes of one name
    /// apart.
    fn place(&self, shape: usize) -> String {
        let Appearance { names, paths, .. } = self.appearance;
        let place = paths.get(shape).cloned().unwrap_or_default();
        match names.get(shape).and_then(Option::as_ref) {
            Some(name) if self.counts.get(name.as_str()) == Some(&1) => name.clone(),
            Some(name) => format!("{name} ({place})"),
            None => place,
        }
    }
}

/// The name of each number except 0.
fn table(numbers: &[u32], name: impl Fn(u32) -> String) -> String {
    let seen: BTreeSet<u32> = numbers.iter().copied().filter(|&number| number > 0).collect();
    let entries = seen.into_iter().map(|number| (number.to_string(), Value::from(name(number))));
    Value::Object(entries.collect::<serde_json::Map<_, _>>()).to_string()
}
