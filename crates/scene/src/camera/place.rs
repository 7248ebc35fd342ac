//! Another place for the camera, and other samples, than the file has.

use glam::DVec3;
use hecs::{Entity, World};

use super::{CameraPath, PARALLEL, ThinLens, View, beside_lens};
use crate::corners::direction;
use crate::options::LoadOptions;
use crate::options::framing::{LookAt, Up};
use wavecrest_base::error::{Error, ErrorKind, Result};

/// Sine of the angle between up and the view below which a camera that is taken elsewhere gets another up: as of a view from
/// directly above.
const STEEP: f64 = 1e-3;

/// Takes the camera of a `world` to another place, at rest, and gives its pixels other samples, as far as the `options` ask
/// for that. Whether it was moved.
///
/// # Errors
/// If there would be no view.
pub(crate) fn change(world: &mut World, options: &LoadOptions) -> Result<bool> {
    let Some((entity, view, lens)) =
        world.query_mut::<(Entity, &mut View, Option<&mut ThinLens>)>().into_iter().next()
    else {
        return Ok(false);
    };
    if let Some(sampling) = options.sampling {
        view.sampling = sampling;
        if let Some(lens) = lens {
            (lens.sampling, lens.samples_x, lens.samples_y) = (sampling, 1, 1);
            // A pinhole's are as they are asked for, also if it is a lens without an aperture.
            if lens.aperture > 0.0 {
                view.sampling = beside_lens(sampling);
            }
        }
    }
    let Some(look_at) = &options.look_at else { return Ok(false) };
    look_at.place(view)?;
    let _ = world.remove_one::<CameraPath>(entity);
    Ok(true)
}

impl LookAt {
    /// Takes a view to this place. If it looks along what was up, another axis is up, as in an upright image on the way there.
    ///
    /// # Errors
    /// If there would be no view: it would be where it looks, or the requested up is along it.
    pub fn place(&self, view: &mut View) -> Result<()> {
        let usage = |message| Error::new(ErrorKind::Usage, message);
        (view.location, view.look) = (self.eye, self.target.unwrap_or(view.look));
        let Some(back) = direction(view.location - view.look) else {
            let error = usage("the camera would be at the point it looks at").value(view.location);
            return Err(error.remedy("use another --from or --at"));
        };
        let is_along =
            |up: DVec3, least| direction(up).is_none_or(|up| up.cross(back).length() < least);
        match self.up {
            Some(up) if is_along(up, PARALLEL) => {
                let error = usage("up would be along the view").value(up);
                return Err(error.remedy("use another --up"));
            }
            Some(up) => view.up = up,
            None if is_along(view.up, STEEP) => {
                view.up = -Up::nearest(view.up).axes().z_axis * back.dot(view.up).signum();
            }
            None => {}
        }
        Ok(())
    }
}
