//! Cameras that move: an image a frame, whatever the range and the share.

use std::path::Path;

use serde_json::{Value, json};

use crate::support::{folder, matte, pinhole, point_light, scene, sphere, wavecrest};

fn moving() -> Value {
    let mut camera = pinhole([24, 16], 50.0, 6.0);
    camera["path"] = json!({"keys": [
        {"frame": 1, "location": [0, 0, 6]},
        {"frame": 3, "location": [2, 1, 5], "fov": 40},
        {"frame": 7, "location": [6, 0, 0], "look": [0, 0.5, 0]}
    ]});
    let ball = sphere([0.0, 0.0, 0.0], 1.0, matte(0.9, [1.0, 0.4, 0.2]));
    scene(0, &camera, &[point_light(60.0, [3.0, 4.0, 6.0], [1.0; 3])], &[ball])
}

fn run(folder: &Path, arguments: &[&str]) -> String {
    let found = wavecrest(folder).args(arguments).output().expect("it runs");
    let text = String::from_utf8(found.stderr).expect("text");
    assert_eq!(found.status.code(), Some(0), "{text}");
    text
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let found = wavecrest(folder).args(arguments).output().expect("it runs");
    assert_eq!(found.status.code(), Some(2));
    String::from_utf8(found.stderr).expect("text")
}

#[test]
fn frames_are_the_same_in_a_range_alone_and_in_shares() {
    let folder = folder();
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect(name);
    std::fs::write(folder.path().join("s.json"), moving().to_string()).expect("it can be written");
    let at = folder.path();
    run(at, &["-q", "s.json", "all-##.pfm", "--frames", "1..7", "--also", "all.png"]);
    for frame in 1..=7 {
        let number = frame.to_string();
        run(at, &["-q", "s.json", "one.pfm", "--frame", &number]);
        assert_eq!(read("one.pfm"), read(&format!("all-0{frame}.pfm")), "frame {frame}");
        assert!(read(&format!("all.000{frame}.png")).starts_with(b"\x89PNG"));
    }
    for shard in ["1/3", "2/3", "3/3"] {
        run(at, &["-q", "s.json", "part#.pfm", "--frames", "1..7", "--shard", shard]);
    }
    for frame in 1..=7 {
        assert_eq!(read(&format!("part{frame}.pfm")), read(&format!("all-0{frame}.pfm")));
    }
    // Where the first key is, the camera itself is too; and it does move.
    run(at, &["-q", "s.json", "still.pfm"]);
    assert_eq!(read("still.pfm"), read("all-01.pfm"));
    assert_ne!(read("all-01.pfm"), read("all-02.pfm"));
    run(at, &["-q", "s.json", "late.pfm", "--frame", "90"]);
    assert_eq!(read("late.pfm"), read("all-07.pfm"));
}

#[test]
fn frames_that_cannot_be_are_refused_in_words() {
    let folder = folder();
    let at = folder.path();
    let write = |scene: &Value| {
        std::fs::write(at.join("s.json"), scene.to_string()).expect("it can be written");
    };
    let mut still = moving();
    still["camera"].as_object_mut().expect("an object").remove("path");
    write(&still);
    let text = refused(at, &["s.json", "o.png", "--frame", "2"]);
    assert!(text.contains("s.json: camera.path: the camera does not move; add a path"), "{text}");
    write(&moving());
    let text = refused(at, &["s.json", "o.png", "--frames", "3..1"]);
    assert!(text.contains("write the first frame and the last, such as 1..24"), "{text}");
    for (pointer, value, words) in [
        ("/camera/path/keys/1/frame", json!(1), "camera.path.keys[1]: the frame must be greater"),
        ("/camera/path/keys/1/focal", json!(1), "camera.path.keys[1].focal: is not a key of"),
        ("/camera/path/keys/1/fov", json!(200), "camera.path.keys[1].fov: must be a number"),
        ("/camera/path/keys/1/look", json!([2, 1, 5]), "looks at its own location"),
        ("/camera/path/keys", json!([]), "camera.path.keys: must be an array of keys"),
        ("/camera/path/interpolation", json!("smoth"), "did you mean \"smooth\"?"),
    ] {
        let mut scene = moving();
        let (parent, key) = pointer.rsplit_once('/').expect("a path");
        scene.pointer_mut(parent).expect("it is there")[key] = value;
        write(&scene);
        let text = refused(at, &["--strict", "s.json", "o.png", "--frame", "2"]);
        assert!(text.contains(words), "{text}");
    }
    assert!(!at.join("o.png").exists());
}
