//! Meshes in several places.

use std::sync::Arc;

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use wavecrest_api::glam::{DAffine3, DMat4, DVec3, Vec3};
use wavecrest_api::{self as api, Aabb, Geometry, Instance, MAX_COORDINATE};

use super::base::Error;
use super::shapes::{Shapes, build};

/// The distinct meshes in the places of instances: for each the number of its mesh, and its transform, of which last
/// rows are left out.
#[pyfunction]
pub(crate) fn scene(
    py: Python<'_>,
    meshes: Vec<Py<Shapes>>,
    instances: Vec<(u32, PyReadonlyArray2<'_, f64>)>,
    bvh: Option<&str>,
) -> PyResult<Shapes> {
    let mut scene = Geometry::default();
    for mesh in &meshes {
        let Geometry { positions, triangles, .. } = mesh.get().accel.geometry();
        let (positions, triangles) = (positions.clone(), triangles.clone());
        scene.prototypes.push(Geometry { positions, triangles, ..Geometry::default() });
    }
    let (mut origin, mut first, mut places) = (DVec3::ZERO, 0_u32, Vec::new());
    for (number, (mesh, place)) in instances.iter().enumerate() {
        let wrong = |what| Err(Error::new_err(format!("instances[{number}]: {what}")));
        let Geometry { positions, triangles, .. } = &scene.prototypes[*mesh as usize];
        let place = DAffine3::from_mat4(DMat4::from_cols_slice(place.as_slice()?).transpose());
        let to_scene = place * DAffine3::from_translation(meshes[*mesh as usize].get().origin);
        if number == 0 {
            let vertex = positions.first().map_or(DVec3::ZERO, |vertex| vertex.as_dvec3());
            origin = api::mesh::origin(to_scene.transform_point3(vertex));
        }
        let to_scene = DAffine3::from_translation(-origin) * to_scene;
        let bounds = positions.iter().map(|&p| Aabb::around([p])).fold(Aabb::EMPTY, Aabb::union);
        let instance = Instance::new(*mesh, first, to_scene, &bounds);
        let limit = Vec3::splat(MAX_COORDINATE);
        let within = |corner: Vec3| corner.abs().cmple(limit).all();
        let Aabb { low, high } = instance.bounds(&[bounds]);
        let fits = positions.is_empty() || within(low) && within(high);
        if !(fits && to_scene.inverse().is_finite()) {
            return wrong("the transform is singular, or moves the mesh beyond 2^40");
        }
        places.push(place);
        first = match first.checked_add(triangles.len() as u32) {
            Some(next) if next < api::NO_PRIMITIVE => next,
            _ => return wrong("there are more than 2^32 - 2 faces"),
        };
        scene.instances.push(instance);
    }
    let corners = meshes.iter().map(|mesh| Arc::clone(&mesh.get().meshes[0])).collect();
    let accel = build(py, scene, bvh)?;
    Ok(Shapes { accel, origin, meshes: corners, places })
}
