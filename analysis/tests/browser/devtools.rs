//! A page in a browser without a window that a test drives: by the protocol of the browser's own developer
//! tools, over a socket.

use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

use crate::chromium::{ARGUMENTS, NAME};

/// Longest that anything may take, on a slow machine.
const TIMEOUT: Duration = Duration::from_secs(120);

/// A browser with one page.
pub struct Page {
    browser: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: String,
    last: u64,
    /// What the page's console has said that is an error or a warning, uncaught errors included.
    pub complaints: Vec<String>,
    _profile: TempDir,
}

impl Page {
    /// Starts a browser in a window so many pixels wide, with an empty page.
    pub fn start(width: u32) -> Self {
        let profile = tempfile::tempdir().unwrap();
        let browser = Command::new(NAME)
            .args(ARGUMENTS)
            .arg("--remote-debugging-port=0")
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg(format!("--window-size={width},1000"))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let address = address(profile.path());
        let (socket, _) = tungstenite::connect(&address).unwrap();
        let (session, complaints) = (String::new(), Vec::new());
        let mut page = Self { browser, socket, session, last: 0, complaints, _profile: profile };
        let target = page.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        page.session = text(&page.call("Target.attachToTarget", attach)["sessionId"]);
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            page.call(domain, json!({}));
        }
        // Windows are no narrower than half of this, screens are.
        page.call(
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": false }),
        );
        page
    }

    /// Opens an address, and waits until the page says that it is ready.
    pub fn open(&mut self, address: &str) {
        let opened = self.call("Page.navigate", json!({ "url": address }));
        assert!(opened.get("errorText").is_none(), "{address}: {opened}");
        self.wait_for("document.documentElement?.dataset.verdict !== undefined");
    }

    /// Opens a file.
    pub fn open_file(&mut self, page: &Path) {
        self.open(&format!("file://{}", page.display()));
    }

    /// The value of an expression, awaited if it is a promise.
    ///
    /// # Panics
    /// With the error that the expression throws.
    pub fn value(&mut self, expression: &str) -> Value {
        let asked =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let mut answer = self.call("Runtime.evaluate", asked);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].take()
    }

    /// Waits until an expression is true.
    ///
    /// # Panics
    /// With what the page shows where it never is.
    pub fn wait_for(&mut self, expression: &str) {
        let start = Instant::now();
        while self.value(&format!("Boolean({expression})")) != true {
            if start.elapsed() > TIMEOUT {
                let shown = self.value("document.body.innerText");
                panic!("never: {expression}; {:?}; {shown}", self.complaints);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// What the mouse does at a place of the page, in pixels of the window: `mousePressed`, `mouseMoved` or
    /// `mouseReleased`.
    pub fn mouse(&mut self, what: &str, [x, y]: [f64; 2]) {
        let event = json!({ "type": what, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Presses a key, by its name, and lets it go.
    pub fn key(&mut self, key: &str) {
        for what in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": what, "key": key, "code": key }));
        }
    }

    /// The middle of an element, in pixels of the window, once the page moves it no more.
    pub fn middle(&mut self, selector: &str) -> [f64; 2] {
        let place = self.value(&format!(
            "(async () => {{ const e = document.querySelector({selector:?}); \
             const frame = () => new Promise(requestAnimationFrame); \
             for (let x, y; ;) {{ \
             e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); await frame(); \
             const r = e.getBoundingClientRect(); \
             const at = [r.x + r.width / 2, r.y + r.height / 2]; \
             const isStill = at[0] === x && at[1] === y && r.width > 0; [x, y] = at; \
             if (isStill) return at; }} }})()"
        ));
        [0, 1].map(|axis| place[axis].as_f64().unwrap())
    }

    /// Clicks on an element, again where it has moved away from under the mouse.
    pub fn click(&mut self, selector: &str) {
        let start = Instant::now();
        self.value(&format!(
            "document.querySelector({selector:?}).addEventListener('click', \
             (event) => {{ event.currentTarget.isClicked = true; }}, {{ capture: true, once: true }})"
        ));
        loop {
            let place = self.middle(selector);
            self.mouse("mousePressed", place);
            self.mouse("mouseReleased", place);
            let is_clicked = format!(
                "(() => {{ const e = document.querySelector({selector:?}); \
                 const is = !e || e.isClicked === true; if (e) delete e.isClicked; return is; }})()"
            );
            if self.value(&is_clicked) == true {
                return;
            }
            assert!(start.elapsed() < TIMEOUT, "{selector} was not clicked in {TIMEOUT:?}");
        }
    }

    /// Calls a method of the protocol, and gives its result.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.last += 1;
        let id = self.last;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = self.session.as_str().into();
        }
        self.socket.send(Message::text(message.to_string())).unwrap();
        loop {
            let mut message = self.message();
            if message["id"] == id {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].take();
            }
            self.note(&message);
        }
    }

    fn message(&mut self) -> Value {
        loop {
            if let Message::Text(text) = self.socket.read().unwrap() {
                return serde_json::from_str(&text).unwrap();
            }
        }
    }

    /// Keeps what a message complains of.
    fn note(&mut self, message: &Value) {
        let details = &message["params"];
        let is_bad = match message["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => {
                ["error", "warning", "assert"].iter().any(|kind| details["type"] == *kind)
            }
            Some("Log.entryAdded") => {
                ["error", "warning"].iter().any(|level| details["entry"]["level"] == *level)
            }
            _ => false,
        };
        if is_bad {
            self.complaints.push(details.to_string());
        }
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.browser.kill();
        let _ = self.browser.wait();
    }
}

/// Where the browser's tools listen: it writes that into a file of its profile.
fn address(profile: &Path) -> String {
    let file = profile.join("DevToolsActivePort");
    let start = Instant::now();
    loop {
        let written = std::fs::read_to_string(&file).unwrap_or_default();
        if let Some((port, path)) = written.trim().split_once('\n') {
            return format!("ws://127.0.0.1:{port}{path}");
        }
        assert!(start.elapsed() < TIMEOUT, "the browser did not start within {TIMEOUT:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_else(|| panic!("no text: {value}")).to_owned()
}
