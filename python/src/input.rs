//! Converts Python values for the library.

use std::str::FromStr;

use numpy::{IntoPyArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;
use wavecrest_api::glam::{DMat4, DVec4};
use wavecrest_api::{self as api, Choice};

use super::arrays::{array, collected, has_type, rows};
use super::{Error, exception};

/// An array of linear colours, or of levels with a transfer curve, as an image.
pub(crate) fn film(image: &Bound<'_, PyAny>, transfer: api::Transfer) -> PyResult<api::Film> {
    let expected = "(height, width, 3)";
    let mut image = image.clone();
    if has_type::<u8>(&image)? {
        let value = |level: u8| match (f32::from(level) / f32::from(u8::MAX), transfer) {
            (value, api::Transfer::Linear) => value,
            (value, api::Transfer::Srgb) => api::srgb_decode(value),
        };
        let values = (0..=u8::MAX).map(value).collect::<Vec<f32>>().into_pyarray(image.py());
        image = values.call_method1("take", (image,))?;
    }
    let array = array::<f32>("image", &image, "float32", expected)?;
    let side = |i: usize| u32::try_from(array.shape()[i]).unwrap_or(u32::MAX);
    let pixels = collected(rows(&array)?.iter().map(|&row| Ok(row)))?;
    api::Film::from_pixels(side(1), side(0), pixels).map_err(|e| exception(&e))
}

/// An optional argument: its name, and its value.
pub(crate) type Argument<'a, 'py> = (&'static str, Option<&'a Bound<'py, PyAny>>);

/// The value of an argument, if it is given; `what` describes it.
pub(crate) fn given<'py, T: FromPyObjectOwned<'py>>(
    argument: Argument<'_, 'py>,
    what: &str,
) -> PyResult<Option<T>> {
    fitting(argument, what, |_| true)
}

/// As [`given`], for a value that `fits`.
pub(crate) fn fitting<'py, T: FromPyObjectOwned<'py>>(
    (key, value): Argument<'_, 'py>,
    what: &str,
    fits: impl Fn(&T) -> bool,
) -> PyResult<Option<T>> {
    let read = |value: &Bound<'py, PyAny>| {
        let found = value.extract().map_err(Into::into)?;
        fits(&found).then_some(found).ok_or_else(|| Error::new_err(""))
    };
    value.map(|value| needed(key, what, value, read)).transpose()
}

/// The value of an argument that is not optional, as `read` converts it.
pub(crate) fn needed<'py, T>(
    key: &str,
    what: &str,
    value: &Bound<'py, PyAny>,
    read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
) -> PyResult<T> {
    read(value).map_err(|error| {
        let found: String = value.repr().map_or_else(|_| "?".into(), |text| text.to_string());
        let found: String = found.chars().take(LONGEST_VALUE).collect();
        let message = format!("{key}: must be {what}, found {found}");
        match error.is_instance_of::<PyTypeError>(value.py()) {
            true => PyTypeError::new_err(message),
            false => Error::new_err(message),
        }
    })
}

/// Messages quote no more characters of a value.
const LONGEST_VALUE: usize = 80;

/// A text.
pub(crate) fn text(argument: Argument<'_, '_>) -> PyResult<Option<String>> {
    given(argument, "a text")
}

/// The value with that name.
pub(crate) fn named<T: Choice>(argument: Argument<'_, '_>) -> PyResult<Option<T>> {
    let (key, Some(name)) = (argument.0, text(argument)?) else { return Ok(None) };
    let names = || T::VALUES.iter().map(|value| value.name()).collect::<Vec<_>>().join(", ");
    let wrong = || Error::new_err(format!("{key}: must be one of {}, found {name:?}", names()));
    T::by_name(&name).map(Some).ok_or_else(wrong)
}

/// The values with the names of a list.
pub(crate) fn all_named<T: Choice>((key, names): Argument<'_, '_>) -> PyResult<Vec<T>> {
    let names: Option<Vec<_>> = given((key, names), "a list of names")?;
    let named = |name| named((key, Some(&name)));
    names.into_iter().flatten().filter_map(|name| named(name).transpose()).collect()
}

/// The value of the text.
pub(crate) fn parsed<T: FromStr<Err = String>>(
    key: &str,
    text: Option<String>,
) -> PyResult<Option<T>> {
    let Some(text) = text else { return Ok(None) };
    let wrong = |remedy| Error::new_err(format!("{key}: {remedy}, found {text:?}"));
    text.parse().map(Some).map_err(wrong)
}

/// The value of the number, as text has it.
pub(crate) fn number<T: FromStr<Err = String>>(
    argument: Argument<'_, '_>,
    what: &str,
) -> PyResult<Option<T>> {
    parsed(argument.0, given(argument, what)?.map(|number: f64| number.to_string()))
}

/// The side of the grid of so many rays in each pixel.
pub(crate) fn antialias(samples: Argument<'_, '_>) -> PyResult<Option<u32>> {
    let what = format!("a whole number from 1 to {}", api::MOST_SAMPLES);
    let count = fitting(samples, &what, |count| (1..=api::MOST_SAMPLES).contains(count))?;
    Ok(count.map(api::antialias))
}

/// The side of a view: its name, or its azimuth and elevation in degrees.
pub(crate) fn view((key, value): Argument<'_, '_>) -> PyResult<Option<api::Side>> {
    let text = match value.and_then(|value| value.extract::<[f64; 2]>().ok()) {
        Some([azimuth, elevation]) => Some(format!("{azimuth},{elevation}")),
        None => given((key, value), "the name of a side, or two angles in degrees")?,
    };
    parsed(key, text)
}

/// A camera: its name in the file, or the matrix that takes its space, where it looks along -z and y is
/// up, to that of the scene.
pub(crate) fn camera(
    camera: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Option<String>, Option<DMat4>)> {
    let Some(value) = camera else { return Ok((None, None)) };
    if value.is_instance_of::<PyString>() {
        return Ok((text(("camera", camera))?, None));
    }
    let what =
        "a name, or a 4 x 4 matrix of a right-handed camera, with 0, 0, 0, 1 as its last row";
    let pose = needed("camera", what, value, |value| {
        let pose = DMat4::from_cols_array_2d(&value.extract()?).transpose();
        let [x, y, z] = [pose.x_axis, pose.y_axis, pose.z_axis].map(|axis| axis.truncate());
        let is_right = pose.is_finite() && pose.row(3) == DVec4::W && x.dot(y.cross(z)) > 0.0;
        is_right.then_some(pose).ok_or_else(|| Error::new_err(""))
    })?;
    Ok((None, Some(pose)))
}

/// The largest number in scene files: 2^40.
const LARGEST: f64 = (1_u64 << 40) as f64;

/// The lighting of a file without lights.
pub(crate) fn lighting(
    lights: Argument<'_, '_>,
    background: Argument<'_, '_>,
    crease: Argument<'_, '_>,
) -> PyResult<api::Lighting> {
    let usual = api::Lighting::USUAL;
    let is_angle = |degrees: &f64| (0.0..=180.0).contains(degrees);
    let crease = fitting(crease, "a number of degrees from 0 to 180", is_angle)?;
    let is_color = |color: &[f64; 3]| color.iter().all(|value| (0.0..=LARGEST).contains(value));
    let what = "three numbers from 0 to 2^40, or a text";
    let background = match background.1 {
        Some(value) if value.is_instance_of::<PyString>() => {
            parsed("background", text(background)?)?
        }
        _ => fitting(background, what, is_color)?.map(|color| api::Background::Color(color.into())),
    };
    Ok(api::Lighting {
        replaces: lights.1.is_some(),
        rig: named(lights)?.unwrap_or(usual.rig),
        background,
        crease_degrees: crease.unwrap_or(usual.crease_degrees),
    })
}
