//! `trace`: the rays of a file against a mesh, timed and answered.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::common::{SearchOptions, Threads, print, to_json};
use crate::choice::choice;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::geometry::Geometry;
use wavecrest_core::accel::{Accel, Hit, KernelChoice, Kernels, TestCounts, Traversal};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::triangle::T_TOLERANCE;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::TracerKind;
use wavecrest_report::ray_file::RayFile;
use wavecrest_report::statistics::ClassUse;
use wavecrest_scene::mesh;

/// Rays handed to a thread at a time.
const BLOCK: usize = 4096;

/// Two t agree if they differ by less than this factor of t: both may be off by the stated error.
const AGREEMENT: f32 = 4.0 * T_TOLERANCE;

/// Traces a file of rays against a mesh: prints the speed, writes the answers.
///
/// The rays are traced with their own t_min and t_max: hits strictly between count. Rays of an any-hit file are timed as such.
/// The file's own answers are compared with ours.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct TraceArgs {
    /// The mesh: PLY or OBJ
    #[arg(long, value_name = "FILE")]
    pub(crate) mesh: PathBuf,
    /// The rays
    #[arg(long, value_name = "FILE")]
    pub(crate) rays: PathBuf,
    /// Write the rays with our answers to this file
    #[arg(long, value_name = "FILE")]
    pub(crate) answers: Option<PathBuf>,
    /// Rays in blocks (wavefront) or one at a time (recursive)
    #[arg(long, value_parser = choice::<TracerKind>(), default_value_t)]
    pub(crate) tracer: TracerKind,
    /// How much work goes into the BVH [default: chosen from triangles and rays]
    #[arg(long, value_name = "PRESET", value_parser = choice::<Preset>())]
    pub(crate) bvh: Option<Preset>,
    /// How exactly hits are found: fast leaks, exact takes its time
    #[arg(long, value_name = "PRECISION", value_parser = choice::<Precision>(), default_value_t)]
    pub(crate) precision: Precision,
    /// How the tree is searched
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Number of timed passes over the rays; the median counts
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) repeats: u32,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// On how many threads
    #[command(flatten)]
    pub(crate) threads: Threads,
}

/// What is printed.
#[derive(Serialize)]
struct Report {
    rays: usize,
    any_hit: bool,
    hits: usize,
    mrays_s: f64,
    seconds: f64,
    repeats: u32,
    threads: usize,
    tracer: TracerKind,
    simd: Level,
    kernel: KernelChoice,
    precision: Precision,
    preset: Preset,
    triangles: usize,
    load_seconds: f64,
    build_seconds: f64,
    nodes_per_ray: f64,
    leaves_per_ray: f64,
    triangles_per_ray: f64,
    kernels: ClassUse,
    compared: Compared,
}

/// Our answers against the file's.
#[derive(Debug, Default, Serialize)]
struct Compared {
    /// Hits of the file that we have not.
    lost: usize,
    /// Hits that only we have.
    extra: usize,
    /// Closest hits on another triangle at the same distance.
    other_triangle: usize,
    /// Closest hits at another distance.
    other_distance: usize,
    /// The largest relative difference of t among the rest.
    largest_relative_t: f32,
    /// Any-hit answers of "hit" that we have not.
    lost_any: usize,
    /// Any-hit answers of "hit" that only we have.
    extra_any: usize,
}

/// Traces as the arguments say.
///
/// # Errors
/// When the mesh or the rays cannot be read or do not belong together, or the answers cannot be
/// written.
pub(crate) fn run(args: &TraceArgs) -> Result<()> {
    if let Some(answers) = &args.answers {
        check_replaceable(answers)?;
        check_differs(answers, &args.mesh, "the mesh")?;
        check_differs(answers, &args.rays, "the file of rays")?;
    }
    args.threads.run(|| run_here(args))
}

fn run_here(args: &TraceArgs) -> Result<()> {
    let start = Instant::now();
    let mut file = RayFile::read(&args.rays)?;
    let data = mesh::load(&args.mesh)?.mesh;
    check_belongs(args, &file, data.triangles.len())?;
    let load_seconds = start.elapsed().as_secs_f64();
    let geometry = Geometry {
        positions: data.positions,
        triangles: data.triangles,
        precision: args.precision,
        ..Geometry::default()
    };
    let triangles = geometry.triangles.len();
    let preset = args.bvh.unwrap_or(Preset::choose(triangles as u64, file.rays.len() as u64));
    let start = Instant::now();
    let mut accel = Accel::new(geometry, preset);
    args.search.apply(&mut accel);
    let build_seconds = start.elapsed().as_secs_f64();
    let Answered { closest, occluded, work, seconds } = answer(args, &accel, &file);
    let Work { tests, kernels } = work;
    let compared = compare(&file, &closest, &occluded);
    let n = file.rays.len();
    let per_ray = |count: u64| count as f64 / n.max(1) as f64;
    let report = Report {
        rays: n,
        any_hit: file.any_hit,
        hits: if file.any_hit {
            occluded.iter().filter(|&&o| o).count()
        } else {
            closest.iter().filter(|h| !h.is_miss()).count()
        },
        mrays_s: n as f64 / seconds / 1e6,
        seconds,
        repeats: args.repeats,
        threads: rayon::current_num_threads(),
        tracer: args.tracer,
        simd: args.search.simd,
        kernel: args.search.kernel,
        precision: args.precision,
        preset,
        triangles,
        load_seconds,
        build_seconds,
        nodes_per_ray: per_ray(tests.nodes),
        leaves_per_ray: per_ray(tests.leaves),
        triangles_per_ray: per_ray(tests.triangles),
        kernels: (&kernels.both()).into(),
        compared,
    };
    print(&if args.json { to_json(&report)? } else { text(&report) })?;
    if let Some(answers) = &args.answers {
        (file.closest, file.occluded) = (closest, occluded);
        file.write(answers)?;
    }
    Ok(())
}

fn check_belongs(args: &TraceArgs, file: &RayFile, triangles: usize) -> Result<()> {
    if file.triangles == triangles as u64 {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Usage, "the rays belong to another mesh")
        .in_file(&args.rays)
        .value(format!("rays for {} triangles", file.triangles))
        .remedy(format!("{} has {triangles}", args.mesh.display())))
}

/// What came of the rays.
struct Answered {
    closest: Vec<Hit>,
    occluded: Vec<bool>,
    /// Of one timed pass.
    work: Work,
    /// The median of the timed passes.
    seconds: f64,
}

/// What a pass took.
#[derive(Clone, Copy, Default)]
struct Work {
    tests: TestCounts,
    kernels: Kernels,
}

impl Work {
    fn add(mut self, other: Self) -> Self {
        self.tests += other.tests;
        self.kernels += other.kernels;
        self
    }
}

fn answer(args: &TraceArgs, accel: &Accel, file: &RayFile) -> Answered {
    let mut closest = vec![Hit::MISS; file.rays.len()];
    let mut occluded = vec![false; file.rays.len()];
    let mut work = Work::default();
    let mut samples: Vec<f64> = Vec::new();
    // Kept from pass to pass: their memory is no part of the work.
    let mut traversals = vec![accel.traversal(); rayon::current_num_threads()];
    for _ in 0..args.repeats {
        let start = Instant::now();
        work = if file.any_hit {
            pass_occluded(args, accel, file, &mut occluded, &mut traversals)
        } else {
            pass_closest(args, accel, file, &mut closest, &mut traversals)
        };
        samples.push(start.elapsed().as_secs_f64());
    }
    if file.any_hit {
        pass_closest(args, accel, file, &mut closest, &mut traversals);
    } else {
        pass_occluded(args, accel, file, &mut occluded, &mut traversals);
    }
    samples.sort_by(f64::total_cmp);
    Answered { closest, occluded, work, seconds: samples[samples.len() / 2] }
}

fn pass_closest(
    args: &TraceArgs,
    accel: &Accel,
    file: &RayFile,
    answers: &mut [Hit],
    traversals: &mut [Traversal],
) -> Work {
    pass(
        args,
        accel,
        (file, answers),
        traversals,
        |a, r, h, t| a.closest_of(r, h, t),
        Accel::closest,
    )
}

fn pass_occluded(
    args: &TraceArgs,
    accel: &Accel,
    file: &RayFile,
    answers: &mut [bool],
    traversals: &mut [Traversal],
) -> Work {
    pass(
        args,
        accel,
        (file, answers),
        traversals,
        |a, r, h, t| a.occluded_of(r, h, t),
        Accel::occluded,
    )
}

/// Asks of every ray, block by block, a thread for each of `traversals`.
fn pass<A: Send>(
    args: &TraceArgs,
    accel: &Accel,
    (file, answers): (&RayFile, &mut [A]),
    traversals: &mut [Traversal],
    many: impl Fn(&Accel, &[Ray], &mut [A], &mut Traversal) + Sync,
    one: impl Fn(&Accel, &Ray, &mut Traversal) -> A + Sync,
) -> Work {
    let blocks = Mutex::new(answers.chunks_mut(BLOCK).zip(file.rays.chunks(BLOCK)));
    let next = || blocks.lock().unwrap_or_else(PoisonError::into_inner).next();
    traversals
        .par_iter_mut()
        .with_max_len(1)
        .map(|traversal| {
            (traversal.tests, traversal.kernels) = Default::default();
            while let Some((answers, rays)) = next() {
                match args.tracer {
                    TracerKind::Wavefront => many(accel, rays, answers, traversal),
                    TracerKind::Recursive => {
                        for (answer, ray) in answers.iter_mut().zip(rays) {
                            *answer = one(accel, ray, traversal);
                        }
                    }
                }
            }
            Work { tests: traversal.tests, kernels: traversal.kernels }
        })
        .reduce(Work::default, Work::add)
}

fn compare(file: &RayFile, closest: &[Hit], occluded: &[bool]) -> Compared {
    let mut c = Compared::default();
    for (theirs, ours) in file.closest.iter().zip(closest) {
        match (theirs.is_miss(), ours.is_miss()) {
            (false, true) => c.lost += 1,
            (true, false) => c.extra += 1,
            (true, true) => {}
            (false, false) => {
                let relative = (theirs.t - ours.t).abs() / theirs.t.abs().max(f32::MIN_POSITIVE);
                // The other way round, a t that is not a number would agree.
                let agrees = relative <= AGREEMENT;
                if !agrees {
                    c.other_distance += 1;
                    continue;
                }
                c.largest_relative_t = c.largest_relative_t.max(relative);
                c.other_triangle += usize::from(theirs.primitive != ours.primitive);
            }
        }
    }
    for (&theirs, &ours) in file.occluded.iter().zip(occluded) {
        c.lost_any += usize::from(theirs && !ours);
        c.extra_any += usize::from(ours && !theirs);
    }
    c
}

fn text(r: &Report) -> String {
    let kind = if r.any_hit { "any hit" } else { "closest hit" };
    let (c, k) = (&r.compared, &r.kernels);
    let average = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.1}"));
    format!(
        "{:.2} Mrays/s: {} rays ({kind}), {} hits, {:.4} s, median of {} on {} threads\n\
         mesh: {} triangles, loaded in {:.3} s; bvh {}, built in {:.3} s, {} tests\n\
         per ray: {:.2} nodes, {:.2} leaves, {:.2} triangles\n\
         {}: {} in packets ({} handed over), {} in flight, {} alone; rays of a packet at a node {}, \
         in flight in a round {}\n\
         against the file: {} lost, {} extra, {} on another triangle, {} at another distance, \
         largest relative difference of t {:.2e}; any-hit {} lost, {} extra\n",
        r.mrays_s,
        r.rays,
        r.hits,
        r.seconds,
        r.repeats,
        r.threads,
        r.triangles,
        r.load_seconds,
        r.preset.name(),
        r.build_seconds,
        r.precision.name(),
        r.nodes_per_ray,
        r.leaves_per_ray,
        r.triangles_per_ray,
        r.simd.name(),
        k.packet,
        k.handed_over,
        k.stream,
        k.single,
        average(k.rays_a_node),
        average(k.rays_a_round),
        c.lost,
        c.extra,
        c.other_triangle,
        c.other_distance,
        c.largest_relative_t,
        c.lost_any,
        c.extra_any,
    )
}
