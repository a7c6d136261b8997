//! Drives a page over a socket with the protocol of the browser's developer tools.

use std::net::TcpStream;
use std::path::Path;
use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{HandshakeError, Message, WebSocket};

use super::{BrowserError, NAME, TIMEOUT, command};

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
    pub complaints: Vec<String>,
    _browser: Browser,
}

/// The browser's process and the folder of its profile. Both end when this is dropped, the process first.
struct Browser {
    process: Child,
    profile: TempDir,
}

impl Browser {
    fn start(width: u32) -> Result<Self, BrowserError> {
        let profile = tempfile::tempdir().map_err(BrowserError::Unstartable)?;
        let mut command = command(profile.path(), [width, HEIGHT]);
        command.args(["--remote-debugging-port=0", "about:blank"]);
        let process = command.spawn().map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => BrowserError::Missing,
            _ => BrowserError::Unstartable(error),
        })?;
        Ok(Self { process, profile })
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
    pub fn start(width: u32) -> Result<Self, BrowserError> {
        let browser = Browser::start(width)?;
        let (port, path) = address(browser.profile.path())?;
        let stream = TcpStream::connect(("127.0.0.1", port)).map_err(tungstenite::Error::Io)?;
        stream.set_read_timeout(Some(TIMEOUT)).map_err(tungstenite::Error::Io)?;
        let url = format!("ws://127.0.0.1:{port}{path}");
        let (socket, _) = tungstenite::client(url, stream).map_err(|error| match error {
            HandshakeError::Failure(error) => error.into(),
            HandshakeError::Interrupted(_) => BrowserError::NotStarted,
        })?;
        let (session, complaints) = (String::new(), Vec::new());
        let mut page = Self { socket, session, last: 0, complaints, _browser: browser };
        page.attach(width)?;
        Ok(page)
    }

    fn attach(&mut self, width: u32) -> Result<(), BrowserError> {
        let target = self.call("Target.createTarget", json!({ "url": "about:blank" }))?;
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = self.call("Target.attachToTarget", attach)?;
        let Some(session) = attached["sessionId"].as_str() else {
            return Err(BrowserError::Page(format!("Target.attachToTarget: {attached}")));
        };
        self.session = session.to_owned();
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            self.call(domain, json!({}))?;
        }
        // The browser has a smallest width of windows, but not of emulated screens.
        self.call(
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": width, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": false }),
        )?;
        Ok(())
    }

    /// Opens an address, and waits until the page reports that it is ready.
    pub fn open(&mut self, address: &str) -> Result<(), BrowserError> {
        self.go_to(address)?;
        self.wait_for("document.documentElement?.dataset.verdict !== undefined")
    }

    /// Opens an address without waiting.
    pub fn go_to(&mut self, address: &str) -> Result<(), BrowserError> {
        let opened = self.call("Page.navigate", json!({ "url": address }))?;
        match opened.get("errorText") {
            None => Ok(()),
            Some(why) => Err(BrowserError::Page(format!("{address} could not be opened: {why}"))),
        }
    }

    /// The value of an expression, awaited if it is a promise.
    pub fn value(&mut self, expression: &str) -> Result<Value, BrowserError> {
        let asked =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let mut answer = self.call("Runtime.evaluate", asked)?;
        match answer.get_mut("exceptionDetails") {
            None => Ok(answer["result"]["value"].take()),
            Some(error) => Err(BrowserError::Page(format!("`{expression}` has thrown: {error}"))),
        }
    }

    /// The value of an expression that is a number, or the text of a number.
    pub fn number(&mut self, expression: &str) -> Result<f64, BrowserError> {
        let value = self.value(expression)?;
        let number = value.as_f64().or_else(|| value.as_str()?.parse().ok());
        number.ok_or_else(|| other_kind(expression, &value, "a number"))
    }

    /// The value of an expression that is a list of numbers.
    pub fn numbers(&mut self, expression: &str) -> Result<Vec<f64>, BrowserError> {
        let value = self.value(expression)?;
        let numbers = value.as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
        numbers.ok_or_else(|| other_kind(expression, &value, "a list of numbers"))
    }

    /// Waits until an expression is true.
    pub fn wait_for(&mut self, expression: &str) -> Result<(), BrowserError> {
        let start = Instant::now();
        while self.value(&format!("Boolean({expression})"))? != true {
            if start.elapsed() > TIMEOUT {
                return Err(BrowserError::Page(format!(
                    "`{expression}` was not true within {} s; the page complains of {:?}",
                    TIMEOUT.as_secs(),
                    self.complaints
                )));
            }
            sleep(LOOK);
        }
        Ok(())
    }

    /// Sends a mouse event at a place of the page, in pixels of the window: `mousePressed`, `mouseMoved` or
    /// `mouseReleased`.
    pub fn mouse(&mut self, what: &str, [x, y]: [f64; 2]) -> Result<(), BrowserError> {
        let event = json!({ "type": what, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event).map(|_| ())
    }

    /// Presses and releases a key, by its name.
    pub fn key(&mut self, key: &str) -> Result<(), BrowserError> {
        for what in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": what, "key": key, "code": key }))?;
        }
        Ok(())
    }

    /// Scrolls an element into the window; returns its left, top, width and height in pixels of the window,
    /// once the page has stopped moving it.
    pub fn place(&mut self, selector: &str) -> Result<[f64; 4], BrowserError> {
        let expression = format!(
            "(async () => {{ const e = document.querySelector({selector:?}); \
             for (let before; ;) {{ \
             e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
             await new Promise(requestAnimationFrame); const r = e.getBoundingClientRect(); \
             const place = [r.x, r.y, r.width, r.height]; \
             if (String(place) === before) return place; before = String(place); }} }})()"
        );
        let numbers = self.numbers(&expression)?;
        <[f64; 4]>::try_from(numbers)
            .map_err(|numbers| other_kind(&expression, &json!(numbers), "four numbers"))
    }

    /// The middle of an element, in pixels of the window.
    pub fn middle(&mut self, selector: &str) -> Result<[f64; 2], BrowserError> {
        let [left, top, width, height] = self.place(selector)?;
        Ok([left + width / 2.0, top + height / 2.0])
    }

    /// Clicks on an element, and again if it has moved away from under the mouse.
    pub fn click(&mut self, selector: &str) -> Result<(), BrowserError> {
        self.value(&format!(
            "document.querySelector({selector:?}).addEventListener('click', \
             (event) => {{ event.currentTarget.isClicked = true; }}, {{ capture: true, once: true }})"
        ))?;
        // It may be gone by the click.
        let is_clicked = format!(
            "(() => {{ const e = document.querySelector({selector:?}); \
             const is = !e || e.isClicked === true; if (e) delete e.isClicked; return is; }})()"
        );
        let start = Instant::now();
        while start.elapsed() < TIMEOUT {
            let place = self.middle(selector)?;
            self.mouse("mousePressed", place)?;
            self.mouse("mouseReleased", place)?;
            if self.value(&is_clicked)? == true {
                return Ok(());
            }
        }
        let seconds = TIMEOUT.as_secs();
        Err(BrowserError::Page(format!(
            "`{selector}` was not clicked within {seconds} s: another element is before it"
        )))
    }

    /// Calls a method of the protocol, and returns its result.
    pub fn call(&mut self, method: &str, parameters: Value) -> Result<Value, BrowserError> {
        self.last += 1;
        let id = self.last;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = self.session.as_str().into();
        }
        self.socket.send(Message::text(message.to_string()))?;
        loop {
            let mut message = self.message()?;
            if message["id"] == id {
                if let Some(error) = message.get("error") {
                    return Err(BrowserError::Page(format!("{method}: {error}")));
                }
                return Ok(message["result"].take());
            }
            self.note(&message);
        }
    }

    fn message(&mut self) -> Result<Value, BrowserError> {
        loop {
            if let Message::Text(text) = self.socket.read()? {
                return serde_json::from_str(&text).map_err(|error| {
                    BrowserError::Page(format!(
                        "the developer tools of {NAME} have sent `{text}`, which is not a message: {error}"
                    ))
                });
            }
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
fn address(profile: &Path) -> Result<(u16, String), BrowserError> {
    let file = profile.join("DevToolsActivePort");
    let start = Instant::now();
    while start.elapsed() < TIMEOUT {
        let written = std::fs::read_to_string(&file).unwrap_or_default();
        if let Some((port, path)) = written.trim().split_once('\n')
            && let Ok(port) = port.parse()
        {
            return Ok((port, path.to_owned()));
        }
        sleep(LOOK);
    }
    Err(BrowserError::NotStarted)
}

fn other_kind(expression: &str, value: &Value, kind: &str) -> BrowserError {
    BrowserError::Page(format!("`{expression}` is {value}; it must be {kind}"))
}
