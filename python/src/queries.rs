//! Queries of shapes, and what is known of the surface at a hit.

use std::ops::Range;

use numpy::{Element, PyArrayMethods};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use wavecrest_api::glam::DVec3;
use wavecrest_api::memory::reserve;
use wavecrest_api::{Hit, rays_at_once};

use super::arrays::{Column, Points, column, in_stretches, table};
use super::rays::{Found, Rays};
use super::shapes::Shapes;
use super::{Any, exception, input};

/// Rays: origins, directions (none for points), t_min and t_max, and whether all numbers are of single precision. One
/// origin or direction is that of all.
#[derive(FromPyObject)]
struct Given<'py>(Points<'py>, Option<Points<'py>>, [Option<Any<'py>>; 2], bool);

/// Faces and distances.
type Closest<'py> = (Column<'py, i64>, Any<'py>);

/// An answer for each ray.
type Answers<'py> = PyResult<Column<'py, bool>>;

impl Given<'_> {
    fn rays<'a>(&'a self, shapes: &'a Shapes) -> PyResult<Rays<'a>> {
        let Self(origins, directions, [t_min, t_max], is_single) = self;
        let (origins, is_single) = (origins.rows()?, *is_single);
        let directions = directions.as_ref().map(Points::rows).transpose()?;
        let count = match (origins.len(), directions) {
            (1, Some(directions)) => directions.len(),
            (count, _) => count,
        };
        let end = |key, value: &Option<_>, usual| {
            let what = "a number of at least 0";
            let read = |value| input::fitting(key, what, value, |t: &f64| *t >= 0.0);
            value.as_ref().map_or(Ok(usual), read)
        };
        let range = [end("t_min", t_min, 0.0)?, end("t_max", t_max, f64::INFINITY)?];
        Ok(Rays { shapes, count, origins, directions, range, is_single })
    }
}

#[pymethods]
impl Shapes {
    /// The closest hits: faces and distances.
    fn closest<'py>(&self, py: Python<'py>, rays: Given<'py>) -> PyResult<Closest<'py>> {
        let rays = rays.rays(self)?;
        match rays.is_single {
            true => closest(py, &rays, |t| t as f32),
            false => closest(py, &rays, |t| t),
        }
    }

    /// Whether rays hit anything.
    fn any<'py>(&self, py: Python<'py>, rays: Given<'py>) -> Answers<'py> {
        let rays = rays.rays(self)?;
        answers(py, rays.count, |part, found| rays.any(part, found))
    }

    /// Whether points are inside, by parity or if they are `wound`.
    fn contains<'py>(&self, py: Python<'py>, rays: Given<'py>, wound: bool) -> Answers<'py> {
        let rays = rays.rays(self)?;
        answers(py, rays.count, |part, inside| rays.contains(part, wound, inside))
    }

    /// What the rays cross, for each at most `max_hits`; or without `every`, the closest hit of each, and its miss if they
    /// are `with_misses`. Returns the `columns` with these names.
    fn hits<'py>(
        &self,
        py: Python<'py>,
        rays: Given<'py>,
        every: bool,
        with_misses: bool,
        max_hits: Option<Any<'py>>,
        columns: Vec<String>,
    ) -> PyResult<Vec<Any<'py>>> {
        let rays = rays.rays(self)?;
        let most = max_hits.map(|value| input::given("max_hits", "a whole number", &value));
        let most = most.transpose()?.unwrap_or(usize::MAX);
        let mut found = if every { all(py, &rays, most)? } else { first(py, &rays)? };
        if !with_misses {
            found.retain(|found| !found.is_miss());
        }
        columns.iter().map(|name| self.column(py, &rays, &found, name)).collect()
    }
}

impl Shapes {
    /// What is known of hits by this name: an array with a row for each.
    fn column<'py>(
        &self,
        py: Python<'py>,
        rays: &Rays<'_>,
        found: &[Found],
        name: &str,
    ) -> PyResult<Any<'py>> {
        let count = found.len();
        let hit = |i: usize| Some(found[i]).filter(|found| !found.is_miss());
        let face = |i| hit(i).map(|found| self.face(found.primitive));
        let index = |number: Option<usize>| [number.map_or(-1, |number| number as i64)];
        let vector = |v: Option<DVec3>| v.unwrap_or(DVec3::NAN).to_array();
        let surface = |i, k: usize| vector(hit(i).map(|found| self.surface(rays, found)[k]));
        match name {
            "rays" => table(py, count, |i| [found[i].ray as i64]),
            "faces" => table(py, count, |i| index(face(i).map(|face| face.number))),
            "instances" => table(py, count, |i| index(face(i).and_then(|face| face.instance))),
            "distances" => table(py, count, |i| [rays.distance(found[i])]),
            "locations" => table(py, count, |i| vector(hit(i).map(|found| rays.place(found)))),
            "barycentrics" => table(py, count, |i| surface(i, 0)),
            "normals" => table(py, count, |i| surface(i, 1)),
            _ => Err(PyKeyError::new_err(name.to_owned())),
        }
    }

    /// The barycentric coordinates of a hit, and the unit normal of its face, on the side from which its corners run
    /// counter-clockwise.
    fn surface(&self, rays: &Rays<'_>, found: Found) -> [DVec3; 2] {
        let [a, b, c] = self.corners(self.face(found.primitive));
        let (u, v, p) = (b - a, c - a, rays.place(found) - a);
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
        let count = rays_at_once(part.len());
        let (into, at) = (&mut into[part.clone()], &mut at[part.clone()]);
        let blocks = into.chunks_mut(count).zip(at.chunks_mut(count));
        let blocks = blocks.map(|(into, at)| into.iter_mut().zip(at));
        rays.closest(part, blocks, |found, (face, t)| {
            let number = if found.is_miss() { -1 } else { found.primitive.into() };
            (*face, *t) = (number, of(rays.distance(found)));
        });
        Ok(())
    })?;
    Ok((faces, distances.into_any()))
}

/// The answer of a query for each ray.
fn answers<'py>(
    py: Python<'py>,
    count: usize,
    query: impl Fn(Range<usize>, &mut [bool]) + Sync,
) -> Answers<'py> {
    // Bytes other than 0 and 1 are no bools, even before they are written.
    let answers = column(py, "zeros", count)?;
    let mut into = answers.readwrite();
    let into = into.as_slice_mut()?;
    in_stretches(py, count, |part| {
        query(part.clone(), &mut into[part]);
        Ok(())
    })?;
    Ok(answers)
}

/// Crossings, for each ray at most this many.
fn all(py: Python<'_>, rays: &Rays<'_>, most: usize) -> PyResult<Vec<Found>> {
    let mut found = Vec::new();
    in_stretches(py, rays.count, |part| rays.all(part, most, &mut found))?;
    Ok(found)
}

/// The closest hit or the miss of each ray.
fn first(py: Python<'_>, rays: &Rays<'_>) -> PyResult<Vec<Found>> {
    let mut found = reserve(rays.count, "the hits").map_err(exception)?;
    found.resize(rays.count, Found::of(0, Hit::MISS));
    in_stretches(py, rays.count, |part| {
        let blocks = found[part.clone()].chunks_mut(rays_at_once(part.len()));
        rays.closest(part, blocks.map(|block| block.iter_mut()), |found, into| *into = found);
        Ok(())
    })?;
    Ok(found)
}
