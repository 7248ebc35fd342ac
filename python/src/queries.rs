//! Queries of shapes, and what is known of the surface at a hit.

use std::convert::Infallible;

use numpy::{Element, PyArrayMethods};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use wavecrest_api::glam::DVec3;
use wavecrest_api::rays_at_once;

use super::arrays::{Column, Points, column, table};
use super::base::{Any, in_stretches};
use super::rays::{RayHit, Rays, Worker};
use super::shapes::Shapes;

/// Rays: origins, directions (none for points), t_min and t_max, and whether all numbers are of single precision. One
/// origin or direction is that of all.
#[derive(FromPyObject)]
struct RayArrays<'py>(Points<'py>, Option<Points<'py>>, [f64; 2], bool);

/// A truth for each ray.
type Bools<'py> = PyResult<Column<'py, bool>>;

/// Faces and distances.
type Closest<'py> = (Column<'py, i64>, Any<'py>);

impl RayArrays<'_> {
    fn rays<'a>(&'a self, shapes: &'a Shapes) -> PyResult<Rays<'a>> {
        let Self(origins, directions, range, is_single) = self;
        let (origins, range, is_single) = (origins.rows()?, *range, *is_single);
        let directions = directions.as_ref().map(Points::rows).transpose()?;
        let count = match (origins.len(), directions) {
            (1, Some(directions)) => directions.len(),
            (count, _) => count,
        };
        Ok(Rays { shapes, count, origins, directions, range, is_single })
    }
}

#[pymethods]
impl Shapes {
    /// The closest hits: faces and distances.
    fn closest<'py>(&self, py: Python<'py>, rays: RayArrays<'py>) -> PyResult<Closest<'py>> {
        let rays = rays.rays(self)?;
        match rays.is_single {
            true => closest(py, &rays, |t| t as f32),
            false => closest(py, &rays, |t| t),
        }
    }

    /// Whether rays hit anything.
    fn any<'py>(&self, py: Python<'py>, rays: RayArrays<'py>) -> Bools<'py> {
        rays.rays(self)?.answers(py, |Worker { traversal, rays, .. }, answers| {
            self.accel.occluded_of(&rays[..], answers, traversal);
        })
    }

    /// Whether points are inside, by parity or if they are `wound`.
    fn contains<'py>(&self, py: Python<'py>, rays: RayArrays<'py>, wound: bool) -> Bools<'py> {
        let given = rays.rays(self)?;
        given.answers(py, |worker, answers| {
            let Ok(()) = worker.cross(&self.accel, |index, ray, hits| {
                answers[index] = given.is_inside(ray, hits, wound);
                Ok::<_, Infallible>(())
            });
        })
    }

    /// What the rays cross, for each at most `max_hits`; or without `every`, the closest hit of each, and its miss if they
    /// are `with_misses`. Returns the `columns` with these names.
    fn hits<'py>(
        &self,
        py: Python<'py>,
        rays: RayArrays<'py>,
        every: bool,
        with_misses: bool,
        max_hits: Option<usize>,
        columns: Vec<String>,
    ) -> PyResult<Vec<Any<'py>>> {
        let rays = rays.rays(self)?;
        let most = max_hits.unwrap_or(usize::MAX);
        let mut hits = if every { rays.all(py, most)? } else { rays.first(py)? };
        if !with_misses {
            hits.retain(|hit| !hit.is_miss());
        }
        columns.iter().map(|name| self.column(py, &rays, &hits, name)).collect()
    }
}

impl Shapes {
    /// What is known of hits by this name: an array with a row for each.
    fn column<'py>(
        &self,
        py: Python<'py>,
        rays: &Rays<'_>,
        hits: &[RayHit],
        name: &str,
    ) -> PyResult<Any<'py>> {
        let count = hits.len();
        let hit = |i: usize| Some(hits[i]).filter(|hit| !hit.is_miss());
        let face = |i| hit(i).map(|hit| self.face(hit.primitive));
        let index = |number: Option<usize>| [number.map_or(-1, |number| number as i64)];
        let vector = |v: Option<DVec3>| v.unwrap_or(DVec3::NAN).to_array();
        let surface = |i, k: usize| vector(hit(i).map(|hit| self.surface(rays, hit)[k]));
        match name {
            "rays" => table(py, count, |i| [hits[i].ray as i64]),
            "faces" => table(py, count, |i| index(face(i).map(|face| face.number))),
            "instances" => table(py, count, |i| index(face(i).and_then(|face| face.instance))),
            "distances" => table(py, count, |i| [rays.distance(hits[i])]),
            "locations" => table(py, count, |i| vector(hit(i).map(|hit| rays.place(hit)))),
            "barycentrics" => table(py, count, |i| surface(i, 0)),
            "normals" => table(py, count, |i| surface(i, 1)),
            _ => Err(PyKeyError::new_err(name.to_owned())),
        }
    }

    /// The barycentric coordinates of a hit, and the unit normal of its face, on the side from which its corners run
    /// counter-clockwise.
    fn surface(&self, rays: &Rays<'_>, hit: RayHit) -> [DVec3; 2] {
        let [a, b, c] = self.corners(self.face(hit.primitive));
        let (u, v, p) = (b - a, c - a, rays.place(hit) - a);
        let normal = u.cross(v);
        let area = normal.length_squared();
        let [second, third] = [p.cross(v), u.cross(p)].map(|part| part.dot(normal) / area);
        [DVec3::new(1.0 - second - third, second, third), normal.normalize()]
    }
}

fn closest<'py, T: Element + Send>(
    py: Python<'py>,
    rays: &Rays<'_>,
    of: impl Fn(f64) -> T + Sync,
) -> PyResult<Closest<'py>> {
    let faces = column(py, "empty", rays.count)?;
    let distances = column(py, "empty", rays.count)?;
    let (mut into, mut at) = (faces.readwrite(), distances.readwrite());
    let (into, at) = (into.as_slice_mut()?, at.as_slice_mut()?);
    in_stretches(py, rays.count, |part| {
        let size = rays_at_once(part.len());
        let (into, at) = (&mut into[part.clone()], &mut at[part.clone()]);
        let blocks = into.chunks_mut(size).zip(at.chunks_mut(size));
        let blocks = blocks.map(|(into, at)| into.iter_mut().zip(at));
        rays.closest(part, blocks, |hit, (face, t)| {
            let number = if hit.is_miss() { -1 } else { hit.primitive.into() };
            (*face, *t) = (number, of(rays.distance(hit)));
        });
    })?;
    Ok((faces, distances.into_any()))
}
