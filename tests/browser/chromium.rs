//! Chromium without a window, told what to do over a pipe.
//!
//! It speaks the DevTools protocol: JSON, each message ended by a zero byte. With
//! `--remote-debugging-pipe` it reads from file 3 and writes to file 4, which a shell makes of the
//! input and output that a child has anyway. So no port is opened, and no crate is needed.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use tempfile::TempDir;

/// Names that the browser goes by.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// How long an answer may take before the test fails.
const PATIENCE: Duration = Duration::from_secs(120);

/// A browser with one page.
pub(crate) struct Browser {
    child: Child,
    input: ChildStdin,
    output: Receiver<Value>,
    session: String,
    count: u64,
    /// Whether the button of the mouse is pressed.
    held: bool,
    /// The address of the page, below which it may ask for more.
    address: String,
    /// What the page complained of, and what it asked of any network.
    pub(crate) complaints: Vec<String>,
    _profile: TempDir,
}

impl Browser {
    /// Starts the browser; `None`, told on standard error, where there is none.
    ///
    /// `WAVECREST_BROWSER` names the program, or is `none` to go without.
    pub(crate) fn start(test: &str) -> Option<Self> {
        let named = std::env::var_os("WAVECREST_BROWSER").map(PathBuf::from);
        if named.as_deref() == Some(Path::new("none")) {
            return skip(test, "WAVECREST_BROWSER is none");
        }
        let Some(program) = named.or_else(find) else {
            return skip(test, "there is no Chromium; install it or name it in WAVECREST_BROWSER");
        };
        Some(Self::launch(&program))
    }

    fn launch(program: &Path) -> Self {
        let profile = tempfile::tempdir().expect("a folder");
        let mut child = Command::new("sh")
            .args(["-c", r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >/dev/null"#])
            .arg(program)
            // It shows nothing but pages of these tests, and cannot lock itself up as root.
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"])
            .args(["--no-first-run", "--disable-extensions", "--hide-scrollbars"])
            // A page that no window shows is drawn all the same.
            .args(["--disable-backgrounding-occluded-windows", "--disable-renderer-backgrounding"])
            .args(["--remote-debugging-pipe", "--force-color-profile=srgb"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("a shell");
        let input = child.stdin.take().expect("it is piped");
        let mut reader = BufReader::new(child.stdout.take().expect("it is piped"));
        let (sender, output) = channel();
        std::thread::spawn(move || {
            let mut message = Vec::new();
            while reader.read_until(0, &mut message).is_ok_and(|length| length > 0) {
                let value = serde_json::from_slice(message.strip_suffix(&[0]).unwrap_or(&message));
                if value.is_err() || sender.send(value.unwrap_or_default()).is_err() {
                    break;
                }
                message.clear();
            }
        });
        let mut browser = Self {
            child,
            input,
            output,
            session: String::new(),
            count: 0,
            held: false,
            address: "about:".to_owned(),
            complaints: Vec::new(),
            _profile: profile,
        };
        // The page that it opens with: another would be drawn behind it, perhaps never.
        let target = browser.first_page();
        let target = json!({"targetId": target, "flatten": true});
        let attached = browser.call("Target.attachToTarget", target);
        browser.session = attached["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        browser
    }

    /// The page that the browser opens with, once it is there.
    fn first_page(&mut self) -> Value {
        loop {
            let targets = self.call("Target.getTargets", json!({}));
            let all = targets["targetInfos"].as_array().into_iter().flatten();
            if let Some(page) = all.into_iter().find(|target| target["type"] == "page") {
                return page["targetId"].clone();
            }
            std::thread::yield_now();
        }
    }

    /// Calls a method, and gives its result.
    pub(crate) fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.count += 1;
        let id = self.count;
        let mut message = json!({"id": id, "method": method, "params": parameters});
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        let sent = self.input.write_all(format!("{message}\0").as_bytes());
        sent.expect("the browser listens");
        loop {
            let answer = self.next(method);
            if answer["id"] == id {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
        }
    }

    /// The next message, its complaint noted if it is one.
    fn next(&mut self, waiting_for: &str) -> Value {
        let Ok(message) = self.output.recv_timeout(PATIENCE) else {
            panic!("no answer to {waiting_for}: the browser ended, or takes too long");
        };
        let parameters = &message["params"];
        let complaint = match message["method"].as_str() {
            Some("Runtime.exceptionThrown") => Some(parameters["exceptionDetails"].to_string()),
            Some("Runtime.consoleAPICalled") => Some(parameters["args"].to_string()),
            Some("Log.entryAdded") => Some(parameters["entry"].to_string()),
            Some("Network.requestWillBeSent") => {
                self.foreign(parameters["request"]["url"].as_str().unwrap_or_default())
            }
            Some("Network.webSocketCreated") => {
                self.foreign(&parameters["url"].as_str().unwrap_or_default().replace("ws", "http"))
            }
            _ => None,
        };
        self.complaints.extend(complaint);
        message
    }

    /// The complaint of a request, unless it is for a part of the page.
    fn foreign(&self, url: &str) -> Option<String> {
        let inside = ["data:", "file:", &self.address];
        let is_inside = inside.iter().any(|start| url.starts_with(start));
        (!is_inside).then(|| format!("a request for {url}"))
    }

    /// Opens a file, and waits until all of it is there.
    pub(crate) fn open(&mut self, file: &Path) {
        self.visit(&format!("file://{}", file.display()));
    }

    /// Opens the page at an address, which may ask for what lies below it.
    pub(crate) fn visit(&mut self, address: &str) {
        self.complaints.clear();
        address.clone_into(&mut self.address);
        let navigated = self.call("Page.navigate", json!({"url": address}));
        assert!(navigated["errorText"].is_null(), "{navigated}");
        while self.evaluate("document.readyState") != "complete" {
            std::thread::yield_now();
        }
    }

    /// The value of an expression in the page.
    pub(crate) fn evaluate(&mut self, expression: &str) -> Value {
        let parameters = json!({"expression": expression, "returnByValue": true});
        let result = self.call("Runtime.evaluate", parameters);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {result}");
        result["result"]["value"].clone()
    }

    /// Waits until an expression in the page is true.
    pub(crate) fn wait_for(&mut self, expression: &str) {
        let script = format!(
            "new Promise((done) => {{ const end = performance.now() + {}; \
             const look = () => {{ const is = Boolean({expression}); \
             is || performance.now() > end ? done(is) : requestAnimationFrame(look); }}; look(); }})",
            PATIENCE.as_millis() / 4
        );
        let parameters = json!({"expression": script, "returnByValue": true, "awaitPromise": true});
        let result = self.call("Runtime.evaluate", parameters);
        assert_eq!(result["result"]["value"], true, "{expression}: {result} {:?}", self.complaints);
    }

    /// Sets the window's size in pixels.
    pub(crate) fn resize(&mut self, width: u32, height: u32) {
        let parameters =
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", parameters);
    }

    /// Has the system prefer `light` or `dark`.
    pub(crate) fn prefer(&mut self, scheme: &str) {
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.call("Emulation.setEmulatedMedia", json!({"features": features}));
    }

    /// Whether the page may run its script, from the next time that it is opened.
    pub(crate) fn allow_script(&mut self, allowed: bool) {
        self.call("Emulation.setScriptExecutionDisabled", json!({"value": !allowed}));
    }

    /// Moves the pointer, and presses or releases its button: `mouseMoved`, `mousePressed` or
    /// `mouseReleased`.
    pub(crate) fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) {
        self.held = (self.held || kind == "mousePressed") && kind != "mouseReleased";
        let button = if self.held || kind != "mouseMoved" { "left" } else { "none" };
        let parameters = json!({
            "type": kind, "x": x, "y": y, "button": button, "buttons": u8::from(self.held),
            "clickCount": 1
        });
        self.call("Input.dispatchMouseEvent", parameters);
    }

    /// Presses a key by its name, such as `ArrowRight`.
    pub(crate) fn press(&mut self, key: &str, code: u32) {
        for kind in ["keyDown", "keyUp"] {
            let parameters =
                json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code});
            self.call("Input.dispatchKeyEvent", parameters);
        }
    }

    /// Waits until the page has been drawn as it is now, whether it may run a script or not.
    pub(crate) fn settle(&mut self) {
        self.call("Page.captureScreenshot", json!({"format": "jpeg", "quality": 1}));
    }

    /// The middle of an element, once it is in sight.
    pub(crate) fn middle(&mut self, selector: &str) -> [f64; 2] {
        let script = format!(
            "(() => {{ const e = document.querySelector({selector:?}); \
             e.scrollIntoView({{block: 'center', behavior: 'instant'}}); \
             const b = e.getBoundingClientRect(); \
             return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        );
        let found = self.evaluate(&script);
        self.settle();
        [0, 1].map(|index| found[index].as_f64().unwrap_or_else(|| panic!("no {selector}")))
    }

    /// A picture of the whole page, written to a file as well.
    pub(crate) fn picture(&mut self, file: &Path) -> image::RgbImage {
        let size = self.call("Page.getLayoutMetrics", json!({}))["cssContentSize"].clone();
        let clip =
            json!({"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1});
        let parameters = json!({"format": "png", "clip": clip, "captureBeyondViewport": true});
        let taken = self.call("Page.captureScreenshot", parameters);
        let bytes = decoded(&taken);
        std::fs::write(file, &bytes).expect("the folder is there");
        image::load_from_memory(&bytes).expect("a PNG").to_rgb8()
    }

    /// What a canvas shows.
    pub(crate) fn canvas(&mut self, selector: &str) -> image::RgbaImage {
        let url = self.evaluate(&format!("document.querySelector({selector:?}).toDataURL()"));
        let png = url.as_str().and_then(|url| url.split_once(',')).expect("a URL of data").1;
        let png = STANDARD.decode(png).expect("base 64");
        image::load_from_memory(&png).expect("a PNG").to_rgba8()
    }

    /// Chooses a value of a field, which learns of it as from a user.
    pub(crate) fn choose(&mut self, selector: &str, value: &str) {
        self.evaluate(&format!(
            "(field => {{ field.value = {value:?}; for (const kind of ['input', 'change']) \
             field.dispatchEvent(new Event(kind, {{bubbles: true}})); }})\
             (document.querySelector({selector:?}))"
        ));
        self.settle();
    }

    /// The page on paper, as PDF.
    pub(crate) fn print(&mut self) -> Vec<u8> {
        decoded(&self.call("Page.printToPDF", json!({})))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn decoded(answer: &Value) -> Vec<u8> {
    STANDARD.decode(answer["data"].as_str().unwrap_or_default()).expect("base 64")
}

fn find() -> Option<PathBuf> {
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let all = NAMES.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let mut there = all.into_iter().filter(|program| program.is_file());
    there.next()
}

/// Says past the test harness, which keeps what passing tests print, that a test was not run.
fn skip<T>(test: &str, why: &str) -> Option<T> {
    let _ = writeln!(std::io::stderr(), "skipped {test}: {why}");
    None
}
