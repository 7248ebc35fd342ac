//! What one takes away from the page: the scene file with its camera, the image, and the command that makes it.
//!
//! Nothing is written to disk: the browser saves what it receives. Of a mesh or a glTF file the scene file is what
//! `wavecrest convert` writes, whose meshes and images that command leaves beside it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use serde_json::{Value, json};

use super::exchange::Exchange;
use super::request::Half;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::render::TracerKind;
use wavecrest_image::look::Look;
use wavecrest_image::write::png;
use wavecrest_scene::components::View;
use wavecrest_scene::load::{FileFormat, LoadedScene};
use wavecrest_scene::write::contents;

/// The longest scene file whose camera is changed, in bytes: as values it takes many times its length.
const LONGEST: u64 = 1 << 22;

/// A file to save: its media type, and its bytes.
pub(super) type Saved = (&'static str, Vec<u8>);

/// The file that is shown, and what becomes of it.
pub(super) struct TakeAway {
    file: PathBuf,
    /// Options that change the file's meshes or its background, as words of a command.
    options: [Vec<String>; 2],
    /// The scene file of another kind of file, once that is read.
    converted: OnceLock<Value>,
}

impl TakeAway {
    /// `of_meshes` are the options of the command that `convert` needs too, `of_image` those of a scene file.
    pub(super) fn new(file: &Path, of_meshes: Vec<String>, of_image: Vec<String>) -> Self {
        let options = [of_meshes, of_image];
        Self { file: file.to_owned(), options, converted: OnceLock::new() }
    }

    /// Keeps what `scene` is as a scene file, unless it is one.
    ///
    /// # Errors
    /// If it cannot be one.
    pub(super) fn keep(&self, scene: &LoadedScene) -> Result<()> {
        if FileFormat::of(&self.file)? != FileFormat::Scene && self.converted.get().is_none() {
            let _ = self.converted.set(contents(scene, &self.named("json"))?);
        }
        Ok(())
    }

    /// The name of the file, with another extension.
    fn named(&self, extension: &str) -> PathBuf {
        PathBuf::from(self.file.file_name().unwrap_or_default()).with_extension(extension)
    }

    /// The names of what is saved: the scene and the image.
    pub(super) fn names(&self) -> [PathBuf; 2] {
        ["view.json", "png"].map(|extension| self.named(extension))
    }

    /// The file with this name among those that can be saved, once there is a scene.
    pub(super) fn get(&self, name: &str, exchange: &Exchange) -> Option<Saved> {
        let (view, image) = {
            let board = exchange.board.borrow();
            (board.view?, board.image.clone())
        };
        match name {
            "scene.json" => {
                let mut scene = self.converted.get().cloned().or_else(|| read(&self.file))?;
                place(&mut scene, &view)?;
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
        let quoted = |path: &Path| quote(&path.to_string_lossy());
        let [of_meshes, of_image] = &self.options;
        let mut words = vec![
            "wavecrest".to_owned(),
            quoted(&self.named("view.json")),
            quoted(&self.named("png")),
        ];
        words.extend(of_image.iter().map(|word| quote(word)));
        if half.precision != Precision::default() {
            words.extend(["--precision".to_owned(), half.precision.name().to_owned()]);
        }
        if half.tracer != TracerKind::default() {
            words.extend(["--tracer".to_owned(), half.tracer.name().to_owned()]);
        }
        look.into_iter().for_each(|look| words.extend(["--as".to_owned(), look.name().to_owned()]));
        let samples =
            if half.points().is_some() { " (the image with the samples of the file)" } else { "" };
        let command = words.join(" ");
        if self.converted.get().is_none() {
            return (
                command,
                format!(
                    "Save the scene beside {}, and run this in its folder{samples}:",
                    self.file.display()
                ),
            );
        }
        let options: String = of_meshes.iter().map(|word| format!(" {}", quote(word))).collect();
        let convert = format!(
            "wavecrest convert {} {}{options}",
            quoted(&self.file),
            quoted(&self.named("json"))
        );
        let note =
            "Save the scene in the folder where you run this; the first command writes its meshes";
        (format!("{convert}\n{command}"), format!("{note}{samples}:"))
    }
}

/// A word as a shell takes it.
fn quote(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:+=@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// A scene file as values, unless it is too long.
fn read(file: &Path) -> Option<Value> {
    let is_short = fs::metadata(file).is_ok_and(|found| found.is_file() && found.len() <= LONGEST);
    let text = is_short.then(|| fs::read_to_string(file).ok())??;
    serde_json::from_str(text.trim_start_matches('\u{feff}')).ok()
}

/// Gives a scene file another camera, at rest.
fn place(scene: &mut Value, view: &View) -> Option<()> {
    let camera = scene.get_mut("camera")?.as_object_mut()?;
    // Other names of these keys, and the motion.
    for key in ["position", "lookat", "lookAt", "path"] {
        camera.remove(key);
    }
    let View { width, height, location, look, up, antialias, .. } = *view;
    let keys = [
        ("width", json!(width)),
        ("height", json!(height)),
        ("location", json!(location.to_array())),
        ("look", json!(look.to_array())),
        ("up", json!(up.to_array())),
        ("antialias", json!(antialias)),
    ];
    camera.extend(keys.map(|(key, value)| (key.to_owned(), value)));
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_change_them() {
        let words = ["a.json", "", "two words", "it's", "$HOME", "#fff"].map(quote);
        assert_eq!(words, ["a.json", "''", "'two words'", r"'it'\''s'", "'$HOME'", "'#fff'"]);
    }
}
