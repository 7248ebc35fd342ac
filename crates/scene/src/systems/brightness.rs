//! The brightest light that any ray may meet: rays end when even that would not show.
//!
//! A bound for the whole file, seen or not: it decides how soon rays end, not what counts of what they meet.

use glam::DVec3;
use hecs::World;

use super::textures::Images;
use crate::components::{
    AreaLight, Environment, Maps, Material, Mesh, Sky, TextureRef, Transparency,
};
use wavecrest_base::error::Result;
use wavecrest_core::kernels::shade::Visible;

/// Finds which rays can show anything before this background, if an image is exposed so.
///
/// # Errors
/// If the image of an environment that may be brighter than white cannot be decoded.
pub(crate) fn run(
    world: &World,
    background: DVec3,
    exposure: f32,
    images: &mut Images,
) -> Result<Visible> {
    type Columns<'a> =
        (&'a Material, Option<&'a Transparency>, Option<&'a TextureRef>, Option<&'a Maps>);
    let mut surfaces = world.query::<Columns<'_>>();
    let goes_on = |(material, through, _, maps): (&Material, Option<&_>, _, Option<&Maps>)| {
        material.kr > 0.0 || through.is_some() || maps.is_some_and(|maps| maps.metal.is_some())
    };
    let mut brightest = background.max_element();
    let mut add = |light: DVec3| brightest = brightest.max(light.max_element());
    if !surfaces.iter().any(goes_on) {
        return Ok(Visible::new(1.0, exposure));
    }
    world.query::<&AreaLight>().iter().for_each(|light| add(light.color));
    for sky in world.query::<&Sky>().iter() {
        sky.sky.into_iter().chain(sky.ground).for_each(&mut add);
    }
    for Environment { around, image, .. } in world.query::<&Environment>().iter() {
        let colors = [around.zenith, around.horizon, around.nadir];
        colors.into_iter().for_each(|color| add(color * around.intensity));
        let place = ("scene.environment", "file");
        image.iter().try_for_each(|image| images.brightest(image, Some(place)).map(&mut add))?;
    }
    let has_colors = |mesh: &Mesh| mesh.data.colors.is_some();
    let is_colored = world.query::<&Mesh>().iter().any(has_colors);
    for (material, through, texture, maps) in surfaces.iter() {
        let map = maps.and_then(|maps| maps.emission.as_ref()?.texture.as_ref());
        let texel = map.map_or(Ok(DVec3::ONE), |map| images.brightest(map, None))?;
        // A product of zero and infinity is none.
        add(DVec3::select(
            material.emission.cmpgt(DVec3::ZERO),
            material.emission * texel,
            DVec3::ZERO,
        ));
        // What surfaces reflect counts as white; what they emit of it may be brighter.
        if material.unlit {
            add(material.diffuse_color);
            texture
                .map_or(Ok(DVec3::ZERO), |texture| images.brightest(texture, None))
                .map(&mut add)?;
        }
        let is_amplified = material.kr * material.specular_color.max_element() > 1.0
            || through.is_some_and(|through| through.kt * through.color.max_element() > 1.0);
        if is_amplified || material.unlit && is_colored {
            add(DVec3::INFINITY);
        }
    }
    Ok(Visible::new(brightest as f32, exposure))
}
