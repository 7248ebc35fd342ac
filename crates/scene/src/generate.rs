//! Generated meshes: of any size, the same on every machine, and free of any licence, for tests,
//! benchmarks and trials.
//!
//! A model is a [`Surface`](surface::Surface): a pure function from the number of a vertex to its
//! position, and one from the number of a triangle to its three vertices. Vertices are independent,
//! so any thread can make any part of a mesh, and [`write_ply`] streams tens of millions of
//! triangles through a few megabytes of memory.
//!
//! A mesh depends only on its [`Recipe`]. Positions are computed in 64-bit floats by `+ - * /`,
//! square roots and the functions of the `libm` crate, and rounded to 32 bits at the end, so the
//! bits are equal on every machine and for every number of threads.

mod knot;
mod noise;
mod ply;
mod recipe;
mod sphere;
mod surface;
mod terrain;
#[cfg(test)]
mod tests;

use crate::mesh::MeshData;
use wavecrest_base::error::Result;
use wavecrest_base::parallel;

pub use ply::{Written, write_ply};
pub use recipe::{MOST_TRIANGLES, Model, Recipe};

/// The mesh of a recipe in memory, with the order and bits that [`write_ply`] writes.
///
/// # Errors
/// If the requested number of triangles or the displacement is outside the model's range.
pub fn mesh(recipe: &Recipe) -> Result<MeshData> {
    let surface = recipe.surface()?;
    let positions = each(surface.vertices(), |v| surface.position(v).as_vec3());
    let triangles = each(recipe.grid_triangles(), |t| surface.triangle(t));
    let normals = || each(surface.vertices(), |v| surface.normal(v).as_vec3()).into();
    let normals = recipe.normals.then(normals);
    Ok(MeshData {
        positions: positions.into(),
        triangles: triangles.into(),
        normals,
        ..MeshData::default()
    })
}

/// `item` of 0, 1, ... `count` - 1, computed in parallel and kept in order.
fn each<T: Clone + Default + Send>(count: u64, item: impl Fn(u64) -> T + Sync + Send) -> Vec<T> {
    let mut items = vec![T::default(); count as usize];
    parallel::each_mut(&mut items, |i, into| *into = item(i as u64));
    items
}
