//! MTL: the materials of OBJ files.
//!
//! A text of statements, one a line, in upper or lower case: `newmtl` begins a material, to which
//! the following statements belong. Malformed and unsupported statements are skipped and named: a
//! mesh is worth more than its materials. SCENES.md states how they are converted.

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

use glam::DVec3;

use crate::components::{
    Channels, CutOut, Encoding, Filter, LookUp, Map, Material, Placing, TextureRef, TextureSource,
    Transparency, Wrap,
};
use crate::format::Range;
use crate::surface::THRESHOLD;

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
    map_kd: Option<MtlMap>,
    /// Opacity, from 0 to 1.
    d: Option<f64>,
    /// What is missing from opacity, from 0 to 1.
    tr: Option<f64>,
    /// Colour of refracted light.
    tf: Option<DVec3>,
    /// Index of refraction.
    ni: Option<f64>,
    map_d: Option<MtlMap>,
    /// Metalness and roughness, from 0 to 1.
    pm: Option<f64>,
    pr: Option<f64>,
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

/// Statements without effect here: ambient colour, sharpness of maps.
const NEEDLESS: [&str; 3] = ["ka", "map_ka", "sharpness"];

impl Mtl {
    /// That of an image alone.
    pub(crate) fn of_image(name: &str) -> Self {
        let map = MtlMap { name: name.to_owned(), clamp: false, placing: None, gain: 1.0 };
        Self { map_kd: Some(map), ..Self::default() }
    }
}

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
            let statement =
                |(_, mtl): &mut (String, Mtl)| self.statement(mtl, &keyword, rest.trim());
            let is_right = current.as_mut().is_some_and(statement);
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
            "tr" => set(&mut mtl.tr, number(rest)),
            "tf" => set(&mut mtl.tf, color(rest)),
            "ni" => set(&mut mtl.ni, number(rest)),
            "pm" => set(&mut mtl.pm, number(rest).filter(|&pm| pm <= 1.0)),
            "pr" => set(&mut mtl.pr, number(rest).filter(|&pr| pr <= 1.0)),
            "map_d" => set(&mut mtl.map_d, MtlMap::read(rest, &mut self.options)),
            "map_kd" => set(&mut mtl.map_kd, MtlMap::read(rest, &mut self.options)),
            needless if NEEDLESS.contains(&needless) => true,
            other => {
                self.skipped.insert(other.chars().take(LONGEST_NAME).collect());
                true
            }
        }
    }
}

/// The lighting models with mirrors: with ray tracing, glass, and Fresnel without ray tracing.
const MIRRORS: [u32; 3] = [3, 5, 8];

/// The diffuse colour of a mesh without a material, and of a surface whose image is missing.
pub(crate) const GREY: f64 = 0.7;

/// The models with refraction.
const GLASS: [u32; 2] = [6, 7];

/// The roughness of a metal without one.
const ROUGHNESS: f64 = 0.5;

/// The models without a highlight.
const MATT: [u32; 2] = [0, 1];

/// The appearance of a surface.
#[derive(Clone, Debug)]
pub(crate) struct MtlSurface {
    pub(crate) material: Material,
    pub(crate) transparency: Transparency,
    pub(crate) texture: Option<TextureRef>,
    /// The metal, where an image sets its colour.
    pub(crate) metal: Option<Map>,
    pub(crate) cutout: Option<CutOut>,
    /// Whether any of it is opaque.
    pub(crate) is_there: bool,
}

/// The material, with its images at the paths that `find` returns.
pub(crate) fn surface(mtl: &Mtl, mut find: impl FnMut(&str) -> Option<PathBuf>) -> MtlSurface {
    let is_model = |models: &[u32]| mtl.illum.is_some_and(|model| models.contains(&model));
    let exponent = mtl.ns.unwrap_or(0.0).min(Material::SHARPEST);
    let gloss = mtl.ks.map_or(0.0, |ks| ks.element_sum() / 3.0).min(1.0);
    let kr = if is_model(&MIRRORS) { gloss } else { 0.0 };
    // An exponent of 0 would be a highlight everywhere.
    let has_highlight = exponent > 0.0 && !is_model(&MATT);
    let kd = mtl.kd.unwrap_or(DVec3::ONE);
    let mut found = |map: &Option<MtlMap>, filter| {
        let map = map.as_ref()?;
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        let source = TextureSource::File(find(&map.name)?);
        Some(LookUp { source, filter, wrap, placing: map.placing })
    };
    let texture = found(&mtl.map_kd, Filter::Trilinear).map(|look_up| TextureRef {
        look_up,
        encoding: Encoding::Srgb,
        channels: Channels::Color,
        // Many programs write black if there is an image.
        tint: if kd == DVec3::ZERO { DVec3::ONE } else { kd }
            * mtl.map_kd.as_ref().map_or(1.0, |map| map.gain),
    });
    // Without its image a surface is grey, unless it has a colour of its own.
    let is_missing = mtl.map_kd.is_some() && texture.is_none();
    let is_plain = [DVec3::ZERO, DVec3::ONE].contains(&kd);
    let color = if is_missing && is_plain { DVec3::splat(GREY) } else { kd };
    // Some programs write 1 for opaque surfaces.
    let tr = mtl.tr.filter(|&tr| tr < 1.0);
    let d = mtl.d.or(tr.map(|tr| 1.0 - tr)).unwrap_or(1.0).min(1.0);
    // A filter tells of glass, too.
    let is_glass = is_model(&GLASS) && (d < 1.0 || mtl.tf.is_some_and(|tf| tf != DVec3::ZERO));
    let kt = match is_glass {
        true if d < 1.0 => 1.0 - d,
        true => 1.0,
        false => 0.0,
    };
    let mask = found(&mtl.map_d, Filter::Bilinear);
    let cutout = mask.map(|own| CutOut {
        // In a scene file both share the wrap mode and the place.
        look_up: Some(match &texture {
            Some(TextureRef { look_up: LookUp { wrap, placing, .. }, .. }) => {
                LookUp { wrap: *wrap, placing: *placing, ..own }
            }
            None => own,
        }),
        is_mask: true,
        threshold: THRESHOLD,
    });
    let [metallic, roughness] = [mtl.pm.unwrap_or(0.0), mtl.pr.unwrap_or(ROUGHNESS)];
    let is_metal = mtl.pm.or(mtl.pr).is_some() && !is_glass;
    // Where an image sets the colour, it sets that of the metal.
    let metal_by_color = (is_metal && texture.is_some() && metallic > 0.0 && roughness < 1.0)
        .then_some(Map { texture: None, strength: 1.0, metallic, roughness });
    let emission = mtl.ke.unwrap_or(DVec3::ZERO);
    let plain = Material {
        ks: if has_highlight { gloss } else { 0.0 },
        kd: (1.0 - kr) * (1.0 - kt),
        specular_exponent: exponent,
        diffuse_color: color,
        kr,
        emission,
        ..Material::MATTE
    };
    let metal = Material { emission, ..Material::metal(color, metallic, roughness) };
    let material = if is_metal { metal } else { plain };
    let ior = mtl.ni.filter(|&ni| Transparency::IOR.contains(ni));
    let transparency = Transparency {
        opacity: if is_glass { 1.0 } else { d },
        kt,
        ior: ior.unwrap_or(Transparency::OPAQUE.ior),
        color: mtl.tf.unwrap_or(DVec3::ONE),
        ..Transparency::OPAQUE
    };
    let is_there = d > 0.0 || is_glass;
    MtlSurface { material, transparency, texture, metal: metal_by_color, cutout, is_there }
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
    value.map(|value| *to = Some(value)).is_some()
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

/// An image that a material names.
#[derive(Clone, Debug, PartialEq)]
struct MtlMap {
    /// As in the file.
    name: String,
    /// Whether coordinates outside 0 to 1 are clamped to the edge.
    clamp: bool,
    /// The scale and the offset of texture coordinates, if not 1 and 0.
    placing: Option<Placing>,
    /// Factor on its values.
    gain: f64,
}

/// The options by the largest number of words after each. Offset, scale and turbulence may have
/// fewer.
const OPTIONS: [(usize, &str); 3] = [
    (1, "-blendu -blendv -bm -boost -cc -clamp -colorspace -imfchan -texres -type"),
    (2, "-mm"),
    (3, "-o -s -t"),
];

/// Each option with the largest number of words after it.
fn options() -> impl Iterator<Item = (&'static str, usize)> {
    OPTIONS.into_iter().flat_map(|(most, names)| names.split(' ').map(move |name| (name, most)))
}

impl MtlMap {
    /// Reads the text after `map_Kd`; `None` if it names no image. Options without effect are added
    /// to `skipped`.
    fn read(text: &str, skipped: &mut BTreeSet<String>) -> Option<Self> {
        let mut clamp = false;
        let (mut scale, mut offset, mut levels) = ([1.0; 2], [0.0; 2], [0.0, 1.0]);
        let mut rest = text;
        while let Some((option, most, after)) = option(rest) {
            rest = after;
            let mut words = Vec::new();
            for taken in 0..most {
                let (word, after) = word(rest)?;
                // The second and third number may be missing.
                if taken > 0 && most == 3 && word.parse::<f64>().is_err() {
                    break;
                }
                words.push(word);
                rest = after;
            }
            match option {
                "-clamp" => clamp = words.iter().any(|word| word.eq_ignore_ascii_case("on")),
                "-s" => set_first(&mut scale, &words)?,
                "-o" => set_first(&mut offset, &words)?,
                "-mm" if words.first() == Some(&"0") => set_first(&mut levels, &words)?,
                _ => {
                    skipped.insert(option.to_owned());
                }
            }
        }
        let name = without_options(rest, skipped);
        let ([u, v], [x, y]) = (scale, offset);
        let placing = (scale != [1.0; 2] || offset != [0.0; 2])
            .then_some(Placing([[u, 0.0, x], [0.0, v, y]]));
        let gain = levels[1].max(0.0);
        (!name.is_empty()).then(|| Self { name: name.to_owned(), clamp, placing, gain })
    }
}

/// Sets the first of some numbers to those of `words`; `None` if one is none in range.
fn set_first(numbers: &mut [f64; 2], words: &[&str]) -> Option<()> {
    numbers.iter_mut().zip(words).try_for_each(|(number, word)| {
        *number = word.parse().ok().filter(|x| Range::COORDINATE.contains(*x))?;
        Some(())
    })
}

/// The option at the start of a text, the number of words that may follow it, and the text after
/// it.
fn option(text: &str) -> Option<(&'static str, usize, &str)> {
    let (first, rest) = word(text)?;
    let (name, most) = options().find(|(name, _)| first.eq_ignore_ascii_case(name))?;
    Some((name, most, rest))
}

/// The first word of a text, and the text after it.
fn word(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (end > 0).then(|| text.split_at(end))
}

/// A name that may contain blanks, up to an option that some programs write after it.
fn without_options<'a>(text: &'a str, skipped: &mut BTreeSet<String>) -> &'a str {
    let found = options().filter_map(|(name, _)| Some((text.find(&format!(" {name} "))?, name)));
    let Some((end, option)) = found.min() else { return text.trim() };
    skipped.insert(option.to_owned());
    text[..end].trim()
}

#[cfg(test)]
mod tests;
