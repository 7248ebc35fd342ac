//! wavecrest: a data-oriented ray tracer for large triangle-mesh scenes.
//!
//! The command is a thin layer over this library. A scene goes three steps: [`scene::load`] reads a file into a
//! world of entities, [`systems`] turn that into a [`prepared::PreparedScene`], which nothing changes any more, and
//! [`render::render()`] makes a film of it. Work is done on the threads of the current rayon pool.
//!
//! # Render to a buffer
//!
//! ```
//! use wavecrest::accel::build::Preset;
//! use wavecrest::render::{RenderOptions, render};
//! use wavecrest::{scene, systems};
//!
//! # fn main() -> wavecrest::error::Result<()> {
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
//! let mut loaded = scene::load::load_str(json, "ball.json".as_ref(), &Default::default())?;
//! let (prepared, warnings) = systems::prepare(&mut loaded.world, Preset::Fast)?;
//! assert!(loaded.warnings.is_empty() && warnings.is_empty());
//!
//! let image = render(&prepared, &RenderOptions::default(), &())?.film;
//! // Red, green and blue of each pixel, the top row first, linear.
//! let pixels: &[[f32; 3]] = image.pixels();
//! assert_eq!(pixels.len(), 64 * 48);
//! assert_eq!(pixels[0], [0.0, 0.0, 0.25]);
//! # Ok(())
//! # }
//! ```
//!
//! [`image::write`](mod@image::write) writes a film to a file, [`aov`] makes layers of what camera rays meet.
//!
//! # Trace rays
//!
//! The tree of a prepared scene answers rays of any origin. With primitives of your own it needs no scene at all:
//!
//! ```
//! use glam::Vec3;
//! use wavecrest::accel::Accel;
//! use wavecrest::accel::build::Preset;
//! use wavecrest::accel::geometry::Geometry;
//! use wavecrest::math::ray::Ray;
//!
//! let geometry = Geometry {
//!     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
//!     triangles: vec![[0, 1, 2]],
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
//! Many rays at once are quicker: [`accel::Accel::closest_of`].
//!
//! # Watch, and cancel
//!
//! [`render::Watch`] is told of progress and of finished tiles, and may end a render, whose finished part is kept:
//!
//! ```
//! use std::sync::atomic::{AtomicUsize, Ordering};
//! use wavecrest::render::{RenderOptions, Watch, render};
//! use wavecrest::tile::Tile;
//! # use wavecrest::accel::build::Preset;
//! # use wavecrest::{scene, systems};
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
//! # fn main() -> wavecrest::error::Result<()> {
//! # let json = r#"{"nbounces": 0, "camera": {"type": "pinhole", "width": 512, "height": 512, "fov": 40,
//! #     "location": [0, 0, 5], "look": [0, 0, 0]}, "scene": {"backgroundcolor": [1, 1, 1]}}"#;
//! # let mut loaded = scene::load::load_str(json, "empty.json".as_ref(), &Default::default())?;
//! # let (prepared, _) = systems::prepare(&mut loaded.world, Preset::Fast)?;
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
//! Whatever fails returns an [`error::Error`], which names the file, the place in it, the value found and what would
//! be right; no input makes the library panic.

pub mod accel;
pub mod accuracy;
pub mod aov;
pub mod cli;
pub mod counters;
pub mod error;
pub mod farm;
pub mod generate;
pub mod image;
pub mod kernels;
pub mod math;
pub mod memory;
pub mod plan;
pub mod prepared;
pub mod probe;
pub mod ray_file;
pub mod recursive;
pub mod render;
pub mod replace;
pub mod report;
pub mod scene;
pub mod selftest;
pub mod systems;
pub mod tile;
pub mod variant;
pub mod wavefront;
