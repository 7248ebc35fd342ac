//! Benchmark of both tracers, with a stable JSON form.
//!
//! [`measure`] runs them and checks their images; [`crate::summary`] defines medians, intervals and
//! spreads; [`advice`] names problems of a measurement and their remedies; [`text`] writes the
//! results for a terminal, and [`page`] as a page with charts. [`compare`] times variants of the
//! wavefront, and [`hardware`] reads the counters of the processor.
//!
//! | key | unit | meaning |
//! |---|---|---|
//! | `version`, `command` | | the program and its arguments |
//! | `commit` | | of the checkout that contains the program, with a `+` if its files are modified (`null` outside a checkout) |
//! | `machine.processor`, `.cores`, `.threads`, `.os` | | its model (`null` if unknown), the cores available to the program, and the threads in use |
//! | `machine.hardware_missing` | | why the processor has no counters here, `null` if it has |
//! | `scenes` | | one entry for each scene, in the order of the command line: |
//!
//! | key of a scene | unit | meaning |
//! |---|---|---|
//! | `scene`, `seed`, `batch`, `simd`, `kernel`, `precision` | | the settings |
//! | `image.width`, `.height`, `.samples_per_pixel` | pixels, rays | the image |
//! | `triangles`, `quads`, `spheres`, `lights`, `dropped.degenerate` | | the contents of the scene, and dropped triangles |
//! | `preset` | | the BVH preset |
//! | `expected_visits.nodes`, `.leaves` | per ray | visits of an unobstructed ray expected by the surface-area heuristic |
//! | `time.load`, `.build` | seconds | reading and preparing, and building the tree, once |
//! | `memory.predicted`, `.peak` | bytes | estimate for a render; peak of the process so far, including earlier scenes (`null` if unknown) |
//! | `equal` | | whether every image was the same to the last bit, and all work except tests |
//! | `difference` | | the difference, or `null`: see [`measure::Difference`] |
//! | `rays.primary`, `.secondary`, `.shadow` | rays | in one run, of either tracer |
//! | `invalid` | samples | not finite; they count as black |
//! | `wavefront`, `recursive` | | the runs of one tracer, or `null` if the images differ: |
//! | `.seconds.median`, `.min`, `.max`, `.first_quartile`, `.third_quartile`, `.mad`, `.each` | seconds | wall-clock time of a run; `each` in the order of the runs |
//! | `.yardstick` | seconds | median time of a fixed piece of work after each run, which measures the machine's speed: see [`crate::yardstick`] |
//! | `.mrays_s` | 10^6 rays / s | rays of every kind, by the median of the seconds |
//! | `.rays_s.primary`, `.secondary`, `.shadow` | rays / s | rays of that kind in the median of the seconds of the whole run |
//! | `.passes.NAME.seconds`, `.share` | seconds | median time in the pass, summed over threads, and its share in the sum of all passes |
//! | `.tests.nodes`, `.primitives` | tests | in one run, as in [`crate::statistics`] |
//! | `.tests_per_ray.nodes`, `.primitives` | tests / ray | the same for each ray of any kind |
//! | `.kernels` | | rays by kernel in one run, as in [`crate::statistics`] |
//! | `.hardware.cycles`, `.instructions`, `.cache_references`, `.cache_misses`, `.branch_misses` | | hardware counters of a separate run, all threads together; `null` if a counter, or for `.hardware` all, are unavailable |
//! | `ratio.median`, `.low`, `.high`, `.confidence`, `.pairs`, `.method` | | the speed of the wavefront over that of the recursive tracer: seconds of the recursive run over seconds of the wavefront's, pair by pair; `null` if the images differ |
//! | `comparisons` | | one entry for each requested comparison, see [`compare::Comparison`]: |
//! | `.of`, `.rounds` | | `kernels`, `levels`, `batches` or `plan`; timed rounds, each of one run of every choice |
//! | `.variants` | | the default, then the others: `kernel`, `simd`, `batch`, `planned`, all keys of `wavefront`, and `ratio`, its speed over that of the default, round by round; empty if images differ |
//! | `.difference` | | the variant whose image differs, and how, or `null` |
//! | `warnings` | | possible problems of the measurement |
//!
//! Entry `n` of `wavefront.seconds.each` and entry `n` of `recursive.seconds.each` are a pair.

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
