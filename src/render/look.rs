//! Renders for inspection: other materials, or other colours than those of light.

use super::args::RenderArgs;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::counters::Counters;
use wavecrest_core::plan::schedule::{PASSES, unplanned};
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::units::Order;
use wavecrest_core::render::{Rendered, Watch, render, render_in_order, window};
use wavecrest_image::look::{Look, draw_edges, film};
use wavecrest_scene::load::LoadedScene;
use wavecrest_scene::systems::{self, Extracted, Options, looks};

/// Without the ground of the lights, for looks other than clay: the ground is not part of the file,
/// and has its own edges and depth.
pub(super) fn without_ground(mut args: RenderArgs) -> RenderArgs {
    args.scene_options.input.without_ground = !matches!(args.look, None | Some(Look::Clay));
    args
}

/// Refuses a shard of one image, whose part contains only light.
///
/// # Errors
/// If there is one, and a look is requested.
pub(super) fn check(args: &RenderArgs) -> Result<()> {
    let (Some(look), Some(_)) = (args.look, args.shard) else { return Ok(()) };
    let error = Error::new(ErrorKind::Usage, "--as and --shard cannot be used together");
    Err(error
        .value(look.name())
        .remedy("leave out one of them, or render whole frames with --frames"))
}

/// Runs all systems but the last on `loaded`, for the requested look.
///
/// # Errors
/// As [`systems::extract`].
pub(super) fn extract(args: &RenderArgs, mut loaded: LoadedScene) -> Result<Extracted> {
    let options = &args.scene_options;
    match args.look {
        Some(Look::Clay) => looks::clay(&mut loaded.world),
        Some(Look::Uv) => looks::show_uvs(&mut loaded.world),
        _ => {}
    }
    if args.look.is_none_or(Look::is_shaded) {
        return options.extract(loaded, &args.extent());
    }
    // Show what light would not show too.
    let passes = unplanned(&PASSES);
    let (precision, flat) = (options.precision, options.flatten);
    let extracted = systems::extract(loaded.world, Options { precision, passes: &passes, flat })?;
    options.checked(extracted, &args.extent())
}

/// Renders the image, or the requested look of it.
///
/// # Errors
/// As [`render`].
pub(super) fn trace(
    args: &RenderArgs,
    scene: &PreparedScene,
    watch: &dyn Watch,
) -> Result<Rendered> {
    let (options, crop, seed) = (args.options(), args.crop, args.seed);
    // The pace of a part is that of the whole only if it is a fair sample.
    let order = if args.time_budget.is_some() { Order::Spread } else { Order::Rows };
    let Some(look) = args.look else { return render_in_order(scene, &options, watch, order) };
    if look.is_shaded() {
        let mut rendered = render(scene, &options, watch)?;
        if look == Look::Wireframe && rendered.finished {
            draw_edges(&mut rendered.film, scene, crop, seed)?;
        }
        return Ok(rendered);
    }
    let start = std::time::Instant::now();
    let film = film(scene, look, crop, seed)?;
    let tile = window(scene, crop)?;
    watch.tile(&tile, film.pixels());
    Ok(Rendered {
        film,
        finished: true,
        tiles: vec![tile],
        counters: Counters::default(),
        columns: 0,
        pass_seconds: Vec::new(),
        seconds: start.elapsed().as_secs_f64(),
        precision: scene.accel.geometry().precision,
    })
}
