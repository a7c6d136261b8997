//! `haptic bench --host`: a ratio only beside a peer of the same run.

use serde_json::Value;

use crate::common::{answer, program};

fn text<'f>(figure: &'f Value, key: &str) -> &'f str {
    figure[key].as_str().unwrap_or_else(|| panic!("{key}: {figure}"))
}

#[test]
#[ignore = "measures for long"]
fn a_figure_has_a_ratio_if_its_peer_was_in_the_run() {
    let output = program(&["bench", "--host", "--quick", "--json"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let figures = answer(&output);
    let figures = figures.as_array().unwrap();
    for figure in figures {
        let (value, against) =
            (figure["value"].as_f64().unwrap(), figure["against"].as_f64().unwrap());
        assert!(value > 0.0 && against > 0.0 && !text(figure, "unit").is_empty(), "{figure}");
        let source = text(figure, "source");
        assert_eq!(source.ends_with("same run"), !figure["ratio"].is_null(), "{figure}");
        assert_eq!(source.starts_with("budget"), figure["ratio"].is_null(), "{figure}");
        if let Some(ratio) = figure["ratio"].as_f64() {
            assert!((ratio - value / against).abs() <= 1e-12 * ratio, "{figure}");
        }
    }
    let beside: Vec<_> =
        figures.iter().filter(|figure| text(figure, "name").contains("beside")).collect();
    let [in_c] = beside[..] else { panic!("{beside:?}") };
    assert_eq!(text(in_c, "name"), "exact simulation, a step: beside C");
    // With the first line of `cc --version`.
    let version = std::process::Command::new("cc").arg("--version").output().unwrap().stdout;
    let version = String::from_utf8(version).unwrap();
    let source = format!("plain C, {}, -O2, same run", version.lines().next().unwrap());
    assert_eq!(text(in_c, "source"), source);
}
