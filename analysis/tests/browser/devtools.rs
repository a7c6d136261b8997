//! A page in a browser that a test drives: every error fails the test.

use std::path::Path;
use std::time::{Duration, Instant};

use analysis::browser;
use serde_json::{Value, json};

/// A browser with one page.
pub struct Page(browser::Page);

impl Page {
    /// Starts a browser with an empty page, in a window of this width in pixels.
    pub fn start(width: u32) -> Self {
        Self(done(browser::Page::start(width)))
    }

    /// The page has complained of nothing.
    #[track_caller]
    pub fn assert_silent(&self) {
        assert_eq!(self.0.complaints, [""; 0]);
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
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The value of a successful operation.
///
/// # Panics
/// With the error of a failed operation.
#[track_caller]
fn done<T>(result: Result<T, browser::BrowserError>) -> T {
    result.unwrap_or_else(|error| panic!("{error}"))
}

macro_rules! operations {
    ($($(#[$what:meta])* $name:ident($($argument:ident: $of:ty),*) -> $result:ty;)*) => {
        impl Page {
            $(
                $(#[$what])*
                #[track_caller]
                pub fn $name(&mut self, $($argument: $of),*) -> $result {
                    done(self.0.$name($($argument),*))
                }
            )*
        }
    };
}

operations! {
    /// Opens an address, and waits until the page reports that it is ready.
    open(address: &str) -> ();
    /// The value of an expression, awaited if it is a promise.
    value(expression: &str) -> Value;
    /// Waits until an expression is true.
    wait_for(expression: &str) -> ();
    /// Sends a mouse event at a place of the page.
    mouse(what: &str, place: [f64; 2]) -> ();
    /// Presses and releases a key, by its name.
    key(key: &str) -> ();
    /// The middle of an element, in pixels of the window.
    middle(selector: &str) -> [f64; 2];
    /// Clicks on an element.
    click(selector: &str) -> ();
    /// Calls a method of the protocol, and gives its result.
    call(method: &str, parameters: Value) -> Value;
}
