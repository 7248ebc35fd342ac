//! Lights that are added to a file follow the camera: the same lights again, as from another view.

use std::collections::BTreeMap;
use std::path::Path;

use glam::DAffine3;
use hecs::{Entity, Or, Satisfies, World};

use super::ground::is_above;
use super::light::{allow_for_surfaces, axes, rig, room_lamp};
use super::{Framed, Scenery, VisibleMesh};
use crate::components::{
    Added, CutOut, DirectionalLight, Hidden, InstanceOf, Maps, Mesh, PointLight, Sky, Transform,
    View,
};
use crate::mesh::MeshData;
use crate::options::lighting::{Lighting, Rig};
use crate::query::change;
use crate::systems::bounds::Ends;
use crate::systems::cutouts::Masks;

/// That lights were added, and for which view: an entity of its own.
#[derive(Clone, Debug)]
pub(crate) struct Staged {
    pub(super) framed: Framed,
    pub(super) lighting: Lighting,
    /// The view that they are for now.
    pub(super) lit: View,
    /// The box around everything.
    pub(super) ends: Ends,
    /// The height of a ground along up.
    pub(super) height: Option<f64>,
}

/// What decides on added lights for a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightFrame {
    /// What they move with; `None` if they are the same everywhere nearby.
    pub place: Option<DAffine3>,
    /// Whether there is a ground.
    has_ground: bool,
}

impl Staged {
    /// The choices for the lights of a `world`; `None` if it has its own.
    pub(crate) fn of(world: &World) -> Option<Self> {
        world.query::<&Self>().iter().next().cloned()
    }

    /// The view that lights were added for.
    pub(crate) fn usual(&self) -> View {
        self.framed.view
    }

    /// What decides on the lights for this view.
    pub(crate) fn frame(&self, view: View) -> LightFrame {
        let up = self.framed.up;
        let has_ground = self.height.is_some_and(|height| is_above(height, up, view.location));
        LightFrame { place: self.place(view), has_ground }
    }

    fn place(&self, view: View) -> Option<DAffine3> {
        let framed = Framed { view, ..self.framed.clone() };
        match self.lighting.rig {
            Rig::Studio if room_lamp(&framed, &self.ends).is_some() => None,
            Rig::Studio => Some(DAffine3::from_mat3(axes(&framed))),
            Rig::Headlight => Some(DAffine3::from_translation(view.location)),
            Rig::None => None,
        }
    }

    /// Replaces the lights that were added to a `world` of a `file` by those for this view, if they are others.
    pub(crate) fn light(&self, world: &mut World, view: View, file: &Path) {
        if self.frame(view) == self.frame(self.lit) {
            return;
        }
        change(world, |staged: &mut Self| staged.lit = view);
        remove_lights(world);
        let shown = ShownMesh::all(world);
        let mut images = Masks::of_scene(file);
        let meshes: Vec<VisibleMesh<'_>> =
            shown.iter().map(|one| one.visible(&mut images)).collect();
        let instances =
            meshes.iter().zip(&shown).flat_map(|(mesh, one)| mesh.instances(&one.places));
        let framed = Framed { view, ..self.framed.clone() };
        rig(world, &Scenery::new(instances.collect()), &framed, file, &self.lighting);
        allow_for_surfaces(world);
    }
}

/// The components by which what was added is known: a file whose lights are added has none of its own.
type Lit<'w> = Or<Or<&'w DirectionalLight, &'w PointLight>, Or<&'w Sky, &'w Added>>;

fn remove_lights(world: &mut World) {
    let lights: Vec<Entity> =
        world.query_mut::<(Entity, Lit<'_>)>().into_iter().map(|(entity, _)| entity).collect();
    lights.into_iter().for_each(|entity| drop(world.despawn(entity)));
}

/// A mesh of a world, and where it is shown. Its arrays are shared.
struct ShownMesh {
    mesh: MeshData,
    cutout: Option<CutOut>,
    maps: Maps,
    places: Vec<DAffine3>,
}

impl ShownMesh {
    /// Those of a `world`.
    fn all(world: &World) -> Vec<Self> {
        let own = |transform: Option<&Transform>| transform.map_or(DAffine3::IDENTITY, |own| own.0);
        let mut all = BTreeMap::new();
        let mut query = world.query::<(
            Entity,
            &Mesh,
            Option<&CutOut>,
            Option<&Maps>,
            Option<&Transform>,
            Satisfies<&Hidden>,
        )>();
        for (entity, Mesh { data, .. }, cutout, maps, transform, is_hidden) in query.iter() {
            let place = own(transform) * DAffine3::from_translation(data.origin);
            let places = if is_hidden { vec![] } else { vec![place] };
            let (cutout, maps) = (cutout.cloned(), maps.cloned().unwrap_or_default());
            all.insert(entity, (place, Self { mesh: data.clone(), cutout, maps, places }));
        }
        for (InstanceOf(of), transform) in world.query::<(&InstanceOf, Option<&Transform>)>().iter()
        {
            if let Some((place, shown)) = all.get_mut(of) {
                shown.places.push(own(transform) * *place);
            }
        }
        all.into_values().map(|(_, shown)| shown).collect()
    }

    fn visible(&self, images: &mut Masks<'_>) -> VisibleMesh<'_> {
        let Self { mesh, cutout, maps, places } = self;
        VisibleMesh::of_uses(mesh, (cutout.as_ref(), maps), places.len(), images)
    }
}
