//! The environment: what rays see that hit nothing.

use glam::DVec3;

use crate::format::{
    Cursor, Declaration, Declared, Key, Kind, Object, Range, Writer, component, keys,
};
use crate::surface::{Encoding, IMAGE, TextureRef, existing_file};
use wavecrest_base::error::Result;

component! {
    /// A gradient around the scene, and its direction.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Surroundings {
        /// The colour straight up, without an image.
        pub zenith: DVec3 = "zenith": Color, Are([0.35, 0.5, 0.8]);
        /// The colour at the horizon.
        pub horizon: DVec3 = "horizon": Color, Are([0.85, 0.9, 0.95]);
        /// The colour straight down.
        pub nadir: DVec3 = "nadir": Color, Are([0.3, 0.28, 0.25]);
        /// Factor on all colours.
        pub intensity: f64 = "intensity": Number(Range::NOT_NEGATIVE), Is(1.0);
        /// The direction of the zenith.
        pub up: DVec3 = "up": Direction("[0, 1, 0]"), Are([0.0, 1.0, 0.0]);
        /// Turn about it, in degrees, counter-clockwise as seen from above.
        pub turn: f64 = "turn": Number(Range::COORDINATE), Is(0.0) => "file";
    }
}

/// What is around the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The gradient, and the direction of either.
    pub around: Surroundings,
    /// The image in place of the gradient.
    pub image: Option<TextureRef>,
    /// Whether it is seen only where it is mirrored or bent, in front of a transparent background.
    pub hidden: bool,
}

/// The object of an environment.
pub(crate) const OBJECT: Kind = Kind {
    keys: Surroundings::FIELDS,
    components: &[Declaration::of::<Environment>()],
    ..Kind::new("an environment", "What rays see that hit nothing: an image or a gradient.", &[])
};

impl Declared for Environment {
    const KEYS: &'static [Key] = keys! {
        /// An image by longitude and latitude, in place of the gradient: its centre is in the
        /// direction -z, and its upper edge at the zenith.
        "file": Text;
        /// Encoding of the image's values.
        "encoding": word::<Encoding>(), Says("linear") => "file";
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let around = Surroundings::fields(object, None);
        let encoding = object.read("encoding");
        let image = |file: Cursor<'_>| -> Result<TextureRef> {
            let texture = TextureRef::plain(object, existing_file(&file, IMAGE)?)?;
            Ok(TextureRef { encoding, tint: DVec3::splat(around.intensity), ..texture })
        };
        let image = object.get("file").map(image).transpose()?;
        Ok(Some(Self { around, image, hidden: false }))
    }

    fn write(&self, to: &mut Writer<'_>) {
        self.around.write_fields(to);
        if let Some(image) = &self.image {
            to.image("file", &image.look_up.source);
            to.put("encoding", image.encoding);
        }
    }
}

impl Environment {
    /// An image alone, with its upper edge in the direction `up`.
    pub(crate) fn of_image(image: TextureRef, up: DVec3, hidden: bool) -> Self {
        let [zenith, horizon, nadir] = [DVec3::ONE; 3];
        let around = Surroundings { zenith, horizon, nadir, intensity: 1.0, up, turn: 0.0 };
        Self { around, image: Some(image), hidden }
    }

    /// Whether it adds anything.
    pub(crate) fn is_bright(&self) -> bool {
        let Surroundings { zenith, horizon, nadir, intensity, .. } = self.around;
        let is_colored = [zenith, horizon, nadir].iter().any(|color| *color != DVec3::ZERO);
        intensity > 0.0 && (self.image.is_some() || is_colored)
    }
}
