//! What is shown of a scene: its light, or what `--as` names instead.

use std::time::Instant;

use wavecrest_base::error::Result;
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::units::Order;
use wavecrest_core::render::{RenderOptions, Rendered, Watch, render_in_order, window};
use wavecrest_image::look::{Look, draw_edges, film};

/// Renders the light of the scene, in this `order`, or a `look`, for which it was prepared.
///
/// # Errors
/// As [`render_in_order`].
pub(crate) fn render_look(
    scene: &PreparedScene,
    look: Option<Look>,
    options: &RenderOptions,
    watch: &dyn Watch,
    order: Order,
) -> Result<Rendered> {
    let &RenderOptions { crop, seed, .. } = options;
    let Some(look) = look.filter(|look| !look.is_shaded()) else {
        let mut rendered = render_in_order(scene, options, watch, order)?;
        if look == Some(Look::Wireframe) && rendered.finished {
            draw_edges(&mut rendered.film, scene, crop, seed)?;
        }
        return Ok(rendered);
    };
    let start = Instant::now();
    let film = film(scene, look, (crop, seed), watch)?;
    let tile = window(scene, crop)?;
    let finished = !watch.cancelled();
    watch.tile(&tile, film.pixels());
    Ok(Rendered {
        film,
        finished,
        tiles: vec![tile],
        counters: Counters::default(),
        columns: 0,
        pass_seconds: Vec::new(),
        seconds: start.elapsed().as_secs_f64(),
        precision: scene.accel.geometry().precision,
    })
}
