//! The built-in scenes of the self-test, and the images that they show.

use std::fs;

use tempfile::TempDir;

use wavecrest_base::error::{Error, Result};

/// Files of this folder of the repository, each by the name that scenes have for it.
macro_rules! files {
    ($folder:literal $($name:literal $(= $other:literal)?)+) => {
        &[$((concat!($folder, $name), include_bytes!(concat!("../../", $folder, files!(@ $name $($other)?))))),+]
    };
    (@ $name:literal) => { $name };
    (@ $name:literal $other:literal) => { $other };
}

#[rustfmt::skip]
const SCENES: &[(&str, &[u8])] = files! { "scenes/"
    "hard/aperture-zero.json" "hard/axis-parallel.json" "hard/cone-without-angle.json" "hard/cones.json"
    "hard/contact.json" "hard/coplanar-duplicates.json" "hard/cut-outs.json" "hard/degenerate-triangles.json"
    "hard/edge-on-light.json" "hard/emission-alone.json" "hard/empty.json" "hard/exponents.json"
    "hard/facing-mirrors.json" "hard/far-from-origin.json" "hard/far-spheres.json" "hard/grazing-sphere.json"
    "hard/huge-sphere.json" "hard/inside-mesh.json" "hard/inside-sphere.json" "hard/light-at-surface.json"
    "hard/nested-boxes.json" "hard/no-lights.json" "hard/no-numbers.json" "hard/nonplanar-quad.json"
    "hard/normal-maps.json" "hard/occluded-light.json" "hard/pole-texture.json" "hard/shared-centroid.json"
    "hard/slivers.json" "hard/smooth-terminator.json" "hard/thin-image.json" "hard/tiny-scene.json"
    "hard/under-a-ceiling.json" "hard/up-parallel.json" "hard/vertex-colors.json" "hard/vertex-fan.json"
    "hard/wide-fov.json" "DoF-sobol.json" "drink.json" "glass.json" "hemisphere.json" "instances.json" "materialmaps.json"
    "occlusion.json" "testareajitter.json" "texturefilter.json"
};

/// A small image stands for photographs, which would make the program larger and test nothing more.
#[rustfmt::skip]
const TEXTURES: &[(&str, &[u8])] = files! { "textures/"
    "bricks.png" = "uvgrid.png" "checker.png" "globe.png" = "uvgrid.png" "leaf.png" "no-numbers.exr"
    "picture.png" = "uvgrid.png" "tiles-glow.png" "tiles-material.png" "tiles-normal.png" "tiles.png" "uvgrid.png"
};

/// Writes them to a temporary folder, which is removed when it is dropped.
///
/// # Errors
/// If a file cannot be written.
pub(super) fn unpacked() -> Result<TempDir> {
    let wrong =
        |error| Error::io("cannot write the scenes of the self-test", std::env::temp_dir(), error);
    let folder = tempfile::tempdir().map_err(wrong)?;
    for (name, content) in SCENES.iter().chain(TEXTURES) {
        let path = folder.path().join(name);
        let parent = path.parent().unwrap_or(&path);
        fs::create_dir_all(parent).and_then(|()| fs::write(&path, content)).map_err(wrong)?;
    }
    Ok(folder)
}
