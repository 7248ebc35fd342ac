//! Benchmark of both tracers, with a stable JSON form.
//!
//! A comparison is a list of [variants](variant) of a render, timed by [one loop](crate::measure)
//! in rounds, their images checked: the ladder from the recursive tracer to the wavefront, and on
//! request kernels, instruction sets, batches, threads or the plan. [`crate::summary`] defines
//! medians, intervals and spreads; [`SceneBench`] names problems of a measurement and their remedies;
//! [`page`] shows the results, and [`crate::text`] the same on a terminal.
//!
//! | key | unit | meaning |
//! |---|---|---|
//! | `version`, `command` | | the program and its arguments |
//! | `machine.processor`, `.cores`, `.threads`, `.os` | | its model (`null` if unknown), the cores available to the program, and the threads in use |
//! | `machine.caches[].level`, `.bytes`, `.shared_by` | bytes | the caches of data, and the processors that share one |
//! | `scenes` | | one entry for each scene, in the order of the command line: |
//!
//! | key of a scene | unit | meaning |
//! |---|---|---|
//! | `scene`, `seed`, `batch`, `simd`, `kernel`, `precision` | | the settings |
//! | `preset` | | the BVH preset |
//! | `time.load`, `.build` | seconds | reading and preparing, and building the tree, once |
//! | `image.width`, `.height`, `.samples_per_pixel` | pixels, rays | the image |
//! | `triangles`, `quads`, `spheres`, `lights` | | the contents of the scene |
//! | `bytes_per_path` | bytes | in the columns of the wavefront |
//! | `memory.peak` | bytes | peak of the process so far, including earlier scenes (`null` if unknown) |
//! | `equal` | | whether every image was the same to the last bit, and all work except tests |
//! | `rays.primary`, `.secondary`, `.shadow` | rays | in one run, of either tracer |
//! | `invalid` | samples | not finite; they count as black |
//! | `comparisons` | | one entry for each list, the ladder first: |
//! | `.of` | | `ladder`, `kernels`, `levels`, `batches`, `threads` or `plan` |
//! | `.rounds`, `.left_out`, `.busy` | | timed rounds, each of one run of every variant; rounds left out because other programs used the processors, and those not left out nevertheless: see [`crate::measure`] |
//! | `.difference` | | the variant whose image differs, and how, or `null`: see [`equal::RunDifference`] |
//! | `.variants` | | one entry for each, empty if images differ: |
//! | `..label` | | its name in the list |
//! | `..tracer`, `.kernel`, `.simd`, `.batch`, `.threads`, `.planned` | | the variant: see [`variant::Variant`] |
//! | `..over` | | the variant that its speed is compared with |
//! | `..ratio.median`, `.low`, `.high`, `.confidence`, `.pairs` | | its speed over that of the other: seconds of the other over its own, round by round |
//! | `..gain` | | the step that leads to it: what is new (`of`), the variant before (`from`), and the ratio of the speeds; the gains of a ladder multiply to the ratio of the last variant |
//! | `..seconds.median`, `.mad`, `.each` | seconds | wall-clock time of a run; `each` round by round |
//! | `..processor_seconds` | seconds | processor time of each run, of all threads (`null` if unknown) |
//! | `..processors` | | processors that worked on average |
//! | `..mrays_s` | 10^6 rays / s | rays of every kind, by the median of the seconds |
//! | `..passes.NAME` | seconds | median time in the pass of the wavefront, summed over threads; empty for the recursive tracer |
//! | `..costs[].pass`, `.of`, `.count`, `.nanoseconds` | | what a pass handles, how many in one run, and its time for each: plain hits are on opaque surfaces without maps, mapped hits on all others |
//! | `..batch_bytes` | bytes | held for one batch |
//! | `..tests.nodes`, `.primitives` | tests | in one run, as in [`crate::statistics`] |
//! | `..kernels` | | rays by kernel in one run, as in [`crate::statistics`] |
//! | `warnings` | | possible problems of the measurement |

mod compare;
pub(crate) mod equal;
mod machine;
pub mod page;
mod report;
#[cfg(test)]
mod tests;
pub mod variant;

pub(crate) use compare::Ratio;
pub use compare::{BenchComparison, PassCost, TimedRender, compare};
pub use equal::RunDifference;
pub use machine::{Circumstances, Machine};
pub use report::{BenchPlan, BenchReport, BenchSetting, Preparation, SceneBench};
