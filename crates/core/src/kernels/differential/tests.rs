//! Derivatives against differences of neighbouring rays, which are followed in double precision.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::*;
use crate::accel::tests::Numbers;
use crate::kernels::Camera;
use crate::kernels::camera::{FovAxis, Placement};
use crate::kernels::texture::{PlanarMap, sphere_uv_change};
use crate::math::float::normalize_f64;
use crate::math::sampling::Sampling;

/// How far a derivative may be from the difference, in parts of its length, at 60 degrees or less
/// from the normal: directions, distances and normals are rounded to single precision, and a few
/// such errors add up over the surfaces on the way.
const RELATIVE_ERROR: f64 = 2e-5;

/// Width of the central difference in samples: errors of the second order are below the bound.
const STEP: f64 = 1e-3;

impl Numbers {
    /// Others for each case.
    fn new(index: u32) -> Self {
        Self(index << 12)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.one())
    }

    fn direction(&mut self) -> DVec3 {
        normalize_f64(DVec3::from_array([0; 3].map(|_| self.between(-1.0, 1.0))))
    }

    /// At up to 60 degrees from `axis`.
    fn about(&mut self, axis: DVec3) -> DVec3 {
        loop {
            let found = self.direction();
            if found.dot(axis) > 0.5 {
                return found;
            }
        }
    }
}

/// A ray, in double precision.
type Ray64 = (DVec3, DVec3);

/// A camera as a function of the place in the image.
struct View {
    placement: Placement,
    antialias: u32,
    /// A point of a lens, from its middle in units of length to the right and up, and the depth in
    /// focus.
    lens: Option<(DVec2, f64)>,
}

impl View {
    fn random(numbers: &mut Numbers) -> Self {
        let location = numbers.direction() * 3.0;
        let placement = Placement {
            location,
            look: location + numbers.direction(),
            up: numbers.direction(),
            fov_degrees: numbers.between(20.0, 120.0),
            fov_axis: FovAxis::X,
            size: [400, 300],
        };
        let at = DVec2::new(numbers.between(-0.3, 0.3), numbers.between(-0.3, 0.3));
        let focal = numbers.between(1.0, 8.0);
        let lens = (numbers.between(0.0, 1.0) < 0.5).then_some((at, focal));
        Self { placement, antialias: 1 + numbers.between(0.0, 3.0) as u32, lens }
    }

    /// The ray through a place, in samples from the top left.
    fn ray(&self, sample: DVec2) -> Ray64 {
        let Placement { location, look, up, fov_degrees, size, .. } = self.placement;
        let forward = normalize_f64(look - location);
        let right = normalize_f64(forward.cross(up));
        let up = right.cross(forward);
        let half = (fov_degrees / 2.0).to_radians().tan();
        let [width, height] = size.map(f64::from);
        let pixel = sample / f64::from(self.antialias);
        let across = half * (2.0 * pixel.x / width - 1.0);
        let along = half * (height / width) * (1.0 - 2.0 * pixel.y / height);
        let through = forward + right * across + up * along;
        let (offset, focal) = match self.lens {
            None => (DVec3::ZERO, 1.0),
            Some((at, focal)) => (right * at.x + up * at.y, focal),
        };
        (location + offset, normalize_f64(through * focal - offset))
    }

    fn differential(&self, direction: Vec3) -> Differential {
        Camera::new(&self.placement, self.antialias, Sampling::Jittered, None)
            .differential(direction.into(), 1.0 / f64::from(self.antialias))
    }
}

/// A surface that goes on beyond its edges.
#[derive(Clone, Copy, Debug)]
enum Mirror {
    Plane { corners: [Vec3; 3] },
    Sphere { center: Vec3, radius: f32 },
    Smooth { corners: [Vec3; 3], normals: [Vec3; 3] },
}

/// Where a ray meets a mirror: how far along, where, the geometric normal, the one it turns about.
struct MirrorHit {
    t: f64,
    point: DVec3,
    geometric: DVec3,
    normal: DVec3,
}

fn plane(corners: &[Vec3; 3], (origin, direction): Ray64) -> (f64, DVec3, DVec3) {
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let normal = normalize_f64((b - a).cross(c - a));
    let t = (a - origin).dot(normal) / direction.dot(normal);
    (t, origin + direction * t, normal)
}

/// Solved for as a system of equations, unlike the kernel does it.
fn weights_of(corners: &[Vec3; 3], point: DVec3) -> [f64; 2] {
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    let (u, v, p) = (b - a, c - a, point - a);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let (pu, pv) = (p.dot(u), p.dot(v));
    let determinant = uu * vv - uv * uv;
    [(pu * vv - pv * uv) / determinant, (pv * uu - pu * uv) / determinant]
}

impl Mirror {
    /// Somewhere on the ray, turned at most 60 degrees away from it.
    fn random(numbers: &mut Numbers, (origin, direction): Ray64) -> Self {
        let at = origin + direction * numbers.between(0.5, 5.0);
        let normal = numbers.about(-direction);
        let side = if numbers.between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
        let corners = |numbers: &mut Numbers| {
            let (u, v) = normal.any_orthonormal_pair();
            [-0.5, 0.5, 1.5].map(|turn: f64| {
                let (sin, cos) = ((turn + numbers.between(-0.2, 0.2)) * 2.0).sin_cos();
                (at + (u * cos + v * sin) * numbers.between(0.5, 2.0)).as_vec3()
            })
        };
        match numbers.between(0.0, 3.0) as u32 {
            0 => Self::Plane { corners: corners(numbers) },
            1 => {
                // From outside, or from inside.
                let radius = numbers.between(0.5, 3.0);
                let center = (at - normal * radius * side).as_vec3();
                Self::Sphere { center, radius: radius as f32 }
            }
            _ => {
                let normals = [0; 3].map(|_| {
                    ((normal + numbers.direction() * 0.3) * side * numbers.between(0.5, 2.0))
                        .as_vec3()
                });
                Self::Smooth { corners: corners(numbers), normals }
            }
        }
    }

    /// Where the ray meets it: a sphere at the side that is next to `near`.
    fn meet(&self, (origin, direction): Ray64, near: Option<f64>) -> MirrorHit {
        let (t, point, geometric, normal) = match self {
            Self::Plane { corners } => {
                let (t, point, normal) = plane(corners, (origin, direction));
                (t, point, normal, normal)
            }
            Self::Sphere { center, radius } => {
                let from = origin - center.as_dvec3();
                let half_b = from.dot(direction);
                let radius = f64::from(*radius);
                let root = (half_b * half_b - from.dot(from) + radius * radius).sqrt();
                let both = [-half_b - root, -half_b + root];
                let far = |t: f64| near.map_or(t <= 0.0, |near| (t - near).abs() > root);
                let t = if far(both[0]) { both[1] } else { both[0] };
                let point = origin + direction * t;
                let outward = (point - center.as_dvec3()) / radius;
                (t, point, outward, outward)
            }
            Self::Smooth { corners, normals } => {
                let (t, point, geometric) = plane(corners, (origin, direction));
                let [y, z] = weights_of(corners, point);
                let [a, b, c] = normals.map(|n| n.as_dvec3());
                (t, point, geometric, normalize_f64(a * (1.0 - y - z) + b * y + c * z))
            }
        };
        let towards = |n: DVec3| if n.dot(direction) > 0.0 { -n } else { n };
        MirrorHit { t, point, geometric: towards(geometric), normal: towards(normal) }
    }

    fn turn(&self, meeting: &MirrorHit, step: Vec3) -> Vec3 {
        match self {
            Self::Plane { .. } => Vec3::ZERO,
            Self::Sphere { center, radius } => {
                let outward = meeting.point - center.as_dvec3();
                let side = if outward.dot(meeting.normal) < 0.0 { -1.0 } else { 1.0 };
                step * side / *radius
            }
            Self::Smooth { corners, normals } => {
                let (point, normal) = (meeting.point.as_vec3(), meeting.normal.as_vec3());
                let at = (point.into(), normal.into());
                let [corners, normals] = [corners, normals].map(|of| of.map(Vector::from));
                turn_between(&corners, &normals, at, step.into()).into()
            }
        }
    }
}

fn reflected(meeting: &MirrorHit, direction: DVec3) -> Ray64 {
    (meeting.point, direction - meeting.normal * (2.0 * direction.dot(meeting.normal)))
}

/// The ray behind the mirrors, near to the one whose distances are given.
fn follow(view: &View, sample: DVec2, mirrors: &[(Mirror, f64)]) -> Ray64 {
    mirrors
        .iter()
        .fold(view.ray(sample), |ray, (mirror, t)| reflected(&mirror.meet(ray, Some(*t)), ray.1))
}

/// By how much a derivative is off, in parts of its length.
#[track_caller]
fn check(found: Vector<f32>, exact: DVec3, what: &str) {
    let found = Vec3::from(found);
    let error = found.as_dvec3().distance(exact) / exact.length();
    assert!(error <= RELATIVE_ERROR, "{what}: {found} is off {exact} by {error:e}");
}

fn central(f: impl Fn(DVec2) -> Ray64, at: DVec2, axis: DVec2) -> Ray64 {
    let (after, before) = (f(at + axis * STEP), f(at - axis * STEP));
    ((after.0 - before.0) / (2.0 * STEP), (after.1 - before.1) / (2.0 * STEP))
}

const AXES: [DVec2; 2] = [DVec2::X, DVec2::Y];

#[test]
fn camera_rays_of_a_pinhole_and_of_a_lens_change_as_their_neighbours_say() {
    for index in 0..2000 {
        let mut numbers = Numbers::new(index);
        let view = View::random(&mut numbers);
        let at = DVec2::new(numbers.between(0.0, 400.0), numbers.between(0.0, 300.0));
        let at = at * f64::from(view.antialias);
        let found = view.differential(view.ray(at).1.as_vec3());
        for (k, axis) in AXES.into_iter().enumerate() {
            let (origin, direction) = central(|p| view.ray(p), at, axis);
            assert!(origin.length() < 1e-9 && Vec3::from(found.origin[k]) == Vec3::ZERO);
            check(found.direction[k], direction, &format!("camera {index}, axis {k}"));
        }
    }
}

/// Up to three mirrors one after the other, each of any kind; the change of the point at each, and of
/// the ray that it sends on.
#[test]
fn hits_and_mirror_rays_change_as_their_neighbours_say() {
    let mut tried = [0; 3];
    for index in 0..3000 {
        let mut numbers = Numbers::new(index);
        let view = View::random(&mut numbers);
        let at = DVec2::new(numbers.between(0.0, 400.0), numbers.between(0.0, 300.0));
        let at = at * f64::from(view.antialias);
        let mut ray = view.ray(at);
        let mut differential = view.differential(ray.1.as_vec3());
        let mut mirrors = Vec::new();
        for _ in 0..3 {
            let mirror = Mirror::random(&mut numbers, ray);
            let meeting = mirror.meet(ray, None);
            if meeting.geometric.dot(-ray.1) < 0.5 || meeting.normal.dot(-ray.1) < 0.5 {
                break;
            }
            tried[match mirror {
                Mirror::Plane { .. } => 0,
                Mirror::Sphere { .. } => 1,
                Mirror::Smooth { .. } => 2,
            }] += 1;
            mirrors.push((mirror, meeting.t));
            let (ahead, normal) = (ray.1.as_vec3().into(), meeting.geometric.as_vec3().into());
            let steps = differential.at(ahead, meeting.t as f32, normal);
            let turns = steps.map(|step| mirror.turn(&meeting, step.into()).into());
            differential =
                differential.turned(ahead, steps, meeting.normal.as_vec3().into(), turns, None);
            for (k, axis) in AXES.into_iter().enumerate() {
                let what = format!("ray {index}, {mirrors:?}, axis {k}");
                let (origin, direction) = central(|p| follow(&view, p, &mirrors), at, axis);
                check(differential.origin[k], origin, &what);
                check(differential.direction[k], direction, &what);
            }
            ray = reflected(&meeting, ray.1);
        }
    }
    assert!(tried.iter().all(|&n| n > 1000), "{tried:?}");
}

#[test]
fn texture_coordinates_change_as_their_neighbours_say() {
    for index in 0..1000 {
        let mut numbers = Numbers::new(index);
        let corners = [0; 3].map(|_| (numbers.direction() * 4.0).as_vec3());
        let uvs = [0; 3].map(|_| {
            Vec2::new(numbers.between(-3.0, 3.0) as f32, numbers.between(-3.0, 3.0) as f32)
        });
        let [a, b, c] = corners.map(|v| v.as_dvec3());
        let normal = (b - a).cross(c - a);
        if normal.length() < 0.5 {
            continue;
        }
        let step = (b - a) * numbers.between(-1.0, 1.0) + (c - a) * numbers.between(-1.0, 1.0);
        let uv_at = |point: DVec3| {
            let [y, z] = weights_of(&corners, point);
            let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
            a * (1.0 - y - z) + b * y + c * z
        };
        let exact = uv_at(a + step) - uv_at(a);
        let found = Vec2::from(uv_change(
            &corners.map(Vector::from),
            &uvs.map(|uv| uv.to_array()),
            step.as_vec3().into(),
        ));
        let size = uvs.iter().fold(0.0, |m: f32, uv| m.max(uv.length()));
        let error = found.as_dvec2().distance(exact) / f64::from(size);
        assert!(error < 1e-4, "{index}: {found} is off {exact} by {error:e}");

        let map = PlanarMap::new(corners[0], corners[1] - corners[0], corners[2] - corners[0]);
        let [whole, _] = map.change(Vector::from(corners[1] - corners[0]));
        assert!((whole - 1.0).abs() < 1e-5, "{whole}");
    }
}

/// The coordinates of a sphere's point, from a normal of any length.
fn sphere_uv64(n: DVec3) -> DVec2 {
    let n = normalize_f64(n);
    DVec2::new(n.x.atan2(n.z), n.y.asin() * 2.0) / std::f64::consts::TAU
}

fn change_on_sphere(normal: Vec3, turn: Vec3) -> Vec2 {
    sphere_uv_change(Vector::from(normal), turn.into()).into()
}

#[test]
fn coordinates_of_a_sphere_change_as_their_neighbours_say() {
    for index in 0..3000 {
        let mut numbers = Numbers::new(index);
        let normal = numbers.direction();
        if normal.y.abs() > 0.99 {
            continue;
        }
        let across = numbers.direction();
        let turn = (across - normal * across.dot(normal)) * STEP;
        let [after, before] = [1.0, -1.0].map(|side| sphere_uv64(normal + turn * side));
        let mut exact = (after - before) / 2.0;
        // Behind, u begins again.
        if exact.x.abs() > 0.25 {
            exact.x -= 0.5_f64.copysign(exact.x);
        }
        let found = change_on_sphere(normal.as_vec3(), turn.as_vec3()).as_dvec2();
        let error = found.distance(exact) / exact.length();
        // A step of a thousandth, near the poles of a tenth of the way there.
        assert!(error < 1e-4 / (1.0 - normal.y * normal.y), "{index}, {normal}: {error:e}");
    }
}

#[test]
fn hc30_at_the_poles_of_a_sphere_coordinates_change_by_finite_amounts() {
    for pole in [1.0, -1.0] {
        for beside in [0.0, 1e-45, 1e-30, 1e-20, 1e-7] {
            for step in [0.0, 1e-30, 1e-4, 1.0, 1e30] {
                for turn in [Vec3::X, Vec3::Z, Vec3::new(-0.6, 0.0, 0.8)] {
                    let found = change_on_sphere(Vec3::new(beside, pole, -beside), turn * step);
                    assert!(found.is_finite() && found.x.abs() <= 0.25, "{found}");
                }
            }
        }
    }
    // A step away from the pole goes along a meridian, and by as much in v.
    let [away, aside] = [Vec3::Z, Vec3::X].map(|turn| change_on_sphere(Vec3::Y, turn * 0.01));
    assert!((away.y.abs() * std::f32::consts::PI - 0.01).abs() < 1e-8 && away.x == 0.0, "{away}");
    assert!(aside == Vec2::new(0.25, 0.0), "{aside}");
}

#[test]
fn a_grazing_ray_spreads_without_bound_and_never_silently() {
    let direction = [Vec3::Y * 0.1, Vec3::Z * 0.1].map(Vector::from);
    let differential = Differential { origin: [Vec3::ZERO.into(); 2], direction };
    let [across, along] = differential.at(Vec3::X.into(), 10.0, Vec3::Y.into()).map(Vec3::from);
    assert!(!across.is_finite(), "{across}");
    assert!(!along.is_finite() || along.distance(Vec3::Z) < 1e-6, "{along}");
}
