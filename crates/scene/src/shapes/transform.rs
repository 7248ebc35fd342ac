//! Transforms from a shape's own space to the world's.

use glam::{DAffine3, DMat3, DVec3};
use serde_json::json;

use crate::format::{Cursor, Declared, Key, Kind, Object, Range, Writer, keys};
use wavecrest_base::error::Result;

/// Relative difference below which the scales along the axes, and the angles between them, count as
/// equal: eight times the rounding of single precision, in which the scene is rendered.
const EVEN: f64 = 1e-6;

/// A transform by its parts.
const PARTS: Kind = Kind::new(
    "a transform (or a matrix of 4 rows)",
    "A scale, then a rotation, then a translation.",
    keys! {
        /// Translation.
        "translate": Point, Are([0.0; 3]);
        /// Degrees about x, then y, then z.
        "rotate": Point, Are([0.0; 3]);
        /// One factor, or one along each axis.
        "scale": Either(&Point, &Number(Range::COORDINATE)), Is(1.0);
    },
);

/// The transform from the shape's own space to the world; of an instance, from the world of its
/// prototype.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform(pub DAffine3);

impl Declared for Transform {
    const KEYS: &'static [Key] = keys! {
        /// Transform from its own space to the world; of an instance, after the shape's own.
        "transform": Either(&Matrix, &Object(&PARTS));
    };

    fn read(object: &Object<'_>) -> Result<Option<Self>> {
        let transform = object.get("transform").map(|cursor| transform(&cursor)).transpose()?;
        Ok(transform.map(Self))
    }

    /// As rows, from columns.
    fn write(&self, to: &mut Writer<'_>) {
        let DAffine3 { matrix3: m, translation: t } = self.0;
        let [x, y, z] = [0, 1, 2].map(|i| [m.x_axis[i], m.y_axis[i], m.z_axis[i], t[i]]);
        to.set("transform", json!([x, y, z, [0.0, 0.0, 0.0, 1.0]]));
    }
}

/// Reads a transform: a matrix, or its parts.
fn transform(cursor: &Cursor<'_>) -> Result<DAffine3> {
    let transform =
        if cursor.value().is_array() { matrix(cursor)? } else { parts(&cursor.object(PARTS)?)? };
    if is_singular(transform.matrix3) {
        let error = cursor.error("the transform is singular");
        return Err(error.remedy("use a scale other than 0 on every axis"));
    }
    Ok(transform)
}

/// Checks that the transform of a round `shape` keeps it round.
pub(super) fn keeps_round(object: &Object<'_>, shape: &str) -> Result<()> {
    match object.get("transform") {
        Some(cursor) if !is_uniform(&transform(&cursor)?) => {
            let error = cursor.error(format!("{shape} can only be scaled uniformly"));
            Err(error.remedy("use one scale factor, or a trimesh"))
        }
        _ => Ok(()),
    }
}

/// Whether the transform keeps a sphere a sphere.
fn is_uniform(transform: &DAffine3) -> bool {
    let m = transform.matrix3;
    // Scaled first, so that squares neither underflow nor overflow.
    let m = m * (1.0 / greatest(m));
    let gram = m.transpose() * m;
    let size = gram.x_axis.x;
    let uneven = gram - DMat3::from_diagonal(DVec3::splat(size));
    greatest(uneven) <= EVEN * size
}

fn matrix(cursor: &Cursor<'_>) -> Result<DAffine3> {
    let what = "a matrix of 4 rows [[a, b, c, x], [d, e, f, y], [g, h, i, z], [0, 0, 0, 1]]";
    let row = |item: Cursor<'_>| item.numbers::<4>("a row of four numbers", Range::COORDINATE);
    let [x, y, z, last] = cursor.exactly(what, row)?;
    if last != [0.0, 0.0, 0.0, 1.0] {
        let error = cursor.error("the last row must be [0, 0, 0, 1]");
        return Err(error.remedy("put the translation in the last column"));
    }
    let column = |i: usize| DVec3::new(x[i], y[i], z[i]);
    let matrix3 = DMat3::from_cols(column(0), column(1), column(2));
    Ok(DAffine3 { matrix3, translation: column(3) })
}

/// First the scale, then the rotation, then the translation.
fn parts(object: &Object<'_>) -> Result<DAffine3> {
    let translation = object.read("translate");
    let rotate = object.read("rotate");
    let scale = object.get("scale").map_or(Ok(DVec3::ONE), |cursor| scale(&cursor))?;
    Ok(DAffine3 { matrix3: rotation(rotate) * DMat3::from_diagonal(scale), translation })
}

fn scale(cursor: &Cursor<'_>) -> Result<DVec3> {
    if cursor.value().is_number() {
        return cursor.number(Range::COORDINATE).map(DVec3::splat);
    }
    cursor.numbers("a number, or three numbers [x, y, z]", Range::COORDINATE).map(DVec3::from_array)
}

/// The rotation about x, then y, then z, by these angles in degrees, counter-clockwise as seen from
/// the axis' positive end.
fn rotation(degrees: DVec3) -> DMat3 {
    let (sx, cx) = sin_cos(degrees.x);
    let (sy, cy) = sin_cos(degrees.y);
    let (sz, cz) = sin_cos(degrees.z);
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, cx, sx), DVec3::new(0.0, -sx, cx));
    let about_y = DMat3::from_cols(DVec3::new(cy, 0.0, -sy), DVec3::Y, DVec3::new(sy, 0.0, cy));
    let about_z = DMat3::from_cols(DVec3::new(cz, sz, 0.0), DVec3::new(-sz, cz, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

/// Sine and cosine of an angle in degrees: exact at quarter turns, and the same on every machine.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let quarters = libm::round(degrees / 90.0);
    let (s, c) = libm::sincos((degrees - quarters * 90.0).to_radians());
    match quarters.rem_euclid(4.0) {
        0.0 => (s, c),
        1.0 => (c, -s),
        2.0 => (-s, -c),
        _ => (-c, s),
    }
}

/// Whether a determinant is 0, or indistinguishable from it after rounding.
///
/// Each of its six products has at most five roundings of half an EPSILON, so the error is below 4
/// EPSILON times the sum of the products' magnitudes.
fn is_singular(m: DMat3) -> bool {
    let magnitudes = {
        let [a, b, c] = m.to_cols_array_2d().map(|column| DVec3::from_array(column).abs());
        let minors =
            DVec3::new(b.y * c.z + b.z * c.y, b.z * c.x + b.x * c.z, b.x * c.y + b.y * c.x);
        a.dot(minors)
    };
    m.determinant().abs() <= 4.0 * f64::EPSILON * magnitudes
}

fn greatest(m: DMat3) -> f64 {
    m.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
}
