//! Converts the options of renders, whose types the Python part has checked.

use std::str::FromStr;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavecrest_api::glam::DVec3;
use wavecrest_api::{self as api, Choice};

use super::base::Error;

/// Optional arguments by name. `None` is as good as none.
pub(crate) struct Options<'py>(pub(crate) Bound<'py, PyDict>);

impl<'py> Options<'py> {
    /// The value of an argument, if it is given.
    pub(crate) fn get<T: FromPyObjectOwned<'py>>(&self, key: &str) -> PyResult<Option<T>> {
        let value = self.0.get_item(key)?.filter(|value| !value.is_none());
        value.map(|value| value.extract().map_err(Into::into)).transpose()
    }

    /// The choice with the name that is given.
    pub(crate) fn named<T: Choice>(&self, key: &str) -> PyResult<Option<T>> {
        self.get::<String>(key)?.map(|name| named(key, &name)).transpose()
    }

    /// The value of the text that is given.
    fn parsed<T: FromStr<Err = String>>(&self, key: &str) -> PyResult<Option<T>> {
        let wrong = |remedy, text| Error::new_err(format!("{key}: {remedy}, found {text:?}"));
        let text = self.get::<String>(key)?;
        text.map(|text| text.parse().map_err(|remedy: String| wrong(remedy, text))).transpose()
    }

    /// How input is loaded.
    pub(crate) fn loading(&self) -> PyResult<api::LoadOptions> {
        let eye = self.get::<[f64; 3]>("eye")?;
        let target = self.get::<[f64; 3]>("target")?.map(DVec3::from);
        let look_at = |eye: [f64; 3]| api::LookAt { eye: eye.into(), target, up: None };
        let framing = api::Framing {
            side: self.parsed("view")?,
            up: self.named("up")?,
            fov: self.parsed("fov")?,
            fit: self.parsed("fit")?,
            ..api::Framing::default()
        };
        let color = self.get::<[f64; 3]>("color")?;
        let usual = api::Lighting::default();
        let rig = self.named("lights")?;
        let lighting = api::Lighting {
            replaces: rig.is_some(),
            rig: rig.unwrap_or(usual.rig),
            background: match color {
                Some(color) => Some(api::Background::Color(color.into())),
                None => self.parsed("background")?,
            },
            stays: false,
            crease_degrees: self.get("crease")?.unwrap_or(usual.crease_degrees),
        };
        Ok(api::LoadOptions {
            width: self.get("width")?,
            height: self.get("height")?,
            antialias: self.get("samples")?.map(api::antialias),
            camera: self.get("camera")?,
            framing,
            look_at: eye.map(look_at),
            lighting,
            ..api::LoadOptions::default()
        })
    }
}

/// The choice with that name.
pub(crate) fn named<T: Choice>(key: &str, name: &str) -> PyResult<T> {
    let names = || T::VALUES.iter().map(|value| value.name());
    let wrong = || {
        let near = api::did_you_mean(name, names());
        let hint = near.map(|near| format!("; did you mean {near}?")).unwrap_or_default();
        let names = names().collect::<Vec<_>>().join(", ");
        Error::new_err(format!("{key}: must be one of {names}, found {name:?}{hint}"))
    };
    T::by_name(name).ok_or_else(wrong)
}
