//! `trace`: traces the rays of a file against a mesh, with times and answers.

mod passes;
mod report;

use std::path::PathBuf;
use std::time::Instant;

use super::common::{SearchOptions, Threads, print, to_json, whole};
use crate::choice::choice;
use report::{Compared, Report};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::tree::Tree;
use wavecrest_core::counters::Counters;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::render::TracerKind;
use wavecrest_report::ray_file::RayFile;
use wavecrest_scene::mesh;

/// Trace a file of rays against a mesh, and print the speed.
///
/// Hits strictly between each ray's t_min and t_max count. Rays of an any-hit file are traced as any-hit queries.
/// The results are compared with those in the file.
#[derive(Clone, Debug, clap::Args)]
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
    let usual = || Preset::choose(triangles as u64, rays as u64).at_once();
    let preset = args.bvh.unwrap_or_else(usual);
    let start = Instant::now();
    let mut accel = Accel::new(geometry, preset);
    args.search.apply(&mut accel);
    let build_seconds = start.elapsed().as_secs_f64();
    let answers = passes::run(&accel, &file, args.tracer, args.repeats);
    let per_ray = |count: u64| count as f64 / rays.max(1) as f64;
    let Counters { tests, kernels, .. } = answers.work;
    let report = Report {
        rays,
        any_hit: file.any_hit,
        hits: answers.hits(file.any_hit),
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
        triangles_per_ray: per_ray(tests.triangles),
        settled_per_ray: per_ray(tests.settled),
        exact_per_ray: per_ray(tests.exact),
        kernels: (&kernels.both()).into(),
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
