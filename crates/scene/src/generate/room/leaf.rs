//! Leaves of plants.

use glam::DVec3;

use super::random::Random;

/// The triangles of a leaf.
pub(super) const LEAF_TRIANGLES: u64 = 4;

/// A leaf of four triangles, folded along its middle.
pub(super) struct Leaf {
    /// Where it grows.
    base: DVec3,
    /// From there to its tip.
    along: DVec3,
    /// From its middle to its right edge.
    across: DVec3,
    /// From the level of its middle to that of its edges.
    fold: DVec3,
}

impl Leaf {
    /// The corners of its triangle number `part`, the last one twice.
    pub(super) fn triangle(&self, part: u64) -> [DVec3; 4] {
        let middle = self.base + self.along * 0.45;
        let tip = self.base + self.along - self.fold;
        let [right, left] = [self.across, -self.across].map(|side| middle + side + self.fold);
        let [a, b, c] = match part {
            0 => [self.base, right, middle],
            1 => [self.base, middle, left],
            2 => [middle, right, tip],
            _ => [middle, tip, left],
        };
        [a, b, c, c]
    }
}

/// A leaf from `base` along `way`, which droops by a share `droop` of its length.
pub(super) fn leaf(
    base: DVec3,
    way: DVec3,
    [length, width]: [f64; 2],
    droop: f64,
    random: &mut Random,
) -> Leaf {
    let along = (way - DVec3::Y * droop).normalize();
    let across = along.cross(random.direction()).normalize();
    let fold = across.cross(along) * (width * 0.3);
    Leaf { base, along: along * length, across: across * (width / 2.0), fold }
}
