//! A browser without a window, driven as its own developer tools drive it: by messages through a pipe.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

/// Names under which systems have the browser.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// One page of a browser.
pub struct Browser {
    process: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    session: Option<String>,
    count: u64,
    /// Addresses that pages have asked for.
    pub asked_for: Vec<String>,
    _profile: TempDir,
}

impl Drop for Browser {
    fn drop(&mut self) {
        self.process.kill().ok();
        self.process.wait().ok();
    }
}

impl Browser {
    /// Starts one; none where the system has none.
    pub fn start() -> Option<Self> {
        let has =
            |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
        let name = NAMES.into_iter().find(has)?;
        let profile = tempfile::tempdir().expect("a folder");
        // The pipe is asked for as the third and the fourth file.
        let command = format!(
            "exec {name} --headless --no-sandbox --disable-gpu --no-first-run --remote-debugging-pipe --user-data-dir=\"$0\" \
             about:blank 3<&0 4>&1 1>/dev/null 2>/dev/null"
        );
        let mut process = Command::new("sh");
        process.args(["-c", &command]).arg(profile.path());
        process.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut process = process.spawn().expect("the browser starts");
        let input = process.stdin.take().expect("its input");
        let output = BufReader::new(process.stdout.take().expect("its output"));
        let (session, asked_for) = (None, Vec::new());
        let mut browser = Browser { process, input, output, session, count: 0, asked_for, _profile: profile };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        browser.session = attached["sessionId"].as_str().map(Into::into);
        for domain in ["Page", "Runtime", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Asks for something, and waits for the answer.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.count += 1;
        let mut message = json!({ "id": self.count, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.input.write_all(format!("{message}\0").as_bytes()).expect("the browser listens");
        loop {
            let mut bytes = Vec::new();
            self.output.read_until(0, &mut bytes).expect("the browser answers");
            bytes.pop();
            let answer: Value = serde_json::from_slice(&bytes).expect("the browser answers in JSON");
            if answer["method"] == "Network.requestWillBeSent" {
                self.asked_for.extend(answer["params"]["request"]["url"].as_str().map(Into::into));
            }
            if answer["id"] == self.count {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    /// Opens a page, and waits until it is there.
    pub fn open(&mut self, page: &Path) {
        let page = page.canonicalize().expect("the page is there");
        self.call("Page.navigate", json!({ "url": format!("file://{}", page.display()) }));
        self.wait("document.readyState === 'complete' && location.protocol === 'file:'");
    }

    /// The value of an expression.
    pub fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({ "expression": expression, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", parameters);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub fn wait(&mut self, expression: &str) {
        let began = Instant::now();
        while self.value(expression) != true {
            assert!(began.elapsed() < Duration::from_secs(20), "never so: {expression}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Brings an element into view; the middle of it and its size (px).
    pub fn place(&mut self, selector: &str) -> [f64; 4] {
        let place = self.value(&format!(
            "(() => {{ const element = document.querySelector({selector:?}); element.scrollIntoView({{ block: 'center' }}); \
             const box = element.getBoundingClientRect(); \
             return [box.left + box.width / 2, box.top + box.height / 2, box.width, box.height]; }})()"
        ));
        [0, 1, 2, 3].map(|k| place[k].as_f64().unwrap_or(f64::NAN))
    }

    /// Moves, presses or releases the mouse.
    pub fn mouse(&mut self, kind: &str, (x, y): (f64, f64), clicks: u32) {
        let button = if kind == "mouseMoved" { "none" } else { "left" };
        let buttons = u32::from(kind != "mouseReleased" && clicks > 0);
        let parameters =
            json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": clicks });
        self.call("Input.dispatchMouseEvent", parameters);
    }

    /// Clicks an element, so many times.
    pub fn click(&mut self, selector: &str, times: u32) {
        let [x, y, ..] = self.place(selector);
        self.mouse("mouseMoved", (x, y), 0);
        for count in 1..=times {
            self.mouse("mousePressed", (x, y), count);
            self.mouse("mouseReleased", (x, y), count);
        }
    }

    /// Takes a width of the window (px), as of a telephone where it is small.
    pub fn resize(&mut self, width: u32) {
        let parameters = json!({ "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600 });
        self.call("Emulation.setDeviceMetricsOverride", parameters);
    }
}
