//! `haptic bench --host`: a ratio only beside a peer of the same run.

use serde_json::Value;

use crate::common::{answer, program};

/// The figures with these options; without cargo, so that nothing is compiled.
fn figures(options: &[&str], path: Option<&str>) -> Vec<Value> {
    let mut bench = program(&["bench", "--host", "--quick", "--json"]);
    bench.args(options).env("CARGO", "/nowhere").envs(path.map(|path| ("PATH", path)));
    let output = bench.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    answer(&output).as_array().unwrap().clone()
}

fn text<'f>(figure: &'f Value, key: &str) -> &'f str {
    figure[key].as_str().unwrap_or_else(|| panic!("{key}: {figure}"))
}

#[test]
fn a_figure_has_a_ratio_if_its_peer_was_in_the_run() {
    let figures = figures(&[], None);
    for figure in &figures {
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

/// The budget alone, and the reason.
#[test]
fn a_peer_that_is_not_there_has_no_ratio() {
    let figures = figures(&["--peers"], Some("/nowhere"));
    let peers = ["numpy", "slycot", "python-control", "C", "scipy"];
    let beside = figures.iter().filter_map(|figure| {
        let (_, peer) = text(figure, "name").split_once(": beside ")?;
        Some((figure, peer))
    });
    for ((figure, peer), name) in beside.clone().zip(peers) {
        assert!(peer == name && figure["ratio"].is_null(), "{figure}");
        let (budget, why) = text(figure, "source").split_once("; ").unwrap();
        assert!(budget.starts_with("budget, ") && figure["against"].as_f64().unwrap() >= 10.0);
        assert!(why.starts_with(&format!("{name} is not available: ")), "{why}");
        let tool = if name == "C" { "cc: " } else { "apt install python3" };
        assert!(why.contains(tool), "{why}");
    }
    assert_eq!(beside.count(), peers.len());
}
