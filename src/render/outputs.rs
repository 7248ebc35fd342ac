//! The output files of a render: one or several, with layers and metadata.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

use super::args::RenderArgs;
use crate::common::command_words;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{check_differs, check_replaceable};
use wavecrest_core::film::Film;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::render::Rendered;
use wavecrest_core::tile::Tile;
use wavecrest_image::animation::Animated;
use wavecrest_image::aov;
use wavecrest_image::farm::{Author, Identity};
use wavecrest_image::metadata::{Entry, Extras};
use wavecrest_image::write::{Format, Transfer, check_writable, write_with};
use wavecrest_scene::components::Encoding;

/// The outputs of a render, checked to be writable.
pub(super) struct Outputs<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) paths: Vec<PathBuf>,
    /// The transfer curve of 8-bit images, unless the arguments set it; known after reading the
    /// scene.
    encoding: OnceLock<Encoding>,
}

impl<'a> Outputs<'a> {
    /// The files at `paths`. The output of a shard is not an image.
    ///
    /// # Errors
    /// If one cannot be written, is repeated or is the scene, or a report would be written over it, or if layers are requested that none
    /// can store.
    pub(super) fn check(args: &'a RenderArgs, paths: Vec<PathBuf>, is_shard: bool) -> Result<Self> {
        for (index, path) in paths.iter().enumerate() {
            if is_shard { check_replaceable(path) } else { check_writable(path) }?;
            check_differs(path, &args.scene, "the scene")?;
            paths[..index]
                .iter()
                .try_for_each(|other| check_differs(path, other, "another output"))?;
        }
        for report in args.stats.iter().chain(&args.checkpoint) {
            check_replaceable(report)?;
            paths.iter().try_for_each(|path| check_differs(report, path, "the output"))?;
            check_differs(report, &args.scene, "the scene")?;
        }
        if let (Some(checkpoint), Some(stats)) = (&args.checkpoint, &args.stats) {
            check_differs(checkpoint, stats, "the statistics")?;
        }
        args.checkpoint().map_or(Ok(()), |checkpoint| checkpoint.check().map(drop))?;
        if args.scene_options.input.is_transparent() {
            paths.iter().try_for_each(|path| check_alpha(path, is_shard))?;
        }
        let outputs = Self { args, paths, encoding: OnceLock::new() };
        if args.aov.is_some() && !outputs.paths.iter().any(|path| is_exr(path)) {
            return Err(Error::new(ErrorKind::Usage, "only .exr images have layers")
                .in_file(outputs.first())
                .remedy("add --also and a name that ends in .exr"));
        }
        Ok(outputs)
    }

    /// As [`Outputs::check`], for one animated file.
    ///
    /// # Errors
    /// If it cannot be written, or is the scene.
    pub(super) fn of_one(args: &'a RenderArgs, path: &Path) -> Result<Self> {
        check_replaceable(path)?;
        check_differs(path, &args.scene, "the scene")?;
        Ok(Self { args, paths: vec![path.to_owned()], encoding: OnceLock::new() })
    }

    /// Every file that is replaced: the images, statistics and checkpoint.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        let reports = self.args.stats.iter().chain(&self.args.checkpoint);
        self.paths.iter().chain(reports).map(PathBuf::as_path)
    }

    /// Records the scene's transfer curve of 8-bit images.
    pub(super) fn made_of(&self, encoding: Encoding) {
        self.encoding.get_or_init(|| encoding);
    }

    /// The transfer curve of 8-bit images.
    pub(super) fn transfer(&self) -> Transfer {
        if self.args.look.is_some_and(|look| !look.is_shaded()) {
            // Its colours are encoded display values.
            return Transfer::Linear;
        }
        self.args.transfer.unwrap_or(match self.encoding.get() {
            Some(Encoding::Srgb) => Transfer::Srgb,
            Some(Encoding::Linear) | None => Transfer::Linear,
        })
    }

    /// The origin of the image.
    pub(super) fn author(&self) -> Author {
        let (scene, transfer) = (self.args.scene.display().to_string(), self.transfer());
        Author { scene, command: command_words(), transfer }
    }

    /// The seconds that layers and files of so many rows of `film` take, with the samples of the `scene`: parts are written
    /// elsewhere.
    ///
    /// # Errors
    /// As [`Outputs::write`].
    pub(super) fn rehearse(
        &self,
        scene: &PreparedScene,
        film: &Film,
        height: u32,
    ) -> Result<[f64; 2]> {
        let (width, y) = (film.width(), (film.height() - height) / 2);
        let RenderArgs { crop, seed, .. } = *self.args;
        let [left, top] = crop.map_or([0, 0], |crop| [crop.x, crop.y]);
        let crop = Some(Tile { x: left, y: top + y, width, height });
        let (layers, start) = (&self.args.layers(), Instant::now());
        let mut channels = Vec::new();
        if !layers.is_empty() {
            let request = aov::Request { layers, crop, seed, invalid: 0 };
            channels = aov::layers(scene, &request, &())?.channels;
        }
        let seconds = start.elapsed().as_secs_f64();
        let folder = tempfile::tempdir()
            .map_err(|error| Error::io("cannot make a folder", std::env::temp_dir(), error))?;
        let part = film.part([0, y, width, height])?;
        let start = Instant::now();
        let entries = self.entries(scene)?;
        for (index, path) in self.paths.iter().enumerate() {
            let file = folder.path().join(format!("{index}.{}", Format::from_path(path)?.name()));
            let extras = Extras { channels: &channels, ..self.extras(&entries) };
            write_with(&part, &file, self.transfer(), &extras)?;
        }
        Ok([seconds, start.elapsed().as_secs_f64()])
    }

    /// Writes all of them, with any requested layers.
    ///
    /// # Errors
    /// If there is no memory for the layers, or a file cannot be written: those before it are then
    /// complete, and it and those after it unchanged.
    pub(super) fn write(&self, scene: &PreparedScene, rendered: &Rendered) -> Result<()> {
        let aov::Layers { channels, entries: tables } = self.layers(scene, rendered)?;
        let entries = self.entries(scene)?;
        // The tables of numbers are useful only with the numbers.
        let with_tables = [&entries[..], &tables].concat();
        self.paths.iter().try_for_each(|path| {
            let entries = if is_exr(path) { &with_tables } else { &entries };
            let extras = Extras { channels: &channels, ..self.extras(entries) };
            write_with(&rendered.film, path, self.transfer(), &extras)
        })
    }

    /// Writes a film of which only a `share`, from 0 to 1, is rendered, to some of the files, without layers.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub(super) fn write_part(
        &self,
        paths: &[PathBuf],
        film: &Film,
        entries: &[Entry],
        share: f64,
    ) -> Result<()> {
        let mut entries = entries.to_vec();
        if !entries.is_empty() && share < 1.0 {
            // Rounded down: unfinished work is never 100 %.
            let percent = (share * 100.0).floor();
            entries.push(Entry { name: "unfinished", text: format!("{percent} % is rendered") });
        }
        let (transfer, extras) = (self.transfer(), self.extras(&entries));
        paths.iter().try_for_each(|path| write_with(film, path, transfer, &extras))
    }

    /// As [`Outputs::write_part`] after a signal, but leaves existing files unchanged, unless unfinished images were
    /// requested anyway. Returns what became of the files, in words.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub(super) fn write_unfinished(
        &self,
        film: &Film,
        entries: &[Entry],
        share: f64,
    ) -> Result<String> {
        let replaces = self.args.save_every.is_some();
        let (free, kept): (Vec<PathBuf>, Vec<PathBuf>) =
            self.paths.iter().cloned().partition(|path| replaces || !path.exists());
        self.write_part(&free, film, entries, share)?;
        let rest = if share < 1.0 { "; the rest is black" } else { "" };
        let black = |path: &PathBuf| format!("{} has what was finished{rest}", path.display());
        let words = free.iter().map(black).chain(kept.iter().map(|path| unchanged(path)));
        Ok(words.collect::<Vec<_>>().join("; "))
    }

    /// That none of the files is written, in words.
    pub(super) fn untouched(&self) -> String {
        self.paths.iter().map(|path| unchanged(path)).collect::<Vec<_>>().join("; ")
    }

    /// The name of the image.
    pub(super) fn name(&self) -> String {
        self.first().display().to_string()
    }

    /// The first of the files.
    pub(super) fn first(&self) -> &Path {
        self.paths.first().map_or(Path::new(""), PathBuf::as_path)
    }

    fn extras<'e>(&self, entries: &'e [Entry]) -> Extras<'e> {
        self.args.metadata.extras(entries, self.args.develop)
    }

    fn layers(&self, scene: &PreparedScene, rendered: &Rendered) -> Result<aov::Layers> {
        let layers = &self.args.layers();
        if layers.is_empty() {
            return Ok(aov::Layers::default());
        }
        let RenderArgs { crop, seed, .. } = *self.args;
        let invalid = rendered.counters.invalid;
        aov::layers(scene, &aov::Request { layers, crop, seed, invalid }, &())
    }

    /// The metadata of the image, as far as requested and as any file can store it.
    ///
    /// # Errors
    /// If the crop is not within the image.
    pub(super) fn entries(&self, scene: &PreparedScene) -> Result<Vec<Entry>> {
        let metadata = self.args.metadata;
        if !self.paths.iter().any(|path| metadata.is_stored_in(path)) {
            return Ok(Vec::new());
        }
        let identity = Identity::of(scene, &self.args.options())?;
        Ok(metadata.entries(&identity))
    }
}

/// The format of a turntable in one file.
pub(super) fn animated(output: &Path) -> Option<Animated> {
    let is_numbered = output.file_name().is_some_and(|name| name.to_string_lossy().contains('#'));
    Animated::from_path(output).filter(|_| !is_numbered)
}

/// That a file is not written, in words.
fn unchanged(path: &Path) -> String {
    let what = if path.exists() { "unchanged" } else { "not written" };
    format!("{} is {what}", path.display())
}

/// Refuses a format without alpha.
fn check_alpha(path: &Path, is_shard: bool) -> Result<()> {
    let has_alpha = !is_shard && Format::from_path(path)?.has_alpha();
    if has_alpha {
        return Ok(());
    }
    let what = if is_shard { "a shard" } else { "an image of this format" };
    let error = Error::new(ErrorKind::Usage, format!("{what} has no alpha")).in_file(path);
    Err(error.remedy("use .png or .exr with --background transparent, or a colour"))
}

fn is_exr(path: &Path) -> bool {
    Format::from_path(path).is_ok_and(|format| format == Format::Exr)
}
