//! Images: writing and reading, comparison, layers, and renders in parts.
//!
//! * [`metadata`]: how an image was made, and further channels of a file.
//! * [`mod@write`]: writes a film as a PPM, PNG, JPEG, EXR or PFM file, atomically.
//! * [`decoder`]: decoders of image files, whose headers are not trusted.
//! * [`mod@read`]: reads an image as a film.
//! * [`mod@compare`]: differences between two films, as numbers.
//! * [`mod@flip`]: the perceived difference between two films.
//! * [`mod@error_map`]: images of differences, with the colours of [`colormap`].
//! * [`aov`]: layers other than colour.
//! * [`animation`]: animated images.
//! * [`look`]: images for inspection: normals, depth, edges.
//! * `camera_rays`: the pass that gathers both.
//! * [`farm`]: images rendered in parts.
//! * `color`: colour spaces.
//! * `transfer`: from linear values to 8-bit levels.
//! * `netpbm`: the byte layouts of PPM and PFM.
//! * `openexr`: colours and further channels as EXR.

pub mod animation;
pub mod aov;
mod camera_rays;
mod color;
pub mod colormap;
pub mod compare;
pub mod decoder;
pub mod error_map;
pub mod farm;
pub mod flip;
pub mod look;
pub mod metadata;
mod netpbm;
mod openexr;
pub mod read;
mod transfer;
pub mod write;

#[cfg(test)]
#[path = "../../../tests/approved.rs"]
mod approved;
