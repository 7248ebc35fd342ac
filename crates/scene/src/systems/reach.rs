//! Which lights add more than their ambient part, and to which surfaces.
//!
//! A light is skipped only if every visible hit on every surface certainly rejects it: because the
//! material reflects none of its colour, because it is behind the visible side of the surface, or
//! because its cone misses the surface. The light's whole extent counts, as its box, and so do the
//! rounding errors of the shading step. In doubt a light reaches.

use glam::{DVec3, Vec3};
use hecs::World;

use super::bounds::wide;
use super::visibility::{Faces, MaterialBound, Source, Visibility};
use crate::components::TextureRef;
use wavecrest_core::geometry::{Geometry, Primitive};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::kernels::disk::Disk;
use wavecrest_core::kernels::light::{Cone, Emitter, Light};
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::kernels::{quad, triangle};
use wavecrest_core::math::float::{UNIT_ROUNDOFF, normalize_f64};
use wavecrest_core::prepared::Shape;

/// How far behind a plane a light must be for all hits to find it there, relative to its distance
/// and the largest coordinate.
///
/// A hit and a point of a light are off by less than 4 roundings of the largest coordinate in each
/// direction (`math::vector::Vector::rounding_error`); the normal, the direction to the light and their
/// product add fewer than 8 roundings of the distance. This is sixteen times their sum.
pub(super) const BEHIND: f64 = 256.0 * UNIT_ROUNDOFF as f64;

/// Largest number of primitives tested for all lights together, and of pairs of a light and a
/// surface. Beyond them, lights count as reaching: nearly all do, and show it at one of the first.
const MOST_TESTS: u64 = 1 << 22;

/// A surface that may receive light: not of a light's own shape.
#[derive(Clone, Copy, Debug)]
struct Receiver<'a> {
    shape: &'a Shape,
    material: &'a Material,
    /// Whether it may have a texture, of any colour.
    textured: bool,
    /// Its visible sides that lights can reach.
    faces: Faces,
}

/// Whether a light adds more than its ambient part to a surface in view, and to any surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Illuminates {
    pub(crate) in_view: bool,
    pub(crate) anywhere: bool,
}

/// Finds out which lights reach surfaces, and which of these they reach.
pub(crate) fn run(world: &World, geometry: &Geometry) {
    let textures = world.view::<&TextureRef>();
    let mut lit = Vec::new();
    let (mut all, mut in_view) = (Vec::new(), Vec::new());
    let mut shapes = world.query::<(&Source, &Shape, &MaterialBound, &mut Visibility)>();
    let shapes = shapes.iter().filter(|(.., visibility)| visibility.is_surface);
    for (source, shape, MaterialBound(material), visibility) in shapes {
        let textured = textures.contains(source.0);
        let receiver = Receiver { shape, material, textured, faces: Faces::lit(shape) };
        all.push(receiver);
        in_view.extend(visibility.faces.map(|faces| Receiver { faces, ..receiver }));
        lit.push(visibility);
    }
    let mut lights = world.query::<(&Light, &mut Illuminates)>();
    let (lights, found): (Vec<_>, Vec<_>) = lights.iter().unzip();
    let reached_in_view = reached(&lights, &in_view, geometry);
    let is_same = |(one, other): (&Receiver<'_>, &Receiver<'_>)| one.faces == other.faces;
    let anywhere = match all.len() == in_view.len() && all.iter().zip(&in_view).all(is_same) {
        true => reached_in_view.clone(),
        false => reached(&lights, &all, geometry),
    };
    let ([lights_in_view, seen], [lights_anywhere, all]) = (reached_in_view, anywhere);
    for (found, (in_view, anywhere)) in
        found.into_iter().zip(lights_in_view.into_iter().zip(lights_anywhere))
    {
        *found = Illuminates { in_view, anywhere };
    }
    let mut seen = seen.into_iter();
    for (visibility, anywhere) in lit.into_iter().zip(all) {
        let is_seen = visibility.faces.is_some();
        visibility.is_lit = if is_seen { seen.next() == Some(true) } else { anywhere };
    }
}

/// For each of `lights`, whether it reaches any of `receivers`, and for each of these, whether any light but ambient
/// light reaches it.
fn reached(lights: &[&Light], receivers: &[Receiver<'_>], geometry: &Geometry) -> [Vec<bool>; 2] {
    let extents: Vec<Extent> = lights.iter().map(|light| Extent::of(&light.emitter)).collect();
    let (mut tests, mut pairs) = (0, 0);
    let mut reaches = |light: usize, receiver: &Receiver<'_>| {
        reflects(receiver, lights[light])
            && is_faced(receiver.shape, receiver.faces, &extents[light], geometry, &mut tests)
    };
    let mut of_light = |light: usize| receivers.iter().any(|receiver| reaches(light, receiver));
    let reaching: Vec<bool> = (0..lights.len()).map(&mut of_light).collect();
    // Ambient light shows nothing but diffuse colour.
    let is_useful =
        |&light: &usize| reaching[light] && lights[light].emitter.ambient_reach().is_none();
    let useful: Vec<usize> = (0..lights.len()).filter(is_useful).collect();
    let of_receiver = |receiver: &Receiver<'_>| {
        useful.iter().any(|&light| {
            pairs += 1;
            pairs > MOST_TESTS || reaches(light, receiver)
        })
    };
    let reached = receivers.iter().map(of_receiver).collect();
    [reaching, reached]
}

/// Whether any of the light's colour is reflected: as in the shading step, a product of zero adds
/// nothing.
fn reflects(receiver: &Receiver<'_>, light: &Light) -> bool {
    let &Material { ks, kd, color, ambient, .. } = receiver.material;
    // Ambient light shows diffuse colour alone, for any kd.
    let is_ambient = light.emitter.ambient_reach().is_some();
    let (ks, kd) = if is_ambient { (0.0, ambient) } else { (ks, kd) };
    // Infinite power adds something, if only a NaN.
    let shines = light.power.cmpgt(Vec3::ZERO);
    let colored = color.cmpgt(Vec3::ZERO) & shines;
    !light.power.is_finite()
        || shines.any() && (ks > 0.0 || kd > 0.0 && (receiver.textured || colored.any()))
}

/// Whether any point of the light may be in front of any point of the shape, on one of these sides.
pub(super) fn is_faced(
    shape: &Shape,
    faces: Faces,
    light: &Extent,
    geometry: &Geometry,
    tests: &mut u64,
) -> bool {
    // Fast precision has no error bounds, so nothing is certain. Whatever has no cone is on one
    // side or the other.
    let is_certain =
        geometry.precision == Precision::Fast || faces.front && faces.back && light.cone.is_none();
    if is_certain || !faces.any() {
        return faces.any();
    }
    shape.primitives.clone().any(|number| {
        *tests += 1;
        *tests > MOST_TESTS || may_face(shape, faces, light, geometry, number)
    })
}

/// Whether no line from a point of these sides of a shape meets the shape again.
pub(super) fn is_convex(shape: &Shape, faces: Faces, geometry: &Geometry) -> bool {
    let mut primitives = shape.primitives.clone();
    let is_bent_to = |height: f64| faces.front && height > 0.0 || faces.back && height < 0.0;
    let (Some(number), None) = (primitives.next(), primitives.next()) else { return false };
    match geometry.primitive(number) {
        Primitive::Triangle(_) => true,
        Primitive::Quad(i) => {
            let [[a, b, c], [.., d]] =
                quad::halves(&geometry.quad(i)).map(|half| half.map(|corner| corner.as_dvec3()));
            let height = (b - a).cross(c - a).dot(d - a);
            !is_bent_to(if shape.flipped { -height } else { height })
        }
        Primitive::Quadric(i) => geometry.quadrics[i].sphere().is_none() || !faces.back,
        Primitive::Instanced(_) => false,
    }
}

/// Whether any of the light may be on one of these sides of the primitive, unless its cone misses
/// it.
fn may_face(shape: &Shape, faces: Faces, light: &Extent, geometry: &Geometry, number: u32) -> bool {
    let may_face = |corners: &[Vec3; 3]| {
        let normal = triangle::normal(corners);
        let front = if shape.flipped { -normal } else { normal };
        light.may_face(faces, front, corners) && !light.misses(corners, 0.0, front)
    };
    match geometry.primitive(number) {
        // In doubt: its points have one more rounding.
        Primitive::Instanced(_) => !geometry.is_degenerate(number),
        // Triangles without area are not hit.
        Primitive::Triangle(i) => {
            !geometry.is_degenerate(number) && may_face(&geometry.triangle(i))
        }
        Primitive::Quad(i) => quad::halves(&geometry.quad(i)).iter().any(may_face),
        Primitive::Quadric(i) => {
            let (center, radius, front) = geometry.quadrics[i].parts();
            let is_faced = if front == Vec3::ZERO {
                // Its far inside faces all that is around it.
                faces.back || !light.is_within(center, radius)
            } else {
                let front = front.as_dvec3();
                let [u, v] = Disk::axes(front).map(|axis| axis.as_vec3() * radius);
                let square = [center - u - v, center + u - v, center + u + v, center - u + v];
                light.may_face(faces, front, &square)
            };
            is_faced && !light.misses(&[center], radius.into(), DVec3::ZERO)
        }
    }
}

/// The extent of a light: the points within `radius` of a box, or a distant patch.
pub(super) struct Extent {
    /// For a distant light, the unit vector towards it.
    center: DVec3,
    half: DVec3,
    /// For a distant light, the sine of its angular radius.
    radius: f64,
    is_distant: bool,
    /// The cone of a spot light.
    cone: Option<Cone>,
}

impl Extent {
    fn of(emitter: &Emitter) -> Self {
        let (center, half, radius) = emitter.extent();
        let is_distant = emitter.is_distant() || emitter.ambient_reach().is_some();
        Self { center, half, radius, is_distant, cone: emitter.cone().copied() }
    }

    /// The origins of a camera's rays.
    pub(super) fn of_pupil(camera: &Camera) -> Self {
        let (center, radius) = camera.pupil();
        Self::around(center, radius)
    }

    fn around(center: DVec3, radius: f64) -> Self {
        Self { center, half: DVec3::ZERO, radius, is_distant: false, cone: None }
    }

    pub(super) fn of_box(bounds: &Aabb) -> Self {
        let [low, high] = wide(*bounds);
        let (center, half) = ((low + high) / 2.0, (high - low) / 2.0);
        Self { half, ..Self::around(center, 0.0) }
    }

    /// Bound on the coordinates of its points.
    fn size(&self) -> f64 {
        (self.center.abs() + self.half).max_element() + self.radius
    }

    /// Bound on the distance of its points from `point`.
    fn farthest(&self, point: DVec3) -> f64 {
        ((self.center - point).abs() + self.half).length() + self.radius
    }

    /// Whether any of it may be on one of these sides of a flat shape through `corners`, whose front
    /// is on the side of the unit vector `front`.
    fn may_face(&self, faces: Faces, front: DVec3, corners: &[Vec3]) -> bool {
        faces.front && !self.is_behind(front, corners)
            || faces.back && !self.is_behind(-front, corners)
    }

    /// Whether all of it is certainly behind a flat shape through `corners`, whose front is on the
    /// side of the unit vector `normal`.
    fn is_behind(&self, normal: DVec3, corners: &[Vec3]) -> bool {
        let reach = normal.abs().dot(self.half) + self.radius;
        if self.is_distant {
            return normal.dot(self.center) + reach < -BEHIND;
        }
        corners.iter().map(|corner| corner.as_dvec3()).all(|corner| {
            let height = normal.dot(self.center - corner) + reach;
            let size = self.size().max(corner.abs().max_element());
            height < -BEHIND * (size + self.farthest(corner))
        })
    }

    /// Whether its cone certainly contains nothing within `radius` of the hull of the `corners`,
    /// which face along `normal`: a plane through its tip is between them.
    ///
    /// The cone is behind a plane if the plane's normal is at least a right angle plus the cone's
    /// half angle off its axis. Directions to the hull and normals of its face are tried, each
    /// turned away from the axis as far as it has to be.
    fn misses(&self, corners: &[Vec3], radius: f64, normal: DVec3) -> bool {
        let Some(cone) = &self.cone else { return false };
        let (axis, [sine, cosine]) = cone.shape();
        let points = || corners.iter().map(|corner| corner.as_dvec3());
        let is_between = |normal: DVec3| {
            let away = -normal.dot(axis);
            let beside = normalize_f64(normal + axis * away);
            let turned = if away >= sine { normal } else { beside * cosine - axis * sine };
            // What is along the axis has no direction beside it.
            let is_beside = beside.dot(axis).abs() <= UNIT_ROUNDOFF.into();
            (away >= sine || is_beside)
                && points().all(|point| {
                    let size = self.size().max(point.abs().max_element()) + radius;
                    let margin = BEHIND * (size + self.farthest(point) + radius);
                    turned.dot(point - self.center) - radius > margin
                })
        };
        let middle = points().sum::<DVec3>() / corners.len() as f64;
        let towards = points().chain([middle]).map(|point| normalize_f64(point - self.center));
        towards.chain([-axis, normal, -normal]).any(is_between)
    }

    /// Whether all of it is certainly inside a sphere, behind every point of its outside.
    pub(super) fn is_within(&self, center: Vec3, radius: f32) -> bool {
        if self.is_distant {
            return false;
        }
        let (center, radius) = (center.as_dvec3(), f64::from(radius));
        let size = self.size().max(center.abs().max_element() + radius);
        self.farthest(center) - radius < -BEHIND * (size + 2.0 * radius)
    }

    /// Whether all of it is certainly outside a sphere.
    pub(super) fn is_beyond(&self, center: Vec3, radius: f32) -> bool {
        let (center, radius) = (center.as_dvec3(), f64::from(radius));
        let nearest = ((self.center - center).abs() - self.half).max(DVec3::ZERO).length();
        let size = self.size().max(center.abs().max_element() + radius);
        nearest - self.radius - radius > BEHIND * (size + 2.0 * radius)
    }
}

#[cfg(test)]
mod tests;
