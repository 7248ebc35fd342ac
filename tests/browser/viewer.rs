//! The command `view` and its page.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use image::{Pixel as _, RgbImage, RgbaImage};
use serde_json::json;

use super::chromium::Browser;

const WAVECREST: &str = env!("CARGO_BIN_EXE_wavecrest");

/// How long a page may take to draw what it has been told.
pub(crate) const SOON: Duration = Duration::from_secs(10);
/// Of the images.
pub(crate) const SIZE: [u32; 2] = [160, 120];

/// Keeps what the server tells the page. A new state means new figures: until they are there, the old
/// ones could pass for them. The page cannot read canvases, as in browsers that guard against being recognised.
const SPY: &str = r#"
    window.told = { images: [], previews: 0 };
    CanvasRenderingContext2D.prototype.getImageData = HTMLCanvasElement.prototype.toBlob =
        () => { throw new Error("a canvas is read"); };
    window.WebSocket = class extends WebSocket {
        constructor(address) {
            super(address);
            this.addEventListener("message", ({ data }) => {
                if (typeof data !== "string") {
                    const head = new DataView(data);
                    const [index, flags, length, from] = [0, 12, 16, 20].map((at) => head.getUint32(at, true));
                    // JPEGs of what does not move.
                    told.previews += (flags & 5) === 4;
                    if (from === 0) told.images[index] = new Uint8Array(length);
                    told.images[index].set(new Uint8Array(data, 24), from);
                    return;
                }
                const message = JSON.parse(data);
                if (message.kind === "state") told.figures = null;
                told[message.kind] = message;
            });
        }
    };"#;

/// True when every half that the page shows is complete.
pub(crate) const RESTS: &str = "told.figures?.halves.length === told.state.halves.length \
                     && told.figures.halves.every((half) => half.rests)";

/// The command, serving a file.
pub(crate) struct Server {
    child: Child,
    pub(crate) address: String,
    folder: PathBuf,
}

impl Server {
    /// Serves a file in a folder, with more options.
    pub(crate) fn start(folder: &Path, file: &str, options: &[&str]) -> Self {
        let mut child = Command::new(WAVECREST)
            .current_dir(folder)
            .args(["view", "-q", "--no-open", "--size", "160x120", file])
            .args(options)
            .stdout(Stdio::piped())
            // Notes on the scene.
            .stderr(Stdio::null())
            .spawn()
            .expect("it runs");
        let mut address = String::new();
        let mut output = BufReader::new(child.stdout.take().expect("it is piped"));
        output.read_line(&mut address).expect("an address");
        Self { child, address: address.trim_end().to_owned(), folder: folder.to_owned() }
    }

    /// What is served below the address.
    fn get(&self, resource: &str) -> Vec<u8> {
        let rest = self.address.strip_prefix("http://");
        let (host, path) = rest.and_then(|rest| rest.split_once('/')).expect("a URL");
        let mut stream = TcpStream::connect(host).expect("the server listens");
        write!(stream, "GET /{path}{resource} HTTP/1.1\r\nHost: {host}\r\n\r\n").expect("it reads");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let end = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n").expect("a head");
        assert!(
            answer.starts_with(b"HTTP/1.1 200 "),
            "{}",
            String::from_utf8_lossy(&answer[..end])
        );
        answer.split_off(end + 4)
    }

    /// The image as the server gives it away.
    pub(crate) fn image(&self) -> RgbImage {
        decoded(&self.get("image.png"))
    }

    /// Runs a command of the page where the server was started, and gives the image that it writes.
    pub(crate) fn rendered(&self, command: &str, image: &str) -> RgbImage {
        let ran = Command::new("sh")
            .current_dir(&self.folder)
            .env("WAVECREST", WAVECREST)
            .args(["-ec", &format!("wavecrest() {{ \"$WAVECREST\" \"$@\"; }}\n{command}")])
            .output()
            .expect("a shell");
        assert!(ran.status.success(), "{command}: {}", String::from_utf8_lossy(&ran.stderr));
        decoded(&std::fs::read(self.folder.join(image)).expect("an image"))
    }

    /// Ends the command.
    pub(crate) fn end(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.end();
    }
}

/// The pixels of a PNG.
pub(crate) fn decoded(png: &[u8]) -> RgbImage {
    image::load_from_memory(png).expect("a PNG").to_rgb8()
}

/// A browser whose pages note what servers tell them.
pub(crate) fn started(test: &str) -> Option<Browser> {
    let mut browser = Browser::start(test)?;
    browser.resize(1100, 900);
    browser.prefer("light");
    browser.call("Page.addScriptToEvaluateOnNewDocument", json!({"source": SPY}));
    Some(browser)
}

/// Where the image lies in the window: its left and upper edge, and the side of a pixel. Around it the
/// canvas is transparent.
pub(crate) fn place(canvas: &RgbaImage) -> [f64; 3] {
    let is_image = |x: u32, y: u32| canvas.get_pixel(x, y).0[3] == 255;
    let [width, height] = [canvas.width(), canvas.height()];
    let inside = |x: u32| (0..height).filter(move |&y| is_image(x, y)).collect::<Vec<_>>();
    let columns = (0..width).map(|x| (x, inside(x)));
    let (left, rows) = columns.into_iter().find(|(_, rows)| !rows.is_empty()).expect("an image");
    let side = rows.len() as f64 / f64::from(SIZE[1]);
    [f64::from(left), f64::from(rows[0]), side]
}

/// The middle of a pixel of the image, in the window.
pub(crate) fn middle(place: [f64; 3], pixel: [u32; 2]) -> [f64; 2] {
    [0, 1].map(|axis| place[axis] + (f64::from(pixel[axis]) + 0.5) * place[2])
}

/// The pixels of the image as the canvas shows them.
pub(crate) fn shown(browser: &mut Browser) -> RgbImage {
    let canvas = browser.canvas("#image");
    let place = place(&canvas);
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let [x, y] = middle(place, [x, y]).map(|at| at as u32);
        canvas.get_pixel(x, y).to_rgb()
    })
}

/// The image at rest, once the page shows all of it.
pub(crate) fn at_rest(browser: &mut Browser, server: &Server) -> RgbImage {
    browser.wait_for(RESTS);
    let status = browser.evaluate("document.querySelector('#status').textContent");
    assert_eq!(status, "at rest: the whole image");
    let is_covered = browser.evaluate("document.querySelector('#stage').checkVisibility()");
    assert_eq!(is_covered, false, "the progress still lies over the image");
    // A page that still draws gets the last image a little later than the figures.
    let (expected, start) = (server.image(), Instant::now());
    while shown(browser) != expected {
        assert!(start.elapsed() < SOON, "the page shows another image");
    }
    expected
}
