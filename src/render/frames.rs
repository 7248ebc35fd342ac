//! Frames of a moving camera: an image of each, or all in one file.

use std::path::{Path, PathBuf};

use super::args::{Frames, RenderArgs};
use super::outputs::Outputs;
use super::renderer::{Renderer, in_pixels};
use wavecrest_base::error::Result;
use wavecrest_image::animation::{Animated, Animation};
use wavecrest_image::farm::Shard;

/// Smallest number of digits of a frame's number in the name of its image, by default.
const MIN_DIGITS: usize = 4;

/// The frames of a shard: each of N shards takes every N-th.
fn share(frames: Frames, shard: Option<Shard>) -> impl Iterator<Item = u32> {
    let (number, count) = shard.map_or((1, 1), |shard| (shard.number(), shard.count()));
    frames.skip(number as usize - 1).step_by(count as usize)
}

/// Renders the frames of a range, or of the shard's share of it.
///
/// # Errors
/// If one cannot be rendered or written: those before it are complete then.
pub(super) fn render_frames(args: &RenderArgs, frames: Frames, shard: Option<Shard>) -> Result<()> {
    let paths = args.paths()?;
    let of_frame = |frame| {
        let paths = paths.iter().map(|path| numbered(path, frame)).collect();
        Ok((frame, Outputs::check(args, paths, false)?))
    };
    let all: Vec<(u32, Outputs<'_>)> = share(frames, shard).map(of_frame).collect::<Result<_>>()?;
    let files: Vec<&Outputs<'_>> = all.iter().map(|(_, outputs)| outputs).collect();
    Renderer::run(args, &files, Some(all.len()), |mut renderer| {
        for (frame, outputs) in &all {
            renderer.place(*frame)?;
            let rendered = renderer.render(outputs)?.rendered;
            renderer.write(outputs, &rendered)?;
        }
        let size = in_pixels(renderer.size());
        renderer.finish(&args.output()?.display().to_string(), &size);
        Ok(())
    })
}

/// Renders a turntable of this many frames as one file.
///
/// # Errors
/// If a frame cannot be rendered, or the file cannot be written.
pub(super) fn render_animation(args: &RenderArgs, count: u32, format: Animated) -> Result<()> {
    let path = args.output()?;
    let outputs = Outputs::of_one(args, path)?;
    Renderer::run(args, &[&outputs], Some(count as usize), |mut renderer| {
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
        renderer.finish(&outputs.name(), &in_pixels(size));
        Ok(())
    })
}

/// `path` with the number of the frame: in place of the last # characters of its name, or before
/// its extension.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if let Some(end) = name.rfind('#') {
        let start = name[..end].trim_end_matches('#').len();
        let width = end + 1 - start;
        let number = format!("{frame:0width$}");
        return path.with_file_name(format!("{}{number}{}", &name[..start], &name[end + 1..]));
    }
    let number = format!("{frame:0MIN_DIGITS$}");
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map(|e| format!(".{}", e.to_string_lossy()));
    path.with_file_name(format!("{stem}.{number}{}", extension.unwrap_or_default()))
}
