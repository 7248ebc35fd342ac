//! Cameras that move: an image a frame, whatever the range and the share.

use serde_json::{Value, json};

use crate::support::{bytes, folder, matte, pinhole, point_light, put, run_well, scene, sphere};

/// A camera that moves about a ball.
pub(crate) fn moving() -> Value {
    let mut camera = pinhole([24, 16], 50.0, 6.0);
    camera["path"] = json!({"keys": [
        {"frame": 1, "location": [0, 0, 6]},
        {"frame": 3, "location": [2, 1, 5], "fov": 40},
        {"frame": 7, "location": [6, 0, 0], "look": [0, 0.5, 0]}
    ]});
    let ball = sphere([0.0, 0.0, 0.0], 1.0, matte(0.9, [1.0, 0.4, 0.2]));
    scene(0, &camera, &[point_light(60.0, [3.0, 4.0, 6.0], [1.0; 3])], &[ball])
}

#[test]
fn frames_are_the_same_in_a_range_alone_and_in_shares() {
    let folder = folder();
    let at = folder.path();
    let read = |name: &str| bytes(at, name);
    put(at, "s.json", moving().to_string());
    run_well(at, &["-q", "s.json", "all-##.pfm", "--frames", "1..7", "--also", "all.png"]);
    for frame in 1..=7 {
        let number = frame.to_string();
        run_well(at, &["-q", "s.json", "one.pfm", "--frame", &number]);
        assert_eq!(read("one.pfm"), read(&format!("all-0{frame}.pfm")), "frame {frame}");
        assert!(read(&format!("all.000{frame}.png")).starts_with(b"\x89PNG"));
    }
    for shard in ["1/3", "2/3", "3/3"] {
        run_well(at, &["-q", "s.json", "part#.pfm", "--frames", "1..7", "--shard", shard]);
    }
    for frame in 1..=7 {
        assert_eq!(read(&format!("part{frame}.pfm")), read(&format!("all-0{frame}.pfm")));
    }
    // Where the first key is, the camera itself is too; and it does move.
    run_well(at, &["-q", "s.json", "still.pfm"]);
    assert_eq!(read("still.pfm"), read("all-01.pfm"));
    assert_ne!(read("all-01.pfm"), read("all-02.pfm"));
    run_well(at, &["-q", "s.json", "late.pfm", "--frame", "90"]);
    assert_eq!(read("late.pfm"), read("all-07.pfm"));
}
