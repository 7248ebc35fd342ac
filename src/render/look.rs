//! What `--as` shows of a scene instead of its light.

use std::time::Instant;

use super::args::RenderArgs;
use wavecrest_base::error::Result;
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{Rendered, Watch, render, window};
use wavecrest_image::look::{Look, draw_edges, film};

/// Renders a `look` of the scene, which was prepared for it.
///
/// # Errors
/// As [`render`].
pub(super) fn render_look(
    look: Look,
    args: &RenderArgs,
    scene: &PreparedScene,
    watch: &dyn Watch,
) -> Result<Rendered> {
    let (crop, seed) = (args.crop, args.seed);
    if look.is_shaded() {
        let mut rendered = render(scene, &args.options(), watch)?;
        if look == Look::Wireframe && rendered.finished {
            draw_edges(&mut rendered.film, scene, crop, seed)?;
        }
        return Ok(rendered);
    }
    let start = Instant::now();
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
