//! Which camera of the scene is taken.

use crate::components::View;
use crate::options::LoadOptions;
use crate::reader::Notes;
use crate::staging::Sphere;
use wavecrest_base::error::{Error, ErrorKind, Result};

use super::document::Document;
use super::node::Placed;

/// The view of the camera that is taken; `None` where the scene has no camera.
///
/// # Errors
/// Where the one asked for is not in the scene, or cannot be taken.
pub(super) fn camera(
    document: &Document,
    bounds: &Sphere,
    options: &LoadOptions,
    notes: &Notes<'_>,
) -> Result<Option<View>> {
    let all: Vec<(usize, &Placed)> = document
        .placed
        .iter()
        .filter_map(|place| Some((document.nodes[place.node].camera?, place)))
        .collect();
    let found = match &options.camera {
        Some(asked) => Some(
            all.iter()
                .find(|(camera, place)| is_asked_for(asked, document, *camera, place))
                .ok_or_else(|| not_there(asked, document, &all, notes))?,
        ),
        None => {
            let has_perspective =
                |(camera, _): &&(usize, &Placed)| document.cameras[*camera].has_perspective();
            all.iter().find(has_perspective).or(all.first())
        }
    };
    let Some((camera, place)) = found else { return Ok(None) };
    document.cameras[*camera].view(&place.world, bounds, options, notes).map(Some)
}

/// Whether a camera is that of the name or number `asked`: its own name, or that of its node.
fn is_asked_for(asked: &str, document: &Document, camera: usize, place: &Placed) -> bool {
    let is = |name: &Option<String>| name.as_deref() == Some(asked);
    is(&document.cameras[camera].name)
        || is(&document.nodes[place.node].name)
        || asked.parse() == Ok(camera)
}

fn not_there(
    asked: &str,
    document: &Document,
    all: &[(usize, &Placed)],
    notes: &Notes<'_>,
) -> Error {
    /// More than these are not listed.
    const MOST_LISTED: usize = 8;
    let describe = |(camera, place): &(usize, &Placed)| {
        let own = document.cameras[*camera].name.as_ref();
        match own.or(document.nodes[place.node].name.as_ref()) {
            Some(name) => format!("{camera} ({name})"),
            None => camera.to_string(),
        }
    };
    let mut names: Vec<String> = all.iter().take(MOST_LISTED).map(describe).collect();
    if all.len() > MOST_LISTED {
        names.push("...".to_owned());
    }
    let error = notes.error(ErrorKind::Usage, "", "no such camera is in the scene".to_owned());
    let error = error.value(asked);
    if names.is_empty() {
        return error.remedy("it has none: leave --camera out, and one is chosen");
    }
    error.remedy(format!("it has {}", names.join(", ")))
}
