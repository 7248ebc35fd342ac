//! Tests of what is private to the loader: the predicates on corners.

#[path = "../../../tests/approved.rs"]
pub(crate) mod approved;
mod corners;
