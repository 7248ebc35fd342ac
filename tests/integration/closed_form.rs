//! Closed forms: images agree with formulas worked out here, in double precision, from the
//! definition of the scene format. Nothing here comes from the renderer's own arithmetic.

// What point lights, ambient light, shadows and mirrors add up to.
mod lighting;

// What area lights average to, and how they are seen.
mod area;

// Silhouettes, angles of view, lenses.
mod camera;

// What is all around.
mod environment;

// How much of the ambient light arrives.
mod ambient;

// What goes through surfaces.
mod transparency;

// Where surfaces touch, overlap or nest.
mod interfaces;

// Textures, transforms, sides of surfaces, units of length.
mod surfaces;

use std::f64::consts::PI;

use glam::DVec3;
use serde_json::{Value, json};

use crate::support::with;

/// The material of the reference.
#[derive(Clone, Copy)]
struct Phong {
    ks: f64,
    kd: f64,
    exponent: f64,
    color: [f64; 3],
}

impl Phong {
    fn json(self) -> Value {
        json!({"ks": self.ks, "kd": self.kd, "specularexponent": self.exponent,
               "diffusecolor": self.color})
    }
}

/// The light of the reference, at one point.
#[derive(Clone, Copy)]
struct Lamp {
    position: DVec3,
    intensity: f64,
    color: [f64; 3],
    falloff: &'static str,
}

impl Lamp {
    fn json(self) -> Value {
        let light = json!({"type": "pointlight", "intensity": self.intensity,
                           "position": self.position.to_array(), "color": self.color});
        with(light, "falloff", self.falloff)
    }

    /// The factor at a distance, as the format defines it.
    fn strength(self, distance: f64) -> f64 {
        self.intensity
            * match self.falloff {
                "linear" => 1.0 / (4.0 * PI * distance),
                "inverse-square" => 1.0 / (4.0 * PI * distance * distance),
                _ => 1.0,
            }
    }

    /// What a point that it reaches adds to the ambient part: the format's Blinn-Phong sum.
    fn reflected(self, material: Phong, point: DVec3, normal: DVec3, view: DVec3) -> [f64; 3] {
        let to_light = (self.position - point).normalize();
        let half = (to_light + view).normalize();
        let diffuse = material.kd * normal.dot(to_light).max(0.0);
        let highlight = material.ks * normal.dot(half).max(0.0).powf(material.exponent);
        let strength = self.strength(self.position.distance(point));
        let channel =
            |i: usize| (diffuse * material.color[i] + highlight) * strength * self.color[i];
        [0, 1, 2].map(channel)
    }
}

/// The camera of the reference: at (0, 0, `distance`), looking at the origin, +y up.
#[derive(Clone, Copy)]
struct Eye {
    size: [u32; 2],
    fov: f64,
    distance: f64,
}

impl Eye {
    fn json(self) -> Value {
        crate::support::pinhole(self.size, self.fov, self.distance)
    }

    fn origin(self) -> DVec3 {
        DVec3::Z * self.distance
    }

    /// The ray through the centre of a pixel, with z = -1: the angle spans the shorter side.
    fn direction(self, x: u32, y: u32) -> DVec3 {
        let [width, height] = self.size.map(f64::from);
        let scale = 2.0 * (self.fov.to_radians() / 2.0).tan() / width.min(height);
        let across = (f64::from(x) + 0.5 - width / 2.0) * scale;
        let up = (height / 2.0 - f64::from(y) - 0.5) * scale;
        DVec3::new(across, up, -1.0)
    }

    /// Where the pixel's ray meets the plane z = `z`.
    fn on_wall(self, x: u32, y: u32, z: f64) -> DVec3 {
        self.origin() + self.direction(x, y) * (self.distance - z)
    }
}

/// The sum of two colours.
fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

/// A colour, so many times.
fn times(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|value| value * factor)
}
