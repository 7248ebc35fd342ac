//! `probe`: the hits of a pixel's rays.

use std::path::PathBuf;

use glam::Vec3;

use super::common::{SearchOptions, numbers, print, rounded, to_json, whole};
use super::input::SceneOptions;
use wavecrest_api::session::Session;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::probe::{
    Bounce, HitRecord, LightRecord, PathRecord, PixelRecord, RayKind, SurfaceRecord, Visibility,
    pixel,
};
use wavecrest_core::recursive::PathEnd;

/// Follow the rays of a pixel: what they hit, its material, and what each light adds.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ProbeArgs {
    /// Scene (.json, .gltf, .glb) or mesh (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// Pixel, counted from 0,0 at the top left
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    pub(crate) pixel: [u32; 2],
    /// Follow only this sample of the pixel [default: the first 16]
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

/// Prints the hits of the pixel's rays.
///
/// # Errors
/// If the scene cannot be prepared, or has no such pixel or sample.
pub(crate) fn run(args: &ProbeArgs) -> Result<()> {
    args.search.check(args.scene_options.precision)?;
    args.scene_options.threads.run(|| {
        let options = args.scene_options.preparing(Some(&args.search));
        let Session { scene, .. } =
            args.scene_options.session(&args.scene, &options, |_| Ok(()))?;
        let (size, samples) = (scene.camera.size(), scene.camera.rays_per_pixel());
        check(args, size, samples)?;
        let record = pixel(&scene, args.pixel, args.sample, args.seed, &|_| false);
        scene.appearance.check()?;
        let text = if args.json { to_json(&record)? } else { text(&record) };
        print(&text)
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

/// What the rays of a pixel meet, in sentences.
pub(crate) fn text(record: &PixelRecord) -> String {
    let mut text = String::new();
    let (samples, [x, y]) = (record.samples, record.pixel);
    let mut rest: Vec<&PathRecord> = record.paths.iter().collect();
    // Samples with the same hits are printed once.
    while let Some(&first) = rest.first() {
        let own = outline(first);
        let (same, others): (Vec<&PathRecord>, Vec<&PathRecord>) =
            rest.iter().partition(|path| outline(path) == own);
        let radiance = three(first.radiance);
        text +=
            &format!("pixel {x},{y}, sample {} of {samples}: radiance {radiance}\n", first.sample);
        first.bounces.iter().enumerate().for_each(|(number, one)| text += &bounce(number, one));
        for path in &same[1..] {
            let radiance = three(path.radiance);
            text += &format!("  sample {}: the same hits, radiance {radiance}\n", path.sample);
        }
        rest = others;
    }
    if let Some(count) = record.cut_after {
        text += &format!("Cut after {count} rays and points on lights.\n");
    }
    text
}

/// For each ray of a path the primitive that it hits, and for each point of a light whether its light arrives.
type PathOutcome = Vec<(Option<u32>, Vec<(usize, bool)>)>;

fn outline(path: &PathRecord) -> PathOutcome {
    let arrives = |light: &LightRecord| {
        matches!(light.verdict, Visibility::Visible | Visibility::Weakened { .. })
    };
    let light = |light: &LightRecord| (light.light, arrives(light));
    let bounce = |bounce: &Bounce| match &bounce.met {
        Some(met) => (Some(met.primitive), met.lights.iter().map(light).collect()),
        None => (None, Vec::new()),
    };
    path.bounces.iter().map(bounce).collect()
}

/// A single-precision number, with as many digits as are certain after a few operations.
fn number(x: f32) -> String {
    const DIGITS: usize = 6;
    rounded(f64::from(x), DIGITS).to_string()
}

fn three(v: Vec3) -> String {
    v.to_array().map(number).join(" ")
}

fn bounce(number: usize, bounce: &Bounce) -> String {
    let what = match (bounce.kind, bounce.from.unwrap_or(0)) {
        (RayKind::Camera, _) => "camera ray".to_owned(),
        (RayKind::Mirrored, from) => format!("ray {number}, mirrored where ray {from} ends,"),
        (RayKind::Refracted, from) => format!("ray {number}, refracted where ray {from} ends,"),
        (RayKind::Straight, from) => format!("ray {number}, straight on where ray {from} ends,"),
    };
    let Bounce { nodes, leaves, primitives, .. } = bounce;
    let throughput = match bounce.kind {
        RayKind::Camera => String::new(),
        _ => format!(", throughput {}", three(bounce.throughput)),
    };
    let medium = bounce.medium.as_ref().map_or_else(String::new, |of| format!(", inside of {of}"));
    let (direction, radiance) = (three(bounce.direction), three(bounce.radiance));
    let origin = bounce.origin.to_array().map(|x| rounded(x, 7).to_string()).join(" ");
    let hit = bounce.met.as_ref().map_or("    hits nothing\n".to_owned(), met);
    let end = bounce.end.map_or("goes on", |end| match end {
        PathEnd::Nothing => "ends at the background",
        PathEnd::Light => "ends at a light",
        PathEnd::LastBounce => "ends: no bounces left",
        PathEnd::NoMirror => "ends: neither mirrored nor let through",
    });
    format!(
        "  {what} from {origin}, direction {direction}{throughput}{medium}\n    visits: nodes {nodes}, leaves {leaves}; \
         primitives tested: {primitives}\n{hit}    radiance so far {radiance}; {end}\n"
    )
}

fn met(met: &HitRecord) -> String {
    let name = met.name.as_ref().map_or_else(String::new, |name| format!(" ({name})"));
    let bound = met.t_error.map_or("no bound".to_owned(), |e| format!("\u{b1}{e:.1e}"));
    let [u, v] = met.uv.map(number);
    let t = within(met.t.into(), met.t_error);
    let coordinate = |(x, e): (f64, f32)| within(x, Some(e));
    let point = met.point.to_array().into_iter().zip(met.error.to_array()).map(coordinate);
    let (point, error) = (point.collect::<Vec<_>>().join(" "), met.error.max_element());
    let mut text = format!(
        "    hits {} {} of {}{name}\n    t = {t} {bound}, u = {u}, v = {v}\n    \
         point {point} \u{b1}{error:.1e}\n    normal {}",
        met.kind,
        met.primitive,
        met.shape,
        three(met.normal)
    );
    if met.normal != met.shading_normal {
        text += &format!(", shading normal {}", three(met.shading_normal));
    }
    text.push('\n');
    text += &met.surface.as_ref().map_or_else(String::new, surface);
    if !met.lit && !met.lights.is_empty() {
        text += "    lights do not reach this side\n";
    }
    text + &met.lights.iter().map(light).collect::<String>()
}

fn surface(
    SurfaceRecord { color, texture, ks, kd, exponent, kr, opacity, kt, ior, emission }: &SurfaceRecord,
) -> String {
    let from = texture.as_ref().map_or_else(String::new, |file| format!(" from {file}"));
    let [kd, ks, exponent] = [*kd, *ks, *exponent].map(number);
    let color = three(*color);
    let mut text = format!("    colour {color}{from}; kd {kd}, ks {ks}, exponent {exponent}");
    if *kr > 0.0 {
        text += &format!(", kr {}", number(*kr));
    }
    if *opacity < 1.0 {
        text += &format!(", opacity {}", number(*opacity));
    }
    if *kt > 0.0 {
        text += &format!(", kt {}, ior {}", number(*kt), number(*ior));
    }
    if *emission != Vec3::ZERO {
        text += &format!(", emission {}", three(*emission));
    }
    text + "\n"
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

fn light(light: &LightRecord) -> String {
    let verdict = match &light.verdict {
        Visibility::Behind => "behind the surface".to_owned(),
        Visibility::NotReflected => "reflects nothing".to_owned(),
        Visibility::Visible => format!("visible, adds {}", three(light.adds)),
        Visibility::Weakened { transmittance } => {
            format!("weakened to {}, adds {}", three(*transmittance), three(light.adds))
        }
        Visibility::Occluded { primitive: Some(primitive), shape, t } => {
            format!("blocked by primitive {primitive} of {shape}, at {} of the way", number(*t))
        }
        Visibility::Occluded { primitive: None, .. } => "blocked".to_owned(),
    };
    let LightRecord { light, ambient, index, distance, .. } = light;
    let name = if *ambient { "ambient light".to_owned() } else { format!("light {light}") };
    let distance = distance.map_or("infinitely far".to_owned(), |d| format!("{} away", number(d)));
    format!("    {name}, point {index}, {distance}: {verdict}\n")
}
