//! Several views of a file in one: a turntable as an animation, or a sheet of sides.

use super::args::RenderArgs;
use super::outputs::Outputs;
use super::renderer::{Renderer, Run, in_pixels};
use super::rows::Rows;
use wavecrest_base::error::Result;
use wavecrest_image::animation::{Animated, Animation};
use wavecrest_scene::load::framing::Sheet;

/// Renders a turntable of this many frames as one file.
///
/// # Errors
/// If a frame cannot be rendered, or the file cannot be written.
pub(super) fn render_animation(args: &RenderArgs, count: u32, format: Animated) -> Result<()> {
    let path = args.output()?;
    let outputs = Outputs::of_one(args, path)?;
    Run::start(args, Some(count as usize), |mut work| {
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

/// Renders every side as an image of its own, with lights of its own, and arranges them.
///
/// # Errors
/// If a side cannot be rendered, or the file cannot be written.
pub(super) fn render_sheet(args: &RenderArgs, Sheet(sides): &Sheet) -> Result<()> {
    let outputs = Outputs::check(args, args.paths()?, false)?;
    let mut seen = args.clone();
    let of_side = |side| {
        seen.scene_options.input.view = Some(side);
        let one = seen.clone();
        // The notes of every side are the same.
        seen.scene_options.quiet = true;
        one
    };
    let all: Vec<RenderArgs> = sides.iter().copied().map(of_side).collect();
    Run::start(args, Some(sides.len()), |mut work| {
        let mut rows = Rows::new(sides.len());
        for one in &all {
            let mut renderer = Renderer::begin(one, &[&outputs], &mut work)?;
            let mut rendered = renderer.render(&outputs)?.rendered;
            rows.add(&rendered.film)?;
            if let Some(sheet) = rows.whole() {
                rendered.film = sheet;
                renderer.write(&outputs, &rendered)?;
                let size = [rendered.film.width(), rendered.film.height()];
                renderer.work.finish(&outputs.name(), &in_pixels(size));
            }
        }
        Ok(())
    })
}
