//! Images: what a render fills, how it is written, and how two are compared.
//!
//! * [`metadata`]: what a file says of how its image was made, and further channels.
//! * [`mod@write`]: a film becomes a PPM, PNG, EXR or PFM file, whole or not at all.
//! * [`mod@read`]: any picture becomes a film again.
//! * [`mod@compare`]: by how much two films differ, as numbers.
//! * [`mod@flip`]: by how much they seem to differ to one who looks at them in turn.
//! * [`mod@error_map`]: pictures of where they differ, with the colours of [`colormap`].
//! * [`aov`]: layers beside the colours.
//! * [`animation`]: images that move.
//! * [`look`]: pictures for looking closer: normals, depth, edges.
//! * `camera_rays`: what both are gathered from.
//! * [`farm`]: images that are made in parts.
//! * `color`: spaces of colour.
//! * `transfer`: from linear values to 8-bit levels.
//! * `idat`: the pixels of a PNG, compressed in bands.
//! * `netpbm`: the byte layouts of PPM and PFM, which are simple enough to be our own.
//! * `openexr`: colours and further channels as an EXR.

pub mod animation;
pub mod aov;
mod camera_rays;
mod color;
pub mod colormap;
pub mod compare;
pub mod error_map;
pub mod farm;
pub mod flip;
mod idat;
pub mod look;
pub mod metadata;
mod netpbm;
mod openexr;
pub mod read;
mod transfer;
pub mod write;
