//! Progress, the image while it is not finished, and a viewer.

use std::io::{Read, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use wavecrest_core::film::Film;

use super::{ball, run_silently, with_ball, with_scene};
use crate::support::{bytes, edited, film, folder, image, put, run, text};

/// The ball in so many pixels.
fn of_size(width: u32, height: u32) -> Value {
    edited(ball(), &format!("/camera/width {width}\n/camera/height {height}"))
}

#[test]
fn progress_is_printed_as_lines_of_json() {
    let folder = with_scene(&of_size(170, 130).to_string());
    let start = Instant::now();
    let output = run(folder.path(), &["ball.json", "out.exr", "--progress", "json", "--quiet"]);
    let spent = start.elapsed().as_secs_f64();
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), ""));
    let parse = |line: &str| serde_json::from_str::<Value>(line).expect("JSON");
    let lines: Vec<Value> = text(&output.stderr).lines().map(parse).collect();
    let mut stages: Vec<&str> = lines.iter().map(|l| l["stage"].as_str().expect("text")).collect();
    stages.dedup();
    assert_eq!(stages, ["load", "build", "trace", "write", "done"]);
    assert!((lines.len() as f64) < 10.0 * spent + 8.0, "{} lines in {spent} s", lines.len());
    let seconds = |line: &Value| line["seconds"].as_f64().expect("a number");
    assert!(lines.windows(2).all(|pair| seconds(&pair[0]) <= seconds(&pair[1])));
    let traced: Vec<_> = lines.iter().filter(|line| line["stage"] == "trace").collect();
    assert_eq!((&traced[0]["done"], &traced[0]["all"]), (&json!(0), &Value::Null));
    let last = traced[traced.len() - 1];
    assert_eq!((&last["done"], &last["all"]), (&json!(170 * 130), &json!(170 * 130)));
    assert_eq!(last["left"], 0.0);
    for line in &lines {
        let keys: Vec<_> = line.as_object().expect("an object").keys().collect();
        assert_eq!(keys, ["stage", "frame", "frames", "done", "all", "seconds", "left"]);
        assert_eq!([&line["frame"], &line["frames"]], [&Value::Null; 2]);
    }
}

/// The lines of progress of a command that succeeds.
fn progress(folder: &Path, line: &str) -> Vec<Value> {
    let arguments: Vec<&str> = line.split(' ').collect();
    let output = run(folder, &[&arguments[..], &["--progress", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{line}: {}", text(&output.stderr));
    let lines = text(&output.stderr).lines();
    // Notes are no JSON.
    lines.filter_map(|line| serde_json::from_str(line).ok()).collect()
}

#[test]
fn progress_names_the_frame_of_animations_and_sheets() {
    let folder = folder();
    put(folder.path(), "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for views in ["a.gif --turntable 3", "a#.png --turntable 3", "a.png --sheet front,top,left"] {
        let lines = progress(folder.path(), &format!("t.obj {views} --size 64x48"));
        let traced = lines.iter().filter(|line| line["stage"] == "trace");
        let mut frames: Vec<_> = traced.map(|line| (&line["frame"], &line["frames"])).collect();
        frames.dedup();
        let expected = [json!(1), json!(2), json!(3)];
        assert_eq!(frames, expected.each_ref().map(|frame| (frame, &expected[2])), "{views}");
    }
}

#[test]
fn reading_and_building_are_counted() {
    let folder = folder();
    run_silently(folder.path(), &["generate", "knot", "mesh.ply", "-n", "1M", "-q"]);
    let bytes = bytes(folder.path(), "mesh.ply").len();
    let lines = progress(folder.path(), "mesh.ply a.png --size 8x6 --bvh fast");
    for (stage, all) in [("load", bytes), ("build", 1_000_000)] {
        let of_stage: Vec<_> = lines.iter().filter(|line| line["stage"] == stage).collect();
        let last = of_stage[of_stage.len() - 1];
        assert!(of_stage.len() > 1, "{stage} takes longer than a tenth of a second: {lines:?}");
        let found = last["all"].as_u64().expect("a number") as usize;
        assert!((all..all + all / 50).contains(&found), "{stage}: {found}, not {all}");
        let done = of_stage.iter().map(|line| line["done"].as_u64());
        assert!(done.is_sorted() && last["done"].as_u64() > Some(0), "{of_stage:?}");
    }
}

/// What a command prints on a terminal; none where no program gives it one.
fn on_a_terminal(folder: &Path, arguments: &str) -> Option<String> {
    let mut script = Command::new("script");
    let command = format!("{} {arguments}", env!("CARGO_BIN_EXE_wavecrest"));
    script.args(["-qec", &command, "/dev/null"]).current_dir(folder).stdin(Stdio::null());
    let output = script.output().ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
#[cfg(target_os = "linux")]
fn a_terminal_shows_each_stage_and_frame_from_the_start() {
    let folder = with_ball();
    // Each stage takes longer than a bar takes to be drawn again.
    run_silently(folder.path(), &["generate", "knot", "mesh.ply", "-n", "1M", "-q"]);
    for (arguments, expected) in [
        ("mesh.ply a.png --size 8x6 --bvh very-slow", &["reading", "building the BVH"][..]),
        ("mesh.ply a.gif --size 300x200 --turntable 2", &["image 1 of 2", "image 2 of 2"]),
        ("ball.json a.png -q", &[]),
    ] {
        let Some(shown) = on_a_terminal(folder.path(), arguments) else {
            eprintln!("there is no program script: bars are not tried");
            return;
        };
        assert!(expected.iter().all(|words| shown.contains(words)), "{arguments}: {shown}");
        assert!(!expected.is_empty() || shown.is_empty(), "{arguments}: {shown}");
    }
}

/// A child that is killed when the test ends.
struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_image_is_written_while_it_is_rendered() {
    // So many rays that the test is over before the render is.
    let mut scene = of_size(200, 150);
    scene["camera"]["antialias"] = json!(64);
    let folder = with_scene(&scene.to_string());
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavecrest"));
    command.args(["ball.json", "out.pfm", "--also", "out.exr", "--save-every", "0.05", "-q"]);
    let child = command.current_dir(folder.path()).stderr(Stdio::piped()).spawn();
    let _child = Killed(child.expect("the command starts"));
    let start = Instant::now();
    // The second output is there as soon as the first is whole.
    while !folder.path().join("out.exr").exists() {
        assert!(start.elapsed() < Duration::from_secs(120), "no image is written");
        std::thread::sleep(Duration::from_millis(20));
    }
    let found = film(folder.path(), "out.exr");
    assert_eq!((found.width(), found.height()), (200, 150));
    let done = found.pixels().iter().filter(|pixel| **pixel != [0.0; 3]).count();
    assert!(done > 0 && done < 200 * 150, "{done}");
    let bytes = bytes(folder.path(), "out.exr");
    let said = String::from_utf8_lossy(&bytes);
    assert!(said.contains("wavecrest.unfinished") && said.contains("% is rendered"));
    assert!(folder.path().join("out.pfm").exists());
}

/// What a viewer was told: the names and the pixels of its images.
#[derive(Default)]
struct Viewer {
    name: String,
    size: [u32; 2],
    pixels: Vec<f32>,
    updates: usize,
}

/// Reads the protocol of the viewer tev: packets of a length, a kind, and what belongs to it.
struct Packet<'a>(&'a [u8]);

impl Packet<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_first_chunk::<N>().expect("the packet goes on");
        self.0 = rest;
        *head
    }

    fn number(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn long(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|&byte| byte == 0).expect("a text ends");
        let text = text(&self.0[..end]).to_owned();
        self.0 = &self.0[end + 1..];
        text
    }
}

impl Viewer {
    fn take(&mut self, bytes: &[u8]) {
        let mut rest = bytes;
        while !rest.is_empty() {
            let length = Packet(rest).number() as usize;
            let mut packet = Packet(&rest[4..length]);
            rest = &rest[length..];
            match packet.take() {
                [4] => self.create(&mut packet),
                [6] => self.update(&mut packet),
                kind => panic!("an unknown packet {kind:?}"),
            }
            assert!(packet.0.is_empty(), "a packet is longer than what is in it");
        }
    }

    fn create(&mut self, packet: &mut Packet<'_>) {
        let _: [u8; 1] = packet.take();
        self.name = packet.text();
        self.size = [packet.number(), packet.number()];
        let channels: Vec<_> = (0..packet.number()).map(|_| packet.text()).collect();
        assert_eq!(channels, ["R", "G", "B"]);
        self.pixels = vec![0.0; (self.size[0] * self.size[1] * 3) as usize];
    }

    fn update(&mut self, packet: &mut Packet<'_>) {
        let _: [u8; 1] = packet.take();
        assert_eq!(packet.text(), self.name);
        let channels = packet.number() as usize;
        let names: Vec<_> = (0..channels).map(|_| packet.text()).collect();
        assert_eq!(names, ["R", "G", "B"]);
        let [x, y, width, height] = [0; 4].map(|_| packet.number());
        let offsets: Vec<u64> = (0..channels).map(|_| packet.long()).collect();
        let strides: Vec<u64> = (0..channels).map(|_| packet.long()).collect();
        let values: Vec<f32> = packet
            .0
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        packet.0 = &[];
        for i in 0..width * height {
            let place = ((y + i / width) * self.size[0] + x + i % width) as usize * 3;
            for channel in 0..channels {
                let from = offsets[channel] + u64::from(i) * strides[channel];
                self.pixels[place + channel] = values[from as usize];
            }
        }
        self.updates += 1;
    }

    fn film(self) -> Film {
        let pixels = self.pixels.as_chunks::<3>().0.to_vec();
        Film::from_pixels(self.size[0], self.size[1], pixels).expect("a film")
    }
}

/// A viewer's port, and what it does with the connection that comes.
fn listen<T: Send + 'static>(
    serve: impl FnOnce(TcpStream) -> T + Send + 'static,
) -> (String, std::thread::JoinHandle<T>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address").to_string();
    (address, std::thread::spawn(move || serve(listener.accept().expect("a connection").0)))
}

#[test]
fn a_viewer_is_sent_the_image_tile_by_tile() {
    let scene = of_size(150, 100);
    let folder = with_scene(&scene.to_string());
    let read_all = |mut stream: TcpStream| {
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).expect("what is sent");
        bytes
    };
    for (options, part) in
        [(&[][..], [0, 0, 150, 100]), (&["--crop", "30,9,80,70"], [30, 9, 80, 70])]
    {
        let (address, viewer) = listen(read_all);
        let tev = format!("--tev={address}");
        run_silently(folder.path(), &[&["ball.json", "out.exr", tev.as_str()], options].concat());
        let mut shown = Viewer::default();
        shown.take(&viewer.join().expect("the viewer saw no fault"));
        assert_eq!((shown.name.as_str(), shown.updates > 1), ("out.exr", true));
        let expected = image(&scene).part(part).expect("a part");
        assert!(shown.film().same_bits(&expected), "{options:?}");
    }
}

#[test]
fn a_missing_viewer_does_not_stop_the_render() {
    let folder = with_scene(&of_size(150, 100).to_string());
    let expected = image(&of_size(150, 100));
    // A port without a listener.
    let port = TcpListener::bind("127.0.0.1:0").expect("a port").local_addr().expect("an address");
    let output = run(folder.path(), &["-q", "ball.json", "out.exr", &format!("--tev={port}")]);
    assert_eq!(output.status.code(), Some(0));
    let told = text(&output.stderr);
    let words = format!("warning: {port}: cannot reach the viewer: ");
    assert!(told.starts_with(&words) && told.lines().count() == 1, "{told}");
    assert!(film(folder.path(), "out.exr").same_bits(&expected));
}

#[test]
fn a_viewer_that_disconnects_does_not_stop_the_render() {
    let folder = with_scene(&of_size(300, 200).to_string());
    let expected = image(&of_size(300, 200));
    let (address, viewer) = listen(|mut stream: TcpStream| {
        let mut some = [0; 10];
        stream.read_exact(&mut some).expect("the first bytes");
        let _ = stream.write_all(b"no more");
    });
    let output = run(folder.path(), &["-q", "ball.json", "out.exr", &format!("--tev={address}")]);
    viewer.join().expect("it left");
    assert_eq!(output.status.code(), Some(0));
    let told = text(&output.stderr);
    assert!(told.is_empty() || told.starts_with("warning: lost the viewer"), "{told}");
    assert!(film(folder.path(), "out.exr").same_bits(&expected));
}
