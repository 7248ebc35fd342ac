//! The differentials of rays that go on from hits.
//!
//! Only rays that may show trilinear textures have any.

use glam::Vec3;

use super::{Group, GroupHits, PreparedScene, SampleCounts, three};
use crate::accel::Hit;
use crate::geometry::ShadingKind;
use crate::kernels::differential::turn_between;
use crate::kernels::{Differential, Footprint, ShadingPoint, shade};
use crate::math::{Line, Mask, Ray, Single, Vector, both};
use crate::plan::schedule::Step;

impl PreparedScene {
    /// Whether rays from surfaces have differentials. Those of camera rays follow from their directions
    /// ([`Camera::differential`](crate::kernels::camera::Camera::differential)) and are never
    /// stored.
    pub fn carries_differentials(&self) -> bool {
        let schedule = self.plan.schedule();
        (self.bounces > 0 || schedule.has_transmission()) && schedule.runs(Step::Differentials)
    }

    /// The differentials of rays, which carry one each or come from the camera.
    #[inline(always)]
    pub(super) fn incoming_differentials<F: Single>(
        &self,
        direction: Vector<F>,
        footprint: &dyn Fn(usize) -> Footprint,
    ) -> Differential<F> {
        let mut shares = direction.x.zero();
        for lane in 0..F::LANES {
            if let Footprint::Camera(share) = footprint(lane) {
                shares.set_lane(lane, share);
            }
        }
        let mut found = self.camera.differential(direction, shares);
        for lane in 0..F::LANES {
            if let Footprint::Carried(carried) = footprint(lane) {
                found.set_lane(lane, &carried);
            }
        }
        found
    }

    /// The differential of the mirror ray at `point`, from the footprint of `ray`, which arrives there with `hit`.
    pub fn mirrored(
        &self,
        footprint: Footprint,
        (ray, hit): (&Ray, &Hit),
        point: &ShadingPoint<f32>,
        look_ups: &mut SampleCounts,
    ) -> Differential {
        look_ups.footprints += 1;
        let hits = (self.accel.geometry().kind(hit.primitive), &Line::from(ray), hit.t);
        self.group(ray, hit).mirrored(self, hits, &|_| footprint, point)
    }
}

impl<F: Single> Group<F> {
    /// The differentials of the mirror rays at the points, of rays that carry differentials or come from the
    /// camera.
    #[inline(always)]
    pub fn mirrored(
        &self,
        scene: &PreparedScene,
        hits: GroupHits<'_, F>,
        footprint: &dyn Fn(usize) -> Footprint,
        point: &ShadingPoint<F>,
    ) -> Differential<F> {
        let from = scene.incoming_differentials(hits.1.direction, footprint);
        let (_, smooth) = shade::mirrored(point.view, point.shading_normal, point.normal);
        self.turned(scene, hits, &from, (point, smooth), None)
    }

    /// The differentials of the rays that turn at the points about their interpolated normals if `smooth`,
    /// else about the geometric ones: see [`Differential::turned`].
    #[inline(always)]
    pub(super) fn turned(
        &self,
        scene: &PreparedScene,
        (kind, line, t): GroupHits<'_, F>,
        from: &Differential<F>,
        (point, smooth): (&ShadingPoint<F>, F::Mask),
        refracted: Option<(Vector<F>, F)>,
    ) -> Differential<F> {
        let steps = from.at(line.direction, t, point.normal);
        let turns = self.turns(scene, kind, steps, (point, smooth));
        let about = Vector::select(smooth, point.shading_normal, point.normal);
        from.turned(line.direction, steps, about, turns, refracted)
    }

    /// The changes of the normals with the points.
    #[inline(always)]
    fn turns(
        &self,
        scene: &PreparedScene,
        kind: ShadingKind,
        steps: [Vector<F>; 2],
        (point, smooth): (&ShadingPoint<F>, F::Mask),
    ) -> [Vector<F>; 2] {
        let token = point.kr.token();
        let still = Vector::splat(token, Vec3::ZERO);
        if kind == ShadingKind::Quadrics {
            let [center, radius, front] = three(token, &self.corners);
            let is_behind = (point.point - center).dot(point.normal).lt(point.kr.zero());
            return both(
                steps,
                #[inline(always)]
                |step| {
                    let turn = step.over(radius.x);
                    let turn = Vector::select(is_behind, -turn, turn);
                    Vector::select(front.is_not_zero(), still, turn)
                },
            );
        }
        let (normals, smooth) = (three(token, &self.normals), smooth & F::mask(token, self.smooth));
        if !smooth.any() {
            return [still; 2];
        }
        let corners = self.corners_in_world(token, scene.accel.geometry());
        let at = (point.point, point.shading_normal);
        both(
            steps,
            #[inline(always)]
            |step| Vector::select(smooth, turn_between(&corners, &normals, at, step), still),
        )
    }
}
