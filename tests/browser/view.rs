//! The page of the command `view`: what moves its camera, what it shows, and what it gives away.

use std::path::Path;
use std::time::Instant;

use image::{Pixel as _, RgbImage, RgbaImage};
use serde_json::json;
use tempfile::TempDir;

use super::chromium::Browser;
use super::pictures;
use super::viewer::{RESTS, SIZE, SOON, Server, at_rest, middle, place, shown, started};

/// A folder with scenes of this repository, a small mesh, and the textures in their place.
pub(crate) fn laid_out() -> TempDir {
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

/// The distance between the camera and the point that it looks at, and where it is.
pub(crate) fn camera(browser: &mut Browser) -> (f64, [f64; 3]) {
    let found = browser.evaluate("[told.state.camera.location, told.state.camera.look]");
    let [location, look] =
        [0, 1].map(|point| [0, 1, 2].map(|axis| found[point][axis].as_f64().expect("a number")));
    let distance = [0, 1, 2].map(|axis| (location[axis] - look[axis]).powi(2)).iter().sum::<f64>();
    (distance.sqrt(), location)
}

/// Does what moves the camera, and gives the image from there at rest.
pub(crate) fn moved(
    browser: &mut Browser,
    server: &Server,
    act: impl FnOnce(&mut Browser),
) -> RgbImage {
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

/// The command of the page must render the same image, and so must that for its scene, with these options.
fn assert_the_same_is_rendered(
    browser: &mut Browser,
    server: &Server,
    image: &RgbImage,
    of_image: Option<&str>,
) {
    let told = browser.evaluate(
        "['#render', '#convert'].map((part) => document.querySelector(part).textContent)\
         .concat(document.querySelector('#picture').download)",
    );
    let [render, convert, picture] = [0, 1, 2].map(|index| told[index].as_str().expect("text"));
    let scene = Path::new(picture).with_extension("json");
    let of_scene = of_image.map(|options| {
        let render = format!("wavecrest '{}' '{picture}' {options}", scene.display());
        format!("{convert} -q --force && {render}")
    });
    for command in [render].into_iter().chain(of_scene.as_deref()) {
        let rendered = server.rendered(command, picture);
        assert!(rendered == *image, "{command} renders another image");
    }
}

#[test]
fn view_follows_pointer_wheel_and_keys_until_the_server_ends() {
    let Some(mut browser) = started("the camera of view") else { return };
    let folder = laid_out();
    let mut server = Server::start(&folder.path().join("scenes"), "cutouts.json", &[]);
    browser.visit(&server.address);
    browser.wait_for("told.images[0] && document.querySelector('#stage').hidden");
    let first = at_rest(&mut browser, &server);
    let (distance, start) = camera(&mut browser);
    let point = middle(place(&browser.canvas("#image")), [80, 60]);

    // A turn keeps the distance; a notch of the wheel takes a sixth of it.
    let image =
        moved(&mut browser, &server, |b| drag(b, point, [point[0] + 90.0, point[1] + 30.0]));
    let (turned, location) = camera(&mut browser);
    assert!(image != first && location != start && (turned / distance - 1.0).abs() < 1e-9);
    assert_the_same_is_rendered(&mut browser, &server, &image, Some(""));
    let nearer = moved(&mut browser, &server, |b| turn_wheel(b, point));
    let ratio = distance / camera(&mut browser).0;
    assert!(nearer != image && (ratio - 1.2).abs() < 1e-9, "{ratio}");

    // From the front the camera is before the middle, and above it from the top.
    let side = |b: &mut Browser, key: &str, code| {
        let image = moved(b, &server, |b| b.press(key, code));
        let script = "(({ location, look }) => location.map((x, axis) => \
                      Math.round((x - look[axis]) * 1e6) + 0))(told.state.camera)";
        (image, b.evaluate(script))
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

    server.end();
    browser.wait_for("document.querySelector('#ended').checkVisibility()");
    let words = browser.evaluate("document.querySelector('#ended').innerText");
    assert!(words.as_str().is_some_and(|words| words.contains("The server has ended.")));
}

#[test]
fn scenes_of_view_render_to_what_it_shows() {
    let Some(mut browser) = started("scenes of view") else { return };
    let folder = laid_out();
    for (inner, file, options, of_image) in [
        ("", "one mesh.obj", &[][..], Some("")),
        ("", "one mesh.obj", &["--lights-stay", "--view", "30,20", "--up", "z"], Some("")),
        ("", "one mesh.obj", &["--lights", "headlight"], None),
        ("", "one mesh.obj", &["--from", "0,1,9", "--up", "1,0,0", "--up", "z"], Some("")),
        ("scenes/hard", "far-from-origin.json", &[], Some("")),
        ("scenes", "cutouts.json", &["--seed", "5"], Some("--seed 5")),
        ("scenes", "cutouts.json", &["--as", "clay"], None),
        ("scenes", "cutouts.json", &["--as", "normals"], None),
    ] {
        let server = Server::start(&folder.path().join(inner), file, options);
        browser.visit(&server.address);
        browser.wait_for("told.state");
        at_rest(&mut browser, &server);
        let point = middle(place(&browser.canvas("#image")), [80, 60]);
        moved(&mut browser, &server, |b| drag(b, point, [point[0] + 71.0, point[1] + 13.0]));
        let image = moved(&mut browser, &server, |b| turn_wheel(b, [point[0] + 50.0, point[1]]));
        assert_the_same_is_rendered(&mut browser, &server, &image, of_image);
        assert_eq!(browser.complaints, Vec::<String>::new());
        browser.visit("about:blank");
    }
}

/// What is chosen on the page is in the command, too.
#[test]
fn settings_of_view_are_those_of_the_command() {
    let Some(mut browser) = started("settings of view") else { return };
    let folder = laid_out();
    for moves in [false, true] {
        let server = Server::start(folder.path(), "one mesh.obj", &["--up", "y"]);
        browser.visit(&server.address);
        browser.wait_for("told.state");
        let first = at_rest(&mut browser, &server);
        if moves {
            let point = middle(place(&browser.canvas("#image")), [80, 60]);
            moved(&mut browser, &server, |b| drag(b, point, [point[0] + 71.0, point[1] + 13.0]));
        }
        choose_settings(&mut browser, &server, (first, moves));
        browser.visit("about:blank");
    }
}

fn choose_settings(browser: &mut Browser, server: &Server, (first, moves): (RgbImage, bool)) {
    let mut last = first;
    for (name, value) in [
        ("exposure", "-1.5"),
        ("transfer", "linear"),
        ("stays", "stay"),
        ("look", "clay"),
        ("look", ""),
        ("up", "x"),
        ("size", "1280x720"),
        ("up", ""),
    ] {
        browser.evaluate("window.before = JSON.stringify(told.state.shown)");
        browser.evaluate(&format!(
            "(() => {{ const field = document.querySelector('#settings').elements.{name}; \
             field.value = '{value}'; \
             field.dispatchEvent(new Event('change', {{ bubbles: true }})); }})()"
        ));
        browser.wait_for(&format!("JSON.stringify(told.state.shown) !== before && {RESTS}"));
        let image = server.image();
        // Lights that stay are where the camera is, unless that was moved.
        assert!(image != last || (name == "stays" && !moves), "{name} changes nothing");
        assert_the_same_is_rendered(browser, server, &image, None);
        last = image;
    }
    assert_eq!(last.dimensions(), (1280, 720));
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// Answers of the page are late, as on a slow line.
const LATE: &str = "(() => {
    const send = WebSocket.prototype.send;
    WebSocket.prototype.send = function (text) {
        const { drawing, ...rest } = JSON.parse(text);
        setTimeout(() => send.call(this, JSON.stringify(rest)), 250);
    };
})()";

#[test]
fn on_a_slow_line_view_shows_a_jpeg_first() {
    let Some(mut browser) = started("view on a slow line") else { return };
    let folder = laid_out();
    let server = Server::start(&folder.path().join("scenes"), "cutouts.json", &[]);
    browser.visit(&server.address);
    browser.wait_for("told.images[0]");
    at_rest(&mut browser, &server);
    let point = middle(place(&browser.canvas("#image")), [80, 60]);
    browser.evaluate(LATE);
    // What is sent next tells how slow it is: then a JPEG comes at once, and the pixels in parts.
    moved(&mut browser, &server, |b| drag(b, point, [point[0] + 20.0, point[1]]));
    browser.evaluate("window.before = told.previews");
    drag(&mut browser, point, [point[0] + 50.0, point[1]]);
    browser.wait_for("told.previews > before");
    let _drawn_by_now = shown(&mut browser);
    let (lossy, exact) = (shown(&mut browser), at_rest(&mut browser, &server));
    let far = lossy.iter().zip(exact.iter()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>();
    let mean = far / exact.len() as f64;
    assert!(mean > 0.0 && mean < 10.0, "the JPEG differs by {mean}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

/// Has two halves, of which the second has other samples, so that its noise tells them apart.
fn compare(browser: &mut Browser) {
    browser.evaluate("document.querySelector('#compare').click()");
    browser.wait_for(&format!("told.state.halves.length === 2 && {RESTS}"));
    choose(browser, "sampler", "random");
}

/// Chooses a value of the second half, and waits for its image.
fn choose(browser: &mut Browser, field: &str, value: &str) {
    browser.choose(&format!("fieldset + fieldset [name={field}]"), value);
    browser.wait_for(&format!("(told.state.halves[1].{field} ?? '') === '{value}' && {RESTS}"));
}

/// The image of a half, as the server has told it.
fn half(browser: &mut Browser, index: usize) -> RgbImage {
    // Before it is finished it may be smaller, or a JPEG.
    let bytes = 4 * SIZE[0] * SIZE[1];
    browser.wait_for(&format!("told.images[{index}].length === {bytes}"));
    let found = browser.evaluate(&format!("[...told.images[{index}]]"));
    let bytes =
        found.as_array().expect("an image").iter().map(|byte| byte.as_u64().expect("a byte"));
    let image = RgbaImage::from_raw(SIZE[0], SIZE[1], bytes.map(|byte| byte as u8).collect());
    image::DynamicImage::from(image.expect("all pixels")).to_rgb8()
}

/// The page must show the first half to the left of the divider, the second to its right.
fn assert_divided(browser: &mut Browser, at: f64) {
    let start = Instant::now();
    // Images arrive a little later than the figures, and are drawn later still.
    while let Err(why) = divided(browser, at) {
        assert!(start.elapsed() < SOON, "with the divider at {at}: {why}");
    }
}

fn divided(browser: &mut Browser, at: f64) -> Result<(), String> {
    let (a, b, seen) = (half(browser, 0), half(browser, 1), shown(browser));
    let mut compared = [0; 2];
    for (x, y, pixel) in seen.enumerate_pixels() {
        let from_divider = f64::from(x) + 0.5 - at;
        let halves = [a.get_pixel(x, y), b.get_pixel(x, y)];
        // The divider hides what is near it.
        if from_divider.abs() > 4.0 && halves[0] != halves[1] {
            let is_right = usize::from(from_divider > 0.0);
            compared[is_right] += 1;
            if pixel != halves[is_right] {
                return Err(format!("another pixel at {x}, {y}"));
            }
        }
    }
    let is_enough = compared.iter().all(|&pixels| pixels > 50);
    is_enough.then_some(()).ok_or_else(|| format!("only {compared:?} pixels differ"))
}

#[test]
fn halves_of_view_are_compared_and_a_pixel_is_followed() {
    let Some(mut browser) = started("halves of view") else { return };
    let folder = laid_out();
    let server = Server::start(folder.path(), "one mesh.obj", &[]);
    browser.visit(&server.address);
    browser.wait_for("told.state");
    at_rest(&mut browser, &server);
    let known = browser.evaluate("told.figures.halves[0].error");
    assert!(known.as_f64() > Some(0.0), "{known}: its passes tell its error");
    compare(&mut browser);
    let place = place(&browser.canvas("#image"));

    // The divider follows its range, and the pointer, which leaves the camera alone.
    assert_divided(&mut browser, 80.0);
    browser.choose("#wipe", "75");
    assert_divided(&mut browser, 120.0);
    let before = camera(&mut browser);
    let [from, to] = [120, 40].map(|x| [place[0] + f64::from(x) * place[2], place[1] + 9.0]);
    drag(&mut browser, from, to);
    browser.settle();
    assert_divided(&mut browser, 40.0);
    assert_eq!(camera(&mut browser), before);
    browser.picture(&pictures().join("view-halves.png"));

    // The difference has as many pixels as it says, and with the other tracer none.
    browser.choose("#shown", "256");
    let (a, b) = (half(&mut browser, 0), half(&mut browser, 1));
    let differs = a.pixels().zip(b.pixels()).map(|(a, b)| a != b);
    let lit = shown(&mut browser).pixels().map(|pixel| pixel.0 != [0; 3]).collect::<Vec<_>>();
    assert!(differs.eq(lit.iter().copied()));
    let count = lit.iter().filter(|&&is_lit| is_lit).count();
    let words = "document.querySelector('#difference').textContent.replaceAll('\\u202f', '')";
    let told = browser.evaluate(words);
    let expected = format!("Pixels that differ: {count} of 19200.");
    assert!(told.as_str().is_some_and(|told| told.starts_with(&expected)), "{told}, {expected}");
    for (field, value) in [("precision", "exact"), ("tracer", "recursive"), ("sampler", "sobol")] {
        choose(&mut browser, field, value);
    }
    browser.wait_for(&format!("{words} === 'A and B agree in all 19200 pixels.'"));
    browser.settle();
    assert!(shown(&mut browser).pixels().all(|pixel| pixel.0 == [0; 3]));

    // A click follows the rays of its pixel, and leaves a white cross there until the camera moves.
    let point = middle(place, [100, 70]);
    let [x, y] = point.map(|at| at as u32);
    assert_eq!(browser.canvas("#image").get_pixel(x - 6, y).to_rgb().0, [0; 3]);
    drag(&mut browser, point, point);
    browser.wait_for("document.querySelector('#record').innerText.includes('pixel 100,70')");
    browser.settle();
    let cross = browser.canvas("#image").get_pixel(x - 6, y).to_rgb().0;
    assert!(cross.iter().all(|&level| level > 150), "{cross:?}");
    browser.picture(&pictures().join("view-pixel.png"));
    turn_wheel(&mut browser, point);
    browser.wait_for("document.querySelector('#pixel-note').innerText.includes('click again')");

    // Both halves follow the camera.
    browser.wait_for(RESTS);
    drag(&mut browser, point, [point[0] + 90.0, point[1]]);
    browser.wait_for("told.figures?.halves[0].moving");
    assert_ne!(browser.evaluate("told.figures.halves[1]?.rests"), true);
    browser.wait_for(RESTS);
    browser.evaluate("document.querySelector('#compare').click()");
    browser.wait_for("document.querySelectorAll('#figures tbody tr:first-child td').length === 1");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn view_in_light_dark_and_narrow_windows() {
    let Some(mut browser) = started("light, dark and narrow view") else { return };
    let folder = laid_out();
    let server = Server::start(&folder.path().join("scenes"), "cutouts.json", &[]);
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
    let [left, top, side] = place(&browser.canvas("#image"));
    let panels = browser.evaluate("document.querySelector('#panels').getBoundingClientRect().top");
    let [right, bottom] = [left + side * 160.0, top + side * 120.0];
    assert!(left >= 0.0 && top >= 0.0 && right <= 400.0, "all of the image is in the window");
    assert!(Some(bottom) <= panels.as_f64(), "the panels hide nothing of the image");
    assert_eq!(browser.complaints, Vec::<String>::new());
}
