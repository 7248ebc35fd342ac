//! Numbers, vectors and rays of all sizes that there may be.

use glam::Vec3;
use proptest::prelude::*;
use wavecrest_core::math::float::{MAX_COORDINATE, normalize};

/// Of either sign, every power of two from `low` to `high` as likely.
pub(crate) fn magnitude(low: i32, high: i32) -> impl Strategy<Value = f32> {
    (1.0_f32..2.0, low..high, any::<bool>()).prop_map(|(mantissa, exponent, negative)| {
        let x = (f64::from(mantissa) * 2.0_f64.powi(exponent)) as f32;
        if negative { -x } else { x }
    })
}

/// A coordinate: often one that others have too, and sometimes of the largest or least size.
pub(crate) fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => (-16_i32..=16).prop_map(|x| x as f32 / 4.0),
        4 => -1.0_f32..1.0,
        2 => magnitude(-20, 20),
        1 => magnitude(-149, 40),
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(MAX_COORDINATE), Just(-MAX_COORDINATE)],
    ]
}

/// Likewise, of moderate size: neither squares nor cubes overflow or vanish.
pub(crate) fn moderate() -> impl Strategy<Value = f32> {
    prop_oneof![
        2 => (-16_i32..=16).prop_map(|x| x as f32 / 4.0),
        2 => -1.0_f32..1.0,
        1 => magnitude(-10, 10),
    ]
}

pub(crate) fn vector<S: Strategy<Value = f32>>(of: fn() -> S) -> impl Strategy<Value = Vec3> {
    (of(), of(), of()).prop_map(Vec3::from)
}

/// Of unit length, but for rounding; some along an axis.
pub(crate) fn unit() -> impl Strategy<Value = Vec3> {
    vector(moderate).prop_map(normalize).prop_filter("it has a direction", |v| *v != Vec3::ZERO)
}
