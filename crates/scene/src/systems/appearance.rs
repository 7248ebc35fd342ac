//! The appearance: the shapes as tracers read them, in the order of their primitives, and of their meshes what
//! some pass of the schedule reads.

use std::sync::Arc;

use hecs::World;

use super::surface::{SurfaceColumns, SurfaceComponents};
use super::visibility::{Source, Visibility};
use crate::components::Added;
use wavecrest_core::plan::Plan;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{Appearance, Class, LazyImage, MeshAttributes, Property, Shape};

/// Writes the arrays of shapes.
pub(super) fn run(
    world: &World,
    plan: &Plan,
    classes: Vec<Class>,
    images: Vec<LazyImage>,
    cutouts: Vec<Arc<LazyImage>>,
    mut meshes: Vec<MeshAttributes>,
) -> Appearance {
    drop_unused(world, plan.schedule(), &classes, &mut meshes);
    let (mut paths, mut names) = (Vec::new(), Vec::new());
    let (mut shapes, mut ground) = (Vec::new(), None);
    let surfaces = world.view::<SurfaceColumns<'_>>();
    for (source, shape) in world.query::<(&Source, &Shape)>().iter() {
        let SurfaceComponents { place, name, .. } = SurfaceComponents::of(&surfaces, source.0);
        if world.get::<&Added>(source.0).is_ok_and(|added| *added == Added::Ground) {
            ground = Some(shapes.len());
        }
        paths.push(place.to_owned());
        names.push(name.map(|name| name.0.clone()));
        shapes.push(shape.clone());
    }
    Appearance { shapes, classes, paths, names, ground, images, cutouts, meshes }
}

/// Drops normals and colours of meshes that are not in view, unless the schedule requires them, and texture
/// coordinates, tangents and alphas that no map of the `classes` uses.
fn drop_unused(
    world: &World,
    schedule: Schedule,
    classes: &[Class],
    meshes: &mut [MeshAttributes],
) {
    // Whether the step's data of a shape is needed.
    let shows =
        |step, in_view: bool| schedule.runs(step) && (in_view || schedule.is_unconditional(step));
    let mut used = vec![[false; 5]; meshes.len()];
    for (shape, visibility) in world.query::<(&mut Shape, &Visibility)>().iter() {
        let in_view = visibility.faces.is_some();
        shape.smooth &= shows(Step::Normals, in_view);
        let Class { maps, transparency, .. } = &classes[shape.class as usize];
        let is_tinted = transparency.is_some_and(|through| through.tinted);
        shape.colored &= shows(Step::Colors, in_view || is_tinted);
        let Some(used) = shape.mesh.and_then(|i| used.get_mut(i as usize)) else { continue };
        let [smooth, textured, colored, turned, fades] = used;
        *smooth |= shape.smooth;
        *textured |= maps.iter().any(|map| map.texture.is_some());
        *colored |= shape.colored;
        *turned |= maps.iter().any(|map| matches!(map.property, Property::Normal { .. }));
        *fades |= maps.iter().any(|map| map.property == Property::Alpha);
    }
    for (mesh, [smooth, textured, colored, turned, fades]) in meshes.iter_mut().zip(used) {
        mesh.normals = mesh.normals.take().filter(|_| smooth);
        mesh.uvs = mesh.uvs.take().filter(|_| textured);
        mesh.colors = mesh.colors.take().filter(|_| colored);
        mesh.alphas = mesh.alphas.take().filter(|_| fades);
        mesh.tangents = mesh.tangents.take().filter(|_| turned);
    }
}
