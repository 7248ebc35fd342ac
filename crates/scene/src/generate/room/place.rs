//! Places of furniture.

use glam::DVec3;

/// A frame: the origin and the three axes of a space, in the room.
#[derive(Clone, Copy)]
pub(super) struct Place {
    origin: DVec3,
    axes: [DVec3; 3],
}

impl Place {
    /// The room's axes at a point.
    pub(super) fn at(x: f64, y: f64, z: f64) -> Self {
        Self { origin: DVec3::new(x, y, z), axes: DVec3::AXES }
    }

    /// A point of this space, in the room.
    pub(super) fn point(&self, p: DVec3) -> DVec3 {
        self.origin + self.direction(p)
    }

    /// A direction of this space, in the room.
    pub(super) fn direction(&self, d: DVec3) -> DVec3 {
        self.axes[0] * d.x + self.axes[1] * d.y + self.axes[2] * d.z
    }

    /// Moved along its own axes.
    pub(super) fn moved(self, x: f64, y: f64, z: f64) -> Self {
        Self { origin: self.point(DVec3::new(x, y, z)), ..self }
    }

    /// Scaled in its own space.
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { axes: self.axes.map(|axis| axis * factor), ..self }
    }

    /// Turned about its own x axis, in degrees: y towards z.
    pub(super) fn pitched(self, degrees: f64) -> Self {
        self.rotated(1, 2, degrees)
    }

    /// Turned about its own y axis, in degrees: z towards x.
    pub(super) fn turned(self, degrees: f64) -> Self {
        self.rotated(2, 0, degrees)
    }

    /// Turned about its own z axis, in degrees: x towards y.
    pub(super) fn rolled(self, degrees: f64) -> Self {
        self.rotated(0, 1, degrees)
    }

    /// Turned so that axis `from` goes towards axis `to`.
    fn rotated(mut self, from: usize, to: usize, degrees: f64) -> Self {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let (a, b) = (self.axes[from], self.axes[to]);
        self.axes[from] = a * cos + b * sin;
        self.axes[to] = b * cos - a * sin;
        self
    }
}
