//! The size asked for.

use super::{LoadOptions, complete, load_options};
use crate::components::View;

#[test]
fn a_requested_size_replaces_the_files_and_one_side_keeps_the_proportions() {
    let too_many = "s.json: camera: the image would have 65536 x 65536 = 4294967296 pixels; \
                    at most 268435456 (2^28) are allowed";
    for (width, height, expected) in [
        (Some(30), Some(20), Ok((30, 20))),
        (Some(32), None, Ok((32, 24))),
        (None, Some(24), Ok((32, 24))),
        (Some(50), None, Ok((50, 38))),
        (Some(65536), Some(1), Ok((65536, 1))),
        (None, None, Ok((640, 480))),
        (Some(0), Some(1), Err("the width must be an integer from 1 to 65536, found 0")),
        (Some(1), Some(65537), Err("the height must be an integer from 1 to 65536, found 65537")),
        (Some(65536), Some(65536), Err(too_many)),
    ] {
        let options = LoadOptions { width, height, ..LoadOptions::default() };
        let found = load_options(&complete(), options).map(|scene| {
            let mut views = scene.world.query::<&View>();
            let view = views.iter().next().unwrap();
            (view.width, view.height)
        });
        let found = found.map_err(|error| error.to_string());
        assert_eq!(found, expected.map_err(str::to_owned));
    }
}
