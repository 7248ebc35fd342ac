//! What one takes away from the page: the image, the command that renders it, and the one that writes its scene.
//!
//! Nothing is written to disk: the browser saves the image that it receives, and commands are text.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::exchange::Exchange;
use super::request::{Half, Shown};
use wavecrest_base::words;
use wavecrest_image::write::png;
use wavecrest_scene::components::View;
use wavecrest_scene::load::FileFormat;

/// Options on what is read, with whether each has a value: the commands have them as they were given.
const OF_FILE: [(&str, bool); 10] = [
    ("--allow-outside", false),
    ("--background", true),
    ("--camera", true),
    ("--color", true),
    ("--crease", true),
    ("--environment", true),
    ("--fit", true),
    ("--fov", true),
    ("--lights", true),
    ("--view", true),
];
/// Those of where the camera is, until it is moved; of its samples, until others are chosen; and of the image alone.
const OF_CAMERA: [(&str, bool); 2] = [("--from", true), ("--at", true)];
const OF_SAMPLES: [(&str, bool); 2] = [("--samples", true), ("--sampler", true)];
const OF_IMAGE: [(&str, bool); 3] = [("--flatten", false), ("--seed", true), ("--strict", false)];

/// The file that is shown, and the words of the command that shows it.
pub(super) struct TakeAway {
    file: PathBuf,
    words: Vec<String>,
}

impl TakeAway {
    pub(super) fn new(file: &Path, words: Vec<String>) -> Self {
        Self { file: file.to_owned(), words }
    }

    /// Whether it is a scene file.
    pub(super) fn is_scene(&self) -> bool {
        FileFormat::of(&self.file).is_ok_and(|format| format == FileFormat::Scene)
    }

    /// The name of what is saved or written, after that of the file.
    pub(super) fn named(&self, extension: &str) -> String {
        let name = PathBuf::from(self.file.file_name().unwrap_or_default());
        unlike_an_option(name.with_extension(extension).to_string_lossy().into_owned())
    }

    /// The file with this name that can be saved, once the image is whole: its media type, and its bytes.
    pub(super) fn get(&self, name: &str, exchange: &Exchange) -> Option<(&'static str, Vec<u8>)> {
        let (film, transfer) =
            exchange.board.borrow().image.clone().filter(|_| name == "image.png")?;
        Some(("image/png", png(&film, transfer).ok()?))
    }

    /// The commands that render the image of `half` from `view`, and write the scene of it. Before it was moved, the camera
    /// was at `start`, with this direction up if one is given.
    pub(super) fn commands(
        &self,
        half: &Half,
        shown: &Shown,
        ([start, view], direction): ([&View; 2], Option<DVec3>),
    ) -> [String; 2] {
        let file = unlike_an_option(self.file.to_string_lossy().into_owned());
        let command = |words: [&str; 2]| words.map(str::to_owned).into_iter();
        let mut of_file = self.given(&OF_FILE);
        of_file.extend(shown.up.iter().flat_map(|up| command(["--up", up.name()])));
        if is_same(start, view) {
            of_file.extend(self.given(&OF_CAMERA));
            of_file.extend(direction.iter().flat_map(|up| option("--up", *up)));
        } else {
            let places = [("--from", view.location), ("--at", view.look), ("--up", view.up)];
            of_file.extend(places.into_iter().flat_map(|(name, place)| option(name, place)));
        }
        of_file.extend(shown.stays.then(|| "--lights-stay".to_owned()));
        let [width, height] = shown.size;
        of_file.extend(command(["--size", &format!("{width}x{height}")]));
        match half.points() {
            Some(points) => {
                of_file.extend(command(["--samples", &points.count().to_string()]));
                of_file.extend(command(["--sampler", points.sampling.name()]));
            }
            None => of_file.extend(self.given(&OF_SAMPLES)),
        }
        let mut of_image = self.given(&OF_IMAGE);
        of_image.extend(shown.look.iter().flat_map(|look| command(["--as", look.name()])));
        let exposure = shown.develop().exposure;
        if exposure != 0.0 {
            of_image.extend(command(["--exposure", &exposure.to_string()]));
        }
        of_image.extend(
            shown.transfer.iter().flat_map(|transfer| command(["--transfer", transfer.name()])),
        );
        of_image.extend(half.differs().flatten().map(str::to_owned));
        let render = ["wavecrest".to_owned(), file.clone(), self.named("view.png")];
        let convert = ["wavecrest".to_owned(), "convert".to_owned(), file, self.named("view.json")];
        // A scene file may name images anywhere, and they are on the page.
        let outside = self.is_scene().then(|| "--allow-outside".to_owned());
        let outside = outside.filter(|option| !of_file.contains(option));
        [
            words::command(render.into_iter().chain(of_file.clone()).chain(of_image)),
            words::command(convert.into_iter().chain(of_file).chain(outside)),
        ]
    }

    /// Those of the `options` that the command gives, as it gives them.
    fn given(&self, options: &[(&str, bool)]) -> Vec<String> {
        let mut found = Vec::new();
        for (index, word) in self.words.iter().enumerate() {
            let (name, value) =
                word.split_once('=').map_or((&**word, None), |(name, v)| (name, Some(v)));
            let Some((_, takes_value)) = options.iter().find(|(option, _)| *option == name) else {
                continue;
            };
            let next = self.words.get(index + 1).filter(|_| *takes_value && value.is_none());
            found.extend([word].into_iter().chain(next).cloned());
        }
        found
    }
}

/// Whether two cameras are in the same place.
fn is_same(a: &View, b: &View) -> bool {
    (a.location, a.look, a.up) == (b.location, b.look, b.up)
}

/// An option with a place or a direction.
fn option(name: &str, DVec3 { x, y, z }: DVec3) -> [String; 2] {
    [name.to_owned(), format!("{x},{y},{z}")]
}

/// A path that no command takes for an option.
fn unlike_an_option(path: String) -> String {
    if path.starts_with('-') { format!("./{path}") } else { path }
}
