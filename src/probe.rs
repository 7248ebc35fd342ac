//! `probe`: the hits of a pixel's rays.

use std::fmt::Write as _;
use std::path::PathBuf;

use glam::Vec3;

use super::common::{Extent, SceneOptions, SearchOptions, numbers, print, rounded, to_json, whole};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::probe::{Bounce, Light, Met, Path, PixelRecord, Surface, Verdict, pixel};
use wavecrest_scene::memory::{Images, film_bytes};

/// Follow the rays of a pixel: what they hit, its material, and what each light adds.
///
/// The exit code is 1 if the two tracers differ.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ProbeArgs {
    /// Scene (.json, .gltf, .glb) or mesh (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// Pixel, counted from 0,0 at the top left
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    pub(crate) pixel: [u32; 2],
    /// Report only this sample of the pixel
    #[arg(long, value_name = "N", value_parser = whole(0..=u32::MAX))]
    pub(crate) sample: Option<u32>,
    /// Seed of the render
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole(0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Traversal
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Scene
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

/// `x,y` in pixels.
fn place(text: &str) -> std::result::Result<[u32; 2], String> {
    numbers(text).ok_or_else(|| "write two whole numbers: x,y, such as 320,200".to_owned())
}

/// Prints the hits of the pixel's rays, and returns whether both tracers agree.
///
/// # Errors
/// If the scene cannot be prepared, or has no such pixel or sample.
pub(crate) fn run(args: &ProbeArgs) -> Result<bool> {
    args.search.check(args.scene_options.precision)?;
    args.scene_options.threads.run(|| {
        // A single pixel, not written.
        let images = |_| Images { film: film_bytes(1), writing: 0 };
        let extent = &Extent { images: Box::new(images), ..Extent::default() };
        let loaded = args.scene_options.load(&args.scene, extent, &[])?;
        let extracted = args.scene_options.extract(loaded, extent)?;
        let preset = args.scene_options.preset(&extracted);
        let mut scene = args.scene_options.build(extracted, preset)?;
        args.search.apply(&mut scene.accel);
        let (size, samples) = (scene.camera.size(), scene.camera.rays_per_pixel());
        check(args, size, samples)?;
        let mut record = pixel(&scene, args.pixel, args.seed);
        scene.appearance.check()?;
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
        return Err(Error::new(ErrorKind::Usage, "the pixel is outside the image")
            .value(format!("{x},{y}"))
            .remedy(format!("use 0,0 to {},{}", width - 1, height - 1)));
    }
    match args.sample {
        Some(sample) if sample >= samples => {
            Err(Error::new(ErrorKind::Usage, "the pixel has no such sample")
                .value(sample)
                .remedy(format!("use 0 to {}", samples - 1)))
        }
        _ => Ok(()),
    }
}

fn text(record: &PixelRecord) -> String {
    let mut text = String::new();
    let [x, y] = record.pixel;
    let mut rest: Vec<&Path> = record.paths.iter().collect();
    // Samples with the same hits are printed once.
    while let Some(&first) = rest.first() {
        let (same, others): (Vec<&Path>, Vec<&Path>) =
            rest.iter().partition(|path| outline(path) == outline(first));
        let _ = write!(text, "pixel {x},{y}, sample {}: {}", first.sample, story(first));
        for path in &same[1..] {
            let radiance = three(path.radiance);
            let _ = writeln!(text, "  sample {}: the same hits, radiance {radiance}", path.sample);
        }
        rest = others;
    }
    let _ = match record.differs {
        None => writeln!(text, "Both tracers agree to the last bit."),
        Some([sample, bounce]) => {
            writeln!(text, "THE TRACERS DIFFER from sample {sample}, bounce {bounce} on.")
        }
    };
    text
}

/// For each bounce of a path the primitive that it hits, and for each point of a light whether it is visible.
type Outline = Vec<(Option<u32>, Vec<(usize, bool)>)>;

fn outline(path: &Path) -> Outline {
    let light = |light: &Light| (light.light, light.verdict == Verdict::Visible);
    let bounce = |bounce: &Bounce| match &bounce.met {
        Some(met) => (Some(met.primitive), met.lights.iter().map(light).collect()),
        None => (None, Vec::new()),
    };
    path.bounces.iter().map(bounce).collect()
}

/// The description of a path.
fn story(path: &Path) -> String {
    let mut text = format!("radiance {}\n", three(path.radiance));
    for (number, bounce) in path.bounces.iter().enumerate() {
        write_bounce(&mut text, number, bounce);
    }
    text
}

/// A single-precision number, with as many digits as are certain after a few operations.
fn number(x: f32) -> String {
    const DIGITS: usize = 6;
    rounded(f64::from(x), DIGITS).to_string()
}

fn three(v: Vec3) -> String {
    v.to_array().map(number).join(" ")
}

fn write_bounce(text: &mut String, number: usize, bounce: &Bounce) {
    let what = if number == 0 { "camera ray".to_owned() } else { format!("mirror ray {number}") };
    let Bounce { origin, direction, nodes, leaves, primitives, .. } = bounce;
    let origin = origin.to_array().map(|x| rounded(x, 7).to_string()).join(" ");
    let _ = writeln!(text, "  {what} from {origin}, direction {}", three(*direction));
    let _ = writeln!(
        text,
        "    visits: nodes {nodes}, leaves {leaves}; primitives tested: {primitives}"
    );
    match &bounce.met {
        None => {
            let _ = writeln!(text, "    hits nothing");
        }
        Some(met) => write_met(text, met),
    }
    let end = bounce.end.map_or("continues from the mirror", |end| match end {
        wavecrest_core::recursive::End::Nothing => "ends at the background",
        wavecrest_core::recursive::End::Light => "ends at a light",
        wavecrest_core::recursive::End::LastBounce => "ends: no bounces left",
        wavecrest_core::recursive::End::NoMirror => "ends: not a mirror",
    });
    let _ = writeln!(text, "    radiance so far {}; {end}", three(bounce.radiance));
}

fn write_met(text: &mut String, met: &Met) {
    let name = met.name.as_ref().map_or_else(String::new, |name| format!(" ({name})"));
    let _ = writeln!(text, "    hits {} {} of {}{name}", met.kind, met.primitive, met.shape);
    let bound = met.t_error.map_or("no bound".to_owned(), |e| format!("\u{b1}{e:.1e}"));
    let [u, v] = met.uv.map(number);
    let _ =
        writeln!(text, "    t = {} {bound}, u = {u}, v = {v}", within(met.t.into(), met.t_error));
    let coordinate = |(x, e): (f64, f32)| within(x, Some(e));
    let point = met.point.to_array().into_iter().zip(met.error.to_array()).map(coordinate);
    let error = met.error.max_element();
    let point = point.collect::<Vec<_>>().join(" ");
    let _ = writeln!(text, "    point {point} \u{b1}{error:.1e}");
    if met.normal == met.shading_normal {
        let _ = writeln!(text, "    normal {}", three(met.normal));
    } else {
        let (normal, shading) = (three(met.normal), three(met.shading_normal));
        let _ = writeln!(text, "    normal {normal}, shading normal {shading}");
    }
    if let Some(surface) = &met.surface {
        write_surface(text, surface);
    }
    if !met.lit && !met.lights.is_empty() {
        let _ = writeln!(text, "    lights do not reach this side");
    }
    for light in &met.lights {
        write_light(text, light);
    }
}

fn write_surface(text: &mut String, surface: &Surface) {
    let Surface { color, texture, ks, kd, exponent, kr, emission } = surface;
    let from = texture.as_ref().map_or_else(String::new, |file| format!(" from {file}"));
    let [kd, ks, exponent] = [*kd, *ks, *exponent].map(number);
    let color = three(*color);
    let _ = write!(text, "    colour {color}{from}; kd {kd}, ks {ks}, exponent {exponent}");
    if *kr > 0.0 {
        let _ = write!(text, ", kr {}", number(*kr));
    }
    if *emission != Vec3::ZERO {
        let _ = write!(text, ", emission {}", three(*emission));
    }
    text.push('\n');
}

/// A number with an error of up to `error`, with the certain digits.
fn within(x: f64, error: Option<f32>) -> String {
    const MOST: usize = 9;
    let error = error.map_or(x.abs() * f64::from(f32::EPSILON), f64::from);
    if error <= 0.0 || x == 0.0 {
        return rounded(x, MOST).to_string();
    }
    // The last digit is the first affected by the error.
    let digits = (x.abs() / error).log10().ceil().clamp(1.0, MOST as f64);
    rounded(x, digits as usize).to_string()
}

fn write_light(text: &mut String, light: &Light) {
    let verdict = match &light.verdict {
        Verdict::Behind => "behind the surface".to_owned(),
        Verdict::NotReflected => "reflects nothing".to_owned(),
        Verdict::Visible => format!("visible, adds {}", three(light.adds)),
        Verdict::Occluded { primitive: Some(primitive), shape, t } => {
            format!("blocked by primitive {primitive} of {shape}, at {} of the way", number(*t))
        }
        Verdict::Occluded { primitive: None, .. } => "blocked".to_owned(),
    };
    let Light { light: index, index: point, distance, .. } = light;
    let distance = distance.map_or("infinitely far".to_owned(), |d| format!("{} away", number(d)));
    let _ = writeln!(text, "    light {index}, point {point}, {distance}: {verdict}");
}
