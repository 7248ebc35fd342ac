//! The faults, from the ray to the image.

/// A wrong expression in place of a right one.
pub(crate) struct Fault {
    /// What is wrong then.
    pub(crate) name: &'static str,
    /// The hard case that must fail.
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
    "rays begin at an epsilon", 10, "crates/core/src/accel/compiled.rs":
        "PreparedRay::of::<P>(self.ray)"
            => "PreparedRay::of::<P>(&Ray { t_min: self.ray.t_min.max(1e-4), ..*self.ray })";

    "reciprocals are clamped", 1, "crates/core/src/kernels/slab.rs":
        "direction.recip()"
            => "direction.recip().clamp(Vec3A::splat(-1.0 / f32::EPSILON), Vec3A::splat(1.0 / f32::EPSILON))";
    "the sign of a zero is lost", 5, "crates/core/src/kernels/slab.rs":
        "negative.into()" => "direction.cmplt(Vec3A::ZERO).into()";
    "boxes are not padded", 2, "crates/core/src/kernels/slab.rs":
        "PADDING * max(max_abs(self.low), max_abs(self.high))" => "0.0";
    "origins are not moved for boxes", 43, "crates/core/src/kernels/slab.rs":
        "max(factor * PADDING * origin.abs().max_element(), f32::MIN_POSITIVE)" => "f32::MIN_POSITIVE";
    "near planes of boxes are taken for far ones", 3, "crates/core/src/accel/node.rs":
        "planes[usize::from(ray.negative[k])]" => "planes[0]";
    "the second of two children is lost", 3, "crates/core/src/accel/node.rs":
        "(Some(child_of(node, at, first)), height + 1)" => "(Some(child_of(node, at, first)), height)";
    "boxes just before a hit are skipped", 3, "crates/core/src/accel/tree.rs":
        "t + t.abs() * BEYOND" => "t - t.abs() * 0.01";
    "rays of a tile change places", 3, "crates/core/src/accel/packet/tile.rs":
        "index & 0b100011 | (index & 0b001100) << 1 | (index & 0b010000) >> 2" => "index";

    "the last triangle of a leaf is lost", 1, "crates/core/src/accel/leaf.rs":
        "(1 << count) - 1" => "(1 << count.saturating_sub(1)) - 1";
    "the first triangle of a leaf is named for others", 3, "crates/core/src/accel/leaf.rs":
        "Hit { t: hits.t[lane], primitive: arena.number(first, lane) }"
            => "Hit { t: hits.t[lane], primitive: arena.number(first, 0) }";
    "t is weighed by the wrong corners", 3, "crates/core/src/kernels/triangle/edges.rs":
        "sorted([*e0 * *az, *e1 * *bz, *e2 * *cz])" => "sorted([*e0 * *bz, *e1 * *cz, *e2 * *az])";
    "an edge belongs to neither of its triangles", 4, "crates/core/src/kernels/triangle.rs":
        "edges.iter().any(|&e| e < 0.0) && edges.iter().any(|&e| e > 0.0)"
            => "edges.iter().any(|&e| e <= 0.0) && edges.iter().any(|&e| e >= 0.0)";
    "what lies beyond the end of a ray is hit", 40, "crates/core/src/kernels/triangle/edges.rs":
        "self.t.gt(range.t_min) & self.t.lt(range.t_max)" => "self.t.gt(range.t_min)";
    "a negative t is before every range", 40, "crates/core/src/kernels/triangle/edges.rs":
        "range.t_min.min(self.far.zero())" => "range.t_min.max(self.far.zero())";
    "hits beside an edge count without a surface", 37, "crates/core/src/accel/near.rs":
        "is_met(t).then_some(t)" => "Some(t)";
    "hits beside an edge are lost", 1, "crates/core/src/accel/near.rs":
        "is_surface(self.geometry, number, &endless, t, found)" => "false";
    "a quad is not the surface beside its own half", 47, "crates/core/src/accel/near.rs":
        "found.primitive == number" => "false";
    "triangles without area seal no gap", 18, "crates/core/src/accel.rs":
        "seals::find(geometry, degenerate)" => "Seals::default()";
    "of equal hits the last is the first", 21, "crates/core/src/accel/ties.rs":
        "self.primitive < other.primitive" => "self.primitive > other.primitive";
    "surfaces in one plane are ordered by rounding", 38, "crates/core/src/accel/ties.rs":
        "are_close(new.t, best.t)" => "false";
    "the far root of a sphere is forgotten", 16, "crates/core/src/kernels/sphere.rs":
        "Real::select(counts(near), near, far)" => "near";
    "a quad has its other diagonal", 34, "crates/core/src/kernels/quad.rs":
        "[[a, b, c], [a, c, d]]" => "[[a, b, d], [b, c, d]]";
    "rays of instances have another unit of t", 44, "crates/core/src/accel/instance.rs":
        "self.to_prototype.transform_vector3(ray.direction.as_dvec3()).as_vec3()"
            => "self.to_prototype.transform_vector3(ray.direction.as_dvec3()).normalize().as_vec3()";
    "boxes of instances are not padded", 44, "crates/core/src/accel/instance.rs":
        "Aabb { low: world.low - pad, high: world.high + pad }" => "world";
    "alpha at its threshold is a hole", 45, "crates/core/src/accel/cutouts.rs":
        "image.look_up(uv, self.filter, self.wrap).x < self.threshold"
            => "image.look_up(uv, self.filter, self.wrap).x <= self.threshold";

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
        "columns_of(rays.rows, &rays.origin, &rays.direction, SHADOW_END)"
            => "columns_of(rays.rows, &rays.origin, &rays.direction, 1.0)";
    "shadow rays end beyond the surface of their light", 11, "crates/core/src/kernels/shade.rs":
        "target.position.offset_end(target.error, target.normal, -to_light)" => "target.position";
    "lights shine through the back of a surface", 33, "crates/core/src/kernels/shade.rs":
        "point.lit & point.normal.dot(to_light).gt(zero)" => "point.lit";
    "cones of 0 degrees light their axis", 41, "crates/scene/src/systems/lights.rs":
        "spot.is_some_and(|spot| spot.outer_degrees == 0.0)" => "false";
    "far scenes are not moved to the camera", 42, "crates/scene/src/systems/frame.rs":
        "if far { nearest(view.location, distance) } else { DVec3::ZERO }" => "DVec3::ZERO";
};
