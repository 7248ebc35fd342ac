//! Writes components as the keys of JSON objects, and names the files beside the scene file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use hecs::Entity;
use serde_json::{Map, Value};

use crate::texture_source::TextureSource;

/// The files beside a scene file, with its name as prefix.
#[derive(Default)]
pub(crate) struct Beside {
    scene: PathBuf,
    /// The entities whose meshes are to be written.
    pub(crate) meshes: Vec<(PathBuf, Entity)>,
    pub(crate) images: Vec<(PathBuf, TextureSource)>,
}

impl Beside {
    pub(crate) fn new(scene: &Path) -> Self {
        Self { scene: scene.to_owned(), ..Self::default() }
    }

    /// A file name beside the scene file, and its path.
    fn name(&self, ending: &str) -> (String, PathBuf) {
        let stem = self.scene.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}-{ending}");
        let path = self.scene.with_file_name(&name);
        (name, path)
    }

    /// Queues the mesh of an entity to be written; returns its name.
    fn mesh(&mut self, entity: Entity) -> String {
        let (name, path) = self.name(&format!("mesh{}.ply", self.meshes.len()));
        self.meshes.push((path, entity));
        name
    }

    /// Queues an image to be written, once; returns its name.
    fn image(&mut self, source: &TextureSource) -> String {
        if let Some((path, _)) = self.images.iter().find(|(_, known)| known == source) {
            return path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        }
        let extension = match source {
            TextureSource::File(path) => path.extension().unwrap_or_default().to_string_lossy(),
            TextureSource::Embedded { bytes, .. } => {
                let format = image::guess_format(bytes).ok();
                let extension = format.and_then(|format| format.extensions_str().first().copied());
                extension.unwrap_or("image").into()
            }
        };
        let (name, path) = self.name(&format!("image{}.{extension}", self.images.len()));
        self.images.push((path, source.clone()));
        name
    }
}

/// An object that is written.
pub(crate) struct Writer<'a> {
    pub(super) map: Map<String, Value>,
    /// The entity that becomes the object.
    entity: Entity,
    beside: &'a mut Beside,
    /// The names of shapes.
    names: &'a HashMap<Entity, String>,
}

impl<'a> Writer<'a> {
    /// The object of an `entity`, without keys yet.
    pub(crate) fn new(
        entity: Entity,
        beside: &'a mut Beside,
        names: &'a HashMap<Entity, String>,
    ) -> Self {
        Self { map: Map::new(), entity, beside, names }
    }

    /// The object.
    pub(crate) fn end(self) -> Value {
        self.map.into()
    }

    /// Writes a value.
    pub(crate) fn set(&mut self, key: &str, value: impl Into<Value>) {
        self.map.insert(key.to_owned(), value.into());
    }

    /// An object within this one, without keys yet.
    pub(crate) fn inner(&mut self) -> Writer<'_> {
        Writer::new(self.entity, self.beside, self.names)
    }

    /// Writes an object within this one.
    pub(crate) fn object(&mut self, key: &str, write: impl FnOnce(&mut Writer<'_>)) {
        let mut inner = self.inner();
        write(&mut inner);
        let value = inner.end();
        self.set(key, value);
    }

    pub(crate) fn remove(&mut self, key: &str) {
        self.map.remove(key);
    }

    /// The value of a key that is written.
    pub(crate) fn get(&self, key: &str) -> Option<&Value> {
        self.map.get(key)
    }

    /// Writes the name of an image beside the scene file.
    pub(crate) fn image(&mut self, key: &str, source: &TextureSource) {
        let name = self.beside.image(source);
        self.set(key, name);
    }

    /// The name of the entity's mesh beside the scene file.
    pub(crate) fn mesh(&mut self) -> String {
        self.beside.mesh(self.entity)
    }

    /// The name of a shape.
    pub(crate) fn name(&self, of: Entity) -> Option<&'a str> {
        self.names.get(&of).map(String::as_str)
    }
}
