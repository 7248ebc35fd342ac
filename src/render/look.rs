//! What `--as` shows of a scene instead of its light.

use std::time::Instant;

use wavecrest_base::error::Result;
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::{RenderOptions, Rendered, Watch, render, window};
use wavecrest_image::look::{Look, draw_edges, film};

/// Renders a `look` of the scene, which was prepared for it.
///
/// # Errors
/// As [`render`].
pub(crate) fn render_look(
    look: Look,
    options: &RenderOptions,
    scene: &PreparedScene,
    watch: &dyn Watch,
) -> Result<Rendered> {
    let &RenderOptions { crop, seed, .. } = options;
    if look.is_shaded() {
        let mut rendered = render(scene, options, watch)?;
        if look == Look::Wireframe && rendered.finished {
            draw_edges(&mut rendered.film, scene, crop, seed)?;
        }
        return Ok(rendered);
    }
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
