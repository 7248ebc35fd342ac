//! A turntable as an animation in one file.

use super::args::RenderArgs;
use super::outputs::Outputs;
use super::renderer::{Renderer, Work, in_pixels};
use wavecrest_base::error::Result;
use wavecrest_image::animation::{Animated, Animation};

/// Renders a turntable of this many frames as one file.
///
/// # Errors
/// If a frame cannot be rendered, or the file cannot be written.
pub(super) fn render_animation(args: &RenderArgs, count: u32, format: Animated) -> Result<()> {
    let path = args.output()?;
    let outputs = Outputs::of_one(args, path)?;
    Work::start(args, Some(count as usize), |mut work| {
        let mut renderer = Renderer::begin(args, &[&outputs], &mut work)?;
        let size = renderer.size();
        let (transfer, entries) = (outputs.transfer(), &outputs.entries(&renderer.scene)?);
        let animation = Animation { path, format, size, frames: count, transfer, entries };
        // Errors of a frame are not about the file.
        let mut failed = None;
        let mut film = |frame| {
            let placed = renderer.place(frame + 1);
            let outcome = placed.and_then(|()| renderer.render(&outputs));
            outcome.map(|one| one.rendered.film).inspect_err(|error| failed = Some(error.clone()))
        };
        animation.write(&mut film).map_err(|error| failed.unwrap_or(error))?;
        work.finish(&outputs.name(), &in_pixels(size));
        Ok(())
    })
}
