//! What most cases use.

pub(super) use glam::{DVec3, Vec3};
pub(super) use serde_json::{Value, json};

pub(super) use super::case::{Effort, Outcome};
pub(super) use super::numbers::Numbers;
pub(super) use super::parts::{Expected, Picture, Refusal, World};
pub(super) use super::scenes::{self, Eye};
pub(super) use super::ways::Tests;
pub(super) use wavecrest_core::accel::build::Preset;
pub(super) use wavecrest_core::accel::{Accel, Hit};
pub(super) use wavecrest_core::geometry::Geometry;
pub(super) use wavecrest_core::math::ray::Ray;
