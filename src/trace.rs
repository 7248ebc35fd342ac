//! `trace`: traces the rays of a file against a mesh, with times and answers.

use std::path::PathBuf;
use std::sync::Mutex;
use std::time::Instant;

use serde::Serialize;

use super::common::{SearchOptions, Threads, choice, print, to_json, whole};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::lock;
use wavecrest_base::parallel::with_state;
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::tree::{Tree, Visits};
use wavecrest_core::accel::{Accel, Hit, KernelChoice, Traversal, rays_at_once};
use wavecrest_core::counters::{Counters, KernelCounts};
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::Level;
use wavecrest_core::render::TracerKind;
use wavecrest_report::ray_file::RayFile;
use wavecrest_scene::mesh;

/// Trace a file of rays against a mesh, and print the speed.
///
/// Hits strictly between each ray's t_min and t_max count. Rays of an any-hit file are traced as any-hit queries.
/// The results are compared with those in the file. A ray is invalid, and counts as a miss, if it is
/// not finite, has no direction, or has a coordinate of its origin beyond 2^127.
#[derive(Clone, Debug, clap::Args)]
#[command(hide = true)]
pub(crate) struct TraceArgs {
    /// Mesh (.ply, .obj, .stl)
    #[arg(long, value_name = "FILE")]
    pub(crate) mesh: PathBuf,
    /// Rays
    #[arg(long, value_name = "FILE")]
    pub(crate) rays: PathBuf,
    /// Write the rays with these results to a file
    #[arg(long, value_name = "FILE")]
    pub(crate) answers: Option<PathBuf>,
    /// Trace rays in blocks (wavefront) or one at a time (recursive)
    #[arg(long, value_parser = choice::<TracerKind>(), default_value_t)]
    pub(crate) tracer: TracerKind,
    /// Quality of the BVH [default: chosen from the numbers of triangles and rays]
    #[arg(long, value_name = "PRESET", value_parser = choice::<Preset>())]
    pub(crate) bvh: Option<Preset>,
    /// Precision of intersections: fast can leak at edges
    #[arg(long, value_name = "PRECISION", value_parser = choice::<Precision>(), default_value_t)]
    pub(crate) precision: Precision,
    /// Traversal
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Timed passes over the rays; the median is reported
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = whole(1..=10_000_u32))]
    pub(crate) repeats: u32,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Threads
    #[command(flatten)]
    pub(crate) threads: Threads,
}

/// Runs the trace.
///
/// # Errors
/// If the mesh or the rays cannot be read or do not match, or the answers cannot be written.
pub(crate) fn run(args: &TraceArgs) -> Result<()> {
    args.search.check(args.precision)?;
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
    let mesh = mesh::load(&args.mesh)?.mesh;
    let (rays, triangles) = (file.rays.len(), mesh.triangles.len());
    check_belongs(args, &file, triangles)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let (positions, precision) = (mesh.positions, args.precision);
    let geometry =
        Geometry { positions, triangles: mesh.triangles, precision, ..Geometry::default() };
    let usual = || Preset::choose(triangles as u64, rays as u64);
    let preset = args.bvh.unwrap_or_else(usual);
    let start = Instant::now();
    let mut accel = Accel::new(geometry, preset);
    accel.search_by(args.search.kernel, args.search.simd);
    let build_seconds = start.elapsed().as_secs_f64();
    let answers = time_passes(&accel, &file, args.tracer, args.repeats);
    let per_ray = |count: u64| count as f64 / rays.max(1) as f64;
    let Counters { tests, kernels, .. } = answers.work;
    let mut classes = kernels.closest;
    classes += kernels.shadow;
    let report = TraceReport {
        rays,
        any_hit: file.any_hit,
        hits: answers.hits(file.any_hit),
        invalid: file.rays.iter().filter(|ray| !ray.is_valid()).count(),
        mrays_s: rays as f64 / answers.seconds / 1e6,
        seconds: answers.seconds,
        repeats: args.repeats,
        threads: rayon::current_num_threads(),
        tracer: args.tracer,
        simd: args.search.simd,
        kernel: args.search.kernel,
        precision,
        preset,
        triangles,
        load_seconds,
        build_seconds,
        expected_visits: accel.tree().map(Tree::expected_visits).unwrap_or_default(),
        nodes_per_ray: per_ray(tests.nodes),
        leaves_per_ray: per_ray(tests.leaves),
        triangles_per_ray: per_ray(tests.primitives.triangles),
        settled_per_ray: per_ray(tests.settled),
        exact_per_ray: per_ray(tests.exact),
        kernels: classes,
        compared: Compared::new(&file, &answers),
    };
    print(&if args.json { to_json(&report)? } else { report.text() })?;
    if let Some(output) = &args.answers {
        (file.closest, file.occluded) = (answers.closest, answers.occluded);
        file.write(output)?;
    }
    Ok(())
}

fn check_belongs(args: &TraceArgs, file: &RayFile, triangles: usize) -> Result<()> {
    if file.triangles == triangles as u64 {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Usage, "the rays are for another mesh")
        .in_file(&args.rays)
        .value(format!("rays for {} triangles", file.triangles))
        .remedy(format!("{} has {triangles}", args.mesh.display())))
}

/// The answers and times.
struct Answers {
    closest: Vec<Hit>,
    occluded: Vec<bool>,
    /// The tests and the rays of one timed pass.
    work: Counters,
    /// The median of the timed passes.
    seconds: f64,
}

impl Answers {
    /// The number of rays with a hit, by one kind of answers.
    fn hits(&self, any_hit: bool) -> usize {
        if any_hit {
            self.occluded.iter().filter(|&&occluded| occluded).count()
        } else {
            self.closest.iter().filter(|hit| !hit.is_miss()).count()
        }
    }
}

/// Times `repeats` passes with the query of the file, and runs the other query once.
fn time_passes(accel: &Accel, file: &RayFile, tracer: TracerKind, repeats: u32) -> Answers {
    let (mut closest, mut occluded) =
        (vec![Hit::MISS; file.rays.len()], vec![false; file.rays.len()]);
    // One for each thread, kept for the next pass.
    let mut traversals = Vec::new();
    let one_by_one = tracer == TracerKind::Recursive;
    let find = |rays: &[Ray], hits: &mut [Hit], t: &mut Traversal| match one_by_one {
        true => hits.iter_mut().zip(rays).for_each(|(hit, ray)| *hit = accel.closest(ray, t)),
        false => accel.closest_of(rays, hits, t),
    };
    let test = |rays: &[Ray], found: &mut [bool], t: &mut Traversal| match one_by_one {
        true => found.iter_mut().zip(rays).for_each(|(any, ray)| *any = accel.occluded(ray, t)),
        false => accel.occluded_of(rays, found, t),
    };
    let mut passes = |any_hit: bool| match any_hit {
        false => pass(accel, &mut traversals, &file.rays, &mut closest, find),
        true => pass(accel, &mut traversals, &file.rays, &mut occluded, test),
    };
    let mut work = Counters::default();
    let mut samples: Vec<f64> = Vec::new();
    for _ in 0..repeats {
        let start = Instant::now();
        work = passes(file.any_hit);
        samples.push(start.elapsed().as_secs_f64());
    }
    passes(!file.any_hit);
    samples.sort_by(f64::total_cmp);
    Answers { closest, occluded, work, seconds: samples[samples.len() / 2] }
}

/// Answers a `query` for every ray, block by block.
fn pass<A: Send>(
    accel: &Accel,
    traversals: &mut Vec<Traversal>,
    rays: &[Ray],
    answers: &mut [A],
    query: impl Fn(&[Ray], &mut [A], &mut Traversal) + Sync,
) -> Counters {
    let count = rays_at_once(rays.len());
    let blocks = answers.chunks_mut(count).zip(rays.chunks(count));
    let kept = Mutex::new(std::mem::take(traversals));
    let begin = || {
        let mut kept = lock(&kept).pop().unwrap_or_else(|| accel.traversal());
        (kept.tests, kept.kernels) = Default::default();
        kept
    };
    *traversals = with_state(blocks, begin, |own, (answers, rays)| query(rays, answers, own));
    let mut work = Counters::default();
    for &Traversal { tests, kernels, .. } in &*traversals {
        work += Counters { tests, kernels, ..Counters::default() };
    }
    work
}

/// Two t agree if they differ by less than this factor of t: those of the file may be off by what
/// single precision leaves at grazing angles.
const AGREEMENT: f32 = 1.0 / 16384.0;

/// The output.
#[derive(Serialize)]
struct TraceReport {
    rays: usize,
    any_hit: bool,
    hits: usize,
    /// Rays that cannot be traced and count as misses.
    invalid: usize,
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
    /// The visits that the surface-area heuristic expects of a ray; 0 without a tree.
    expected_visits: Visits,
    nodes_per_ray: f64,
    leaves_per_ray: f64,
    triangles_per_ray: f64,
    settled_per_ray: f64,
    exact_per_ray: f64,
    kernels: KernelCounts,
    compared: Compared,
}

/// The comparison of our answers with the file's.
#[derive(Debug, Default, Serialize)]
struct Compared {
    /// Hits only in the file.
    lost: usize,
    /// Hits only in ours.
    extra: usize,
    /// Closest hits on another triangle at the same distance.
    other_triangle: usize,
    /// Closest hits at another distance.
    other_distance: usize,
    /// The largest relative difference of t among the rest.
    largest_relative_t: f32,
    /// Any-hit answers of "hit" only in the file.
    lost_any: usize,
    /// Any-hit answers of "hit" only in ours.
    extra_any: usize,
}

impl Compared {
    /// Compares `ours` with the answers of `file`.
    fn new(file: &RayFile, ours: &Answers) -> Self {
        let mut compared = Self::default();
        for (theirs, ours) in file.closest.iter().zip(&ours.closest) {
            compared.add_closest(theirs, ours);
        }
        for (&theirs, &ours) in file.occluded.iter().zip(&ours.occluded) {
            compared.lost_any += usize::from(theirs && !ours);
            compared.extra_any += usize::from(ours && !theirs);
        }
        compared
    }

    fn add_closest(&mut self, theirs: &Hit, ours: &Hit) {
        match (theirs.is_miss(), ours.is_miss()) {
            (false, true) => self.lost += 1,
            (true, false) => self.extra += 1,
            (true, true) => {}
            (false, false) => {
                let relative = (theirs.t - ours.t).abs() / theirs.t.abs().max(f32::MIN_POSITIVE);
                // Written so that a NaN does not agree.
                let agrees = relative <= AGREEMENT;
                if !agrees {
                    self.other_distance += 1;
                    return;
                }
                self.largest_relative_t = self.largest_relative_t.max(relative);
                self.other_triangle += usize::from(theirs.primitive != ours.primitive);
            }
        }
    }

    fn text(&self) -> String {
        let Self { lost, extra, other_triangle, other_distance, lost_any, extra_any, .. } = self;
        format!(
            "against the file: {lost} lost, {extra} extra, {other_triangle} on another triangle, \
             {other_distance} at another distance, largest relative difference of t {:.2e}; \
             any-hit {lost_any} lost, {extra_any} extra\n",
            self.largest_relative_t
        )
    }
}

impl TraceReport {
    /// In words.
    fn text(&self) -> String {
        let kind = if self.any_hit { "any hit" } else { "closest hit" };
        let Self { mrays_s, rays, hits, invalid, seconds, repeats, threads, triangles, .. } = self;
        let Self { load_seconds, build_seconds, nodes_per_ray, leaves_per_ray, .. } = self;
        let Self { triangles_per_ray, settled_per_ray, exact_per_ray, compared, .. } = self;
        let (preset, precision, simd) =
            (self.preset.name(), self.precision.name(), self.simd.name());
        let Visits { nodes, leaves } = self.expected_visits;
        let KernelCounts { packet, handed_over, stream, single, .. } = &self.kernels;
        let average =
            |value| Option::from(value).map_or("-".to_owned(), |v: f64| format!("{v:.1}"));
        let [a_node, a_round] = [self.kernels.rays_a_node, self.kernels.rays_a_round].map(average);
        format!(
            "{mrays_s:.2} Mrays/s: {rays} rays ({kind}), {hits} hits, {invalid} invalid, {seconds:.4} s, \
             median of {repeats} on {threads} threads\n\
             mesh: {triangles} triangles, loaded in {load_seconds:.3} s; \
             BVH {preset}, built in {build_seconds:.3} s, \
             estimate {nodes:.1} nodes and {leaves:.1} leaves per ray; {precision} precision\n\
             per ray: {nodes_per_ray:.2} nodes, {leaves_per_ray:.2} leaves, \
             {triangles_per_ray:.2} triangles, {settled_per_ray:.5} settled in double precision, \
             {exact_per_ray:.6} in exact arithmetic\n\
             {simd}: {packet} rays in packets ({handed_over} handed over), {stream} in streams, \
             {single} alone; average: {a_node} rays of a packet at a node, \
             {a_round} rays in flight per round\n{}",
            compared.text()
        )
    }
}
