//! `probe`: what the rays of a pixel meet.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::common::{SceneOptions, SearchOptions, print, to_json};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::probe::{Bounce, Light, Met, Path, PixelRecord, Verdict, pixel};

/// Says what happens to the rays of a pixel: what they meet, and what every light does there.
///
/// Exits with 1 if the two tracers differ.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ProbeArgs {
    /// The scene, in JSON
    pub(crate) scene: PathBuf,
    /// The pixel, from the top left
    #[arg(long, value_name = "X,Y", value_parser = place)]
    pub(crate) pixel: [u32; 2],
    /// Report this sample of the pixel alone
    #[arg(long, value_name = "N")]
    pub(crate) sample: Option<u32>,
    /// The seed of the render
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// How the tree is searched
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// What is read and how
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

/// `x,y` in pixels.
fn place(text: &str) -> std::result::Result<[u32; 2], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y]) => Ok([x, y]),
        _ => Err("write two whole numbers: x,y, such as 320,200".to_owned()),
    }
}

/// Prints what the rays of the pixel meet, and returns whether both tracers agree.
///
/// # Errors
/// When the scene cannot be prepared, or has no such pixel or sample.
pub(crate) fn run(args: &ProbeArgs) -> Result<bool> {
    args.scene_options.threads.run(|| {
        let loaded = args.scene_options.load(&args.scene)?;
        let extracted = args.scene_options.extract(loaded)?;
        let preset = args.scene_options.bvh.unwrap_or_else(|| extracted.preset());
        let mut scene = extracted.build(preset);
        args.search.apply(&mut scene.accel);
        let (size, samples) = (scene.camera.size(), scene.camera.rays_per_pixel());
        check(args, size, samples)?;
        let mut record = pixel(&scene, args.pixel, args.seed);
        if let Some(sample) = args.sample {
            record.paths.retain(|path| path.sample == sample);
        }
        print(&if args.json { to_json(&record)? } else { text(&record) })?;
        Ok(record.differs.is_none())
    })
}

fn check(args: &ProbeArgs, [width, height]: [u32; 2], samples: u32) -> Result<()> {
    let [x, y] = args.pixel;
    if x >= width || y >= height {
        return Err(Error::new(ErrorKind::Usage, "the pixel is not in the image")
            .value(format!("{x},{y}"))
            .remedy(format!("the image is {width} x {height}, and the first pixel is 0,0")));
    }
    match args.sample {
        Some(sample) if sample >= samples => {
            Err(Error::new(ErrorKind::Usage, "the pixel has no such sample")
                .value(sample)
                .remedy(format!("it has {samples}, and the first is 0")))
        }
        _ => Ok(()),
    }
}

fn text(record: &PixelRecord) -> String {
    let mut text = String::new();
    for path in &record.paths {
        write_path(&mut text, record.pixel, path);
    }
    let _ = match record.differs {
        None => writeln!(text, "Both tracers tell this story, to the last bit."),
        Some([sample, bounce]) => {
            writeln!(
                text,
                "THE WAVEFRONT TELLS ANOTHER STORY from sample {sample}, bounce {bounce} on."
            )
        }
    };
    text
}

fn write_path(text: &mut String, [x, y]: [u32; 2], path: &Path) {
    let [r, g, b] = path.radiance.to_array();
    let _ = writeln!(text, "pixel {x},{y}, sample {}: radiance {r} {g} {b}", path.sample);
    for (number, bounce) in path.bounces.iter().enumerate() {
        write_bounce(text, number, bounce);
    }
}

fn write_bounce(text: &mut String, number: usize, bounce: &Bounce) {
    let what = if number == 0 { "camera ray".to_owned() } else { format!("mirror ray {number}") };
    let Bounce { origin: o, direction: d, nodes, leaves, primitives, .. } = bounce;
    let _ = writeln!(text, "  {what} from {o} towards {d}");
    let _ = writeln!(
        text,
        "    visits {nodes} nodes and {leaves} leaves, tests {primitives} primitives"
    );
    match &bounce.met {
        None => {
            let _ = writeln!(text, "    meets nothing");
        }
        Some(met) => write_met(text, met),
    }
    let end = bounce.end.map_or("goes on from the mirror", |end| match end {
        wavecrest_core::recursive::End::Nothing => "ends at the background",
        wavecrest_core::recursive::End::Light => "ends at a light",
        wavecrest_core::recursive::End::LastBounce => "ends: no bounces are left",
        wavecrest_core::recursive::End::NoMirror => "ends: no mirror",
    });
    let _ = writeln!(text, "    gathered {}; {end}", bounce.radiance);
}

fn write_met(text: &mut String, met: &Met) {
    let bound = met.t_error.map_or("no bound".to_owned(), |e| format!("within {e:.2e}"));
    let _ = writeln!(
        text,
        "    meets {} {} of {} at t = {} ({bound}), u = {}, v = {}",
        met.kind, met.primitive, met.shape, met.t, met.uv[0], met.uv[1]
    );
    let [x, y, z] = met.error.to_array();
    let _ = writeln!(text, "    point {} within {x:.2e}, {y:.2e}, {z:.2e}", met.point);
    let _ = writeln!(text, "    normal {}, lit with {}", met.normal, met.shading_normal);
    if !met.lit && !met.lights.is_empty() {
        let _ = writeln!(text, "    lights do not reach this side");
    }
    for light in &met.lights {
        write_light(text, light);
    }
}

fn write_light(text: &mut String, light: &Light) {
    let verdict = match &light.verdict {
        Verdict::Behind => "behind the surface".to_owned(),
        Verdict::NotReflected => "nothing of it is reflected".to_owned(),
        Verdict::Visible => format!("visible, adds {}", light.adds),
        Verdict::Occluded { primitive: Some(number), shape, t } => {
            format!("in the shadow of primitive {number} of {shape}, at {t} of the way")
        }
        Verdict::Occluded { primitive: None, .. } => "in shadow".to_owned(),
    };
    let Light { light: number, index, distance, .. } = light;
    let distance = distance.map_or("infinitely far".to_owned(), |d| format!("{d} away"));
    let _ = writeln!(text, "    light {number}, point {index}, {distance}: {verdict}");
}
