//! The environment: what rays see that hit nothing.

use glam::{DMat3, DQuat, DVec3, Vec3};
use hecs::{Entity, World};

use crate::components::{Encoding, TextureRef};
use crate::corners::unit;
use crate::format::{
    Cursor, Declaration, Declared, Key, Kind, Object, Range, Writer, component, keys,
};
use crate::surface::{IMAGE, existing_file};
use crate::systems::frame::Frame;
use crate::systems::textures::Images;
use wavecrest_base::error::Result;
use wavecrest_core::kernels::environment::{self, EnvironmentColors};
use wavecrest_core::plan::{Effect, Plan};
use wavecrest_core::prepared::UvMap;

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

/// What rays see that hit nothing: the environment, if the plan has it, and the background.
pub(crate) fn run(
    world: &World,
    frame: &Frame,
    plan: &Plan,
    images: &mut Images,
) -> (Option<environment::Environment>, Vec3) {
    let mut environments = world.query::<(&Environment, Option<&EvenColor>)>();
    let found = environments.iter().find(|(found, _)| found.is_bright());
    match found {
        Some((found, _)) if plan.has(Effect::Environment) => {
            (Some(found.prepared(images)), frame.settings.background.as_vec3())
        }
        found => {
            let found = found.filter(|(around, _)| !around.hidden);
            let even = found.and_then(|(_, color)| color.map(|color| color.0));
            (None, even.unwrap_or(frame.settings.background).as_vec3())
        }
    }
}

/// Whether a world has an environment that adds anything.
pub(crate) fn is_bright(world: &World) -> bool {
    world.query::<&Environment>().iter().any(Environment::is_bright)
}

/// The colour of an environment that is bright and of one colour, as that of a background is: a component
/// beside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EvenColor(DVec3);

/// Leaves the colour of an even environment with it, and returns it. Images that give ambient light, or are not
/// small, may have several.
pub(crate) fn leave_even_color(
    world: &mut World,
    images: &mut Images,
    gives_light: bool,
) -> Option<DVec3> {
    let mut query = world.query::<(Entity, &Environment)>();
    let (entity, found) = query.iter().find(|(_, found)| found.is_bright())?;
    let Surroundings { zenith, horizon, nadir, intensity, .. } = found.around;
    let color = match &found.image {
        Some(_) if gives_light => None,
        Some(image) => images.only_color(image, ("scene.environment", "file")),
        None => (zenith == horizon && horizon == nadir).then_some(zenith * intensity),
    }?;
    drop(query);
    let _ = world.insert_one(entity, EvenColor(color));
    Some(color)
}

impl Environment {
    /// As tracers read it.
    fn prepared(&self, images: &mut Images) -> environment::Environment {
        let Surroundings { zenith, horizon, nadir, intensity, up, turn } = self.around;
        let gradient = [zenith, horizon, nadir].map(|color| (color * intensity).as_vec3());
        let image = self
            .image
            .as_ref()
            .map(|image| images.texture(image, ("scene.environment", "file"), UvMap::Mesh).image);
        let colors = image.map_or(EnvironmentColors::Gradient(gradient), EnvironmentColors::Image);
        // A gradient is the same all around, but for roundings.
        let turn = if image.is_some() { turn } else { 0.0 };
        // The shortest rotation from the zenith to +y, after the turn about it.
        let to_own = DQuat::from_rotation_y(-turn.to_radians())
            * DQuat::from_rotation_arc(unit(up), DVec3::Y);
        let to_own = DMat3::from_quat(to_own).as_mat3();
        environment::Environment { to_own, colors, hidden: self.hidden }
    }

    /// Whether it adds anything.
    pub(crate) fn is_bright(&self) -> bool {
        let Surroundings { zenith, horizon, nadir, intensity, .. } = self.around;
        let is_colored = [zenith, horizon, nadir].iter().any(|color| *color != DVec3::ZERO);
        intensity > 0.0 && (self.image.is_some() || is_colored)
    }
}
