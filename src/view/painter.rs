//! Renders what pages show: small images while the camera moves, then with more and more samples.
//!
//! One thread, with the pool that traces, has the scene. It takes requests between renders, and each that arrives ends the
//! render in progress. An image at rest has the bits of `wavecrest render` for its camera and settings; but a half in another
//! precision than the command's searches the scene that was prepared for that.

mod messages;
mod preparing;

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::ViewArgs;
use super::exchange::{Exchange, Kind};
use super::ready::Ready;
use super::refine::{HalfRender, Tried, Work, figures_of, rays};
use super::request::{Half, Request, Shown};
use super::showing::Showing;
use super::steering::Steering;
use super::take_away::TakeAway;
use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_core::probe;
use wavecrest_core::render::Watch;
use wavecrest_core::render::work::RenderWork;
use wavecrest_image::farm::{Author, Pass, Passes};
use wavecrest_image::look;
use wavecrest_scene::components::View;
use wavecrest_scene::load::LoadedScene;

/// Seconds of a frame while something moves, with some left for what moves it.
const FRAME: f64 = 0.9 / 15.0;
/// The share of its sides at which the first image is made.
const FIRST: f64 = 0.125;
/// How long nothing may be asked for before the image is refined.
const REST: Duration = Duration::from_millis(120);
/// What a second of walking covers, as a share of the diagonal of the scene.
const STRIDE: f64 = 0.2;
/// How long the rays of a pixel are followed, and how many with points on lights, so that an answer takes twice as long.
const PROBE: Duration = Duration::from_millis(100);
const PROBED: u32 = 4096;

/// The most triangles of a file whose added lights follow the camera from the start: the scene is prepared again wherever that
/// rests, which takes a third of a second for so many on two cores.
const MOST_FOLLOWED: usize = 1 << 21;

/// The scene, where it is seen from, and what is shown of it.
pub(super) struct Painter<'a> {
    args: ViewArgs,
    exchange: &'a Exchange,
    take_away: &'a TakeAway,
    ready: Ready,
    steering: Steering,
    halves: Vec<Half>,
    shown: Shown,
    /// The size of the image as the command has it.
    own_size: [u32; 2],
    /// For each half, what is rendered for this camera, and the figures of that.
    progress: [Option<HalfRender>; 2],
    figures: [Value; 2],
    tried: Tried,
    /// The pixels that were traced in a second while something moved.
    pace: Option<f64>,
}

/// A mesh file of more bytes is shown by so many of its faces, the first, until all is read.
const LARGE_FILE: u64 = 1 << 27;
const FIRST_FACES: u64 = 1 << 20;

/// Shows the scene of `args` until the process ends.
///
/// # Errors
/// If it cannot be loaded or prepared, or an image can no longer be decoded.
pub(super) fn paint(args: &ViewArgs, exchange: &Exchange, take_away: &TakeAway) -> Result<()> {
    if args.scene.metadata().is_ok_and(|data| data.len() > LARGE_FILE) {
        let mut part = args.clone();
        part.scene_options.input.first = Some(FIRST_FACES);
        if let Ok(mut painter) = Painter::open(&part, exchange, take_away) {
            // A small image, then one as large as its pace allows.
            let is_shown = painter.draft().and_then(|()| painter.draft()).is_ok();
            exchange.shows_part.store(is_shown, Ordering::Relaxed);
        }
    }
    let mut painter = Painter::open(args, exchange, take_away)?;
    if exchange.shows_part.swap(false, Ordering::Relaxed) {
        // What was asked meanwhile was about the camera and the settings of the part.
        exchange.inbox.take(Duration::ZERO);
    }
    painter.run()
}

impl<'a> Painter<'a> {
    /// Reads and prepares the scene of `args`.
    fn open(args: &ViewArgs, exchange: &'a Exchange, take_away: &'a TakeAway) -> Result<Self> {
        let input = &args.scene_options.input;
        let up = input.axis();
        let (look, stays) = (args.look, input.lights_stay);
        let first = |loaded: &LoadedScene, size| Shown {
            size,
            look,
            up,
            stays: stays || loaded.usual_view().is_some() && loaded.triangles() > MOST_FOLLOWED,
            exposure: 0.0,
            transfer: None,
        };
        let (ready, view, shown) = Ready::open(args, exchange, first)?;
        let half = Half::of_file(args.scene_options.precision, args.tracer, ready.rays());
        let mut painter = Self {
            args: args.clone(),
            exchange,
            take_away,
            ready,
            steering: Steering::new(view),
            halves: vec![half],
            shown,
            own_size: shown.size,
            progress: Default::default(),
            figures: Default::default(),
            tried: Tried::default(),
            pace: None,
        };
        painter.send_plan();
        let first =
            json!({"kind": "progress", "stage": "tracing the first rays", "done": 0, "all": 0});
        exchange.send(Kind::Progress, first.to_string());
        painter.restart();
        Ok(painter)
    }

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
            let mut probed = None;
            for request in requests {
                match request {
                    // Of several only the last is of interest.
                    Request::Probe { at } => probed = Some(at),
                    request => moves |= self.obey(request)?,
                }
            }
            probed.map_or(Ok(()), |at| self.probe(at))?;
        }
    }

    /// Does what a page asks; returns whether the image changes.
    fn obey(&mut self, request: Request) -> Result<bool> {
        let before = self.steering.view;
        match request {
            Request::Grab { at } => self.steering.pivot = self.ready.see(&self.steering, at).point,
            Request::Orbit { by } => self.steering.orbit(by),
            Request::Turn { by } => self.steering.turn(by),
            Request::Pan { by } => self.steering.pan(by),
            Request::Zoom { at, by } => {
                self.steering.zoom(at, by, |steering| self.ready.see(steering, at));
            }
            Request::Walk { by } => {
                let [low, high] = self.ready.ends;
                self.steering.walk(by, STRIDE * low.distance(high));
            }
            Request::Side { side } => self.steering.show(&side, self.ready.ends),
            Request::Set { halves } => self.set(halves),
            Request::Show(shown) => return self.show_as(shown),
            Request::Probe { .. } | Request::Taken { .. } => {}
        }
        if self.steering.view == before {
            return Ok(false);
        }
        self.exchange.withdraw(Kind::Error);
        self.restart();
        Ok(true)
    }

    /// Renders these halves from now on. What is finished of one that stays is kept.
    fn set(&mut self, mut halves: Vec<Half>) {
        // Looks have nothing to compare.
        halves.truncate(if self.shown.look.is_some() { 1 } else { 2 });
        let is_known = |index: usize| self.halves.get(index) == halves.get(index);
        let same = [is_known(0), is_known(1)];
        if halves.is_empty() || same == [true; 2] {
            return;
        }
        for index in [0, 1].into_iter().filter(|&index| !same[index]) {
            self.progress[index] = None;
            if let Some(figures) = self.figures[index].as_object_mut() {
                figures.insert("rests".to_owned(), false.into());
            }
        }
        if !same[1] {
            self.figures[1] = Value::Null;
            self.exchange.withdraw(Kind::Second);
        }
        self.halves = halves;
        self.send_state();
        self.send_figures();
    }

    /// Forgets what was rendered for another camera.
    fn restart(&mut self) {
        (self.progress, self.tried) = Default::default();
        self.figures[1] = Value::Null;
        for kind in [Kind::Second, Kind::Probe, Kind::Chart] {
            self.exchange.withdraw(kind);
        }
        self.exchange.board.send_modify(|board| board.image = None);
        self.send_state();
    }

    /// Begins to show a half, of this size in pixels, with its samples in words.
    fn show(&mut self, index: usize, words: &str, size: [u32; 2], moves: bool) -> Showing<'a> {
        let draft = moves.then_some(&self.shown);
        self.ready.place(&self.steering.view, size, &self.halves[index], draft);
        let mut figures = self.all_figures();
        if let Some(half) = figures["halves"].get_mut(index) {
            (half["next"], half["rests"]) = (json!(words), json!(false));
        }
        let developed = (self.shown.develop(), self.ready.transfer(&self.shown));
        Showing::new(self.exchange, index, size, developed, moves, figures)
    }

    /// Shows a small image at once, of a size for many in a second.
    fn draft(&mut self) -> Result<()> {
        let whole = self.steering.view.placement().size.map(f64::from);
        let scale =
            self.pace.map_or(FIRST, |pace| (pace * FRAME / whole[0] / whole[1]).sqrt().min(1.0));
        let size = whole.map(|side| ((side * scale) as u32).max(1));
        let start = Instant::now();
        let words = rays(1);
        let showing = self.show(0, &words, size, true);
        let options = self.ready.options(&self.args, self.halves[0].tracer);
        let rendered = look::render(&self.ready.scene, self.shown.look, &options, &showing)?;
        showing.finish(&rendered.film, false);
        self.exchange.withdraw(Kind::Progress);
        self.figures[0] = figures_of(&words, &Work::of(&rendered), true);
        self.send_figures();
        let pace = f64::from(size[0]) * f64::from(size[1]) / start.elapsed().as_secs_f64();
        self.pace = Some(self.pace.map_or(pace, |before| before.midpoint(pace)));
        Ok(())
    }

    /// Renders with more and more samples; returns whether all is finished.
    fn refine(&mut self) -> Result<bool> {
        if !self.ready.fits(&self.args, &self.shown, &self.steering.view) {
            let is_ready = self.prepare_again();
            self.ready.failed = Some(self.steering.view).filter(|_| !is_ready);
        }
        for index in 0..self.halves.len() {
            while !self.progress[index].as_ref().is_some_and(HalfRender::is_finished) {
                if !self.advance(index)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// Renders the next pass of a half; false if a request ended it, after which it goes on.
    fn advance(&mut self, index: usize) -> Result<bool> {
        let (half, size) = (self.halves[index], self.steering.view.placement().size);
        self.ready.place(&self.steering.view, size, &half, None);
        let options = self.ready.options(&self.args, half.tracer);
        let camera = self.ready.scene.camera;
        let all = camera.rays_per_pixel();
        if let Some(look) = self.shown.look {
            let words = rays(all);
            let showing = self.show(index, &words, size, false);
            let rendered = look::render(&self.ready.scene, Some(look), &options, &showing)?;
            if !rendered.finished {
                return Ok(false);
            }
            self.progress[index] = Some(HalfRender::Look);
            let figures = figures_of(&words, &Work::of(&rendered), false);
            self.finish(index, &showing, figures, rendered.film, true);
            return Ok(true);
        }
        if self.progress[index].is_none() {
            let nothing = (None, true);
            let passes =
                Passes::begin(&self.ready.scene, options, Author::default(), None, nothing)?;
            let work = RenderWork::none(&self.ready.scene);
            self.progress[index] = Some(HalfRender::Light(Box::new((passes, work))));
        }
        let Some(HalfRender::Light(mut render)) = self.progress[index].take() else {
            return Ok(true);
        };
        let (passes, work) = &mut *render;
        let Pass { from, to, .. } = passes.pass();
        let to = if to > from { to } else { half.next_pass(from, all) };
        let words = rays(to);
        let showing = self.show(index, &words, size, false);
        work.add(passes.advance(&self.ready.scene, to, &showing, &|_| {})?);
        let pass = passes.pass();
        let seconds = work.seconds;
        let figures = figures_of(&words, &Work::of_passes(work, pass.error), false);
        let film = (pass.from == to).then(|| passes.painted()).transpose()?.map(|done| done.film);
        self.progress[index] = Some(HalfRender::Light(render));
        let Some(film) = film else { return Ok(false) };
        if to == 1 {
            self.pace = Some(film.pixels().len() as f64 / seconds);
        }
        if let Some(error) = pass.error.filter(|error| *error > 0.0) {
            self.tried.add(&half, &words, seconds, error);
            self.send_chart();
        }
        self.finish(index, &showing, figures, film, to == all);
        Ok(true)
    }

    /// Shows what is finished of a half; the last of the first may be taken away.
    fn finish(
        &mut self,
        index: usize,
        showing: &Showing<'_>,
        figures: Value,
        film: Film,
        is_last: bool,
    ) {
        let (developed, transfer) = showing.finish(&film, is_last);
        self.exchange.withdraw(Kind::Progress);
        if is_last && index == 0 {
            let image = Some((Arc::new(developed), transfer));
            self.exchange.board.send_modify(|board| board.image = image);
        }
        self.figures[index] = figures;
        self.figures[index]["rests"] = is_last.into();
        self.send_figures();
    }

    /// The hits of the rays of a pixel, with the samples of the first half.
    fn probe(&mut self, at: [f64; 2]) -> Result<()> {
        let View { width, height, .. } = self.steering.view;
        let half = self.halves[0];
        self.ready.place(&self.steering.view, [width, height], &half, None);
        let pixel = |share: f64, side: u32| ((share * f64::from(side)) as u32).min(side - 1);
        let pixel = [pixel(at[0], width), pixel(at[1], height)];
        let (start, inbox) = (Instant::now(), &self.exchange.inbox);
        let is_over = |count| count >= PROBED || inbox.cancelled() || start.elapsed() > PROBE;
        let record = probe::pixel(&self.ready.scene, pixel, None, self.args.seed, &is_over);
        self.ready.scene.appearance.check()?;
        let message = json!({"kind": "probe", "at": at, "record": crate::probe::text(&record)});
        self.exchange.send(Kind::Probe, message.to_string());
        Ok(())
    }
}
