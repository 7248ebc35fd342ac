//! Ray differentials: how a ray changes from one sample of the image to the next, and the footprint
//! of a sample on a surface (Igehy, *Tracing Ray Differentials*, SIGGRAPH 1999).
//!
//! A differential is a pair of derivatives, for a step to the right and a step down in the image.
//! Each function here differentiates a stage of the ray's path: the camera creates the differential
//! ([`Camera::differential`]), the transfer to a surface moves it ([`Differential::at`]), and
//! reflection or refraction turns it ([`Differential::turned`]). At a surface, the change of the point becomes
//! a change of texture coordinates: [`PlanarMap::change`], [`sphere_uv_change`] and [`uv_change`].
//!
//! Changes in triangles, whose edges may be nearly parallel, and on spheres, near whose poles they are large, are computed
//! in double precision, all else in single. At grazing angles the derivative is unbounded, so results may be infinite or NaN. They stay so: textures use the coarsest level for
//! values that are not finite ([`Image::level`]).
//!
//! [`Camera::differential`]: super::camera::Camera::differential
//! [`PlanarMap::change`]: super::texture::PlanarMap::change
//! [`sphere_uv_change`]: super::texture::sphere_uv_change
//! [`Image::level`]: super::texture::Image::level

use crate::math::{Real, Single, Vector, both};

/// The derivatives of a ray, or of a ray in each lane, for a step to the right and one down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differential<F = f32> {
    /// Of the origin, in scene units per sample.
    pub origin: [Vector<F>; 2],
    /// Of the unit direction.
    pub direction: [Vector<F>; 2],
}

/// What is known of the footprint of a ray.
#[derive(Clone, Copy, Debug)]
pub enum Footprint {
    /// Of a camera ray: its share of a pixel ([`Camera::footprint`]). Its differential follows from its direction.
    ///
    /// [`Camera::footprint`]: super::camera::Camera::footprint
    Camera(f32),
    /// The differential that the ray carries.
    Carried(Differential),
}

impl<F: Single> Differential<F> {
    /// The changes of the points at `t` of rays in these directions on surfaces with these geometric
    /// normals, on either side: neighbouring rays meet the plane through the point.
    #[inline(always)]
    pub fn at(&self, direction: Vector<F>, t: F, normal: Vector<F>) -> [Vector<F>; 2] {
        let towards = direction.dot(normal);
        let ([right, down], [turn_right, turn_down]) = (self.origin, self.direction);
        both(
            [(right, turn_right), (down, turn_down)],
            #[inline(always)]
            |(origin, turn)| {
                let sideways = origin + turn.scale(t);
                let farther = -sideways.dot(normal) / towards;
                sideways + direction.scale(farther)
            },
        )
    }

    /// Replaces the differential in lane `i`.
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, of: &Differential) {
        let Differential { origin, direction } = of;
        let own = self.origin.iter_mut().chain(&mut self.direction);
        own.zip(origin.iter().chain(direction)).for_each(|(own, of)| own.set_lane(i, (*of).into()));
    }

    /// The differentials of the rays that those in these directions become about the unit vectors
    /// `normal`, if points change by `steps` and normals by `turns`: mirrored, or refracted with these
    /// unit directions and ratios of the index of refraction before to that behind.
    #[inline(always)]
    pub fn turned(
        &self,
        direction: Vector<F>,
        steps: [Vector<F>; 2],
        normal: Vector<F>,
        turns: [Vector<F>; 2],
        refracted: Option<(Vector<F>, F)>,
    ) -> Self {
        let before = direction.dot(normal);
        // What the direction, with this weight, moves along the normal, and how that changes with
        // `before`. Mirrored, it leaves as far from the plane as it arrives.
        let two = before.same(2.0);
        let (ratio, along, change_along) = match refracted {
            None => (before.same(1.0), two * before, two),
            Some((bent, ratio)) => {
                let behind = bent.dot(normal);
                (ratio, ratio * before - behind, ratio - ratio * ratio * before / behind)
            }
        };
        let ([right, down], [turn_right, turn_down]) = (self.direction, turns);
        let direction = both(
            [(right, turn_right), (down, turn_down)],
            #[inline(always)]
            |(change, turn)| {
                let cosine_changes = change.dot(normal) + direction.dot(turn);
                let moved = turn.scale(along) + normal.scale(change_along * cosine_changes);
                change.scale(ratio) - moved
            },
        );
        Self { origin: steps, direction }
    }

    /// The differential in lane `i`.
    pub fn lane(&self, i: usize) -> Differential {
        let ([a, b], [c, d]) = (&self.origin, &self.direction);
        Differential {
            origin: [a.lane(i).into(), b.lane(i).into()],
            direction: [c.lane(i).into(), d.lane(i).into()],
        }
    }
}

/// How the interpolated normals of triangles change with the point.
///
/// `normals` are the values at the `corners`, and `normal` is the interpolated unit normal at
/// `point`, on either side. Zero if the normals cancel out.
#[inline(always)]
pub fn turn_between<F: Single>(
    corners: &[Vector<F>; 3],
    normals: &[Vector<F>; 3],
    (point, normal): (Vector<F>, Vector<F>),
    step: Vector<F>,
) -> Vector<F> {
    let [a, b, c] = normals;
    let (a, b, c) = (a.widen(), b.widen(), c.widen());
    let [y, z] = weights(corners, point - corners[0]);
    let sum = a.scale(y.same(1.0) - y - z) + b.scale(y) + c.scale(z);
    let length = sum.dot(sum).sqrt();
    let [y, z] = weights(corners, step);
    let change = (b - a).scale(y) + (c - a).scale(z);
    let unit = sum.over(length);
    let turn = (change - unit.scale(unit.dot(change))).over(length);
    let zero = length.zero();
    let is_behind = unit.dot(normal.widen()).lt(zero);
    let turn = Vector::select(is_behind, -turn, turn);
    let still = Vector::new(zero, zero, zero);
    Vector::narrow(Vector::select(length.eq(zero), still, turn))
}

/// The changes of texture coordinates for a `step` on triangles with `uvs` at their `corners`.
#[inline(always)]
pub fn uv_change<F: Single>(
    corners: &[Vector<F>; 3],
    uvs: &[[F; 2]; 3],
    step: Vector<F>,
) -> [F; 2] {
    let [[au, av], [bu, bv], [cu, cv]] = *uvs;
    let [y, z] = weights(corners, step);
    both(
        [[au, bu, cu], [av, bv, cv]],
        #[inline(always)]
        |[a, b, c]| {
            let a = a.widen();
            F::narrow((b.widen() - a) * y + (c.widen() - a) * z)
        },
    )
}

/// The components of `step` along the edges from the first corner to the second and to the third:
/// the changes of their barycentric coordinates.
#[inline(always)]
fn weights<F: Single>([a, b, c]: &[Vector<F>; 3], step: Vector<F>) -> [F::Double; 2] {
    let (a, b, c, step) = (a.widen(), b.widen(), c.widen(), step.widen());
    let (to_b, to_c) = (b - a, c - a);
    let normal = to_b.cross(to_c);
    let area = normal.dot(normal);
    [step.cross(to_c).dot(normal) / area, to_b.cross(step).dot(normal) / area]
}
