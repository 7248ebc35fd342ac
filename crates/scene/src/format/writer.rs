//! Writes components as the keys of JSON objects.

use std::collections::HashMap;

use hecs::{Entity, EntityRef};
use serde_json::{Map, Value};

use super::beside::Beside;
use super::declared::Field;
use super::keys::{Kind, Variants};
use crate::components::TextureSource;

/// An object that is written.
pub(crate) struct Writer<'a> {
    map: Map<String, Value>,
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

    /// The object of an `entity` with the components of a `kind`.
    pub(crate) fn of(mut self, kind: &Kind, entity: EntityRef<'_>) -> Value {
        self.components(kind, entity);
        self.end()
    }

    /// Writes the components of an `entity` of a `kind`, without keys of no effect.
    pub(crate) fn components(&mut self, kind: &Kind, entity: EntityRef<'_>) {
        kind.declarations().for_each(|component| (component.write)(entity, self));
        while let Some(idle) = kind.all_keys().find(|key| key.is_idle(&self.map)) {
            self.remove(idle.name);
        }
    }

    /// The same for the kind that its components tell: of several, the one with the most.
    pub(crate) fn variant(mut self, variants: &Variants, entity: EntityRef<'_>) -> Value {
        let is_of = |kind: &&Kind| kind.components.first().is_some_and(|own| (own.is_in)(entity));
        let kinds = variants.kinds.iter().filter(is_of);
        match kinds.max_by_key(|kind| kind.components.len()) {
            Some(kind) => {
                self.set("type", kind.word);
                self.of(kind, entity)
            }
            None => Value::Null,
        }
    }

    /// Writes a field.
    pub(crate) fn put(&mut self, key: &str, value: impl Field) {
        let value = value.to_json();
        if !value.is_null() {
            self.set(key, value);
        }
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
