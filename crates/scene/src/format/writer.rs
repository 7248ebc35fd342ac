//! Writes components as the keys of JSON objects.

use std::collections::HashMap;

use hecs::Entity;
use serde_json::{Map, Value};

use super::beside::Beside;
use crate::components::TextureSource;

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

    /// Removes a key.
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
