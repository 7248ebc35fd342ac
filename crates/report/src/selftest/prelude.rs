//! What several files of cases use.

pub(super) use glam::{DVec3, Vec3};
pub(super) use rayon::prelude::*;
pub(super) use wavecrest_base::parallel;

pub(super) use super::aim::met;
pub(super) use super::case::{Count, Effort, InputRng, Outcome};
pub(super) use super::errors::ulp;
pub(super) use super::shapes::{add_sheet, add_triangle, corners, of_triangles};
pub(super) use super::world::{ALL_HIT, ALL_MISS, MIXED, World, hash};
pub(super) use wavecrest_core::accel::build::Preset;
pub(super) use wavecrest_core::accel::{Accel, Hit};
pub(super) use wavecrest_core::geometry::Geometry;
pub(super) use wavecrest_core::kernels::precision::Precision;
pub(super) use wavecrest_core::kernels::quad::halves;
pub(super) use wavecrest_core::math::float::{normalize, offset_origin};
pub(super) use wavecrest_core::math::ray::Ray;
