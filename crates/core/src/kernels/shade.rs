//! The shading step of both tracers, taken at every hit.
//!
//! It returns requests and never traces: light added at once ([`ShadingPoint::local_light`]), a
//! shadow ray for each point of each light with its contribution if unoccluded
//! ([`shadow_request`]), and the mirror ray ([`mirror_request`]). Whitted, *An Improved
//! Illumination Model for Shaded Display* (1980).

use glam::Vec3;

use super::{Hemisphere, Light, LightPoint, Material, Reflection, blinn_phong};
use crate::math::float::gamma;
use crate::math::{Line, Mask, Ray, Single, Vector};

/// The inputs of shading at a hit.
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint<F: Single> {
    /// The point, in world space.
    pub point: Vector<F>,
    /// Bound on its rounding error, for each coordinate.
    pub error: Vector<F>,
    /// Geometric unit normal on the viewer's side.
    pub normal: Vector<F>,
    /// Shading unit normal on the viewer's side.
    pub shading_normal: Vector<F>,
    /// Unit direction to the origin of the ray.
    pub view: Vector<F>,
    /// Base colour, from the material or a texture: that of diffuse light.
    pub color: Vector<F>,
    /// Share of the ambient light that the surface scatters: less in cavities, of which textures
    /// tell, and less what is mirrored or refracted.
    pub occlusion: F,
    /// Emission of the material.
    pub emission: Vector<F>,
    /// Reflection parameters.
    pub reflection: Reflection<F>,
    /// Weight of the mirror ray.
    pub kr: F,
    /// Share of the light that comes from the surface, not from straight behind it.
    pub opacity: F,
    /// Whether lights reach this side.
    pub lit: F::Mask,
    /// Whether this side is the back.
    pub inside: F::Mask,
}

impl ShadingPoint<f32> {
    /// A lit point of a surface without details: the point, its error and the normal, and the
    /// direction to the viewer.
    pub fn plain([point, error, normal]: [Vec3; 3], view: Vec3, material: &Material) -> Self {
        Self {
            point: point.into(),
            error: error.into(),
            normal: normal.into(),
            shading_normal: normal.into(),
            view: view.into(),
            color: material.color.into(),
            occlusion: material.ambient,
            emission: material.emission.into(),
            reflection: material.reflection(),
            kr: material.kr,
            opacity: 1.0,
            lit: true,
            inside: false,
        }
    }
}

impl<F: Single> ShadingPoint<F> {
    /// The shading point in lane `i`.
    pub fn lane(&self, i: usize) -> ShadingPoint<f32> {
        ShadingPoint {
            point: self.point.lane(i).into(),
            error: self.error.lane(i).into(),
            normal: self.normal.lane(i).into(),
            shading_normal: self.shading_normal.lane(i).into(),
            view: self.view.lane(i).into(),
            color: self.color.lane(i).into(),
            occlusion: self.occlusion.lane(i),
            emission: self.emission.lane(i).into(),
            reflection: self.reflection.lane(i),
            kr: self.kr.lane(i),
            opacity: self.opacity.lane(i),
            lit: self.lit.bits() >> i & 1 == 1,
            inside: self.inside.bits() >> i & 1 == 1,
        }
    }

    /// The light of a hit before any further ray: the ambient part of all lights together, the
    /// hemisphere's light, and the emission.
    #[inline(always)]
    pub fn local_light(&self, ambient: f32, hemisphere: Option<&Hemisphere>) -> Vector<F> {
        let even = self.color.scale(self.occlusion * self.kr.same(ambient)) + self.emission;
        match hemisphere {
            None => even,
            Some(hemisphere) => {
                let mut ambient_light = self.scattered_ambient(hemisphere);
                if hemisphere.traced {
                    let none = Vector::splat(self.kr.token(), Vec3::ZERO);
                    ambient_light = Vector::select(self.lit, none, ambient_light);
                }
                even + self.color * ambient_light
            }
        }
    }

    /// The hemisphere's light that the surface scatters if nothing is in its way, before the
    /// diffuse colour.
    #[inline(always)]
    fn scattered_ambient(&self, hemisphere: &Hemisphere) -> Vector<F> {
        hemisphere.at(self.shading_normal).scale(self.occlusion)
    }
}

/// A shadow ray and its contribution.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRequest<F: Single> {
    /// From the surface; t = 1 at the light, or beyond the scene.
    pub line: Line<F>,
    /// The light to add if the ray is not occluded.
    pub contribution: Vector<F>,
    /// Whether the light is nearer than the point's own error; its distance then counts as that
    /// error.
    pub at_light: F::Mask,
    /// The lanes with a request.
    pub asked: F::Mask,
}

impl ShadowRequest<f32> {
    /// The ray to be traced.
    #[inline(always)]
    pub fn ray(&self) -> Ray {
        let Line { origin, direction } = self.line;
        Ray { t_max: SHADOW_END, ..Ray::new(origin.into(), direction.into()) }
    }
}

/// Where a shadow ray ends, as a share of the distance to the light.
///
/// The segment's direction is rounded, so its end is up to gamma(2) of its length off the light. A
/// surface that contains the light must not occlude it: this end lies before every point at which
/// the segment meets such a surface at more than 4 degrees. Occluders 32 ulp before the light are
/// still met.
pub const SHADOW_END: f32 = 1.0 - 16.0 * gamma(2);

/// The shadow ray from a lit point with weight `throughput` to `target`, a point of `light`, which
/// may be that of the `ambient` light; `None` if no lane has a request. Lanes without a possible
/// contribution have none: the light is behind the surface, has no strength, or is not reflected to
/// the viewer.
///
/// A light on the surface itself would be infinitely strong. Its distance counts as at least the
/// point's error bound; a light at distance zero has no direction and adds nothing.
#[inline(always)]
pub fn shadow_request<F: Single>(
    point: &ShadingPoint<F>,
    throughput: Vector<F>,
    light: &Light,
    target: &LightPoint<F>,
    ambient: Option<&Hemisphere>,
) -> Option<ShadowRequest<F>> {
    if let Some(distance) = light.emitter.ambient_reach() {
        let ambient = point.scattered_ambient(ambient?).over(point.kr.same(light.samples() as f32));
        return ambient_request(point, throughput * ambient, distance, target);
    }
    let zero = point.kr.zero();
    let is_distant = light.emitter.is_distant();
    let towards = if is_distant { target.position } else { target.position - point.point };
    let to_light = towards.normalize_in_single();
    let asked = point.lit & point.normal.dot(to_light).gt(zero);
    if !asked.any() {
        return None;
    }
    let least = point.error.max_abs();
    let distance = towards.dot(towards).sqrt();
    let reflected = blinn_phong::reflect(
        &point.reflection,
        point.color,
        point.shading_normal,
        point.view,
        to_light,
    );
    let strength = light.share_at(distance.max(least), towards) / zero.same(light.samples() as f32);
    let power = Vector::splat(zero.token(), light.power).scale(strength);
    let contribution = throughput * (reflected * power);
    let asked = asked & contribution.is_not_zero();
    if !asked.any() {
        return None;
    }
    let origin = point.point.offset_origin(point.error, point.normal, to_light);
    let end = target.position.offset_end(target.error, target.normal, -to_light);
    let line = Line { origin, direction: if is_distant { towards } else { end - origin } };
    // A ray that starts at the light itself has no direction and adds nothing.
    let asked = asked & line.origin.is_finite() & line.direction.is_finite();
    // A distant light is at no surface.
    let at_light = distance.lt(if is_distant { zero } else { least });
    let request = ShadowRequest { line, contribution, at_light, asked };
    asked.any().then_some(request)
}

/// The ray that finds whether anything up to a `distance` is in the way of ambient light; `target`
/// is a point of the unit sphere. All rays together have the contribution that
/// [`ShadingPoint::local_light`] adds without them, so light that arrives has no noise.
///
/// Directions below the surface, for which the shading normal leans, are mirrored at it.
#[inline(always)]
fn ambient_request<F: Single>(
    point: &ShadingPoint<F>,
    ambient: Vector<F>,
    distance: f32,
    target: &LightPoint<F>,
) -> Option<ShadowRequest<F>> {
    let zero = point.kr.zero();
    let direction = (point.shading_normal + target.position).normalize_in_single();
    let height = direction.dot(point.normal);
    let above = direction - point.normal.scale((height + height).min(zero));
    let contribution = ambient * point.color;
    let origin = point.point.offset_origin(point.error, point.normal, above);
    let line = Line { origin, direction: above.scale(zero.same(distance)) };
    let asked = point.lit & contribution.is_not_zero() & line.is_valid();
    let at_light = F::mask(zero.token(), 0);
    asked.any().then_some(ShadowRequest { line, contribution, at_light, asked })
}

/// Half of one of 255 linear levels: less light than this does not show.
pub const HALF_LEVEL: f32 = 0.5 / 255.0;

/// Which rays end where a path is split, as they could show nothing.
///
/// A ray is faint if what surfaces reflect, which counts as white, is less than half a level after its weight. Of what
/// faint rays meet only light counts that is brighter by as much, so that it does not matter to a pixel what else there
/// is; and they end if nothing in the scene is so bright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visible {
    /// Half of one of 255 levels, as the image is exposed.
    half_level: f32,
    /// Rays of less weight than this end.
    least: f32,
}

impl Visible {
    /// Of a scene in which nothing is brighter than `brightest`, in an image that multiplies light by `exposure`; as it
    /// is if that is less.
    pub fn new(brightest: f32, exposure: f32) -> Self {
        let half_level = HALF_LEVEL / exposure.max(1.0);
        // Less by some roundings, so that no light is lost that counts.
        let margin = if brightest > 1.0 { 1.0 - gamma(8) } else { 1.0 };
        Self { half_level, least: half_level * margin / brightest.max(1.0) }
    }

    /// Whether faint rays go on.
    #[inline(always)]
    pub fn has_faint(&self) -> bool {
        self.least < self.half_level
    }

    /// Whether rays of these weights go on.
    #[inline(always)]
    pub fn goes_on<F: Single>(&self, weight: Vector<F>) -> F::Mask {
        let largest = weight.x.max(weight.y.max(weight.z));
        largest.gt(largest.zero()) & largest.ge(largest.same(self.least))
    }

    /// Whether rays of these weights are faint.
    #[inline(always)]
    pub fn is_faint<F: Single>(&self, weight: Vector<F>) -> F::Mask {
        let largest = weight.x.max(weight.y.max(weight.z));
        largest.lt(largest.same(self.half_level))
    }

    /// Whether light of a faint ray of this weight counts: that of something of this brightness.
    #[inline(always)]
    pub fn counts(&self, weight: Vec3, brightness: Vec3) -> bool {
        weight.max_element() * brightness.max_element().max(1.0) >= self.half_level
    }
}

/// A mirror ray and its throughput.
#[derive(Clone, Copy, Debug)]
pub struct MirrorRequest<F: Single> {
    /// The ray, with unit direction.
    pub line: Line<F>,
    /// Throughput of the path from this ray on.
    pub throughput: Vector<F>,
    /// The lanes with a request.
    pub asked: F::Mask,
}

/// The mirror ray of a point with weight `throughput`, if this side of the surface is a mirror and
/// the reflected light can still contribute.
#[inline(always)]
pub fn mirror_request<F: Single>(
    point: &ShadingPoint<F>,
    throughput: Vector<F>,
) -> Option<MirrorRequest<F>> {
    let asked = point.lit & point.kr.gt(point.kr.zero());
    if !asked.any() {
        return None;
    }
    let (direction, _) = mirrored(point.view, point.shading_normal, point.normal);
    let throughput = throughput * point.reflection.tint.scale(point.kr);
    let origin = point.point.offset_origin(point.error, point.normal, direction);
    let line = Line { origin, direction };
    let asked = asked & throughput.is_not_zero() & line.is_valid();
    asked.any().then_some(MirrorRequest { line, throughput, asked })
}

/// `view` mirrored about the shading normal, and true in those lanes; otherwise about the geometric
/// normal. Reflection about an interpolated normal may point into the surface; reflection about the
/// geometric normal cannot.
#[inline(always)]
pub fn mirrored<F: Single>(
    view: Vector<F>,
    shading_normal: Vector<F>,
    normal: Vector<F>,
) -> (Vector<F>, F::Mask) {
    let smooth = reflection(view, shading_normal);
    let leaves = smooth.dot(normal).gt(view.x.zero());
    if !(!leaves).any() {
        return (smooth, leaves);
    }
    (Vector::select(leaves, smooth, reflection(view, normal)), leaves)
}

/// `view` mirrored about the unit vector `normal`.
#[inline(always)]
fn reflection<F: Single>(view: Vector<F>, normal: Vector<F>) -> Vector<F> {
    (normal.scale(view.dot(normal).times(2.0)) - view).normalize_in_single()
}
