use glam::{DMat3, DVec3, Vec3};

use super::*;
use crate::components::{JsonPath, Order, Transform, Triangle};
use crate::mesh::Attribute;
use crate::mesh::tests::strip;
use crate::options::lighting::Lighting;
use crate::staging;
use crate::systems::frame::Frame;
use crate::systems::geometry::{Arrays, run};
use crate::systems::placement;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::shade::Visible;
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_core::prepared::Shape;

fn spawn(world: &mut World, order: u32, data: MeshData) -> hecs::Entity {
    let path = JsonPath(format!("scene.shapes[{order}]"));
    world.spawn((Order(order), path, Mesh { data, ..Mesh::default() }))
}

/// The arrays of a world's shapes.
fn arrays(world: &mut World) -> Result<Arrays> {
    let instances = placement::run(world, DVec3::ZERO);
    let settings = staging::settings("scene.json".as_ref(), 0, &Lighting::default());
    let precision = Precision::default();
    let (origin, cameras, visible) = (DVec3::ZERO, Vec::new(), Visible::new(1.0, 1.0));
    let frame = Frame { settings, precision, origin, cameras, visible };
    run(world, &frame, instances, false)
}

#[test]
fn several_meshes_stand_one_behind_the_other() {
    // An empty mesh and a triangle between them, and one in the place of the first.
    for empty_first in [false, true] {
        let mut world = World::new();
        let mut meshes = vec![strip(40_000), MeshData::default(), strip(70_000)];
        if empty_first {
            meshes.insert(
                0,
                MeshData { positions: vec![Vec3::ONE; 7].into(), ..MeshData::default() },
            );
        }
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
        world.spawn((Order(2), JsonPath(String::new()), Triangle { points }));
        for (order, mesh) in [0, 1, 3, 4].into_iter().zip(meshes.clone()) {
            spawn(&mut world, order, mesh);
        }
        let output = arrays(&mut world).unwrap();
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        let as_mesh = MeshData {
            positions: points.map(|p| p.as_vec3()).to_vec().into(),
            triangles: vec![[0, 1, 2]].into(),
            ..MeshData::default()
        };
        meshes.insert(2, as_mesh);
        for mesh in meshes {
            let before = positions.len() as u32;
            positions.extend(&mesh.positions);
            triangles.extend(mesh.triangles.into_iter().map(|t| t.map(|v| v + before)));
        }
        assert_eq!(output.geometry.positions, positions);
        assert_eq!(output.geometry.triangles, triangles);
        assert_eq!(output.geometry.positions.capacity(), positions.len(), "set aside once");
        assert_eq!(output.geometry.triangles.capacity(), triangles.len(), "set aside once");
        let ends: Vec<u32> = world.query::<&Shape>().iter().map(|s| s.primitives.end).collect();
        assert_eq!(ends.last(), Some(&(triangles.len() as u32)));
    }
}

#[test]
fn a_transform_carries_every_position_in_place() {
    let (mut world, data) = (World::new(), strip(60_000));
    let (place, before) = (data.positions.as_ptr(), data.positions.to_vec());
    let transform = DAffine3::from_mat3_translation(
        DMat3::from_diagonal(DVec3::new(2.0, -1.0, 3.0)),
        DVec3::ONE,
    );
    let entity = spawn(&mut world, 0, data);
    world.insert_one(entity, Transform(transform)).unwrap();
    let positions = arrays(&mut world).unwrap().geometry.positions;
    assert_eq!(positions.as_ptr(), place);
    let right = |p: &Vec3| transform.transform_point3(p.as_dvec3()).as_vec3();
    assert_eq!(positions, before.iter().map(right).collect::<Vec<_>>());
}

#[test]
fn the_first_position_moved_too_far_is_reported() {
    let (mut world, mut data) = (World::new(), strip(60_000));
    data.positions[40_000].x = MAX_COORDINATE / 2.0;
    data.positions[50_000].x = MAX_COORDINATE;
    let entity = spawn(&mut world, 0, data);
    world.insert_one(entity, Transform(DAffine3::from_scale(DVec3::splat(4.0)))).unwrap();
    let error = arrays(&mut world).unwrap_err().to_string();
    let value = format!("found a coordinate of {:e}", f64::from(MAX_COORDINATE) * 2.0);
    assert!(
        error.starts_with("scene.json: scene.shapes[0].transform: ") && error.contains(&value),
        "{error}"
    );
}

#[test]
fn attributes_that_nothing_reads_are_dropped() {
    let mut world = World::new();
    let mut data = strip(10);
    data.normals = Some(Attribute { values: vec![Vec3::Z; 12].into(), indices: None });
    spawn(&mut world, 0, data);
    let output = arrays(&mut world).unwrap();
    assert!(output.meshes.is_empty() && world.query::<&Shape>().iter().all(|shape| !shape.smooth));
}
