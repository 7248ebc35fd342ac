//! Numbers of shapes and materials, and their names.

use std::collections::{BTreeSet, HashMap};

use serde_json::Value;

use wavecrest_core::prepared::{Appearance, Class, Map, PreparedScene};

/// The numbers of a scene's shapes and materials.
pub(super) struct ShapeNumbers<'a> {
    appearance: &'a Appearance,
    /// For each shape the number of its material; 0 for lights.
    materials: Vec<u32>,
    /// For each material, from 1 on, the first shape with it.
    first: Vec<usize>,
    /// The number of shapes of each name.
    counts: HashMap<&'a str, usize>,
}

impl<'a> ShapeNumbers<'a> {
    pub(super) fn of(scene: &'a PreparedScene) -> Self {
        let appearance = &scene.appearance;
        let mut names =
            Self { appearance, materials: Vec::new(), first: Vec::new(), counts: HashMap::new() };
        let mut known = HashMap::new();
        for (index, shape) in appearance.shapes.iter().enumerate() {
            if shape.light.is_some() {
                names.materials.push(0);
                continue;
            }
            let Class { material, transparency, maps, .. } = appearance.class(shape);
            // Without coordinates, in which shapes differ.
            let maps = maps.iter().map(|Map { property, texture }| {
                let look_up = texture.as_ref().map(|t| (t.image, t.filter, t.wrap));
                format!("{property:?} {look_up:?}")
            });
            // As text, numbers are as good as their bits.
            let text = format!("{material:?} {transparency:?} {:?}", maps.collect::<Vec<_>>());
            let number = *known.entry(text).or_insert_with(|| {
                names.first.push(index);
                names.first.len() as u32
            });
            names.materials.push(number);
        }
        for name in appearance.names.iter().flatten() {
            *names.counts.entry(name.as_str()).or_default() += 1;
        }
        names
    }

    /// The number of the material of the shape with this number; 0 for nothing.
    pub(super) fn material(&self, shape: u32) -> u32 {
        let shape = (shape as usize).checked_sub(1);
        shape.and_then(|shape| self.materials.get(shape)).copied().unwrap_or_default()
    }

    /// The shapes that occur, as JSON: for each number its name or place in the scene.
    pub(super) fn objects(&self, numbers: &[u32]) -> String {
        table(numbers, |number| self.place(number as usize - 1))
    }

    /// The materials that occur, as JSON: for each number its first place in the scene.
    pub(super) fn materials(&self, numbers: &[u32]) -> String {
        table(numbers, |number| {
            let shape = self.first.get(number as usize - 1).copied().unwrap_or_default();
            format!("{}.material", self.place(shape))
        })
    }

    /// The name of a shape, or else its place in the scene, which also tells shapes of one name
    /// apart.
    fn place(&self, shape: usize) -> String {
        let Appearance { names, places, .. } = self.appearance;
        let place = places.get(shape).cloned().unwrap_or_default();
        match names.get(shape).and_then(Option::as_ref) {
            Some(name) if self.counts.get(name.as_str()) == Some(&1) => name.clone(),
            Some(name) => format!("{name} ({place})"),
            None => place,
        }
    }
}

/// The name of each number except 0.
fn table(numbers: &[u32], name: impl Fn(u32) -> String) -> String {
    let seen: BTreeSet<u32> = numbers.iter().copied().filter(|&number| number > 0).collect();
    let entries = seen.into_iter().map(|number| (number.to_string(), Value::from(name(number))));
    Value::Object(entries.collect::<serde_json::Map<_, _>>()).to_string()
}
