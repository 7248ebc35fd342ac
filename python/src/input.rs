//! Converts the options of renders.

use std::str::FromStr;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use wavecrest_api::glam::{DMat4, DVec4};
use wavecrest_api::{self as api, Choice};

use super::{Any, Error};

/// Messages quote no more characters of a value.
const LONGEST_VALUE: usize = 80;

/// The largest number in scene files: 2^40.
const LARGEST: f64 = (1_u64 << 40) as f64;

/// Optional arguments by name. `None` is as good as none.
pub(crate) struct Options<'py>(pub(crate) Bound<'py, PyDict>);

impl<'py> Options<'py> {
    /// The value of an argument, as `read` converts it, if it is given.
    pub(crate) fn get<T>(
        &self,
        key: &str,
        read: impl FnOnce(&str, &Any<'py>) -> PyResult<T>,
    ) -> PyResult<Option<T>> {
        let value = self.0.get_item(key)?.filter(|value| !value.is_none());
        value.map(|value| read(key, &value)).transpose()
    }

    /// The same for a value that `what` describes and that `fits`.
    pub(crate) fn fitting<T: FromPyObjectOwned<'py>>(
        &self,
        key: &str,
        what: &str,
        fits: impl Fn(&T) -> bool,
    ) -> PyResult<Option<T>> {
        self.get(key, |key, value| fitting(key, what, value, fits))
    }

    /// The number that `what` describes, as text has it.
    fn number<T: FromStr<Err = String>>(&self, key: &str, what: &str) -> PyResult<Option<T>> {
        self.get(key, |key, value| parsed(key, &given::<f64>(key, what, value)?.to_string()))
    }

    /// How input is loaded, and the pose of the camera if it is a matrix.
    pub(crate) fn loading(&self) -> PyResult<(api::LoadOptions, Option<DMat4>)> {
        let side = |key| self.fitting(key, "a whole number of pixels", |_| true);
        let framing = api::Framing {
            side: self.get("view", view)?,
            up: self.get("up", named)?,
            fov: self.number("fov", "a number of degrees")?,
            fit: self.number("fit", "a share of the image")?,
            ..api::Framing::default()
        };
        let (camera, pose) = self.get("camera", camera)?.unwrap_or_default();
        let options = api::LoadOptions {
            width: side("width")?,
            height: side("height")?,
            antialias: self.get("samples", antialias)?,
            camera,
            framing,
            lighting: self.lighting()?,
            ..api::LoadOptions::default()
        };
        Ok((options, pose))
    }

    /// The lighting of a file without lights.
    fn lighting(&self) -> PyResult<api::Lighting> {
        let usual = api::Lighting::USUAL;
        let is_angle = |degrees: &f64| (0.0..=180.0).contains(degrees);
        let crease = self.fitting("crease", "a number of degrees from 0 to 180", is_angle)?;
        let rig = self.get("lights", named)?;
        Ok(api::Lighting {
            replaces: rig.is_some(),
            rig: rig.unwrap_or(usual.rig),
            background: self.get("background", background)?,
            crease_degrees: crease.unwrap_or(usual.crease_degrees),
        })
    }
}

/// The value of an argument; `what` describes it.
pub(crate) fn given<'py, T: FromPyObjectOwned<'py>>(
    key: &str,
    what: &str,
    value: &Any<'py>,
) -> PyResult<T> {
    fitting(key, what, value, |_| true)
}

/// As [`given`], for a value that `fits`.
pub(crate) fn fitting<'py, T: FromPyObjectOwned<'py>>(
    key: &str,
    what: &str,
    value: &Any<'py>,
    fits: impl Fn(&T) -> bool,
) -> PyResult<T> {
    let message = || {
        let found: String = value.repr().map_or_else(|_| "?".into(), |text| text.to_string());
        let found: String = found.chars().take(LONGEST_VALUE).collect();
        format!("{key}: must be {what}, found {found}")
    };
    let found = value.extract::<T>().map_err(|error| {
        let error: PyErr = error.into();
        match error.is_instance_of::<PyTypeError>(value.py()) {
            true => PyTypeError::new_err(message()),
            false => Error::new_err(message()),
        }
    })?;
    if fits(&found) { Ok(found) } else { Err(Error::new_err(message())) }
}

/// The value with that name.
pub(crate) fn named<T: Choice>(key: &str, value: &Any<'_>) -> PyResult<T> {
    let name: String = given(key, "a text", value)?;
    let names = || T::VALUES.iter().map(|value| value.name()).collect::<Vec<_>>().join(", ");
    let wrong = || Error::new_err(format!("{key}: must be one of {}, found {name:?}", names()));
    T::by_name(&name).ok_or_else(wrong)
}

/// The values with the names of a list.
pub(crate) fn all_named<T: Choice>(key: &str, names: &Any<'_>) -> PyResult<Vec<T>> {
    let names: Vec<Any<'_>> = given(key, "a list of names", names)?;
    names.iter().map(|name| named(key, name)).collect()
}

/// The value of the text.
fn parsed<T: FromStr<Err = String>>(key: &str, text: &str) -> PyResult<T> {
    text.parse().map_err(|remedy| Error::new_err(format!("{key}: {remedy}, found {text:?}")))
}

/// The side of the grid of so many rays in each pixel.
fn antialias(key: &str, samples: &Any<'_>) -> PyResult<u32> {
    let what = format!("a whole number from 1 to {}", api::MOST_SAMPLES);
    let fits = |count: &u32| (1..=api::MOST_SAMPLES).contains(count);
    fitting(key, &what, samples, fits).map(api::antialias)
}

/// The side of a view: its name, or its azimuth and elevation in degrees.
fn view(key: &str, value: &Any<'_>) -> PyResult<api::Side> {
    let text = match value.extract::<[f64; 2]>() {
        Ok([azimuth, elevation]) => format!("{azimuth},{elevation}"),
        Err(_) => given(key, "the name of a side, or two angles in degrees", value)?,
    };
    parsed(key, &text)
}

/// A linear colour, or a text.
fn background(key: &str, value: &Any<'_>) -> PyResult<api::Background> {
    if value.is_instance_of::<PyString>() {
        return parsed(key, &given::<String>(key, "a text", value)?);
    }
    let is_color = |color: &[f64; 3]| color.iter().all(|value| (0.0..=LARGEST).contains(value));
    let color = fitting(key, "three numbers from 0 to 2^40, or a text", value, is_color)?;
    Ok(api::Background::Color(color.into()))
}

/// A camera: its name in the file, or the matrix that takes its space, where it looks along -z and y is
/// up, to that of the scene.
fn camera(key: &str, value: &Any<'_>) -> PyResult<(Option<String>, Option<DMat4>)> {
    if value.is_instance_of::<PyString>() {
        return Ok((given(key, "a text", value)?, None));
    }
    let what =
        "a name, or a 4 x 4 matrix of a right-handed camera, with 0, 0, 0, 1 as its last row";
    let matrix = |rows: &[[f64; 4]; 4]| DMat4::from_cols_array_2d(rows).transpose();
    let is_right = |rows: &_| {
        let pose = matrix(rows);
        let [x, y, z] = [pose.x_axis, pose.y_axis, pose.z_axis].map(|axis| axis.truncate());
        pose.is_finite() && pose.row(3) == DVec4::W && x.dot(y.cross(z)) > 0.0
    };
    Ok((None, Some(matrix(&fitting(key, what, value, is_right)?))))
}
