//! What rays may meet, by boxes alone, before anything of it is stored.
//!
//! Camera rays stay within the frustum of a frame, and on their side of a sphere. Unless something in view mirrors the scene
//! ([`sight`]) or lets light through, the others run from surfaces in view to lights, and so within the convex hull of both:
//! no ray meets a shape that a plane separates from it. The planes of 26-DOPs are tried: Klosowski et al.,
//! *Efficient Collision Detection Using Bounding Volume Hierarchies of k-DOPs* (1998). In doubt a shape is
//! met.

mod sight;

use std::collections::HashMap;

use glam::{DAffine3, DVec3, Vec3};
use hecs::{Entity, World};

use super::bounds::around;
use super::frame::Frame;
use super::geometry::is_varied;
use super::placement::{ShapeGeometry, ShapeInstance};
use super::reach::{BEHIND, Extent};
use super::textures::Images;
use crate::components::{
    DirectionalLight, Disk, Maps, Mesh, PointLight, Quad, Sky, Sphere, TextureRef, Transparency,
    Triangle,
};
use crate::corners::unit;
use crate::surface::OPACITY_MAP;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::instance::Instance;
use wavecrest_core::kernels::camera::Camera;
use wavecrest_core::kernels::slab::Aabb;

/// Largest number of box tests, against cameras and spheres. Beyond them, shapes count as met.
const MOST_TESTS: usize = 1 << 22;

/// Finds out which of `all` no ray can meet, and which of the others let no light through, because the
/// images of their opacity are 1 everywhere.
///
/// # Errors
/// If such an image cannot be decoded.
pub(crate) fn run(
    world: &World,
    frame: &Frame,
    all: &mut [ShapeInstance],
    images: &mut Images,
) -> Result<()> {
    let boxes = boxes(world, &frame.cameras, all);
    if !boxes.is_empty() {
        let walls = Walls::of(&frame.cameras, all);
        for (instance, (bounds, widening)) in all.iter_mut().zip(&boxes) {
            let sees = |camera: &Camera| camera.may_see(bounds, *widening);
            instance.visibility.is_seen = frame.cameras.iter().any(sees) && !walls.hide(bounds);
        }
    }
    look_through(world, all, images, true)?;
    let shows_others = boxes.is_empty() || sight::run(world, frame, all, &boxes)?;
    if !shows_others && all.iter().any(|one| !one.visibility.is_seen) {
        let hull =
            hull(world, frame.origin, all.iter().zip(boxes.iter().map(|(bounds, _)| bounds)));
        for (one, (bounds, _)) in all.iter_mut().zip(&boxes) {
            // Shadow rays pass the shapes of lights.
            one.visibility.is_met =
                one.visibility.is_seen || !one.is_of_light() && hull.may_meet(bounds);
        }
    }
    look_through(world, all, images, false)
}

/// Looks at the opacity of those that may be transparent and are met, of what is seen or of the rest.
fn look_through(
    world: &World,
    all: &mut [ShapeInstance],
    images: &mut Images,
    is_seen: bool,
) -> Result<()> {
    let may_be = |one: &&mut ShapeInstance| {
        let visibility = one.visibility;
        visibility.is_transparent && visibility.is_met && visibility.is_seen == is_seen
    };
    for one in all.iter_mut().filter(may_be) {
        one.visibility.is_transparent = is_transparent(world, one, images)?;
    }
    Ok(())
}

/// Whether light goes through the shape: not if its opacity is 1 at all vertices and in every texel.
fn is_transparent(world: &World, of: &ShapeInstance, images: &mut Images) -> Result<bool> {
    let through = world.get::<&Transparency>(of.entity).ok();
    let through = through.map_or(Transparency::OPAQUE, |through| *through);
    if (Transparency { vertex_alpha: false, ..through }).has_effect() {
        return Ok(true);
    }
    let mesh = world.get::<&Mesh>(of.prototype);
    let alphas = mesh.as_ref().ok().and_then(|mesh| mesh.data.alphas.as_deref());
    if through.vertex_alpha && alphas.is_some_and(|alphas| is_varied(alphas, &1.0)) {
        return Ok(true);
    }
    let maps = world.get::<&Maps>(of.entity).ok();
    let opacity = maps.as_ref().and_then(|maps| maps.opacity.as_ref()?.texture.as_ref());
    let Some(opacity) = opacity else { return Ok(false) };
    let color = world.get::<&TextureRef>(of.entity).ok();
    Ok(!images.is_one(opacity, color.as_deref(), (&of.place, OPACITY_MAP))?)
}

/// The box around each shape, with the factor on the error of rays near it; none if nothing is certain.
fn boxes(world: &World, cameras: &[Camera], all: &[ShapeInstance]) -> Vec<(Aabb, f32)> {
    let is_sphere = |one: &&ShapeInstance| matches!(one.geometry, ShapeGeometry::Sphere(_));
    let planes = cameras.len() + all.iter().filter(is_sphere).count();
    if cameras.is_empty() || all.len().saturating_mul(planes) > MOST_TESTS {
        return Vec::new();
    }
    let mut of_meshes: HashMap<Entity, (Aabb, DVec3)> = HashMap::new();
    let round = |center: DVec3, radius: f64| [center - radius, center + radius];
    let mut own = |instance: &ShapeInstance| {
        let points: Vec<DVec3> = match &instance.geometry {
            ShapeGeometry::Sphere(Sphere { center, radius })
            | ShapeGeometry::Disk(Disk { center, radius, .. }) => round(*center, *radius).to_vec(),
            ShapeGeometry::Quad(Quad { points }) => points.to_vec(),
            ShapeGeometry::Triangle(Triangle { points }) => points.to_vec(),
            ShapeGeometry::Mesh => {
                let of_mesh = || {
                    let mesh = world.get::<&Mesh>(instance.prototype);
                    mesh.map_or((Aabb::EMPTY, DVec3::ZERO), |mesh| {
                        (around(&mesh.data.positions), mesh.data.origin)
                    })
                };
                return *of_meshes.entry(instance.prototype).or_insert_with(of_mesh);
            }
        };
        let points: Vec<Vec3> = points.into_iter().map(|point| point.as_vec3()).collect();
        (around(&points), DVec3::ZERO)
    };
    let placed = |instance: &ShapeInstance| {
        let (own, origin) = own(instance);
        let to_world = instance.transform * DAffine3::from_translation(origin);
        let instance = Instance::new(0, 0, to_world, &own);
        (instance.bounds(&[own]), instance.widening())
    };
    all.iter().map(placed).collect()
}

/// The hull of all rays between what is seen of these shapes and boxes, and the lights.
fn hull<'a>(
    world: &World,
    origin: DVec3,
    all: impl Iterator<Item = (&'a ShapeInstance, &'a Aabb)> + Clone,
) -> Hull {
    let mut hull = Hull::new();
    let seen = all.clone().filter(|(one, _)| one.visibility.is_seen);
    seen.for_each(|(_, bounds)| hull.add(bounds));
    for sky in world.query::<&Sky>().iter().filter(|sky| sky.samples > 0) {
        hull.widen(|normal| normal.length() * sky.distance.unwrap_or(f64::INFINITY));
    }
    all.filter(|(one, _)| one.is_of_light()).for_each(|(_, bounds)| hull.add(bounds));
    for light in world.query::<&PointLight>().iter() {
        if light.intensity > 0.0 && light.color != DVec3::ZERO {
            let point = (light.position - origin).as_vec3();
            hull.add(&Aabb { low: point, high: point });
        }
    }
    for light in world.query::<&DirectionalLight>().iter() {
        if light.intensity > 0.0 && light.color != DVec3::ZERO {
            let towards = -unit(light.direction);
            let spread = libm::sin((light.angle_degrees / 2.0).to_radians());
            let leaves = |normal: DVec3| normal.dot(towards) > -spread * normal.length();
            hull.widen(|normal| if leaves(normal) { f64::INFINITY } else { 0.0 });
        }
    }
    hull
}

/// Half-spaces that contain a convex hull: n . p is at most `top` for normals n, not of unit length.
struct Hull {
    halves: Vec<(DVec3, f64)>,
    /// The largest coordinate.
    size: f64,
}

impl Hull {
    /// Nothing, by the normals of 26-DOPs.
    fn new() -> Self {
        let part = |i: u32| f64::from(i % 3) - 1.0;
        let normals = (0..27).map(|i| DVec3::new(part(i), part(i / 3), part(i / 9)));
        let normals = normals.filter(|normal| *normal != DVec3::ZERO);
        Self { halves: normals.map(|normal| (normal, f64::NEG_INFINITY)).collect(), size: 0.0 }
    }

    fn add(&mut self, bounds: &Aabb) {
        self.size = self.size.max(size(bounds));
        let top = |normal: DVec3| -bottom(bounds, -normal);
        self.halves.iter_mut().for_each(|(normal, all)| *all = all.max(top(*normal)));
    }

    fn widen(&mut self, by: impl Fn(DVec3) -> f64) {
        self.halves.iter_mut().for_each(|(normal, top)| *top += by(*normal));
    }

    /// Whether a ray within the hull may meet what is in the box. A NaN is not certain.
    fn may_meet(&self, bounds: &Aabb) -> bool {
        let margin = BEHIND * self.size.max(size(bounds));
        let is_beyond =
            |(normal, top): &(DVec3, f64)| bottom(bounds, *normal) > top + margin * normal.length();
        !self.halves.iter().any(is_beyond)
    }
}

/// The lowest n . p of the points p of a box, for a normal n.
fn bottom(bounds: &Aabb, normal: DVec3) -> f64 {
    let (low, high) = (bounds.low.as_dvec3(), bounds.high.as_dvec3());
    DVec3::select(normal.cmpgt(DVec3::ZERO), low, high).dot(normal)
}

/// The largest coordinate of a box.
fn size(bounds: &Aabb) -> f64 {
    f64::from(bounds.low.abs().max(bounds.high.abs()).max_element())
}

/// Spheres without holes, by centre and radius, that no ray of any camera passes.
struct Walls {
    /// With all cameras outside.
    outside: Vec<(Vec3, f32)>,
    /// With all cameras inside.
    within: Vec<(Vec3, f32)>,
}

impl Walls {
    fn of(cameras: &[Camera], shapes: &[ShapeInstance]) -> Self {
        let pupils: Vec<Extent> = cameras.iter().map(Extent::of_pupil).collect();
        let sphere = |shape: &ShapeInstance| match &shape.geometry {
            ShapeGeometry::Sphere(Sphere { center, radius }) if !shape.is_cut_out => {
                shape.circle("sphere", *center, *radius).ok()
            }
            _ => None,
        };
        let spheres = || shapes.iter().filter_map(sphere).map(|of| (of.center, of.radius));
        let those = |are: fn(&Extent, Vec3, f32) -> bool| {
            let all = |&(center, radius): &(Vec3, f32)| {
                pupils.iter().all(|pupil| are(pupil, center, radius))
            };
            spheres().filter(all).collect()
        };
        Self { outside: those(Extent::is_beyond), within: those(Extent::is_within) }
    }

    fn hide(&self, bounds: &Aabb) -> bool {
        let extent = Extent::of_box(bounds);
        self.outside.iter().any(|&(center, radius)| extent.is_within(center, radius))
            || self.within.iter().any(|&(center, radius)| extent.is_beyond(center, radius))
    }
}
