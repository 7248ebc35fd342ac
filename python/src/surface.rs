//! Queries of shapes, and what is known of the surface at a hit.

use numpy::PyArrayMethods;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavecrest_api::Hit;
use wavecrest_api::glam::DVec3;
use wavecrest_api::memory::reserve;

use super::exception;
use super::given::{Column, Given, column, in_stretches, table};
use super::rays::{Found, Rays, block};
use super::shapes::{Face, Shapes};

impl Shapes {
    /// The closest hits: faces and distances.
    pub(crate) fn closest<'py>(
        &self,
        given: &Given<'py>,
    ) -> PyResult<(Column<'py, i64>, Bound<'py, PyAny>)> {
        match given.rays(self)?.is_single {
            true => self.closest_as(given, |t| t as f32),
            false => self.closest_as(given, |t| t),
        }
    }

    fn closest_as<'py, T: numpy::Element + Send>(
        &self,
        given: &Given<'py>,
        of: impl Fn(f64) -> T + Sync,
    ) -> PyResult<(Column<'py, i64>, Bound<'py, PyAny>)> {
        let rays = given.rays(self)?;
        let faces = column(given.py, "empty", rays.count)?;
        let distances = column(given.py, "empty", rays.count)?;
        let (mut into, mut at) = (faces.readwrite(), distances.readwrite());
        let (into, at) = (into.as_slice_mut()?, at.as_slice_mut()?);
        in_stretches(given.py, rays.count, |part| {
            let count = block(&part);
            let (into, at) = (&mut into[part.clone()], &mut at[part.clone()]);
            let blocks = into.chunks_mut(count).zip(at.chunks_mut(count));
            rays.closest(
                part,
                blocks.map(|(into, at)| into.iter_mut().zip(at)),
                |found, (face, t)| {
                    (*face, *t) = (number(found), of(rays.distance(found)));
                },
            );
            Ok(())
        })?;
        Ok((faces, distances.into_any()))
    }

    pub(crate) fn any<'py>(&self, given: &Given<'py>) -> PyResult<Column<'py, bool>> {
        self.answers(given, |rays, part, found| rays.any(part, found))
    }

    /// The answer of a query for each ray.
    pub(crate) fn answers<'py>(
        &self,
        given: &Given<'py>,
        query: impl Fn(&Rays<'_>, std::ops::Range<usize>, &mut [bool]) + Sync,
    ) -> PyResult<Column<'py, bool>> {
        let rays = given.rays(self)?;
        // Bytes other than 0 and 1 are no bools, even before they are written.
        let answers = column(given.py, "zeros", rays.count)?;
        let mut into = answers.readwrite();
        let into = into.as_slice_mut()?;
        in_stretches(given.py, rays.count, |part| {
            query(&rays, part.clone(), &mut into[part]);
            Ok(())
        })?;
        Ok(answers)
    }

    /// Crossings, for each ray at most this many.
    pub(crate) fn all(&self, given: &Given<'_>, most: usize) -> PyResult<Vec<Found>> {
        let rays = given.rays(self)?;
        let mut found = Vec::new();
        in_stretches(given.py, rays.count, |part| rays.all(part, most, &mut found))?;
        Ok(found)
    }

    /// The closest hit or the miss of each ray.
    pub(crate) fn first(&self, given: &Given<'_>) -> PyResult<Vec<Found>> {
        let rays = given.rays(self)?;
        let mut found = reserve(rays.count, "the hits").map_err(|e| exception(&e))?;
        found.resize(rays.count, Found::of(0, Hit::MISS));
        in_stretches(given.py, rays.count, |part| {
            let blocks = found[part.clone()].chunks_mut(block(&part));
            rays.closest(part, blocks.map(|block| block.iter_mut()), |found, into| *into = found);
            Ok(())
        })?;
        Ok(found)
    }

    /// The closest hits with what is known of the surface there, as arrays by name; with the numbers of mesh
    /// and instance if there are several.
    pub(crate) fn cast<'py>(
        &self,
        given: Given<'py>,
        several: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let given = given.in_double();
        let (py, rays, found) = (given.py, given.rays(self)?, self.first(&given)?);
        let arrays = PyDict::new(py);
        let count = found.len();
        let hit = |i: usize| Some(found[i]).filter(|found| !found.is_miss());
        let face = |i| hit(i).map(|found| self.face(found.primitive));
        let index = |number: Option<usize>| [number.map_or(-1, |number| number as i64)];
        let at = |i| hit(i).map(|found| Surface::new(self, &rays, found));
        let vector = |v: Option<DVec3>| v.unwrap_or(DVec3::NAN).to_array();
        let add = |name, array| arrays.set_item(name, array);
        add("faces", table(py, count, |i| index(face(i).map(|face| face.number)))?)?;
        if several {
            add("geometries", table(py, count, |i| index(face(i).map(|face| face.mesh)))?)?;
            add("instances", table(py, count, |i| index(face(i).and_then(|face| face.instance)))?)?;
        }
        add("distances", table(py, count, |i| [rays.distance(found[i])])?)?;
        add("locations", table(py, count, |i| vector(hit(i).map(|found| rays.place(found))))?)?;
        let weights = |i| at(i).map_or([f64::NAN; 3], |at| at.weights);
        add("barycentrics", table(py, count, weights)?)?;
        add("normals", table(py, count, |i| vector(at(i).map(|at| at.normal)))?)?;
        let shading = |at: Surface<'_>| self.normal(at.face, at.weights).unwrap_or(at.normal);
        add("shading_normals", table(py, count, |i| vector(at(i).map(shading)))?)?;
        if self.meshes.iter().any(|mesh| mesh.uvs.is_some()) {
            let uv = |at: Surface<'_>| at.face.uv(at.weights);
            add("uvs", table(py, count, |i| at(i).and_then(uv).unwrap_or([f64::NAN; 2]))?)?;
        }
        Ok(arrays)
    }
}

/// The number of the primitive that is found, or -1.
pub(crate) fn number(found: Found) -> i64 {
    if found.is_miss() { -1 } else { found.primitive.into() }
}

/// A place on a face.
struct Surface<'a> {
    face: Face<'a>,
    /// Its barycentric coordinates.
    weights: [f64; 3],
    /// The unit normal of the face, on the side from which its corners run counter-clockwise.
    normal: DVec3,
}

impl<'a> Surface<'a> {
    fn new(shapes: &'a Shapes, rays: &Rays<'_>, found: Found) -> Self {
        let face = shapes.face(found.primitive);
        let [a, b, c] = shapes.corners(face);
        let (u, v, p) = (b - a, c - a, rays.place(found) - a);
        let normal = u.cross(v);
        let area = normal.length_squared();
        let [second, third] = [p.cross(v), u.cross(p)].map(|part| part.dot(normal) / area);
        Self { face, weights: [1.0 - second - third, second, third], normal: normal.normalize() }
    }
}
