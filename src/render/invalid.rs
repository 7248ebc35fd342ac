//! Samples that are not finite: a warning, or an error with `--trap-invalid`.

use super::args::RenderArgs;
use crate::common::tell;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::counters::Counters;
use wavecrest_core::prepared::PreparedScene;
use wavecrest_core::probe::{self, Invalid};

/// The first sample that was not finite.
///
/// # Errors
/// If there is one, and `--trap-invalid` is given.
pub(super) fn find(
    args: &RenderArgs,
    scene: &PreparedScene,
    counters: &Counters,
) -> Result<Option<Invalid>> {
    let first = counters.first_invalid;
    let invalid = first.map(|sample| probe::name_invalid(scene, sample, args.seed));
    match invalid {
        Some(invalid) if args.trap_invalid => Err(trapped(args, &invalid)),
        invalid => Ok(invalid),
    }
}

/// Prints their number, and the first.
pub(super) fn report(counters: &Counters, first: Option<&Invalid>) {
    if let Some(first) = first {
        let count = counters.invalid;
        tell(&format!(
            "warning: {count} samples were not finite and count as black; the first is {first}"
        ));
    }
}

fn trapped(args: &RenderArgs, invalid: &Invalid) -> Error {
    let Invalid { x, y, .. } = invalid;
    let scene = args.scene.display();
    Error::new(ErrorKind::Scene, "a sample is not finite")
        .in_file(&args.scene)
        .at(&invalid.shape)
        .value(invalid)
        .remedy(format!("see it with: wavecrest probe {scene} --pixel {x},{y}"))
}
