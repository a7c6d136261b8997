//! `haptic bench --page`: every figure of a page with its reference, and the message without a browser.

use serde_json::Value;

use crate::common::{answer, complaint, haptic, program};
use crate::explore::explore_without_file;

pub fn each_figure_of_the_page_has_its_reference() {
    let figures = answer(&haptic(&["bench", "--page", "--quick", "--json"]));
    let figures = figures.as_array().unwrap();
    let names: Vec<_> = figures.iter().map(|figure| figure["name"].as_str().unwrap()).collect();
    for part in [
        "opening to the first verdict on the screen, median",
        "first picture of the map, median",
        "map of 40 000 points, most",
        "verdict, words and remedies while a slider is dragged, median",
        "frame while a slider is dragged, most",
    ] {
        for scene in ["wall", "free mode", "wall behind lags and a range of latency"] {
            let name = format!("page, {scene}: {part}");
            assert!(names.contains(&&*name), "{name}: {names:?}");
        }
    }
    assert!(names.contains(&"page: verdict, WebAssembly over native"), "{names:?}");
    for figure in figures {
        let [value, against] = ["value", "against"].map(|what| figure[what].as_f64().unwrap());
        assert!(value > 0.0 && against > 0.0 && figure["source"] != "", "{figure}");
    }
    let folder = tempfile::tempdir().unwrap();
    let page = explore_without_file(folder.path());
    assert_eq!(figures[0]["value"], Value::from(page.len() as f64));
}

pub fn without_a_browser_no_page_is_measured() {
    let output = program(&["bench", "--page"]).env("PATH", "/nowhere").output().unwrap();
    let said = complaint(output);
    assert!(
        said.contains("there is no chromium") && said.contains("apt install chromium"),
        "{said}"
    );
}

pub fn what_goes_wrong_on_a_page_is_an_error() {
    let mut page = analysis::browser::Page::start(400).unwrap();
    let site = analysis::browser::Site::of("<!DOCTYPE html><p>a page</p>".to_owned()).unwrap();
    page.go_to(&site.url()).unwrap();
    assert_eq!(page.value("crossOriginIsolated").unwrap(), true);
    assert_eq!(page.numbers("[1, 2.5]").unwrap(), [1.0, 2.5]);
    for (expression, why) in [("null.x", "has thrown"), ("'soft'", "must be a number")] {
        let error = page.number(expression).unwrap_err().to_string();
        assert!(error.contains(expression) && error.contains(why), "{error}");
    }
    let error = page.place("#nothing").unwrap_err().to_string();
    assert!(error.contains("#nothing"), "{error}");
    let error = page.go_to("http://127.0.0.1:9/").unwrap_err().to_string();
    assert!(error.contains("127.0.0.1:9"), "{error}");
    let error = page.call("No.such", serde_json::json!({})).unwrap_err().to_string();
    assert!(error.contains("No.such"), "{error}");
}
