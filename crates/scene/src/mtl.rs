//! MTL: the materials of OBJ files.
//!
//! A text of statements, one a line, in upper or lower case: `newmtl` begins a material, to which
//! the following statements belong. Malformed and unsupported statements are skipped and named: a
//! mesh is worth more than its materials.

mod map;
mod surface;

use std::collections::{BTreeSet, HashMap};

use glam::DVec3;

use crate::components::{CutOut, Material, TextureRef};
use crate::format::Range;
use map::Map;
pub(crate) use surface::{Look, surface};

/// A material as in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Mtl {
    /// Diffuse colour.
    kd: Option<DVec3>,
    /// Colour of its emission.
    ke: Option<DVec3>,
    /// Colour of highlight and mirror.
    ks: Option<DVec3>,
    /// Sharpness of the highlight.
    ns: Option<f64>,
    /// The number of the lighting model.
    illum: Option<u32>,
    map_kd: Option<Map>,
    /// Opacity, from 0 to 1.
    d: Option<f64>,
    map_d: Option<Map>,
}

/// All materials of some files, and the names of skipped statements.
#[derive(Debug, Default)]
pub(crate) struct Library {
    /// By name; of several with the same name, the first.
    pub(crate) materials: HashMap<String, Mtl>,
    /// Unsupported statements.
    pub(crate) skipped: BTreeSet<String>,
    /// Unsupported options of maps.
    pub(crate) options: BTreeSet<String>,
    /// The first few malformed lines, by file.
    pub(crate) malformed: Vec<String>,
}

/// Largest number of malformed lines to name.
const NAMED: usize = 3;

/// Statements without effect here: ambient colour, refraction, filters, sharpness of maps.
const NEEDLESS: [&str; 6] = ["ka", "ni", "tf", "tr", "map_ka", "sharpness"];

impl Library {
    /// Adds the materials in the text of a file called `name`.
    pub(crate) fn add(&mut self, name: &str, text: &[u8]) {
        let mut current: Option<(String, Mtl)> = None;
        for (number, line) in text.split(|&byte| byte == b'\n').enumerate() {
            let line = String::from_utf8_lossy(line);
            let line = line.trim();
            let (keyword, rest) = line.split_once([' ', '\t']).unwrap_or((line, ""));
            if keyword.is_empty() || keyword.starts_with('#') {
                continue;
            }
            let keyword = keyword.to_ascii_lowercase();
            if keyword == "newmtl" {
                self.end(current.take());
                current = Some((rest.trim().to_owned(), Mtl::default()));
                continue;
            }
            let is_right = match &mut current {
                Some((_, mtl)) => self.statement(mtl, &keyword, rest.trim()),
                None => false,
            };
            if !is_right && self.malformed.len() < NAMED {
                self.malformed.push(format!("{name}, line {}", number + 1));
            }
        }
        self.end(current);
    }

    fn end(&mut self, material: Option<(String, Mtl)>) {
        if let Some((name, mtl)) = material {
            self.materials.entry(name).or_insert(mtl);
        }
    }

    /// Reads a statement; returns whether it is valid.
    fn statement(&mut self, mtl: &mut Mtl, keyword: &str, rest: &str) -> bool {
        match keyword {
            "kd" => set(&mut mtl.kd, color(rest)),
            "ke" => set(&mut mtl.ke, color(rest)),
            "ks" => set(&mut mtl.ks, color(rest)),
            "ns" => set(&mut mtl.ns, number(rest)),
            "illum" => set(&mut mtl.illum, rest.parse().ok()),
            "d" => set(&mut mtl.d, number(rest.trim_start_matches("-halo "))),
            "map_d" => set(&mut mtl.map_d, Map::read(rest, &mut self.options)),
            "map_kd" => set(&mut mtl.map_kd, Map::read(rest, &mut self.options)),
            needless if NEEDLESS.contains(&needless) => true,
            other => {
                self.skipped.insert(other.chars().take(LONGEST_NAME).collect());
                true
            }
        }
    }
}

/// The materials of a text by name, as if every image existed: for tests.
#[doc(hidden)]
pub fn materials(text: &[u8]) -> Vec<(String, Material, Option<TextureRef>, Option<CutOut>)> {
    let mut library = Library::default();
    library.add("a.mtl", text);
    let made = |(name, mtl): (String, Mtl)| {
        let look = surface(&mtl, |image| Some(image.into()));
        (name, look.material, look.texture, look.cutout)
    };
    library.materials.into_iter().map(made).collect()
}

/// Messages quote no more of longer names.
const LONGEST_NAME: usize = 24;

/// Sets a value that could be parsed; returns whether it could.
fn set<T>(to: &mut Option<T>, value: Option<T>) -> bool {
    let is_right = value.is_some();
    *to = value.or(to.take());
    is_right
}

/// A number, 0 or more.
fn number(text: &str) -> Option<f64> {
    let number = text.split_ascii_whitespace().next()?.parse().ok()?;
    Range::NOT_NEGATIVE.contains(number).then_some(number)
}

/// Three numbers, or one for all three.
fn color(text: &str) -> Option<DVec3> {
    let numbers: Option<Vec<f64>> = text.split_ascii_whitespace().take(3).map(number).collect();
    match numbers?[..] {
        [r, g, b] => Some(DVec3::new(r, g, b)),
        [grey] => Some(DVec3::splat(grey)),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
