//! The faults, from the ray to the image.

/// A wrong expression in place of a right one.
pub(crate) struct Fault {
    /// What is wrong then.
    pub(crate) name: &'static str,
    /// The number of the hard case that must fail.
    pub(crate) case: u32,
    /// Where, from the root of the repository.
    pub(crate) file: &'static str,
    /// The expression there, which its file has once.
    pub(crate) right: &'static str,
    pub(crate) wrong: &'static str,
}

macro_rules! faults {
    ($($name:literal, $case:literal, $file:literal: $right:literal => $wrong:literal;)+) => {
        &[$(Fault { name: $name, case: $case, file: $file, right: $right, wrong: $wrong }),+]
    };
}

/// All faults.
pub(crate) const FAULTS: &[Fault] = faults! {
    "rays begin at an epsilon", 10, "crates/core/src/accel/single.rs":
        "PreparedRay::new(ray)"
            => "PreparedRay::new(&Ray { t_min: ray.t_min.max(1e-4), ..*ray })";

    "reciprocals are clamped", 1, "crates/core/src/kernels/slab.rs":
        "direction.recip()"
            => "direction.recip().clamp(Vec3A::splat(-1.0 / f32::EPSILON), Vec3A::splat(1.0 / f32::EPSILON))";
    "the sign of a zero is lost", 5, "crates/core/src/kernels/slab.rs":
        "reciprocal.cmplt(Vec3A::ZERO)" => "direction.cmplt(Vec3A::ZERO)";
    "boxes are left before their roundings", 2, "crates/core/src/accel/node.rs":
        "F::splat(simd, WIDENING)" => "F::splat(simd, 1.0)";
    "boxes of negative t are left before their roundings", 48, "crates/core/src/kernels/slab.rs":
        "16.0 * UNIT_ROUNDOFF * (-t_min)" => "0.0 * (-t_min)";
    "crossings without a reciprocal are known", 6, "crates/core/src/kernels/slab.rs":
        "Vec3A::select(unknown, -before, origin - shift)" => "(origin - shift)";
    "near planes of boxes are taken for far ones", 3, "crates/core/src/accel/node.rs":
        "ray.entry[k] as usize % rows.len()" => "2 * k";
    "the second of two children is lost", 3, "crates/core/src/accel/node.rs":
        "(Some(child_of(node, at, first)), height + 1)" => "(Some(child_of(node, at, first)), height)";
    "boxes just before a hit are skipped", 3, "crates/core/src/accel/single.rs":
        "distance(entry) > ray.slab.reach(best.high)" => "distance(entry) > best.high";
    "a tile answers for rays that it has not", 49, "crates/core/src/accel/packet/tile.rs":
        "self.rays >> i & 1 == 1" => "i < TILE";
    "rays of a tile change places", 3, "crates/core/src/accel/packet/columns.rs":
        "index & 0b100011 | (index & 0b001100) << 1 | (index & 0b010000) >> 2" => "index";

    "the last triangle of a leaf is lost", 1, "crates/core/src/accel/leaf.rs":
        "(1 << count) - 1" => "(1 << count.saturating_sub(1)) - 1";
    "the first triangle of a leaf is named for others", 3, "crates/core/src/accel/best.rs":
        "arena.number_of(Ref::from_bits(self.leaf), self.entry as usize)"
            => "arena.number_of(Ref::from_bits(self.leaf), 0)";
    "t is weighed by the wrong corners", 3, "crates/core/src/kernels/triangle/filter.rs":
        "a.mul_add(az, b.mul_add(bz, c * cz))" => "a.mul_add(bz, b.mul_add(cz, c * az))";
    "an edge belongs to neither of its triangles", 4, "crates/core/src/kernels/triangle/exact.rs":
        "any(Ordering::Less) && any(Ordering::Greater)"
            => "any(Ordering::Equal) || any(Ordering::Less) && any(Ordering::Greater)";
    "what lies beyond the end of a ray is hit", 48, "crates/core/src/kernels/triangle/exact.rs":
        "t.is_within([ray.t_min, ray.t_max])" => "t.is_within([ray.t_min, f32::INFINITY])";
    "a negative t is before every range", 48, "crates/core/src/math/exact.rs":
        "end.clamp(f32::MIN, f32::MAX)" => "end.clamp(0.0, f32::MAX)";
    "what rounding takes for the inside is certain", 49, "crates/core/src/kernels/triangle/filter.rs":
        "least.simd_gt(edge) | most.simd_lt(-edge)"
            => "least.simd_gt(all(0.0)) | most.simd_lt(all(0.0))";
    "edge functions of a leaf have no error", 1, "crates/core/src/kernels/triangle/filter.rs":
        "22.0 * U * (aside * (aside + depth)) + UNDERFLOW" => "0.0 * aside * depth";
    "edge functions of a triangle have no error", 1, "crates/core/src/kernels/triangle/filter.rs":
        "all(22.0 * U)" => "all(0.0 * U)";
    "the vertices of a leaf are all at its first", 51, "crates/core/src/kernels/triangle/filter.rs":
        "2.001 * extent" => "0.0 * extent";
    "the error of edge functions does not move t", 49, "crates/core/src/kernels/triangle/filter.rs":
        "(far - near) * 3.1" => "(far - near) * 0.0";
    "t along a ray has no roundings", 21, "crates/core/src/kernels/triangle/filter.rs":
        "depth * (12.0 * U)" => "depth * (0.0 * U)";
    "what single precision leaves open is a miss", 1, "crates/core/src/kernels/triangle/filter.rs":
        "candidates & !certain" => "0";
    "hits that may come first are too far", 21, "crates/core/src/kernels/triangle/filter.rs":
        "low.simd_gt(reach)" => "high.simd_gt(reach)";
    "a zero in double precision is outside", 48, "crates/core/src/kernels/triangle/settle.rs":
        "value.lt(-error)" => "!value.gt(error)";
    "t in double precision has the digits of single", 3, "crates/core/src/kernels/triangle/settle.rs":
        "height * part" => "(height * part).times(1.0 + 1e-7)";
    "sides in a tile have no error", 49, "crates/core/src/accel/packet/frame/triangles.rs":
        "1.01 * U" => "0.0 * U";
    "t in a tile has no error", 49, "crates/core/src/accel/packet/frame/triangles.rs":
        "18.0 * U * ratio" => "0.0 * U * ratio";
    "normals in a tile have no error", 49, "crates/core/src/accel/packet/frame/triangles.rs":
        "14.0 * U" => "0.0 * U";
    "what a tile leaves open is a miss", 51, "crates/core/src/accel/packet/frame/triangles.rs":
        "maybe & !inside" => "0";
    "all rays of a tile start in its middle", 8, "crates/core/src/accel/packet/frame/triangles.rs":
        "dot(simd, &prepared.normal, triangle, &o)" => "f32x16::splat(simd, 0.0)";
    "hits that may come first are too far for a tile", 49, "crates/core/src/accel/packet/leaves.rs":
        "low.simd_gt(best[1])" => "high.simd_gt(best[0])";
    "what ended a tile ends the next", 49, "crates/core/src/accel/packet.rs":
        "self.ends_as_before(tile)" => "Q::ANY && self.ending.is_some()";
    "triangles without area have one", 18, "crates/core/src/kernels/triangle.rs":
        "collinear(0, 1) && collinear(1, 2) && collinear(2, 0)" => "false";
    "of equal hits the last is the first", 21, "crates/core/src/accel/order.rs":
        "self.hit.primitive.cmp(&other.hit.primitive)"
            => "other.hit.primitive.cmp(&self.hit.primitive)";
    "of hits whose t round alike the first is closest", 49, "crates/core/src/accel/order.rs":
        "self.order_of_t(other)" => "Ordering::Equal";
    "surfaces in one plane are ordered by rounding", 21, "crates/core/src/accel/best.rs":
        "new.low > self.high" => "new.low >= self.low";
    "the far root of a sphere is forgotten", 16, "crates/core/src/kernels/sphere.rs":
        "Real::select(is_first, roots.near, roots.far)" => "roots.near";
    "a quad has its other diagonal", 34, "crates/core/src/kernels/quad.rs":
        "[[a, b, c], [a, c, d]]" => "[[a, b, d], [b, c, d]]";
    "rays of instances have another unit of t", 44, "crates/core/src/geometry/instance.rs":
        "self.to_prototype.transform_vector3(ray.direction.as_dvec3()).as_vec3()"
            => "self.to_prototype.transform_vector3(ray.direction.as_dvec3()).normalize().as_vec3()";
    "boxes of instances are not padded", 44, "crates/core/src/geometry/instance.rs":
        "Aabb { low: world.low - pad, high: world.high + pad }" => "world";
    "an equal hit of an instance is too far", 44, "crates/core/src/accel/instances.rs":
        "self.best.t.next_up()" => "self.best.t";
    "a leaf is smaller than its triangles", 1, "crates/core/src/accel/arena/layout.rs":
        "max(along(0), max(along(1), along(2))).next_up()" => "0.0";
    "alpha at its threshold is a hole", 45, "crates/core/src/geometry/cutouts.rs":
        "image.look_up(uv, self.filter, self.wrap).x * alpha < self.threshold"
            => "image.look_up(uv, self.filter, self.wrap).x * alpha <= self.threshold";

    "rays start on the surface that they leave", 9, "crates/core/src/math/vector.rs":
        "self.move_along(normal, direction, error.element_sum().times(STEEPEST_CREASE))" => "self";
    "a light at a point is infinitely strong", 32, "crates/core/src/kernels/shade.rs":
        "distance.max(least)" => "distance";
    "mirrors return too little", 35, "crates/core/src/kernels/shade.rs":
        "throughput * point.reflection.tint.scale(point.kr)"
            => "throughput * point.reflection.tint.scale(point.kr.times(0.999))";
    "shadow rays of single paths end on their light", 11, "crates/core/src/kernels/shade.rs":
        "Ray { t_max: SHADOW_END, ..Ray::new(origin.into(), direction.into()) }"
            => "Ray { t_max: 1.0, ..Ray::new(origin.into(), direction.into()) }";
    "shadow rays of batches end on their light", 11, "crates/core/src/wavefront/batch.rs":
        "(None, SHADOW_END)"
            => "(None, 1.0)";
    "shadow rays end beyond the surface of their light", 11, "crates/core/src/kernels/shade.rs":
        "target.position.offset_end(target.error, target.normal, -to_light)" => "target.position";
    "the error of the end of a shadow ray has a sign", 11, "crates/core/src/math/vector.rs":
        "normal.abs().dot(error)" => "normal.dot(error)";
    "lights shine less than nothing on what is behind them", 11, "crates/core/src/kernels/shade.rs":
        "Vector::splat(zero.token(), light.power).scale(strength)"
            => "Vector::splat(zero.token(), light.power).scale(strength * target.normal.dot(-to_light))";
    "the error along x is that along all axes", 32, "crates/core/src/kernels/shade.rs":
        "point.error.max_abs()" => "point.error.x";
    "opposite directions have a half vector that is no number", 36, "crates/core/src/kernels/blinn_phong.rs":
        "(view + to_light).normalize()"
            => "(view + to_light).scale(zero.same(1.0) / (view + to_light).dot(view + to_light).sqrt())";
    "lights shine through the back of a surface", 32, "crates/core/src/kernels/shade.rs":
        "point.lit & point.normal.dot(to_light).gt(zero)" => "point.lit";
    "cones of 0 degrees light their axis", 41, "crates/scene/src/lights/point.rs":
        "spot.outer_degrees == 0.0" => "false";
    "far scenes are not moved to the camera", 7, "crates/scene/src/systems/frame.rs":
        "if far { nearest(view.location, distance) } else { DVec3::ZERO }" => "DVec3::ZERO";

    "emission maps are ignored", 50, "crates/core/src/prepared/maps.rs":
        "point.emission * texel" => "point.emission";
    "roughness is read from blue", 50, "crates/core/src/prepared/maps.rs":
        "texel.y.times(roughness)" => "texel.z.times(roughness)";
    "bitangents point backwards", 50, "crates/core/src/prepared/maps.rs":
        "normal.cross(tangent)" => "tangent.cross(normal)";
    "vertex colours are ignored", 46, "crates/core/src/prepared/group.rs":
        "color * tint" => "color";
    "levels are those of shorter sides", 52, "crates/core/src/kernels/texture.rs":
        "across.gt(down)" => "down.gt(across)";
    "repeated images end at their edges", 30, "crates/core/src/kernels/texture/wrap.rs":
        "[last, zero]" => "[zero, last]";
    "classes share a span", 50, "crates/core/src/wavefront/faces.rs":
        "class * ShadingKind::ALL.len() as u32 + kind as u32" => "class.min(0) + kind as u32";
    "spans end before their last hit", 50, "crates/core/src/wavefront/faces.rs":
        "end..end + *place as usize" => "end..end + *place as usize - 1";
    "sorted hits take each other's places", 50, "crates/core/src/wavefront/faces.rs":
        "*place += 1" => "*place += 0";
    "spans are of triangles", 50, "crates/core/src/wavefront/faces.rs":
        "ShadingKind::ALL[key as usize % ShadingKind::ALL.len()]" => "ShadingKind::ALL[key as usize % 1]";
    "mirrors show what is below them", 50, "crates/core/src/kernels/shade.rs":
        "smooth.dot(normal).gt(view.x.zero())" => "smooth.dot(smooth).gt(view.x.zero())";
    "infinite footprints have a level", 52, "crates/core/src/kernels/texture.rs":
        "across.lt(infinity).bits() & down.lt(infinity).bits()" => "u32::MAX";
    "a sphere shows half of its image", 30, "crates/core/src/kernels/texture/coordinates.rs":
        "0.5 + libm::atan2f(x, z) / TAU" => "0.25 + libm::atan2f(x, z) / (2.0 * TAU)";
    "texels that are no numbers are kept", 53, "crates/scene/src/image_file.rs":
        "if x.is_finite() { x } else { 0.0 }" => "x";
    "all rays of a lens start in its middle", 54, "crates/core/src/kernels/camera.rs":
        "origin + offset" => "origin";
    "samples are added up in single precision", 54, "crates/core/src/tile.rs":
        "f64::from(value)" => "f64::from(*sum as f32 + value) - *sum";
    "all pixels have the same random numbers", 54, "crates/core/src/math/random.rs":
        "[self.pixel, self.sample, self.bounce, dimension]"
            => "[0, self.sample, self.bounce, dimension]";

    "what tiles of rays pass is not noted", 57, "crates/core/src/accel/packet.rs":
        "Q::ANY && tile.passing != 0" => "Q::ANY && tile.passing > 1";
    "what a ray passes in lists is noted for the next one", 57, "crates/core/src/accel/leaf.rs":
        "noted.note_list(searched, number, place)"
            => "noted.note_list(searched, number + 1, place)";
    "solids are entered where they are left", 57, "crates/core/src/prepared/media.rs":
        "!leaves" => "leaves";
    "the medium is the solid that was entered first", 57, "crates/core/src/math/multisets.rs":
        "*first < number" => "*first < u32::MAX";
    "surfaces at one place are crossed one by one", 57, "crates/core/src/prepared/interface.rs":
        "(last.point - found.point).dot(last.normal)" => "f32::INFINITY";
    "inner surfaces of a solid are seen", 57, "crates/core/src/prepared/interface.rs":
        "shape.solid.is_none() || self.differ(&sides)" => "true || self.differ(&sides)";
    "shadow rays enter what they leave", 57, "crates/core/src/prepared/shadow_crossings.rs":
        "scene.sides(media, own, first.inside, all)" => "scene.sides(media, own, !first.inside, all)";
    "light is absorbed up to the next surface alone", 57, "crates/core/src/prepared/shadow_crossings.rs":
        "first.distance - from" => "first.distance";
};
