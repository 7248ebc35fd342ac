//! A shard of an image: a part for `wavecrest merge`.

use std::time::Instant;

use super::args::RenderArgs;
use super::image::{begin, find_invalid, go_on};
use super::outputs::Outputs;
use super::renderer::Renderer;
use super::show::{Show, warn};
use crate::interrupt;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_image::farm::Shard;

/// The extension of a part's name.
const EXTENSION: &str = "part";

/// Renders a shard and writes its part.
///
/// # Errors
/// If it would be written as an image, or cannot be rendered or written.
pub(super) fn render_shard(args: &RenderArgs, shard: Shard) -> Result<()> {
    let output = args.output()?;
    if output.extension().is_none_or(|name| name != EXTENSION) {
        return Err(Error::new(ErrorKind::Usage, "a shard must be written to a .part file")
            .in_file(output)
            .remedy("use a name such as out-1.part, and join all parts with wavecrest merge"));
    }
    let outputs = Outputs::check(args, args.paths()?, true)?;
    Renderer::run(args, &[&outputs], None, |mut renderer| {
        let Renderer { scene, progress, .. } = &renderer;
        let part = begin(&outputs, scene, Some(shard))?;
        let start = Instant::now();
        let show = Show::begin(&outputs, progress, scene, true);
        let done = part.advance(scene, scene.camera.rays_per_pixel(), &show, &warn)?;
        part.save(&warn);
        drop(show);
        let seconds = start.elapsed().as_secs_f64();
        if !part.is_finished() {
            let what = outputs.untouched();
            return Err(interrupt::error(part.share()).remedy(what + &go_on(args)));
        }
        find_invalid(args, scene, &done.counters)?;
        part.write(output)?;
        renderer.add(&done.counters, seconds);
        renderer.finish(&outputs.name(), &format!("shard {shard}"));
        Ok(())
    })
}
