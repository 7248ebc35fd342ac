//! wavecrest as a library: a data-oriented ray tracer for large triangle-mesh scenes.
//!
//! A scene passes through four steps: [`load()`] reads a file into a world of entities, [`extract`]
//! turns that into dense arrays, [`Extracted::build`] builds the tree over them, and [`render()`]
//! renders a [`Film`] from the [`PreparedScene`]. Work runs on the threads of the current rayon
//! pool.
//!
//! A [`session::Session`] takes a scene through all of them, and renders it for an error or a time ([`goal::Goal`]).
//! Beside these two the crate re-exports parts of the inner crates. It contains neither the command line nor the reports of
//! the command `wavecrest`.
//!
//! # Render to a buffer
//!
//! ```
//! use wavecrest_api::{RenderOptions, extract, load_str, render};
//!
//! # fn main() -> wavecrest_api::Result<()> {
//! let json = r#"{
//!     "nbounces": 0,
//!     "camera": {"type": "pinhole", "width": 64, "height": 48, "fov": 40,
//!                "location": [0, 0, 5], "look": [0, 0, 0]},
//!     "scene": {
//!         "backgroundcolor": [0, 0, 0.25],
//!         "lightsources": [{"type": "pointlight", "intensity": 60, "position": [2, 3, 5],
//!                           "color": [1, 1, 1]}],
//!         "shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 1,
//!                     "material": {"ks": 0.2, "kd": 0.8, "specularexponent": 20,
//!                                  "diffusecolor": [1, 0.5, 0]}}]
//!     }
//! }"#;
//! // Relative paths in the scene would start from the folder of this file, which need not exist.
//! let loaded = load_str(json, "ball.json".as_ref(), &Default::default())?;
//! assert!(loaded.warnings.is_empty());
//! let extracted = extract(loaded.world, Default::default())?;
//! let preset = extracted.preset();
//! let prepared = extracted.build(preset);
//!
//! let image = render(&prepared, &RenderOptions::default(), &())?.film;
//! // Red, green and blue of each pixel, the top row first, linear.
//! let pixels: &[[f32; 3]] = image.pixels();
//! assert_eq!(pixels.len(), 64 * 48);
//! assert_eq!(pixels[0], [0.0, 0.0, 0.25]);
//! // The ball, where it faces the camera.
//! let [red, green, _] = image.pixel(32, 24).unwrap();
//! assert!(red > 0.1 && green < red);
//! # Ok(())
//! # }
//! ```
//!
//! # Build a scene in code
//!
//! A scene is a [`World`](hecs::World) of entities with [`components`]; a file is one way to fill
//! it:
//!
//! ```
//! use wavecrest_api::components::{
//!     Encoding, Falloff, FovAxis, Material, Order, PointLight, Sampling,
//!     Settings, Shading, Sides, Sphere, View,
//! };
//! use wavecrest_api::glam::DVec3;
//! use wavecrest_api::{Preset, RenderOptions, extract, hecs, render};
//!
//! # fn main() -> wavecrest_api::Result<()> {
//! let mut world = hecs::World::new();
//! world.spawn((Settings {
//!     file: "ball".into(),
//!     bounces: 0,
//!     background: DVec3::ZERO,
//!     ambient: 0.1,
//!     transfer: Encoding::Srgb,
//! },));
//! let view = View {
//!     location: DVec3::Z * 5.0,
//!     look: DVec3::ZERO,
//!     up: DVec3::Y,
//!     fov_degrees: 40.0,
//!     fov_axis: FovAxis::Smaller,
//!     width: 64,
//!     height: 48,
//!     antialias: 1,
//!     sampling: Sampling::Jittered,
//! };
//! world.spawn((view,));
//! let (position, color) = (DVec3::new(2.0, 3.0, 5.0), DVec3::ONE);
//! world.spawn((Order(0), PointLight { intensity: 60.0, position, color, falloff: Falloff::Linear }));
//! let material = Material {
//!     ks: 0.2,
//!     kd: 0.8,
//!     specular_exponent: 20.0,
//!     diffuse_color: DVec3::new(1.0, 0.5, 0.0),
//!     kr: 0.0,
//!     emission: DVec3::ZERO,
//!     specular_color: DVec3::ONE,
//!     ambient: 1.0,
//!     unlit: false,
//! };
//! let ball = Sphere { center: DVec3::ZERO, radius: 1.0 };
//! world.spawn((Order(0), ball, material, Sides::Both, Shading::Flat));
//!
//! let prepared = extract(world, Default::default())?.build(Preset::Fast);
//! let image = render(&prepared, &RenderOptions::default(), &())?.film;
//! let [red, green, _] = image.pixel(32, 24).unwrap();
//! assert!(red > 0.1 && green < red);
//! # Ok(())
//! # }
//! ```
//!
//! [`write_image`] writes a film to a file, [`layers`] renders layers such as depth and normals.
//!
//! # Trace rays
//!
//! The tree of a prepared scene can be searched with any rays. For your own primitives you need no
//! scene at all:
//!
//! ```
//! use wavecrest_api::glam::Vec3;
//! use wavecrest_api::{Accel, Geometry, Preset, Ray};
//!
//! let geometry = Geometry {
//!     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y].into(),
//!     triangles: vec![[0, 1, 2]].into(),
//!     ..Geometry::default()
//! };
//! let accel = Accel::new(geometry, Preset::Fast);
//! // What one thread needs, with counts of the work.
//! let mut traversal = accel.traversal();
//!
//! let ray = Ray::new(Vec3::new(0.25, 0.25, 2.0), Vec3::NEG_Z);
//! let hit = accel.closest(&ray, &mut traversal);
//! assert_eq!((hit.t, hit.primitive), (2.0, 0));
//! assert!(accel.occluded(&ray, &mut traversal));
//!
//! let away = Ray::new(Vec3::new(0.25, 0.25, 2.0), Vec3::Z);
//! assert!(accel.closest(&away, &mut traversal).is_miss());
//! ```
//!
//! [`Accel::closest_of`] is faster for many rays; [`rays_at_once`] tells into how many to divide them
//! for threads.
//!
//! # Progress and cancellation
//!
//! [`Watch`] receives progress and finished tiles, and may end a render; the finished part is kept:
//!
//! ```
//! use std::sync::atomic::{AtomicUsize, Ordering};
//! use wavecrest_api::{RenderOptions, Tile, Watch, render};
//! # use wavecrest_api::{Preset, extract, load_str};
//!
//! /// Lets three tiles be rendered.
//! #[derive(Default)]
//! struct Few {
//!     tiles: AtomicUsize,
//! }
//!
//! impl Watch for Few {
//!     fn tile(&self, _tile: &Tile, _pixels: &[[f32; 3]]) {
//!         self.tiles.fetch_add(1, Ordering::Relaxed);
//!     }
//!
//!     fn cancelled(&self) -> bool {
//!         self.tiles.load(Ordering::Relaxed) >= 3
//!     }
//! }
//!
//! # fn main() -> wavecrest_api::Result<()> {
//! # let json = r#"{"nbounces": 0, "camera": {"type": "pinhole", "width": 512, "height": 512, "fov": 40,
//! #     "location": [0, 0, 5], "look": [0, 0, 0]}, "scene": {"backgroundcolor": [1, 1, 1]}}"#;
//! # let loaded = load_str(json, "empty.json".as_ref(), &Default::default())?;
//! # let prepared = extract(loaded.world, Default::default())?.build(Preset::Fast);
//! let rendered = render(&prepared, &RenderOptions::default(), &Few::default())?;
//! assert!(!rendered.finished && rendered.tiles.len() >= 3);
//! // What was not rendered is black.
//! let done: usize = rendered.tiles.iter().map(Tile::len).sum();
//! assert!(done < rendered.film.pixels().len());
//! # Ok(())
//! # }
//! ```
//!
//! # Errors
//!
//! Functions that can fail return an [`Error`], which names the file, the place in it, the value
//! found and a remedy; no input makes the library panic.

pub mod goal;
pub mod session;

// Errors, warnings, options that have names, and memory.
pub use wavecrest_base::choice::Choice;
pub use wavecrest_base::error::{Error, ErrorKind, Result, Warning, did_you_mean};
pub use wavecrest_base::{memory, parallel};

// From a scene file to a prepared scene.
pub use wavecrest_base::shared::Shared;
pub use wavecrest_core::plan::schedule::{PASSES, UNPLANNED};
pub use wavecrest_core::prepared::PreparedScene;
pub use wavecrest_image::look::Look;
pub use wavecrest_scene::load::framing::{Fit, Fov, Framing, LookAt, Side, Up};
pub use wavecrest_scene::load::lighting::{Background, Lighting, Rig};
pub use wavecrest_scene::load::{
    LoadOptions, LoadedScene, MOST_SAMPLES, antialias, load, load_gltf, load_mesh, load_str,
};
pub use wavecrest_scene::mesh::{Attribute, MeshData, NO_VALUE};
pub use wavecrest_scene::systems::{Extracted, SceneOptions, extract, warnings};
pub use wavecrest_scene::{components, hecs, mesh};

// From a prepared scene to pixels.
pub use wavecrest_core::counters::Counters;
pub use wavecrest_core::film::Film;
pub use wavecrest_core::render::{Progress, RenderOptions, Rendered, TracerKind, Watch, render};
pub use wavecrest_core::tile::Tile;

// Layers beside the colours.
pub use wavecrest_image::aov::{Layer, Layers, Request as LayerRequest, layers};

// Image files and their metadata.
pub use wavecrest_core::math::srgb::srgb_decode;
pub use wavecrest_image::farm::checkpoint::Checkpoint;
pub use wavecrest_image::farm::{Author, Identity, Pass, Passes};
pub use wavecrest_image::metadata::{Channel, Entry, Extras, Values};
pub use wavecrest_image::read::read as read_image;
pub use wavecrest_image::write::{
    Develop, Format, Tone, Transfer, write as write_image, write_with as write_image_with,
};

// Differences between images.
pub use wavecrest_image::compare::{Comparison, compare};
pub use wavecrest_image::flip::{DEFAULT_PIXELS_PER_DEGREE, Flip, flip};

// Rays against a prepared scene, or against your own primitives.
pub use wavecrest_core::accel::build::Preset;
pub use wavecrest_core::accel::{
    Accel, Crossings, Hit, KernelChoice, NO_PRIMITIVE, RayColumns, Rays, Traversal, rays_at_once,
};
pub use wavecrest_core::counters::TestCounts;
pub use wavecrest_core::geometry::instance::Instance;
pub use wavecrest_core::geometry::{Geometry, Primitive};
pub use wavecrest_core::kernels::precision::Precision;
pub use wavecrest_core::kernels::slab::Aabb;
pub use wavecrest_core::math::exact;
pub use wavecrest_core::math::float::MAX_COORDINATE;
pub use wavecrest_core::math::ray::Ray;
pub use wavecrest_core::math::simd::Level;

/// The vector types of [`Geometry`] and [`Ray`].
pub use glam;
