//! Textures of a surface, and their look-up keys.

use std::path::PathBuf;

use glam::DVec3;
use serde_json::json;

use crate::folder::translated;
use crate::format::{Cursor, Declaration, Declared, Key, Object, Range, Writer, keys, words};
use crate::texture_source::TextureSource;
use wavecrest_base::error::{ErrorKind, Result};

pub use wavecrest_core::kernels::texture::{Filter, Wrap};

words!(Filter, Wrap, Encoding, Channels);

/// What a path of an image is.
pub(crate) const IMAGE: &str = "the path of an image";

/// A texture that replaces the diffuse colour.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureRef {
    /// The image.
    pub look_up: LookUp,
    /// The encoding of its values.
    pub encoding: Encoding,
    /// A linear factor on every texel.
    pub tint: DVec3,
    /// The channels that are looked up.
    pub channels: Channels,
}

wavecrest_base::choices! {
    /// The channels of an image that are looked up.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Channels {
        /// Red, green and blue.
        #[default]
        Color = "color",
        /// Alpha in place of each of them, 1 without alpha.
        Alpha = "alpha",
    }
}

/// An image, and how it is looked up.
#[derive(Clone, Debug, PartialEq)]
pub struct LookUp {
    /// The image.
    pub source: TextureSource,
    /// Filtering between texels.
    pub filter: Filter,
    /// Wrap mode of coordinates outside 0 to 1.
    pub wrap: Wrap,
    /// A change of the coordinates before the look-up, if any.
    pub placing: Option<Placing>,
}

/// Two rows of a matrix that acts on texture coordinates [u, v, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing(pub [[f64; 3]; 2]);

/// Holes in a surface, where the alpha of an image is low.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOut {
    /// The image, whose alpha that of vertices multiplies; `None` for that of vertices alone.
    pub look_up: Option<LookUp>,
    /// Whether brightness replaces a missing alpha channel; otherwise an image without alpha has no
    /// holes.
    pub is_mask: bool,
    /// The lowest alpha that is opaque, above 0.
    pub threshold: f64,
}

wavecrest_base::choices! {
    /// The encoding of an image's values.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Encoding {
        /// Linear.
        #[default]
        Linear = "linear",
        /// sRGB-encoded, as in most photographs and painted textures.
        Srgb = "srgb",
    }
}

/// The look-up keys, which a shape's texture and its cut-out share.
pub(crate) const LOOK_UP: Declaration = Declaration::of_keys(keys! {
    /// Filtering between texels.
    "filter": word::<Filter>(), Says("bilinear");
    /// How the image continues outside of coordinates 0 to 1; `mirror` mirrors every second copy.
    "wrap": word::<Wrap>(), Says("repeat");
    /// Encoding of the image's values; `srgb` is decoded.
    "encoding": word::<Encoding>(), Says("linear");
    /// Transform of the texture coordinates before the look-up: two rows that act on [u, v, 1].
    "uvtransform": Exactly(2, &Exactly(3, &Number(Range::COORDINATE)));
});

impl Declared for TextureRef {
    const KEYS: &'static [Key] = keys! {
        /// An image that replaces the diffuse colour: a path from the scene's folder.
        "texture": Text;
        /// Colour that multiplies each decoded texel.
        "tint": Color, Are([1.0; 3]);
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let tint = object.read("tint");
        let Some(cursor) = object.get("texture") else {
            warn_without_texture(object);
            return Ok(None);
        };
        let image = existing_image(&cursor)?;
        image.map(|image| Ok(Self { tint, ..Self::plain(object, image)? })).transpose()
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.image("texture", &self.look_up.source);
        to.put("tint", self.tint);
        to.put("encoding", self.encoding);
        self.look_up.write(to);
    }
}

impl TextureRef {
    /// The colours of the image at `path`, with the look-up keys that the object has.
    pub(crate) fn plain(object: &Object<'_>, path: PathBuf) -> Result<Self> {
        let (encoding, tint) = (object.read("encoding"), DVec3::ONE);
        let look_up = LookUp {
            source: TextureSource::File(path),
            filter: object.read_or("filter", Some(Filter::Bilinear)),
            wrap: object.read_or("wrap", Some(Wrap::Repeat)),
            placing: placing(object)?,
        };
        Ok(Self { look_up, encoding, tint, channels: Channels::Color })
    }
}

impl LookUp {
    /// Writes all but the image.
    pub(super) fn write(&self, to: &mut Writer<'_>) {
        to.put("filter", self.filter);
        to.put("wrap", self.wrap);
        if let Some(Placing(rows)) = self.placing {
            to.set("uvtransform", json!(rows));
        }
    }
}

fn warn_without_texture(object: &Object<'_>) {
    // Alpha is looked up like a texture.
    let of_both: &[&str] =
        if object.get("alpha").is_some() { &[] } else { &["filter", "wrap", "uvtransform"] };
    for key in ["encoding", "tint"].iter().chain(of_both) {
        object.warn(key, "has no effect without a texture", "add \"texture\", or remove it");
    }
}

fn placing(object: &Object<'_>) -> Result<Option<Placing>> {
    let what = "two rows of three numbers, [[a, b, c], [d, e, f]]";
    if !object.has("uvtransform") {
        return Ok(None);
    }
    let cursor = object.need("uvtransform", what)?;
    let rows = cursor.exactly(what, |row| row.numbers(what, Range::COORDINATE))?;
    Ok(Some(Placing(rows)))
}

/// The default threshold with an `alpha`.
pub(crate) const THRESHOLD: f64 = 0.5;

impl Declared for CutOut {
    const KEYS: &'static [Key] = keys! {
        /// Parts of the shape where the alpha of the texture, or of the image `alpha`, is lower are
        /// cut out; 0.5 by default with an `alpha`. The mesh's `alphas` multiply it.
        "alphacutoff": Number(Range::NOT_NEGATIVE) => "texture" | "alpha" | "alphas";
        /// An image whose alpha, or brightness if it has none, cuts out the shape; or "blend", for
        /// the alpha of the texture as opacity.
        "alpha": Text;
    };

    /// A threshold of 0 cuts nothing out.
    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let threshold = object.read_or("alphacutoff", Some(THRESHOLD));
        if blends(object) {
            let message = "has no effect with \"blend\" as \"alpha\"";
            object.warn("alphacutoff", message, "remove one of them");
            return Ok(None);
        }
        let image = |key| match object.get(key) {
            Some(cursor) => existing_image(&cursor),
            None => Ok(None),
        };
        let mask = image("alpha")?;
        let is_mask = mask.is_some();
        let path = match mask {
            None if object.has("alphacutoff") => image("texture")?,
            mask => mask,
        };
        if path.is_none() && !(object.has("alphacutoff") && object.has("alphas")) {
            return Ok(None);
        }
        // The encoding is checked all the same.
        let texture = path.map(|path| TextureRef::plain(object, path)).transpose()?;
        let look_up = texture.map(|texture| texture.look_up);
        Ok((threshold > 0.0).then_some(Self { look_up, is_mask, threshold }))
    }

    fn write(&self, to: &mut Writer<'_>) {
        to.put("alphacutoff", self.threshold);
        let Some(look_up) = &self.look_up else { return };
        let texture = to.get("texture").cloned();
        to.image("alpha", &look_up.source);
        if !self.is_mask && texture.as_ref() == to.get("alpha") {
            to.remove("alpha");
        }
        if texture.is_none() {
            look_up.write(to);
        }
    }
}

/// Whether the alpha of the texture is the shape's opacity.
pub(super) fn blends(object: &Object<'_>) -> bool {
    object.get("alpha").is_some_and(|alpha| alpha.value().as_str() == Some("blend"))
}

/// The path of an existing image. One that is missing is left out with a warning, or an error if strict.
pub(super) fn existing_image(cursor: &Cursor<'_>) -> Result<Option<PathBuf>> {
    match existing_file(cursor, IMAGE) {
        Err(error) if error.kind() == ErrorKind::Io => {
            let remedy = "relative paths start at the scene file's folder";
            let notes = cursor.notes();
            let left_out = || format!("it is left out until then; {remedy}");
            let remedy = if notes.strict { remedy.to_owned() } else { left_out() };
            notes.warn_or_fail(error.remedy(remedy));
            Ok(None)
        }
        found => found.map(Some),
    }
}

/// The path of an existing file, joined to the scene file's folder; `what` describes it. Instead of
/// a file of another machine, the one of the same name beside the scene is taken.
pub(crate) fn existing_file(cursor: &Cursor<'_>, what: &str) -> Result<PathBuf> {
    let notes = cursor.notes();
    let text = cursor.text(what)?;
    let path = notes.resolve(text);
    if path.is_file() {
        return Ok(path);
    }
    let here = notes.resolve(&translated(text));
    if here.is_file() {
        cursor.warn("there is no such file here", &format!("{} is used", here.display()));
        return Ok(here);
    }
    let there = if path.is_dir() { "a folder, not a file," } else { "no file" };
    let message = format!("there is {there} at {}", path.display());
    let error = cursor.error_of(ErrorKind::Io, message);
    Err(error.remedy("relative paths start at the scene file's folder"))
}
