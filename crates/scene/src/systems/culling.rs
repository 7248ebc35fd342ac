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

use super::bounds::{around, wide};
use super::frame::Frame;
use super::geometry::is_varied;
use super::materials::mirrored;
use super::placement::{Circle, ShapeGeometry, ShapeInstance};
use super::reach::{BEHIND, Extent};
use super::surface::{SurfaceColumns, SurfaceComponents};
use super::textures::Images;
use crate::components::{DirectionalLight, Disk, Mesh, PointLight, Sky, Sphere, Transparency};
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
    let is_certain = find_boxes(world, &frame.cameras, all);
    if is_certain {
        let walls = Walls::of(&frame.cameras, all);
        for one in all.iter_mut() {
            let sees = |camera: &Camera| camera.may_see(&one.bounds, one.widening);
            one.visibility.is_seen = frame.cameras.iter().any(sees) && !walls.hide(&one.bounds);
        }
    }
    look_through(world, frame, all, images, true)?;
    let shows_others = !is_certain || sight::run(world, frame, all)?;
    if !shows_others && all.iter().any(|one| !one.visibility.is_seen) {
        let hull = Hull::of(world, frame.origin, all);
        for one in all.iter_mut() {
            // Shadow rays pass the shapes of lights.
            let is_met = || !one.is_of_light() && hull.may_meet(&one.bounds);
            one.visibility.is_met = one.visibility.is_seen || is_met();
        }
    }
    look_through(world, frame, all, images, false)
}

/// Looks at the opacity of those that may be transparent and are met, of what is seen or of the rest.
fn look_through(
    world: &World,
    frame: &Frame,
    all: &mut [ShapeInstance],
    images: &mut Images,
    is_seen: bool,
) -> Result<()> {
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let met = all.iter_mut().filter(|one| one.visibility.is_transparent && one.visibility.is_met);
    for one in met.filter(|one| one.visibility.is_seen == is_seen) {
        let surface = SurfaceComponents::of(&surfaces, one.entity);
        // Paths are split there, so that only what is bright enough counts.
        let is_faint_mirror = frame.settings.bounces > 0
            && surface.material.is_some_and(|m| m.is_faint_mirror() && mirrored(m, frame) > 0.0);
        one.visibility.is_transparent =
            is_faint_mirror || is_transparent(world, &surface, one.prototype, images)?;
    }
    Ok(())
}

/// Whether light goes through a surface of a prototype or is absorbed behind it: not if its opacity is 1 at all vertices
/// and in every texel.
fn is_transparent(
    world: &World,
    surface: &SurfaceComponents<'_>,
    prototype: Entity,
    images: &mut Images,
) -> Result<bool> {
    let through = *surface.transparency.unwrap_or(&Transparency::OPAQUE);
    if (Transparency { vertex_alpha: false, ..through }).has_effect() {
        return Ok(true);
    }
    let mesh = world.get::<&Mesh>(prototype);
    let alphas = mesh.as_ref().ok().and_then(|mesh| mesh.data.alphas.as_deref());
    if through.vertex_alpha && alphas.is_some_and(|alphas| is_varied(alphas, &1.0)) {
        return Ok(true);
    }
    let opacity = surface.maps.opacity.as_ref().and_then(|map| map.texture.as_ref());
    let Some(opacity) = opacity else { return Ok(false) };
    Ok(!images.is_one(opacity, surface.texture, (surface.place, OPACITY_MAP))?)
}

/// Finds the box around each shape, unless there is none, nothing is certain, or it takes too long; returns whether
/// it did.
fn find_boxes(world: &World, cameras: &[Camera], all: &mut [ShapeInstance]) -> bool {
    let is_sphere = |one: &&ShapeInstance| matches!(one.geometry, ShapeGeometry::Sphere(_));
    let planes = cameras.len() + all.iter().filter(is_sphere).count();
    let tests = all.len().saturating_mul(planes);
    if all.is_empty() || cameras.is_empty() || tests > MOST_TESTS {
        return false;
    }
    let mut of_meshes: HashMap<Entity, (Aabb, DVec3)> = HashMap::new();
    for one in all {
        let around_points = |points: &[DVec3]| {
            let points: Vec<Vec3> = points.iter().map(|point| point.as_vec3()).collect();
            (around(&points), DVec3::ZERO)
        };
        let (own, origin) = match &one.geometry {
            ShapeGeometry::Sphere(Sphere { center, radius })
            | ShapeGeometry::Disk(Disk { center, radius, .. }) => {
                around_points(&[*center - *radius, *center + *radius])
            }
            ShapeGeometry::Quad(quad) => around_points(&quad.points),
            ShapeGeometry::Triangle(triangle) => around_points(&triangle.points),
            ShapeGeometry::Mesh => *of_meshes.entry(one.prototype).or_insert_with(|| {
                let mesh = world.get::<&Mesh>(one.prototype);
                let none = (Aabb::EMPTY, DVec3::ZERO);
                mesh.map_or(none, |mesh| (around(&mesh.data.positions), mesh.data.origin))
            }),
        };
        let to_world = one.transform * DAffine3::from_translation(origin);
        let instance = Instance::new(0, 0, to_world, &own);
        (one.bounds, one.widening) = (instance.bounds(&[own]), instance.widening());
    }
    true
}

/// Half-spaces that contain a convex hull: n . p is at most `top` for normals n, not of unit length.
struct Hull {
    halves: Vec<(DVec3, f64)>,
    /// The largest coordinate.
    size: f64,
}

impl Hull {
    /// The hull of all rays between what is seen of these shapes, and the lights.
    fn of(world: &World, origin: DVec3, all: &[ShapeInstance]) -> Self {
        let mut hull = Self::new();
        let seen = all.iter().filter(|one| one.visibility.is_seen);
        seen.for_each(|one| hull.add(&one.bounds));
        for sky in world.query::<&Sky>().iter().filter(|sky| sky.samples > 0) {
            hull.widen(|normal| normal.length() * sky.distance.unwrap_or(f64::INFINITY));
        }
        all.iter().filter(|one| one.is_of_light()).for_each(|one| hull.add(&one.bounds));
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
    let [low, high] = wide(*bounds);
    DVec3::select(normal.cmpgt(DVec3::ZERO), low, high).dot(normal)
}

/// The largest coordinate of a box.
fn size(bounds: &Aabb) -> f64 {
    f64::from(bounds.low.abs().max(bounds.high.abs()).max_element())
}

/// Spheres without holes, by centre and radius, that no ray of any camera passes, and whether all cameras are outside;
/// else all are inside.
struct Walls(Vec<(Vec3, f32, bool)>);

impl Walls {
    fn of(cameras: &[Camera], shapes: &[ShapeInstance]) -> Self {
        let pupils: Vec<Extent> = cameras.iter().map(Extent::of_pupil).collect();
        let wall = |shape: &ShapeInstance| {
            let ShapeGeometry::Sphere(Sphere { center, radius }) = shape.geometry else {
                return None;
            };
            let sphere = shape.circle("sphere", center, radius).ok();
            let Circle { center, radius, .. } = sphere.filter(|_| !shape.is_cut_out)?;
            let are_outside = pupils.iter().all(|pupil| pupil.is_beyond(center, radius));
            let are_inside = || pupils.iter().all(|pupil| pupil.is_within(center, radius));
            (are_outside || are_inside()).then_some((center, radius, are_outside))
        };
        Self(shapes.iter().filter_map(wall).collect())
    }

    fn hide(&self, bounds: &Aabb) -> bool {
        let extent = Extent::of_box(bounds);
        self.0.iter().any(|&(center, radius, are_outside)| match are_outside {
            true => extent.is_within(center, radius),
            false => extent.is_beyond(center, radius),
        })
    }
}
