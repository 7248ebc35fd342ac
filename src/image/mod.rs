//! Images: what a render fills, how it is written, and how two are compared.
