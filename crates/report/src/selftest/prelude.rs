//! What several cases use.

pub(super) use glam::{DVec3, Vec2, Vec3};
pub(super) use rayon::prelude::*;
pub(super) use serde_json::{Value, json};

pub(super) use super::aim::met;
pub(super) use super::case::{Count, Effort, Outcome};
pub(super) use super::errors::ulp;
pub(super) use super::numbers::Numbers;
pub(super) use super::parts::{ExpectedHit, Picture, World};
pub(super) use super::scenes::{self, Eye};
pub(super) use super::shapes::{add_sheet, add_triangle, convex, corners, of_triangles};
pub(super) use wavecrest_base::error::{Error, ErrorKind, Result};
pub(super) use wavecrest_core::accel::build::Preset;
pub(super) use wavecrest_core::accel::{Accel, Hit};
pub(super) use wavecrest_core::geometry::Geometry;
pub(super) use wavecrest_core::kernels::precision::Precision;
pub(super) use wavecrest_core::kernels::quad::halves;
pub(super) use wavecrest_core::math::float::{normalize, offset_origin};
pub(super) use wavecrest_core::math::random::Stream;
pub(super) use wavecrest_core::math::ray::Ray;
