//! The environment: what rays see that hit nothing.

use glam::{DMat3, DQuat, DVec3, Vec3};
use hecs::{Entity, World};

use super::frame::Frame;
use super::textures::Images;
use crate::components::{Environment, Surroundings};
use crate::corners::unit;
use wavecrest_core::kernels::environment::{self, EnvironmentColors};
use wavecrest_core::plan::{Effect, Plan};
use wavecrest_core::prepared::UvMap;

/// The place of its image in the scene file.
const PLACE: (&str, &str) = ("scene.environment", "file");

/// What rays see that hit nothing: the environment, if the plan has it, and the background.
pub(super) fn run(
    world: &World,
    frame: &Frame,
    plan: &Plan,
    images: &mut Images,
) -> (Option<environment::Environment>, Vec3) {
    let mut environments = world.query::<(&Environment, Option<&EvenColor>)>();
    let found = environments.iter().find(|(found, _)| found.is_bright());
    match found {
        Some((found, _)) if plan.has(Effect::Environment) => {
            (Some(prepared(found, images)), frame.settings.background.as_vec3())
        }
        found => {
            let found = found.filter(|(around, _)| !around.hidden);
            let even = found.and_then(|(_, color)| color.map(|color| color.0));
            (None, even.unwrap_or(frame.settings.background).as_vec3())
        }
    }
}

/// Whether a world has an environment that adds anything.
pub(super) fn is_bright(world: &World) -> bool {
    world.query::<&Environment>().iter().any(Environment::is_bright)
}

/// The colour of an environment that is bright and of one colour, as that of a background is: a component
/// beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct EvenColor(DVec3);

/// Leaves the colour of an even environment with it, and returns it. Images that give ambient light, or are not
/// small, may have several.
pub(super) fn leave_even_color(
    world: &mut World,
    images: &mut Images,
    gives_light: bool,
) -> Option<DVec3> {
    let mut environments = world.query_mut::<(Entity, &Environment)>().into_iter();
    let (entity, found) = environments.find(|(_, found)| found.is_bright())?;
    let Surroundings { zenith, horizon, nadir, intensity, .. } = found.around;
    let color = match &found.image {
        Some(_) if gives_light => None,
        Some(image) => images.only_color(image, PLACE),
        None => (zenith == horizon && horizon == nadir).then_some(zenith * intensity),
    }?;
    let _ = world.insert_one(entity, EvenColor(color));
    Some(color)
}

/// An environment as tracers read it.
fn prepared(around: &Environment, images: &mut Images) -> environment::Environment {
    let Surroundings { zenith, horizon, nadir, intensity, up, turn } = around.around;
    let gradient = [zenith, horizon, nadir].map(|color| (color * intensity).as_vec3());
    let texture = around.image.as_ref().map(|image| images.texture(image, PLACE, UvMap::Mesh));
    let image = texture.map(|texture| texture.image);
    let colors = image.map_or(EnvironmentColors::Gradient(gradient), EnvironmentColors::Image);
    // A gradient is the same all around, but for roundings.
    let turn = if image.is_some() { turn } else { 0.0 };
    // The shortest rotation from the zenith to +y, after the turn about it.
    let to_own =
        DQuat::from_rotation_y(-turn.to_radians()) * DQuat::from_rotation_arc(unit(up), DVec3::Y);
    let to_own = DMat3::from_quat(to_own).as_mat3();
    environment::Environment { to_own, colors, hidden: around.hidden }
}
