//! The environment: what rays see that hit nothing.

use std::path::Path;

use glam::{DMat3, DVec3};
use hecs::World;

use crate::components::{Encoding, Sky, TextureRef};
use crate::format::{
    Cursor, Declaration, Declared, Key, Kind, Object, Range, Writer, component, keys,
};
use crate::lights::unit;
use crate::surface::{IMAGE, existing_file};
use crate::systems::textures::Images;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::environment::{self, EnvironmentColors};
use wavecrest_core::kernels::hemisphere::Hemisphere;
use wavecrest_core::prepared::{LazyImage, UvMap};

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
        Ok(Some(Self { around, image }))
    }

    fn write(&self, to: &mut Writer<'_>) {
        self.around.write_fields(to);
        if let Some(image) = &self.image {
            to.image("file", &image.look_up.source);
            to.put("encoding", image.encoding);
        }
    }
}

/// The environment of a world, unless it is black.
pub(crate) fn system(world: &World, images: &mut Images) -> Option<environment::Environment> {
    let mut query = world.query::<&Environment>();
    let Environment { around, image } = query.iter().find(|found| found.is_bright())?;
    let &Surroundings { zenith, horizon, nadir, intensity, up, turn } = around;
    let gradient = [zenith, horizon, nadir].map(|color| (color * intensity).as_vec3());
    let colors = match image {
        None => EnvironmentColors::Gradient(gradient),
        Some(image) => {
            let place = ("scene.environment", "file");
            EnvironmentColors::Image(images.texture(image, place, UvMap::Mesh).image)
        }
    };
    // A gradient is the same all around, but for roundings.
    let turn = if image.is_some() { turn } else { 0.0 };
    // The shortest rotation from the zenith to +y, after the turn about it.
    let to_own = glam::DQuat::from_rotation_y(-turn.to_radians())
        * glam::DQuat::from_rotation_arc(unit(up), DVec3::Y);
    Some(environment::Environment { to_own: DMat3::from_quat(to_own).as_mat3(), colors })
}

/// Whether a world has an environment that adds anything.
pub(crate) fn is_bright(world: &World) -> bool {
    world.query::<&Environment>().iter().any(Environment::is_bright)
}

/// The colour of the environment of a world in a `file`, if it is bright and of one colour, as that of a
/// background is. Images that give ambient light, or are not small, may have others.
pub(crate) fn only_color(world: &World, images: &mut Images, file: &Path) -> Option<DVec3> {
    let mut query = world.query::<&Environment>();
    let Environment { around, image } = query.iter().find(|found| found.is_bright())?;
    let Surroundings { zenith, horizon, nadir, intensity, .. } = around;
    match image {
        Some(_) if world.query::<&Sky>().iter().any(|sky| sky.sky.is_none()) => None,
        Some(image) => images.only_color(image, (file, "scene.environment", "file")),
        None => (zenith == horizon && horizon == nadir).then_some(zenith * intensity),
    }
}

/// The ambient light of an environment.
///
/// # Errors
/// If its image cannot be decoded.
pub(crate) fn ambient(
    around: &environment::Environment,
    images: &[LazyImage],
    traced: bool,
) -> Result<Hemisphere> {
    let image = match around.colors {
        EnvironmentColors::Gradient(_) => None,
        EnvironmentColors::Image(number) => Some(images[number as usize].get()?),
    };
    Ok(around.ambient(image, traced))
}

impl Environment {
    /// Whether it adds anything.
    pub(crate) fn is_bright(&self) -> bool {
        let Surroundings { zenith, horizon, nadir, intensity, .. } = self.around;
        let is_colored = [zenith, horizon, nadir].iter().any(|color| *color != DVec3::ZERO);
        intensity > 0.0 && (self.image.is_some() || is_colored)
    }
}
