//! What one takes away from the page: the scene file with its camera, the image, and the command that makes it.
//!
//! Nothing is written to disk: the browser saves what it receives. Of a mesh or a glTF file the scene file is what
//! `wavecrest convert` writes, whose meshes and images that command leaves beside it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde_json::{Value, json};

use super::exchange::Exchange;
use super::request::Half;
use wavecrest_base::error::Result;
use wavecrest_base::lock;
use wavecrest_base::words;
use wavecrest_core::math::sampling::Points;
use wavecrest_image::look::Look;
use wavecrest_image::write::png;
use wavecrest_scene::components::View;
use wavecrest_scene::load::{FileFormat, LoadedScene};
use wavecrest_scene::write::contents;

/// The longest scene file whose camera is changed, in bytes: as values it takes many times its length.
const LONGEST: u64 = 1 << 22;

/// The extension of the scene file that `convert` writes, after which its meshes are named.
const PARTS: &str = "parts.json";

/// The file that is shown, and what becomes of it.
pub(super) struct TakeAway {
    file: PathBuf,
    /// Whether it is a scene file, beside which another one finds its meshes.
    is_scene: bool,
    /// Options that change the file's meshes or its background, as words of a command.
    options: [Vec<String>; 2],
    /// What was read, as a scene file, unless that is too long.
    scene: Mutex<Option<Value>>,
}

impl TakeAway {
    /// `of_meshes` are the options of the command that `convert` needs too, `of_image` those of a scene file.
    pub(super) fn new(file: &Path, of_meshes: Vec<String>, of_image: Vec<String>) -> Self {
        let options = [of_meshes, of_image];
        let is_scene = FileFormat::of(file).is_ok_and(|format| format == FileFormat::Scene);
        let scene = Mutex::new(if is_scene { read(file) } else { None });
        Self { file: file.to_owned(), is_scene, options, scene }
    }

    /// What `scene` is as a scene file, unless it was one when it was read.
    ///
    /// # Errors
    /// If it cannot be one.
    pub(super) fn contents(&self, scene: &LoadedScene) -> Result<Option<Value>> {
        (!self.is_scene).then(|| contents(scene, &self.named(PARTS))).transpose()
    }

    /// Keeps these contents from now on, if there are any.
    pub(super) fn keep(&self, contents: Option<Value>) {
        if contents.is_some() {
            *lock(&self.scene) = contents;
        }
    }

    /// The name of the file, with another extension.
    fn named(&self, extension: &str) -> PathBuf {
        PathBuf::from(self.file.file_name().unwrap_or_default()).with_extension(extension)
    }

    /// The names of what is saved: the scene and the image.
    pub(super) fn names(&self) -> [String; 2] {
        ["view.json", "view.png"]
            .map(|extension| self.named(extension).to_string_lossy().into_owned())
    }

    /// The file with this name among those that can be saved, once there is a scene: its media type, and its bytes.
    pub(super) fn get(&self, name: &str, exchange: &Exchange) -> Option<(&'static str, Vec<u8>)> {
        let ((view, points), image) = {
            let board = exchange.board.borrow();
            (board.view?, board.image.clone())
        };
        match name {
            "scene.json" => {
                let mut scene = lock(&self.scene).clone()?;
                place(&mut scene, &view, points)?;
                let text = serde_json::to_string_pretty(&scene).ok()? + "\n";
                Some(("application/json", text.into_bytes()))
            }
            "image.png" => {
                let (film, transfer) = image?;
                Some(("image/png", png(&film, transfer).ok()?))
            }
            _ => None,
        }
    }

    /// What makes the image of `half` from the saved scene, and what to do before.
    pub(super) fn command(&self, half: &Half, look: Option<Look>) -> (String, String) {
        let [of_meshes, of_image] = &self.options;
        let look = look.map(|look| ["--as", look.name()]);
        let differs = half.differs().chain(look).flatten().map(str::to_owned);
        let names = self.names().into_iter();
        let render = words::command(
            ["wavecrest".to_owned()]
                .into_iter()
                .chain(names)
                .chain(of_image.clone())
                .chain(differs),
        );
        if self.is_scene {
            let beside = self.file.display();
            return (
                render,
                format!("Save the scene beside {beside}, and run this in its folder:"),
            );
        }
        let file = std::path::absolute(&self.file).unwrap_or_else(|_| self.file.clone());
        let paths = [file, self.named(PARTS)].map(|path| path.to_string_lossy().into_owned());
        // Only an earlier run has left a file of this name.
        let words = ["wavecrest", "convert", "--force"].map(str::to_owned).into_iter();
        let convert = words::command(words.chain(paths).chain(of_meshes.clone()));
        let note =
            "Save the scene in the folder where you run this; the first command writes its meshes";
        (format!("{convert}\n{render}"), format!("{note}:"))
    }
}

/// A scene file as values, unless it is too long.
fn read(file: &Path) -> Option<Value> {
    let is_short = fs::metadata(file).is_ok_and(|found| found.is_file() && found.len() <= LONGEST);
    let text = is_short.then(|| fs::read_to_string(file).ok())??;
    serde_json::from_str(text.trim_start_matches('\u{feff}')).ok()
}

/// Gives a scene file another camera, at rest, with these points in each pixel unless it has its own.
fn place(scene: &mut Value, view: &View, points: Option<Points>) -> Option<()> {
    let camera = scene.get_mut("camera")?.as_object_mut()?;
    let has_lens = camera.contains_key("aperture");
    // Other names of these keys, and the motion.
    for key in ["position", "lookat", "lookAt", "path"] {
        camera.remove(key);
    }
    let View { width, height, location, look, up, antialias, .. } = *view;
    let antialias = points.map_or(antialias, |points| points.side);
    let keys = [
        ("width", json!(width)),
        ("height", json!(height)),
        ("location", json!(location.to_array())),
        ("look", json!(look.to_array())),
        ("up", json!(up.to_array())),
        ("antialias", json!(antialias)),
    ];
    camera.extend(keys.map(|(key, value)| (key.to_owned(), value)));
    if let Some(points) = points {
        camera.insert("sampling".to_owned(), json!(points.sampling));
        // Each has one point on the lens.
        for key in ["nsamplesx", "nsamplesy"].into_iter().filter(|_| has_lens) {
            camera.insert(key.to_owned(), json!(1));
        }
    }
    Some(())
}
