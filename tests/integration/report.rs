//! Tests of reports: what is measured, compared and shown.

mod bench;
mod effects;
mod page;
mod plot;
mod store;
