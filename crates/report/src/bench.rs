//! Both tracers timed against each other, in a stable JSON form.
//!
//! [`measure`] runs them and checks their images; [`crate::summary`] says what a median,
//! its interval and a spread are; [`advice`] says what is wrong with a measurement and what to do
//! about it; [`text`] writes it all for a terminal, and [`page`] as a page with charts. [`compare`] times the
//! wavefront against itself, and [`hardware`] reads the counters of the processor.
//!
//! | key | unit | meaning |
//! |---|---|---|
//! | `version`, `command` | | the program, and the arguments that it was given |
//! | `commit` | | of the checkout that the program lies in, with a `+` where files of it are changed (`null` where it lies in none) |
//! | `machine.processor`, `.cores`, `.threads`, `.os` | | its model (`null` where it is not known), the cores that the program may use, and the threads that it used |
//! | `machine.hardware_missing` | | why the processor counts nothing here, `null` where it does |
//! | `scenes` | | one entry a scene, in the order of the command line: |
//!
//! | key of a scene | unit | meaning |
//! |---|---|---|
//! | `scene`, `seed`, `batch`, `simd`, `kernel`, `precision` | | what was run |
//! | `image.width`, `.height`, `.samples_per_pixel` | pixels, rays | the image |
//! | `triangles`, `quads`, `spheres`, `lights`, `dropped.degenerate` | | what is in the scene, and what was left out |
//! | `preset` | | how the tree was built |
//! | `expected_visits.nodes`, `.leaves` | per ray | what the surface-area heuristic expects of a ray that nothing stops |
//! | `time.load`, `.build` | seconds | reading and preparing, and building the tree: done once |
//! | `memory.predicted`, `.peak` | bytes | estimated for a render; measured for the process so far, earlier scenes counted (`null` where it is not known) |
//! | `equal` | | whether every image was the same to the last bit, and all work but tests the same |
//! | `difference` | | how not, or `null`: see [`measure::Difference`] |
//! | `rays.primary`, `.secondary`, `.shadow` | rays | in one run, of either tracer |
//! | `invalid` | samples | not finite, and counted as black |
//! | `wavefront`, `recursive` | | one tracer's runs, or `null` where the images differ: |
//! | `.seconds.median`, `.min`, `.max`, `.first_quartile`, `.third_quartile`, `.mad`, `.each` | seconds | of a run on the clock; `each` in the order of the runs |
//! | `.yardstick` | seconds | median of some work that no version changes, after each run: how quick the machine was, see [`crate::yardstick`] |
//! | `.mrays_s` | 10^6 rays / s | rays of every kind, by the median of the seconds |
//! | `.rays_s.primary`, `.secondary`, `.shadow` | rays / s | rays of that kind in the median of the seconds of the whole run |
//! | `.passes.NAME.seconds`, `.share` | seconds | median time in the pass, summed over threads, and its share in the sum of all passes |
//! | `.tests.nodes`, `.primitives` | tests | in one run, as in [`crate::statistics`] |
//! | `.tests_per_ray.nodes`, `.primitives` | tests / ray | the same for each ray of any kind |
//! | `.kernels` | | rays by kernel in one run, as in [`crate::statistics`] |
//! | `.hardware.cycles`, `.instructions`, `.cache_references`, `.cache_misses`, `.branch_misses` | | counted by the processor in a run of its own, all threads together; each `null`, or all of `.hardware`, where it does not count |
//! | `ratio.median`, `.low`, `.high`, `.confidence`, `.pairs`, `.method` | | how many times as fast as the recursive tracer the wavefront is: seconds of the recursive run over seconds of the wavefront's, pair by pair; `null` where the images differ |
//! | `comparisons` | | one entry for each thing that was to be compared, see [`compare::Comparison`]: |
//! | `.of`, `.rounds` | | `kernels`, `levels`, `batches` or `plan`; timed rounds, each of one run of every choice |
//! | `.variants` | | the default, then the others: `kernel`, `simd`, `batch`, `planned`, all keys of `wavefront`, and `ratio`, its speed over that of the default, round by round; empty where images differ |
//! | `.difference` | | the choice whose image differs, and how, or `null` |
//! | `warnings` | | what may be wrong with the measurement |
//!
//! The `n`th of `wavefront.seconds.each` and the `n`th of `recursive.seconds.each` are a pair.

pub mod advice;
pub mod compare;
pub mod hardware;
mod machine;
pub mod measure;
pub mod page;
mod report;
mod rows;
#[cfg(test)]
mod tests;
pub mod text;
mod tracer;
mod words;

pub use machine::Machine;
pub use report::{BenchReport, Preparation, SceneBench, Setting};
pub use tracer::{METHOD, Ratio, RaysPerSecond, TestsPerRay, TracerBench};
