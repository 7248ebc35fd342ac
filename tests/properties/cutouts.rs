use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use wavecrest_core::accel::Accel;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::geometry::Geometry;
use wavecrest_core::geometry::cutouts::Cutout;
use wavecrest_core::geometry::instance::Instance;
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::kernels::texture::{Filter, Image, LazyImage, PlanarMap, Texels, UvMap, Wrap};
use wavecrest_core::math::ray::Ray;

use crate::crossings::checked;
use crate::kernels::{Numbers, add_quad, add_triangle, cloud, compare};

/// An image of 8 by 8 texels of this alpha.
fn image(alpha: impl Fn(u32) -> u8) -> Arc<LazyImage> {
    let texels = (0..64).map(|i| [alpha(i); 4]).collect();
    let decode = move || Ok(Image::new(8, 8, Texels::Bytes(texels)));
    Arc::new(LazyImage::new("alpha".into(), Vec::new, decode))
}

/// Holes and what is between them, of every alpha.
fn checkers() -> Arc<LazyImage> {
    image(|i| if (i + i / 8).is_multiple_of(2) { 4 * i as u8 } else { 255 - i as u8 })
}

/// Cut out by projection on the first two axes, or as spheres are.
fn cutout(primitives: Range<u32>, threshold: f32, image: Arc<LazyImage>) -> Cutout {
    let map = UvMap::Planar(PlanarMap::new(Vec3::ZERO, Vec3::X, Vec3::Y));
    let (filter, wrap) = (Filter::Bilinear, Wrap::Repeat);
    let image = Some(image);
    Cutout { primitives, threshold, image, filter, wrap, map, placing: None, mesh: None }
}

/// Rays from around the origin, many of them through vertices.
fn rays(numbers: &mut Numbers, geometry: &Geometry) -> Vec<Ray> {
    let ray = |i: usize| {
        let origin = numbers.vector() * 2.0;
        let vertex = geometry.positions[numbers.below(geometry.positions.len())];
        let to = if i.is_multiple_of(2) { numbers.vector() } else { vertex };
        Ray::new(origin, to - origin)
    };
    (0..3000).map(ray).collect()
}

/// Triangles, quads and spheres, half of them cut out.
fn half_cut_out(numbers: &mut Numbers) -> Geometry {
    let mut geometry = cloud(numbers, 1.0);
    for _ in 0..40 {
        let (corner, u, v) = (numbers.vector(), numbers.vector() * 0.3, numbers.vector() * 0.3);
        add_quad(&mut geometry, [corner, corner + u, corner + u + v, corner + v]);
    }
    let (triangles, quads) = (geometry.triangles.len() as u32, geometry.quads.len() as u32);
    let spheres = triangles + quads;
    let sphere = Cutout {
        map: UvMap::Sphere(glam::Mat3::IDENTITY),
        ..cutout(spheres..spheres + 10, 0.5, checkers())
    };
    geometry.cutouts = vec![
        cutout(20..triangles / 2, 0.4, checkers()),
        cutout(triangles..triangles + quads / 2, 0.6, checkers()),
        sphere,
    ];
    geometry
}

#[test]
fn every_kernel_answers_as_brute_force() {
    let mut numbers = Numbers(40_000);
    let geometry = half_cut_out(&mut numbers);
    let rays = rays(&mut numbers, &geometry);
    let cut = compare("cut-outs", &geometry, &rays);
    let whole = Geometry { cutouts: Vec::new(), ..geometry };
    assert!(cut > 1500 && cut < compare("whole", &whole, &rays), "{cut}");
}

#[test]
fn what_rays_cross_is_without_holes() {
    let mut numbers = Numbers(60_000);
    let geometry = half_cut_out(&mut numbers);
    let rays = &rays(&mut numbers, &geometry)[..600];
    let cut = checked(&geometry, rays);
    assert_ne!(checked(&Geometry { cutouts: Vec::new(), ..geometry }, rays), cut);
}

#[test]
fn instances_are_cut_out_as_their_prototype_is() {
    let mut numbers = Numbers(50_000);
    let mut prototype = half_cut_out(&mut numbers);
    (prototype.quads, prototype.quadrics) = (Vec::new(), Vec::new());
    prototype.cutouts = vec![cutout(0..300, 0.5, checkers())];
    let bounds = Aabb { low: Vec3::splat(-1.5), high: Vec3::splat(1.5) };
    let triangles = prototype.triangles.len() as u32;
    let instance = |i: u32| {
        let turn = DQuat::from_rotation_y(f64::from(i));
        let place = DVec3::new(f64::from(i) - 1.0, 0.3, 0.1);
        let scale = DVec3::new(1.0, -0.8, 1.2);
        let world = DAffine3::from_scale_rotation_translation(scale, turn, place);
        Instance::new(0, i * triangles, world, &bounds)
    };
    let rays = rays(&mut numbers, &prototype);
    let instances = (0..3).map(instance).collect();
    let geometry = Geometry { prototypes: vec![prototype], instances, ..Geometry::default() };
    assert!(compare("instances", &geometry, &rays) > 1500);
}

/// Squares in the planes `z`, from -1 to 1.
fn squares(z: &[f32]) -> Geometry {
    let mut geometry = Geometry::default();
    for &z in z {
        let corner = |x: f32, y: f32| Vec3::new(x, y, z);
        add_triangle(&mut geometry, [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
        add_triangle(&mut geometry, [corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    }
    geometry
}

#[test]
fn a_ray_passes_many_layers() {
    let z: Vec<f32> = (0..300).map(|i| i as f32 / -100.0).collect();
    let mut geometry = squares(&z);
    let last = geometry.triangles.len() as u32 - 2;
    geometry.cutouts = vec![cutout(0..last, 0.5, image(|_| 0))];
    let ray = |i: u8| {
        let x = f32::from(i) / 400.0;
        Ray::new(Vec3::new(x, x / 2.0, 1.0), Vec3::NEG_Z)
    };
    let rays: Vec<Ray> = (0..200).map(ray).collect();
    assert_eq!(compare("layers", &geometry, &rays), rays.len());
    let accel = Accel::new(geometry, Preset::VeryFast);
    let mut traversal = accel.traversal();
    assert!(accel.closest(&rays[0], &mut traversal).primitive >= last);
    assert!(traversal.tests.cutouts >= 299, "{}", traversal.tests.cutouts);
}
