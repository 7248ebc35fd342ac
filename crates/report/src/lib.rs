//! Reports on renders: benchmarks, sweeps of error against time, hard cases, statistics, pages and charts.

pub mod accuracy;
pub mod bench;
pub mod effects;
pub mod expected;
pub mod files;
mod markup;
pub mod measure;
pub mod page;
pub mod plot;
pub mod ray_file;
pub mod selftest;
pub mod statistics;
pub mod summary;
pub mod text;
