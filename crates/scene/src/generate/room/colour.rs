//! The colours of a room: positions in a palette, stored in vertices as texture coordinates.
//!
//! `scenes/large/room.pnm` is such a palette, a row with one texel for each colour.

use glam::Vec2;

/// The number of a texel of the palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Colour(u8);

impl Colour {
    pub(super) const WALL: Self = Self(0);
    pub(super) const CEILING: Self = Self(1);
    pub(super) const FLOOR: Self = Self(2);
    pub(super) const PAINT: Self = Self(3);
    pub(super) const OAK: Self = Self(4);
    pub(super) const WALNUT: Self = Self(5);
    pub(super) const PAPER: Self = Self(6);
    pub(super) const CHINA: Self = Self(7);
    pub(super) const GLAZE: Self = Self(8);
    pub(super) const CLAY: Self = Self(9);
    pub(super) const BRASS: Self = Self(10);
    pub(super) const LINEN: Self = Self(11);
    pub(super) const CURTAIN: Self = Self(12);
    pub(super) const RUG: Self = Self(13);
    pub(super) const RUG_BORDER: Self = Self(14);
    pub(super) const SOFA: Self = Self(15);
    pub(super) const PILLOW: Self = Self(16);
    pub(super) const THROW: Self = Self(17);
    pub(super) const LEAF: Self = Self(18);
    pub(super) const LEAF_DARK: Self = Self(19);
    pub(super) const LEAF_PALE: Self = Self(20);
    pub(super) const STEM: Self = Self(21);
    pub(super) const SOIL: Self = Self(22);
    pub(super) const PETAL: Self = Self(23);
    pub(super) const APPLE: Self = Self(24);
    pub(super) const LEMON: Self = Self(25);
    /// Spines of books, and pictures.
    pub(super) const PRINTS: [Self; 7] =
        [Self(26), Self(27), Self(28), Self(29), Self(30), Self(31), Self(32)];
    /// The number of colours.
    pub(super) const COUNT: u8 = 33;

    /// The centre of its texel.
    pub(super) fn uv(self) -> Vec2 {
        Vec2::new((f32::from(self.0) + 0.5) / f32::from(Self::COUNT), 0.5)
    }
}
