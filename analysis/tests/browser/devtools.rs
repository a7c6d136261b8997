//! A page in a headless browser that a test drives over a socket, with the protocol of the browser's
//! developer tools. Every error fails the test.

use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// Name of the browser and of its package.
pub const NAME: &str = "chromium";

/// Timeout of its operations, its start included, on a slow machine.
const TIMEOUT: Duration = Duration::from_secs(120);

/// No window; no sandbox, which is not available to root; no network traffic of its own.
const ARGUMENTS: [&str; 9] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
];

/// Height of the window in pixels.
const HEIGHT: u32 = 1000;
/// Time between two checks of a condition.
const LOOK: Duration = Duration::from_millis(20);

/// A browser with one page.
pub struct Page {
    // The socket is dropped before the browser.
    socket: WebSocket<TcpStream>,
    session: String,
    last: u64,
    /// Errors and warnings of the page's console, uncaught errors included.
    complaints: Vec<String>,
    _browser: Browser,
}

/// The browser's process and the folder of its profile. Both end when this is dropped, the process first.
struct Browser {
    process: Child,
    profile: TempDir,
}

impl Browser {
    fn start(width: u32) -> Self {
        let profile = tempfile::tempdir().unwrap();
        let mut command = Command::new(NAME);
        command.args(ARGUMENTS).arg(format!("--user-data-dir={}", profile.path().display()));
        command.arg(format!("--window-size={width},{HEIGHT}"));
        command.args(["--remote-debugging-port=0", "about:blank"]);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        Self { process: command.spawn().unwrap(), profile }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Page {
    /// Starts a browser with an empty page, in a window of this width in pixels.
    pub fn start(width: u32) -> Self {
        let browser = Browser::start(width);
        let (port, path) = address(browser.profile.path());
        let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        let url = format!("ws://127.0.0.1:{port}{path}");
        let (socket, _) = tungstenite::client(url, stream).unwrap();
        let (session, complaints) = (String::new(), Vec::new());
        let mut page = Self { socket, session, last: 0, complaints, _browser: browser };
        page.attach(width);
        page
    }

    fn attach(&mut self, width: u32) {
        let target = self.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = self.call("Target.attachToTarget", attach);
        self.session = attached["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            self.call(domain, json!({}));
        }
        // The browser has a smallest width of windows, but not of emulated screens.
        self.call(
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": width, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": false }),
        );
    }

    /// The page has complained of nothing.
    #[track_caller]
    pub fn assert_silent(&self) {
        assert_eq!(self.complaints, [""; 0]);
    }

    /// Has the browser save files into a folder.
    pub fn save_into(&mut self, folder: &Path) {
        let saves = json!({ "behavior": "allow", "downloadPath": folder });
        self.call("Page.setDownloadBehavior", saves);
    }

    /// Opens a file.
    pub fn open_file(&mut self, page: &Path) {
        self.open(&format!("file://{}", page.display()));
    }

    /// Opens an address, and waits until the page reports that it is ready.
    #[track_caller]
    pub fn open(&mut self, address: &str) {
        let opened = self.call("Page.navigate", json!({ "url": address }));
        assert_eq!(opened.get("errorText"), None, "{address} could not be opened");
        self.wait_for("document.documentElement?.dataset.verdict !== undefined");
    }

    /// The value of an expression, awaited if it is a promise.
    #[track_caller]
    pub fn value(&mut self, expression: &str) -> Value {
        let asked =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let mut answer = self.call("Runtime.evaluate", asked);
        let thrown = answer.get("exceptionDetails");
        assert_eq!(thrown, None, "`{expression}` has thrown");
        answer["result"]["value"].take()
    }

    /// Waits until an expression is true.
    #[track_caller]
    pub fn wait_for(&mut self, expression: &str) {
        let start = Instant::now();
        while self.value(&format!("Boolean({expression})")) != true {
            assert!(
                start.elapsed() < TIMEOUT,
                "`{expression}` was not true within {} s; the page complains of {:?}",
                TIMEOUT.as_secs(),
                self.complaints
            );
            sleep(LOOK);
        }
    }

    /// Sends a mouse event at a place of the page, in pixels of the window: `mousePressed`, `mouseMoved` or
    /// `mouseReleased`.
    pub fn mouse(&mut self, what: &str, [x, y]: [f64; 2]) {
        let event = json!({ "type": what, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Presses and releases a key, by its name.
    pub fn key(&mut self, key: &str) {
        for what in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": what, "key": key, "code": key }));
        }
    }

    /// Scrolls an element into the window; returns its left, top, width and height in pixels of the window,
    /// once the page has stopped moving it.
    fn place(&mut self, selector: &str) -> [f64; 4] {
        let expression = format!(
            "(async () => {{ const e = document.querySelector({selector:?}); \
             for (let before; ;) {{ \
             e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
             await new Promise(requestAnimationFrame); const r = e.getBoundingClientRect(); \
             const place = [r.x, r.y, r.width, r.height]; \
             if (String(place) === before) return place; before = String(place); }} }})()"
        );
        serde_json::from_value(self.value(&expression)).expect("four numbers")
    }

    /// The middle of an element, in pixels of the window.
    pub fn middle(&mut self, selector: &str) -> [f64; 2] {
        let [left, top, width, height] = self.place(selector);
        [left + width / 2.0, top + height / 2.0]
    }

    /// Clicks on an element, and again if it has moved away from under the mouse.
    #[track_caller]
    pub fn click(&mut self, selector: &str) {
        self.value(&format!(
            "document.querySelector({selector:?}).addEventListener('click', \
             (event) => {{ event.currentTarget.isClicked = true; }}, {{ capture: true, once: true }})"
        ));
        // It may be gone by the click.
        let is_clicked = format!(
            "(() => {{ const e = document.querySelector({selector:?}); \
             const is = !e || e.isClicked === true; if (e) delete e.isClicked; return is; }})()"
        );
        let start = Instant::now();
        while start.elapsed() < TIMEOUT {
            let place = self.middle(selector);
            self.mouse("mousePressed", place);
            self.mouse("mouseReleased", place);
            if self.value(&is_clicked) == true {
                return;
            }
        }
        let seconds = TIMEOUT.as_secs();
        panic!("`{selector}` was not clicked within {seconds} s: another element is before it")
    }

    /// Calls a method of the protocol, and returns its result.
    #[track_caller]
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.last += 1;
        let id = self.last;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = self.session.as_str().into();
        }
        self.socket.send(Message::text(message.to_string())).unwrap();
        loop {
            let Message::Text(text) = self.socket.read().unwrap() else { continue };
            let mut message: Value = serde_json::from_str(&text).unwrap();
            if message["id"] == id {
                assert_eq!(message.get("error"), None, "{method}");
                return message["result"].take();
            }
            self.note(&message);
        }
    }

    /// Stores the error or the warning of a message, if it has one.
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

/// Port and path at which the browser's tools listen: the browser writes them into a file of its profile.
fn address(profile: &Path) -> (u16, String) {
    let file = profile.join("DevToolsActivePort");
    let start = Instant::now();
    while start.elapsed() < TIMEOUT {
        let written = std::fs::read_to_string(&file).unwrap_or_default();
        if let Some((port, path)) = written.trim().split_once('\n')
            && let Ok(port) = port.parse()
        {
            return (port, path.to_owned());
        }
        sleep(LOOK);
    }
    panic!("{NAME} did not start within {} s", TIMEOUT.as_secs())
}

/// Waits for a file that the browser saves; returns its bytes.
pub fn saved(file: &Path) -> Vec<u8> {
    let start = Instant::now();
    loop {
        // A browser reserves the name with an empty file, and replaces it by the whole one.
        match std::fs::read(file) {
            Ok(bytes) if !bytes.is_empty() => return bytes,
            _ => assert!(start.elapsed() < Duration::from_secs(60), "no {}", file.display()),
        }
        sleep(LOOK);
    }
}
