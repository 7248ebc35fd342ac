//! Renders what pages show: small images while the camera moves, then with more and more samples.
//!
//! One thread, with the pool that traces, has the scene. It takes requests between renders, and each that arrives ends the
//! render in progress. An image at rest has the bits of `wavecrest render` for its camera and settings.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use serde_json::{Map, Value, json};
use tokio_tungstenite::tungstenite::Message;

use super::ViewArgs;
use super::exchange::{Exchange, Kind};
use super::refine::{OwnSamples, Stage, Tried, counts, fewest};
use super::request::{Half, Request};
use super::showing::{Showing, Telling, UntilAsked, text};
use super::steering::Steering;
use super::take_away::TakeAway;
use crate::common::to_json;
use crate::explain;
use crate::input::Purpose;
use crate::render::look::render_look;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::kernels::camera::{Camera, Placement};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::sampling::Sampling;
use wavecrest_core::prepared::{Appearance, Original, PreparedScene, Samples};
use wavecrest_core::probe;
use wavecrest_core::render::{RenderOptions, Rendered, Watch, render};
use wavecrest_image::look::Look;
use wavecrest_image::write::Transfer;
use wavecrest_report::accuracy::pilot::measured;
use wavecrest_report::statistics::Rays;
use wavecrest_scene::components::{Encoding, View};
use wavecrest_scene::systems::{bounds, frame, free_camera};

/// Seconds of a frame while something moves, with some left for what moves it.
const FRAME: f64 = 0.9 / 15.0;
/// The share of its sides at which the first image is made.
const FIRST: f64 = 0.125;
/// How long nothing may be asked for before the image is refined.
const REST: Duration = Duration::from_millis(120);
/// The least number of paths in a batch, and how many batches each thread has of a small image.
const LEAST_BATCH: usize = 256;
const SHARES: usize = 8;
/// What a second of walking covers, as a share of the diagonal of the scene.
const STRIDE: f64 = 0.2;
/// The most pixels of an image.
const MOST_PIXELS: u64 = 1 << 24;
/// The most paths of a pixel that are told.
const MOST_PATHS: usize = 16;

/// A scene that is ready to be traced, from anywhere.
struct Ready {
    scene: PreparedScene,
    preset: Preset,
    /// What it was prepared to show.
    look: Option<Look>,
    /// The camera and the lights of the file.
    camera: Camera,
    original: Original,
    own: OwnSamples,
    /// The transfer curve of what is shown.
    transfer: Transfer,
    /// The box around everything.
    ends: [DVec3; 2],
}

/// The painter.
pub(super) struct Painter<'a> {
    args: &'a ViewArgs,
    exchange: &'a Arc<Exchange>,
    take_away: &'a TakeAway,
    ready: Ready,
    steering: Steering,
    halves: Vec<Half>,
    look: Option<Look>,
    /// For each half, the renders that are finished for this camera, and what pages are told of the last.
    finished: [usize; 2],
    figures: [Value; 2],
    tried: Tried,
    /// The pixels that were traced in a second while something moved.
    pace: Option<f64>,
}

/// Shows the scene of `args` until the process ends.
///
/// # Errors
/// If it cannot be loaded or prepared, or an image can no longer be decoded.
pub(super) fn paint(args: &ViewArgs, exchange: &Arc<Exchange>, take_away: &TakeAway) -> Result<()> {
    let (ready, view) = prepare(args, exchange, take_away, args.look, None)?;
    let half = Half::of_file(args.scene_options.precision, args.tracer);
    let mut painter = Painter {
        args,
        exchange,
        take_away,
        ready,
        steering: Steering::new(view),
        halves: vec![half],
        look: args.look,
        finished: [0; 2],
        figures: Default::default(),
        tried: Tried::default(),
        pace: None,
    };
    painter.tell_plan();
    let first = json!({"kind": "progress", "stage": "tracing the first rays", "done": 0, "all": 0});
    exchange.tell(Kind::Progress, text(&first));
    painter.restart();
    painter.run()
}

/// Reads and prepares the scene, for a camera that goes anywhere, which pages are shown.
fn prepare(
    args: &ViewArgs,
    exchange: &Arc<Exchange>,
    take_away: &TakeAway,
    look: Option<Look>,
    view: Option<View>,
) -> Result<(Ready, View)> {
    let _telling = Telling::begin(Arc::clone(exchange));
    let (options, purpose) = (&args.scene_options, &Purpose { look, ..Purpose::whole(args.batch) });
    let mut loaded = options.load(&args.scene, purpose, &[])?;
    take_away.keep(&loaded)?;
    let view = free_camera(&mut loaded.world, view)?;
    if u64::from(view.width) * u64::from(view.height) > MOST_PIXELS {
        let message = format!("a page shows at most {MOST_PIXELS} pixels");
        let error = Error::new(ErrorKind::Limit, message).in_file(&args.scene);
        let remedy = "use a smaller --size";
        return Err(error.value(format!("{} x {}", view.width, view.height)).remedy(remedy));
    }
    let transfer = match loaded.transfer() {
        // Other looks are encoded already.
        Encoding::Srgb if look.is_none_or(Look::is_shaded) => Transfer::Srgb,
        _ => Transfer::Linear,
    };
    let extracted = options.extract(loaded, purpose)?;
    let preset = options.preset(&extracted);
    let mut scene = options.build(extracted, preset)?;
    args.search.apply(&mut scene.accel);
    let (camera, original) = (scene.camera, scene.original());
    let own = OwnSamples::of(&scene, view.sampling);
    let ends = bounds::of_file(&scene).unwrap_or([DVec3::NEG_ONE, DVec3::ONE]);
    let ends = ends.map(|end| end + scene.origin);
    Ok((Ready { scene, preset, look, camera, original, own, transfer, ends }, view))
}

impl<'a> Painter<'a> {
    /// Renders and takes requests in turn.
    fn run(&mut self) -> Result<()> {
        let mut moves = true;
        loop {
            if moves {
                self.draft()?;
            }
            let at_rest = !moves && self.refine()?;
            let patience = match (moves, at_rest) {
                (true, _) => REST,
                (false, true) => Duration::MAX,
                (false, false) => Duration::ZERO,
            };
            let requests = self.exchange.inbox.take(patience);
            moves = false;
            for request in requests {
                moves |= self.obey(request)?;
            }
        }
    }

    /// Does what a page asks; returns whether the image changes.
    fn obey(&mut self, request: Request) -> Result<bool> {
        let before = self.steering.view;
        match request {
            Request::Grab { at } => self.steering.pivot = self.point(at),
            Request::Orbit { by } => self.steering.orbit(by),
            Request::Pan { by } => self.steering.pan(by),
            Request::Zoom { at, by } => {
                let point = self.point(at);
                self.steering.zoom(point, by);
            }
            Request::Walk { by } => {
                let [low, high] = self.ready.ends;
                self.steering.walk(by, STRIDE * low.distance(high));
            }
            Request::Side { side } => self.steering.show(&side, self.ready.ends),
            Request::Probe { at } => self.probe(at)?,
            Request::Set { halves } => return Ok(self.set(halves)),
            Request::Look { look } => return self.look_at(look),
            Request::Taken => {}
        }
        if self.steering.view == before {
            return Ok(false);
        }
        self.tried = Tried::default();
        self.exchange.withdraw(Kind::Probe);
        self.restart();
        Ok(true)
    }

    /// Shows another look from now on, or light.
    fn look_at(&mut self, look: Option<Look>) -> Result<bool> {
        let is_new = look != self.look;
        self.look = look;
        // Edges are drawn over what is prepared for light.
        let prepared = |look: Option<Look>| look.filter(|look| *look != Look::Wireframe);
        if prepared(look) != prepared(self.ready.look) {
            self.prepare_again()?;
        }
        self.restart();
        Ok(is_new)
    }

    /// Renders these halves from now on. What is finished of one that stays is kept.
    fn set(&mut self, halves: Vec<Half>) -> bool {
        let is_known = |index: usize| self.halves.get(index) == halves.get(index);
        let same = [is_known(0), is_known(1)];
        if !(1..=2).contains(&halves.len()) || same == [true; 2] {
            return false;
        }
        for index in [0, 1].into_iter().filter(|&index| !same[index]) {
            self.finished[index] = 0;
        }
        self.figures[1] = Value::Null;
        if halves.len() == 1 {
            self.exchange.withdraw(Kind::Second);
        }
        self.halves = halves;
        self.tell_state();
        false
    }

    /// Prepares the scene once more: for another look, or because it is too far from where it was prepared for.
    fn prepare_again(&mut self) -> Result<()> {
        // Two scenes would take twice the memory.
        self.ready.scene.accel = Accel::unbuilt(Geometry::default());
        self.ready.scene.appearance = Appearance::default();
        let view = Some(self.steering.view);
        (self.ready, _) = prepare(self.args, self.exchange, self.take_away, self.look, view)?;
        self.tell_plan();
        Ok(())
    }

    /// Forgets what was rendered for another camera.
    fn restart(&mut self) {
        self.finished = [0; 2];
        self.exchange.withdraw(Kind::Second);
        self.tell_state();
    }

    /// What a ray through a place of the image meets first; a point before it if nothing.
    fn point(&self, at: [f64; 2]) -> DVec3 {
        let scene = &self.ready.scene;
        let (from, far) = (self.steering.view.location, self.steering.point(at));
        let direction = (far - from).normalize();
        let ray = Ray::new((from - scene.origin).as_vec3(), direction.as_vec3());
        let hit = scene.accel.closest(&ray, &mut scene.accel.traversal());
        if hit.is_miss() { far } else { from + direction * f64::from(hit.t) }
    }

    /// The render options of a half.
    fn options(&self, half: &Half) -> RenderOptions {
        let pixels =
            self.ready.scene.camera.size().map(|side| side as usize).iter().product::<usize>();
        // A small image is cut into tiles for all threads, too.
        let paths = pixels * self.ready.scene.camera.rays_per_pixel() as usize;
        let share = paths / (SHARES * rayon::current_num_threads());
        let batch = share.clamp(LEAST_BATCH, self.args.batch.max(LEAST_BATCH as u32) as usize);
        RenderOptions {
            tracer: half.tracer,
            seed: self.args.seed,
            batch,
            ..RenderOptions::default()
        }
    }

    /// Makes the scene ready for a render of a half, with these samples and this many pixels.
    fn place(&mut self, half: &Half, samples: &Samples, size: [u32; 2]) {
        let Ready { scene, camera, original, .. } = &mut self.ready;
        scene.accel.set_precision(half.precision);
        scene.resample(original, &Samples::default());
        let placement = self.steering.view.placement();
        let (location, look) = (placement.location - scene.origin, placement.look - scene.origin);
        scene.camera = camera.placed(&Placement { location, look, size, ..placement });
        let placed = scene.original();
        scene.resample(&placed, samples);
    }

    /// Renders a half and shows it: while something moves, or at rest, when a request ends it. Returns what is finished.
    fn shoot(
        &mut self,
        index: usize,
        Stage { samples, words }: &Stage,
        size: [u32; 2],
        moves: bool,
    ) -> Result<Option<Rendered>> {
        let half = self.halves[index];
        self.place(&half, samples, size);
        let mut figures = self.all_figures();
        if let Some(half) = figures["halves"].get_mut(index) {
            (half["samples"], half["rests"]) = (json!(words), json!(false));
        }
        let showing =
            Showing::new(self.exchange, index, size, (self.ready.transfer, moves), figures);
        let (scene, options) = (&self.ready.scene, &self.options(&half));
        let rendered = match self.look {
            None => render(scene, options, &showing)?,
            Some(look) => render_look(look, options, scene, &showing)?,
        };
        if !rendered.finished {
            return Ok(None);
        }
        showing.finish(&rendered.film);
        self.exchange.withdraw(Kind::Progress);
        self.figures[index] = told(words, &rendered, moves);
        self.tell_figures();
        Ok(Some(rendered))
    }

    /// Shows a small image at once, of a size for many in a second.
    fn draft(&mut self) -> Result<()> {
        let whole = self.steering.view.placement().size.map(f64::from);
        let scale =
            self.pace.map_or(FIRST, |pace| (pace * FRAME / whole[0] / whole[1]).sqrt().min(1.0));
        let size = whole.map(|side| ((side * scale) as u32).max(1));
        let start = Instant::now();
        self.shoot(0, &fewest(), size, true)?;
        let pace = f64::from(size[0]) * f64::from(size[1]) / start.elapsed().as_secs_f64();
        self.pace = Some(self.pace.map_or(pace, |before| before.midpoint(pace)));
        Ok(())
    }

    /// Renders with more and more samples; returns whether all is finished.
    fn refine(&mut self) -> Result<bool> {
        // As `render` would prepare it.
        let is_fast = self.args.scene_options.precision == Precision::Fast;
        if !is_fast && frame::origin(&self.steering.view) != self.ready.scene.origin {
            self.prepare_again()?;
        }
        let halves = if self.look.is_some() { 1 } else { self.halves.len() };
        for index in 0..halves {
            let stages = self.ready.own.stages(&self.halves[index]);
            // Looks show no noise that samples could take away step by step.
            let first = if self.look.is_some() { stages.len() - 1 } else { 0 };
            for number in first.max(self.finished[index])..stages.len() {
                if !self.advance(index, &stages[number], number + 1 == stages.len())? {
                    return Ok(false);
                }
                self.finished[index] = number + 1;
            }
        }
        Ok(true)
    }

    /// Renders one stage of a half, and measures its error; false if a request ended it.
    fn advance(&mut self, index: usize, stage: &Stage, is_last: bool) -> Result<bool> {
        let size = self.steering.view.placement().size;
        let Some(rendered) = self.shoot(index, stage, size, false)? else { return Ok(false) };
        let pixels = rendered.film.pixels().len();
        if rendered.counters.primary_rays <= pixels as u64 {
            self.pace = Some(pixels as f64 / rendered.seconds);
        }
        if self.look.is_none() {
            let until = UntilAsked(self.exchange);
            let error = measured(&self.ready.scene, &rendered, self.args.seed, &until)?;
            if until.cancelled() {
                return Ok(false);
            }
            match error {
                Some(error) => {
                    self.figures[index]["error"] = error.error.into();
                    self.tried.add(&self.halves[index], &stage.words, rendered.seconds, error);
                    self.tell_chart();
                }
                None => {
                    let note = "one ray through the centre of each pixel: no random samples";
                    self.figures[index]["note"] = note.into();
                }
            }
        }
        if is_last && index == 0 {
            let image = Some((Arc::new(rendered.film), self.ready.transfer));
            self.exchange.board.send_modify(|board| board.image = image);
        }
        self.figures[index]["rests"] = is_last.into();
        self.tell_figures();
        Ok(true)
    }

    /// The hits of the rays of a pixel, with the samples of the first half.
    fn probe(&mut self, at: [f64; 2]) -> Result<()> {
        let View { width, height, .. } = self.steering.view;
        let half = self.halves[0];
        let Some(last) = self.ready.own.stages(&half).pop() else { return Ok(()) };
        self.place(&half, &last.samples, [width, height]);
        let pixel = |share: f64, side: u32| ((share * f64::from(side)) as u32).min(side - 1);
        let pixel = [pixel(at[0], width), pixel(at[1], height)];
        let mut record = probe::pixel(&self.ready.scene, pixel, self.args.seed);
        self.ready.scene.appearance.check()?;
        record.paths.truncate(MOST_PATHS);
        // As text, in which numbers of single precision are short.
        let (at, record) = (json!(at), to_json(&record)?);
        let told = format!(r#"{{"kind": "probe", "at": {at}, "record": {record}}}"#);
        self.exchange.tell(Kind::Probe, Message::text(told));
        Ok(())
    }

    /// The figures of the halves that have an image.
    fn all_figures(&self) -> Value {
        let halves = &self.figures[..self.halves.len()];
        let known: Vec<&Value> = halves.iter().filter(|figures| !figures.is_null()).collect();
        json!({"kind": "figures", "halves": known})
    }

    fn tell_figures(&self) {
        self.exchange.tell(Kind::Figures, text(&self.all_figures()));
    }

    fn tell_chart(&self) {
        let Some([wide, narrow]) = self.tried.chart() else { return };
        let told = json!({"kind": "chart", "wide": wide, "narrow": narrow});
        self.exchange.tell(Kind::Chart, text(&told));
    }

    fn tell_state(&self) {
        let view = self.steering.view;
        let View { location, look, up, fov_degrees, width, height, .. } = view;
        let (command, note) = self.take_away.command(&self.halves[0]);
        let state = json!({
            "kind": "state",
            "file": self.args.scene.file_name().unwrap_or_default().to_string_lossy(),
            "size": [width, height],
            "halves": self.halves,
            "samplers": Sampling::ALL,
            "look": self.look,
            "looks": Look::ALL,
            "camera": {"location": location.to_array(), "look": look.to_array(), "up": up.to_array(), "fov": fov_degrees},
            "command": command,
            "note": note,
            "names": self.take_away.names(),
        });
        self.exchange.board.send_modify(|board| board.view = Some(view));
        self.exchange.tell(Kind::State, text(&state));
    }

    /// What is simulated, wherever the camera is.
    fn tell_plan(&self) {
        let plan = &self.ready.scene.plan;
        let (passes, bvh) = (explain::passes(plan), self.ready.preset.name());
        let told = json!({"kind": "plan", "effects": plan, "passes": passes, "bvh": bvh});
        self.exchange.tell(Kind::Plan, text(&told));
    }
}

/// What a render took, for the page.
fn told(words: &str, rendered: &Rendered, moves: bool) -> Value {
    let Rendered { counters, seconds, pass_seconds, .. } = rendered;
    let (rays, all) =
        (Rays::from(counters).all(), pass_seconds.iter().map(|(_, s)| s).sum::<f64>());
    let shares =
        pass_seconds.iter().map(|(name, s)| (name, s / all)).filter(|(_, share)| *share > 0.0);
    let counts = counts(counters).into_iter().filter(|(_, count)| *count > 0);
    json!({
            "samples": words,
        "seconds": seconds,
        "error": null,
        "note": "",
        "rays": rays,
        "rays_per_second": rays as f64 / seconds,
        "passes": shares.collect::<Vec<_>>(),
        "counters": counts.map(|(name, count)| (name.to_owned(), count.into())).collect::<Map<_, _>>(),
        "done": 1.0,
        "rests": false,
        "moving": moves,
    })
}
