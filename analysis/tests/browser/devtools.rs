//! A page in a browser that a test drives: every error fails the test.

use std::path::Path;

use analysis::browser;
use serde_json::Value;

/// A browser with one page.
pub struct Page(browser::Page);

impl Page {
    /// Starts a browser with an empty page, in a window of this width in pixels.
    pub fn start(width: u32) -> Self {
        Self(done(browser::Page::start(width)))
    }

    /// Errors and warnings of the page's console.
    pub fn complaints(&self) -> &[String] {
        &self.0.complaints
    }

    /// Opens an address, and waits until the page reports that it is ready.
    pub fn open(&mut self, address: &str) {
        done(self.0.open(address));
    }

    /// Opens a file.
    pub fn open_file(&mut self, page: &Path) {
        self.open(&format!("file://{}", page.display()));
    }

    /// The value of an expression, awaited if it is a promise.
    pub fn value(&mut self, expression: &str) -> Value {
        done(self.0.value(expression))
    }

    /// Waits until an expression is true.
    pub fn wait_for(&mut self, expression: &str) {
        done(self.0.wait_for(expression));
    }

    /// Sends a mouse event at a place of the page.
    pub fn mouse(&mut self, what: &str, place: [f64; 2]) {
        done(self.0.mouse(what, place));
    }

    /// Presses and releases a key, by its name.
    pub fn key(&mut self, key: &str) {
        done(self.0.key(key));
    }

    /// The middle of an element, in pixels of the window.
    pub fn middle(&mut self, selector: &str) -> [f64; 2] {
        done(self.0.middle(selector))
    }

    /// Clicks on an element.
    pub fn click(&mut self, selector: &str) {
        done(self.0.click(selector));
    }

    /// Calls a method of the protocol, and gives its result.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        done(self.0.call(method, parameters))
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
