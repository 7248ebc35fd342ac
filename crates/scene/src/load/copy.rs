//! A copy of a world, for what is prepared more than once.

use hecs::{EntityBuilder, EntityRef, World};

use crate::components::{
    Added, AreaLight, CameraPath, CutOut, DirectionalLight, Disk, Environment, Facing, FreeCamera,
    Hidden, InstanceOf, JsonPath, Maps, Material, Mesh, MeshFile, Name, Order, PointLight, Quad,
    Settings, Shading, Sides, Sky, Sphere, Spot, TextureRef, ThinLens, Transform, Transparency,
    Triangle, View,
};
use crate::staging::Staged;

/// The same entities with the same components, of the kinds that loading adds. Arrays of meshes are shared.
pub(super) fn of(world: &World) -> World {
    let mut all: Vec<EntityRef<'_>> = world.iter().collect();
    // Numbers that are passed over are searched for later, one by one.
    all.sort_unstable_by_key(|entity| entity.entity().id());
    let mut copy = World::new();
    for entity in all {
        copy.spawn_at(entity.entity(), copied(entity).build());
    }
    copy
}

macro_rules! copied_if_there {
    ($entity:ident: $($component:ty),+ $(,)?) => {{
        let mut copy = EntityBuilder::new();
        $($entity.get::<&$component>().map(|found| copy.add(<$component>::clone(&found)));)+
        copy
    }};
}

/// The components of an entity.
fn copied(entity: EntityRef<'_>) -> EntityBuilder {
    let copy = copied_if_there!(entity:
        JsonPath, Order, Name, Added, Staged, Settings,
        View, ThinLens, CameraPath, FreeCamera,
        Environment, Sky, AreaLight, DirectionalLight, PointLight, Spot,
        Mesh, MeshFile, Triangle, Quad, Sphere, Disk,
        Transform, InstanceOf, Hidden, Facing, Sides, Shading,
        Material, Maps, TextureRef, Transparency, CutOut,
    );
    debug_assert_eq!(copy.component_types().count(), entity.component_types().count());
    copy
}
