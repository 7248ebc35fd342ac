//! Files of images: what is written is read again, and what is damaged is refused.

mod animation;
mod openexr;
mod read;
mod strangers;
mod write;
