//! Keys, buttons and the browser's own ways, on the page of the command `view`.

use serde_json::json;

use super::chromium::Browser;
use super::view::{camera, laid_out, moved};
use super::viewer::{RESTS, Server, at_rest, started};

/// The bits that tell of Ctrl and of Command in events of the browser.
const CTRL: u32 = 2;
const META: u32 = 4;

/// The page of a scene, at rest.
fn opened(test: &str) -> Option<(Browser, Server, tempfile::TempDir)> {
    let mut browser = started(test)?;
    let folder = laid_out();
    let server = Server::start(&folder.path().join("scenes"), "cutouts.json", &[]);
    browser.visit(&server.address);
    browser.wait_for("told.state");
    at_rest(&mut browser, &server);
    Some((browser, server, folder))
}

fn key(browser: &mut Browser, kind: &str, [code, key]: [&str; 2], modifiers: u32) {
    let event = json!({"type": kind, "code": code, "key": key, "modifiers": modifiers});
    browser.call("Input.dispatchKeyEvent", event);
}

#[test]
fn keys_of_view_count_by_their_place_and_none_walks_on_unseen() {
    let Some((mut browser, server, _folder)) = opened("keys of view") else { return };
    let walks = ["KeyW", "ц"];
    let ends: [&dyn Fn(&mut Browser); 4] = [
        // The layout has changed since.
        &|b| key(b, "keyUp", ["KeyW", "w"], 0),
        &|b| key(b, "rawKeyDown", ["MetaLeft", "Meta"], META),
        &|b| drop(b.evaluate("dispatchEvent(new Event('blur'))")),
        &|b| drop(b.evaluate("document.dispatchEvent(new Event('visibilitychange'))")),
    ];
    for end in ends {
        // It comes to rest, so it walks no more.
        moved(&mut browser, &server, |b| {
            key(b, "rawKeyDown", walks, 0);
            b.wait_for("JSON.stringify(told.state.camera) !== before");
            end(b);
        });
    }
    // The digit of a layout that has it with Shift alone.
    moved(&mut browser, &server, |b| key(b, "rawKeyDown", ["Digit5", "("], 0));
    let (_, location) = camera(&mut browser);
    assert!(location[1] > location[0].abs() && location[1] > location[2].abs(), "{location:?}");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn ctrl_looks_around_and_the_other_button_moves_the_image_in_view() {
    let Some((mut browser, server, _folder)) = opened("buttons of view") else { return };
    let (_, before) = camera(&mut browser);
    for (button, buttons, modifiers) in [("left", 1, CTRL), ("right", 2, CTRL), ("right", 2, 0)] {
        moved(&mut browser, &server, |b| {
            for (kind, x) in [("mousePressed", 300), ("mouseMoved", 350), ("mouseReleased", 350)] {
                let event = json!({"type": kind, "x": x, "y": 400, "button": button,
                    "buttons": buttons, "modifiers": modifiers, "clickCount": 1});
                b.call("Input.dispatchMouseEvent", event);
            }
        });
        assert_eq!(camera(&mut browser).1 == before, modifiers == CTRL, "{button} {modifiers}");
    }
    let menu = "document.querySelector('#image').dispatchEvent(\
                new MouseEvent('contextmenu', { cancelable: true, ctrlKey: true }))";
    assert_eq!(browser.evaluate(menu), false, "the menu stays away");
    assert_eq!(browser.complaints, Vec::<String>::new());
}

#[test]
fn view_on_another_screen_and_without_a_clipboard() {
    let Some((mut browser, _server, _folder)) = opened("another screen for view") else { return };
    for ratio in [2, 1, 3] {
        let screen =
            json!({"width": 1100, "height": 900, "deviceScaleFactor": ratio, "mobile": false});
        browser.evaluate("addEventListener('resize', (e) => e.stopImmediatePropagation(), true)");
        browser.call("Emulation.setDeviceMetricsOverride", screen);
        browser.wait_for(&format!("document.querySelector('#image').width === 1100 * {ratio}"));
    }
    browser.resize(1100, 900);
    browser.wait_for(RESTS);

    browser.evaluate(
        "Object.defineProperty(navigator, 'clipboard', { value: undefined }); \
         document.addEventListener('copy', () => { window.copied = String(getSelection()); }); \
         document.querySelector('#render').closest('details').open = true",
    );
    let button = browser.middle("[data-copies=render]");
    browser.mouse("mousePressed", button);
    browser.mouse("mouseReleased", button);
    browser.wait_for("document.querySelector('[data-copies=render]').textContent === 'Copied'");
    let is_whole = "copied.trim() === document.querySelector('#render').textContent.trim()";
    assert_eq!(browser.evaluate(is_whole), true);
    assert_eq!(browser.complaints, Vec::<String>::new());
}
