//! The page of the command `view`: what moves its camera, what it shows, and what it gives away.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::RgbImage;
use serde_json::json;
use tempfile::TempDir;

use super::chromium::Browser;
use super::pictures;

const WAVECREST: &str = env!("CARGO_BIN_EXE_wavecrest");
const SIZE: [u32; 2] = [160, 120];

/// Keeps what the server tells the page. A new state means new figures: until they are there, the old ones could pass for
/// them.
const SPY: &str = r#"
    window.told = { images: [] };
    window.WebSocket = class extends WebSocket {
        constructor(address) {
            super(address);
            this.addEventListener("message", ({ data }) => {
                if (typeof data !== "string") {
                    told.images[new DataView(data).getUint32(0, true)] = new Uint8Array(data);
                    return;
                }
                const message = JSON.parse(data);
                if (message.kind === "state") told.figures = null;
                told[message.kind] = message;
            });
        }
    };"#;

/// True when every half that the page shows is complete.
const RESTS: &str = "told.figures?.halves.length === told.state.halves.length \
                     && told.figures.halves.every((half) => half.rests)";

/// The command, serving a file.
struct Server {
    child: Child,
    address: String,
    folder: PathBuf,
}

impl Server {
    /// Serves a file in a folder.
    fn start(folder: &Path, file: &str) -> Self {
        let mut child = Command::new(WAVECREST)
            .current_dir(folder)
            .args(["view", "-q", "--no-open", "--size", "160x120", file])
            .stdout(Stdio::piped())
            .spawn()
            .expect("it runs");
        let mut address = String::new();
        let mut output = BufReader::new(child.stdout.take().expect("it is piped"));
        output.read_line(&mut address).expect("an address");
        Self { child, address: address.trim_end().to_owned(), folder: folder.to_owned() }
    }

    /// What is served below the address: the name to save it by, and its bytes.
    fn get(&self, resource: &str) -> (String, Vec<u8>) {
        let (host, path) = self
            .address
            .strip_prefix("http://")
            .and_then(|rest| rest.split_once('/'))
            .expect("a URL");
        let mut stream = TcpStream::connect(host).expect("the server listens");
        write!(stream, "GET /{path}{resource} HTTP/1.1\r\nHost: {host}\r\n\r\n").expect("it reads");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let end = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n").expect("a head");
        let head = String::from_utf8_lossy(&answer[..end]);
        assert!(head.starts_with("HTTP/1.1 200 "), "{head}");
        let name = head.split('"').nth(1).expect("a name").to_owned();
        (name, answer[end + 4..].to_vec())
    }

    /// The image as the server gives it away.
    fn image(&self) -> RgbImage {
        decoded(&self.get("image.png").1)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // A test may have ended it.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn decoded(png: &[u8]) -> RgbImage {
    image::load_from_memory(png).expect("a PNG").to_rgb8()
}

/// A browser whose pages note what servers tell them.
fn started(test: &str) -> Option<Browser> {
    let mut browser = Browser::start(test)?;
    browser.resize(1100, 900);
    browser.prefer("light");
    browser.call("Page.addScriptToEvaluateOnNewDocument", json!({"source": SPY}));
    Some(browser)
}

/// A folder with scenes of this repository, a small mesh, and the textures in their place.
fn laid_out() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = ["scenes/cutouts.json", "scenes/hard/far-from-origin.json"];
    for file in files.into_iter().chain(["textures/checker.png", "textures/leaf.png"]) {
        let to = folder.path().join(file);
        std::fs::create_dir_all(to.parent().expect("it has one")).expect("a folder");
        std::fs::copy(root.join(file), to).expect("a copy");
    }
    let corners = "v 0 0 0\nv 2 0 0\nv 1 2 0\nv 1 0.7 1.5\n";
    let mesh = format!("{corners}f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    std::fs::write(folder.path().join("one mesh.obj"), mesh).expect("a file");
    folder
}

/// Where the image lies in the window: its left and upper edge, and the side of a pixel. Its labels lie along its lower edge.
fn place(browser: &mut Browser) -> [f64; 3] {
    let found = browser.evaluate(
        "(({ left, width, bottom }) => [left, width, bottom].map(parseFloat).concat(innerHeight))\
         (document.querySelector('#labels').style)",
    );
    let [left, width, bottom, height] =
        [0, 1, 2, 3].map(|index| found[index].as_f64().expect("a number"));
    let side = width / f64::from(SIZE[0]);
    [left, height - bottom - side * f64::from(SIZE[1]), side]
}

/// The middle of a pixel of the image, in the window.
fn middle(place: [f64; 3], pixel: [u32; 2]) -> [f64; 2] {
    [0, 1].map(|axis| place[axis] + (f64::from(pixel[axis]) + 0.5) * place[2])
}

/// What the canvas shows, which is as large as the window.
fn canvas(browser: &mut Browser) -> RgbImage {
    let url = browser.evaluate("document.querySelector('#image').toDataURL()");
    let png = url.as_str().and_then(|url| url.split_once(',')).expect("a URL of data").1;
    decoded(&STANDARD.decode(png).expect("base 64"))
}

/// The pixels of the image as the canvas shows them.
fn shown(browser: &mut Browser) -> RgbImage {
    let (place, canvas) = (place(browser), canvas(browser));
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let [x, y] = middle(place, [x, y]).map(|at| at as u32);
        *canvas.get_pixel(x, y)
    })
}

/// The image at rest, once the page shows all of it.
fn at_rest(browser: &mut Browser, server: &Server) -> RgbImage {
    browser.wait_for(RESTS);
    let status = browser.evaluate("document.querySelector('#status').textContent");
    assert_eq!(status, "at rest: the whole image");
    // A page that still draws gets the last image a little later than the figures.
    let (expected, start) = (server.image(), Instant::now());
    while shown(browser) != expected {
        assert!(start.elapsed() < Duration::from_secs(10), "the page shows another image");
    }
    expected
}

/// The distance between the camera and the point that it looks at, and where it is.
fn camera(browser: &mut Browser) -> (f64, [f64; 3]) {
    let found = browser.evaluate("[told.state.camera.location, told.state.camera.look]");
    let [location, look] =
        [0, 1].map(|point| [0, 1, 2].map(|axis| found[point][axis].as_f64().expect("a number")));
    let distance = [0, 1, 2].map(|axis| (location[axis] - look[axis]).powi(2)).iter().sum::<f64>();
    (distance.sqrt(), location)
}

/// Does what moves the camera, and gives the image from there at rest.
fn moved(browser: &mut Browser, server: &Server, act: impl FnOnce(&mut Browser)) -> RgbImage {
    browser.evaluate("window.before = JSON.stringify(told.state.camera)");
    act(browser);
    browser.wait_for(&format!("JSON.stringify(told.state.camera) !== before && {RESTS}"));
    at_rest(browser, server)
}

/// Drags with one movement, which moves the camera once.
fn drag(browser: &mut Browser, from: [f64; 2], to: [f64; 2]) {
    for (kind, at) in [("mousePressed", from), ("mouseMoved", to), ("mouseReleased", to)] {
        browser.mouse(kind, at);
    }
}

fn turn_wheel(browser: &mut Browser, [x, y]: [f64; 2]) {
    let turn = json!({"type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": -100});
    browser.call("Input.dispatchMouseEvent", turn);
}

/// Saves the scene by its name beside the original, and runs the command of the page there: it must give the same image.
fn assert_the_same_is_rendered(browser: &mut Browser, server: &Server, image: &RgbImage) {
    let (name, scene) = server.get("scene.json");
    std::fs::write(server.folder.join(name), scene).expect("a file");
    let command = browser.evaluate("document.querySelector('#command').textContent");
    let ran = Command::new("sh")
        .current_dir(&server.folder)
        .env("WAVECREST", WAVECREST)
        .args([
            "-ec",
            &format!(
                "wavecrest() {{ \"$WAVECREST\" \"$@\"; }}\n{}",
                command.as_str().expect("text")
            ),
        ])
        .output()
        .expect("a shell");
    assert!(ran.status.success(), "{command}: {}", String::from_utf8_lossy(&ran.stderr));
    let (name, _) = server.get("image.png");
    let rendered = decoded(&std::fs::read(server.folder.join(name)).expect("an image"));
    assert!(rendered == *image, "{command} renders another image");
}

#[test]
fn view_follows_pointer_wheel_and_keys_until_the_server_ends() {
    let Some(mut browser) = started("the camera of view") else { return };
    let folder = laid_out();
    let mut server = Server::start(&folder.path().join("scenes"), "cutouts.json");
    browser.visit(&server.address);
    browser.wait_for("told.images[0] && document.querySelector('#stage').hidden");
    let first = at_rest(&mut browser, &server);
    let (distance, start) = camera(&mut browser);
    let point = middle(place(&mut browser), [80, 60]);

    // A turn keeps the distance; a notch of the wheel takes a sixth of it.
    let image =
        moved(&mut browser, &server, |b| drag(b, point, [point[0] + 90.0, point[1] + 30.0]));
    let (turned, location) = camera(&mut browser);
    assert!(image != first && location != start && (turned / distance - 1.0).abs() < 1e-9);
    assert_the_same_is_rendered(&mut browser, &server, &image);
    let nearer = moved(&mut browser, &server, |b| turn_wheel(b, point));
    let ratio = distance / camera(&mut browser).0;
    assert!(nearer != image && (ratio - 1.2).abs() < 1e-9, "{ratio}");

    // From the front the camera is before the middle, and above it from the top.
    let side = |b: &mut Browser, key: &str, code| {
        let image = moved(b, &server, |b| b.press(key, code));
        (image, b.evaluate("(({ location, look }) => location.map((x, axis) => Math.round((x - look[axis]) * 1e6)))(told.state.camera)"))
    };
    let (_, front) = side(&mut browser, "1", 49);
    assert!(front[0] == 0 && front[1] == 0 && front[2] != 0, "{front}");
    let (_, top) = side(&mut browser, "5", 53);
    assert!(top[1].as_f64() > Some(0.0) && top[0] == 0, "{top}");
    moved(&mut browser, &server, |b| turn_wheel(b, point));
    let (_, framed) = side(&mut browser, "f", 70);
    assert_eq!(framed, top, "all of it is seen from the same distance again");
    assert!(side(&mut browser, "Home", 36).0 == first);
    assert_eq!(camera(&mut browser), (distance, start));
    assert_eq!(browser.complaints, Vec::<String>::new());

    server.child.kill().expect("it runs");
    browser.wait_for("document.querySelector('#ended').checkVisibility()");
    let words = browser.evaluate("document.querySelector('#ended').innerText");
    assert!(words.as_str().is_some_and(|words| words.contains("The server has ended.")));
}

#[test]
fn scenes_of_view_render_to_what_it_shows() {
    let Some(mut browser) = started("scenes of view") else { return };
    let folder = laid_out();
    for (inner, file) in [("", "one mesh.obj"), ("scenes/hard", "far-from-origin.json")] {
        let server = Server::start(&folder.path().join(inner), file);
        browser.visit(&server.address);
        browser.wait_for("told.state");
        at_rest(&mut browser, &server);
        let point = middle(place(&mut browser), [80, 60]);
        moved(&mut browser, &server, |b| drag(b, point, [point[0] + 71.0, point[1] + 13.0]));
        let image = moved(&mut browser, &server, |b| turn_wheel(b, [point[0] + 50.0, point[1]]));
        assert_the_same_is_rendered(&mut browser, &server, &image);
        assert_eq!(browser.complaints, Vec::<String>::new());
        browser.visit("about:blank");
    }
}

/// Chooses from a field of the second half, and waits until that is what the page shows at rest.
fn choose(browser: &mut Browser, field: &str, value: &str) {
    browser.evaluate(&format!(
        "(field => {{ field.value = '{value}'; field.dispatchEvent(new Event('change', {{bubbles: true}})); }})\
         (document.querySelectorAll('[name={field}]')[1])"
    ));
    browser.wait_for(&format!("told.state.halves[1].{field} === '{value}' && {RESTS}"));
}

/// The images of both halves, as the server has told them.
fn halves(browser: &mut Browser) -> [RgbImage; 2] {
    let found = browser.evaluate("told.images.map((bytes) => [...bytes.subarray(16)])");
    [0, 1].map(|half| {
        let bytes = found[half].as_array().expect("an image").iter();
        let bytes = bytes.map(|byte| byte.as_u64().expect("a byte") as u8).collect();
        let image = image::RgbaImage::from_raw(SIZE[0], SIZE[1], bytes).expect("all pixels");
        image::DynamicImage::from(image).to_rgb8()
    })
}

/// Expects the first half to the left of the divider, the second to its right.
fn assert_divided(browser: &mut Browser, share: f64) {
    let (seen, [a, b]) = (shown(browser), halves(browser));
    let divider = share * f64::from(SIZE[0]);
    // The divider hides what is near it.
    let columns = (0..SIZE[0]).filter(|&x| (f64::from(x) + 0.5 - divider).abs() > 4.0);
    for x in columns {
        let half = if f64::from(x) < divider { &a } else { &b };
        let is_same = (0..SIZE[1]).all(|y| seen.get_pixel(x, y) == half.get_pixel(x, y));
        assert!(is_same, "column {x} with the divider at {share}");
    }
}

#[test]
fn halves_of_view_are_compared_and_a_pixel_is_followed() {
    let Some(mut browser) = started("halves of view") else { return };
    let folder = laid_out();
    let server = Server::start(folder.path(), "one mesh.obj");
    browser.visit(&server.address);
    browser.wait_for("told.state");
    at_rest(&mut browser, &server);
    browser.evaluate("document.querySelector('#compare').click()");
    browser.wait_for(&format!("told.state.halves.length === 2 && {RESTS}"));
    choose(&mut browser, "sampler", "random");
    let differs = "(([a, b]) => a.filter((_, at) => at >= 16 && at % 4 === 0 \
                   && [0, 1, 2].some((channel) => a[at + channel] !== b[at + channel])).length)(told.images)";
    let difference = "document.querySelector('#difference').innerText";
    browser.wait_for(&format!(
        "{difference}.startsWith(`Pixels that differ: ${{{differs}.toLocaleString('en').replace(',', '\\u202f')}} of 19\\u202f200.`)"
    ));

    // The divider follows its range and the pointer, which leaves the camera alone.
    let [a, b] = halves(&mut browser);
    let between =
        |image: &RgbImage| image::imageops::crop_imm(image, 40, 0, 32, SIZE[1]).to_image();
    assert!(between(&a) != between(&b), "the divider would change nothing");
    assert_divided(&mut browser, 0.5);
    browser.evaluate("(wipe => { wipe.value = 80; wipe.dispatchEvent(new Event('input')); })(document.querySelector('#wipe'))");
    browser.settle();
    assert_divided(&mut browser, 0.8);
    let place = place(&mut browser);
    let [at, to] = [128, 32].map(|x| [place[0] + f64::from(x) * place[2], 300.0]);
    let before = camera(&mut browser);
    drag(&mut browser, at, to);
    browser.settle();
    assert_divided(&mut browser, 0.2);
    assert_eq!(camera(&mut browser), before);
    browser.picture(&pictures().join("view-halves.png"));

    // The difference itself.
    browser.evaluate("(shown => { shown.value = '16'; shown.dispatchEvent(new Event('change')); })(document.querySelector('#shown'))");
    browser.settle();
    let magnified = RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let (a, b) = (a.get_pixel(x, y).0, b.get_pixel(x, y).0);
        image::Rgb([0, 1, 2].map(|channel| a[channel].abs_diff(b[channel]).saturating_mul(16)))
    });
    assert!(shown(&mut browser) == magnified);
    choose(&mut browser, "sampler", "file");
    choose(&mut browser, "precision", "exact");
    choose(&mut browser, "tracer", "recursive");
    browser.wait_for(&format!("{difference} === 'A and B agree in all 19\\u202f200 pixels.'"));
    assert!(shown(&mut browser).pixels().all(|pixel| pixel.0 == [0; 3]));

    // A click follows the rays of its pixel, and leaves a cross of white there until the camera moves.
    let point = middle(place, [100, 70]);
    let bar =
        |browser: &mut Browser| canvas(browser).get_pixel(point[0] as u32 - 6, point[1] as u32).0;
    assert_eq!(bar(&mut browser), [0; 3]);
    drag(&mut browser, point, point);
    browser.wait_for("document.querySelector('#record').innerText.includes('pixel [100, 70]')");
    browser.settle();
    assert!(bar(&mut browser).iter().all(|&level| level > 150), "{:?}", bar(&mut browser));
    browser.picture(&pictures().join("view-pixel.png"));
    moved(&mut browser, &server, |b| turn_wheel(b, point));
    assert_eq!(bar(&mut browser), [0; 3]);
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn view_in_light_dark_and_narrow_windows() {
    let Some(mut browser) = started("light, dark and narrow view") else { return };
    let folder = laid_out();
    let server = Server::start(&folder.path().join("scenes"), "cutouts.json");
    browser.visit(&server.address);
    browser.wait_for("told.state");
    for (scheme, width, name) in
        [("light", 1100, "view"), ("dark", 1100, "view-dark"), ("light", 400, "view-narrow")]
    {
        browser.prefer(scheme);
        browser.resize(width, 900);
        at_rest(&mut browser, &server);
        let picture = browser.picture(&pictures().join(format!("{name}.png")));
        let is_dark = picture.get_pixel(2, 2).0.iter().all(|&level| level < 64);
        assert_eq!(is_dark, scheme == "dark", "{name}");
        let wide = browser.evaluate("document.documentElement.scrollWidth");
        assert_eq!(wide, width, "nothing stands out of the window");
    }
    // The panels lie below the whole image.
    let [left, top, side] = place(&mut browser);
    let panels = browser.evaluate("document.querySelector('#panels').getBoundingClientRect().top");
    let [right, bottom] = [left + side * 160.0, top + side * 120.0];
    assert!(left >= 0.0 && top >= 0.0 && right <= 400.0 && Some(bottom) <= panels.as_f64());
    assert_eq!(browser.complaints, Vec::<String>::new());
}
