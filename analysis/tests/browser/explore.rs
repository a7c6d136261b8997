//! The page of `haptic explore` in a browser: its numbers are those of the program, to the last bit.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::common::{WALL, haptic, haptic_reading, read};
use crate::devtools::Page;

/// Scenes that page and program judge.
const SCENES: usize = 1000;

/// Writes the page of a scene, and gives its file.
pub fn explore(folder: &Path, scene: &str) -> PathBuf {
    let [file, page] = ["scene.toml", "explore.html"].map(|name| folder.join(name));
    std::fs::write(&file, scene).unwrap();
    let [file, output] = [&file, &page].map(|path| path.to_str().unwrap());
    let run = haptic(&["explore", file, "-o", output]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    page
}

/// A browser of this width with the page of a scene, and the folder of both files.
pub fn opened(width: u32, scene: &str) -> (tempfile::TempDir, Page) {
    let folder = tempfile::tempdir().unwrap();
    let mut page = Page::start(width);
    page.open_file(&explore(folder.path(), scene));
    (folder, page)
}

/// A random number between two, evenly distributed.
fn between(random: &mut fastrand::Rng, least: f64, most: f64) -> f64 {
    least + (most - least) * random.f64()
}

/// A random number between two, evenly distributed in its logarithm.
fn scaled(random: &mut fastrand::Rng, least: f64, most: f64) -> f64 {
    between(random, least.ln(), most.ln()).exp()
}

/// A scene as people write them, certified about as often as not.
fn random_scene(random: &mut fastrand::Rng, number: usize) -> Value {
    let (period, damping) = (scaled(random, 1e-4, 4e-3), scaled(random, 1e-3, 1.0));
    let stiffest = 2.0 * damping / period;
    let stiffness = stiffest * between(random, 0.0, 0.8);
    let delay = random.u32(0..3);
    let wall = json!({
        "type": "damper-wall",
        "stiffness": stiffness,
        "damping": damping * between(random, -0.2, 0.7),
        "delay": delay,
    });
    let environment = match random.u32(0..5) {
        0 => json!({ "type": "delayed-spring", "stiffness": stiffness, "delay": delay }),
        1 => wall,
        2 => {
            let mut wall = wall;
            wall["one_sided"] = true.into();
            wall["face"] = between(random, -0.5, 0.5).into();
            wall
        }
        3 => json!({ "type": "free-mode", "residual": damping * random.f64(), "delay": delay }),
        _ => json!({
            "type": "profile",
            "knots": [[0.0, 0.0], [0.1, 0.1 * stiffness], [0.3, -0.1 * stiffness], [0.4, 0.0]],
            "period": 0.4,
            "delay": 1,
        }),
    };
    let mut scene = json!({
        "name": format!("random {number}"),
        "device": { "inertia": scaled(random, 1e-6, 1e-2), "damping": damping },
        "servo": { "period": period },
        "coupling": { "stiffness": stiffest * between(random, 0.3, 1.1) },
        "environment": environment,
    });
    if random.u32(0..4) == 0 {
        scene["servo"]["output_delay"] = (period * between(random, 0.0, 0.5)).into();
        scene["device"]["actuator_lag"] = (period * between(random, 0.01, 0.5)).into();
    }
    if random.u32(0..6) == 0 {
        scene["limits"] = json!({ "torque": scaled(random, 0.1, 10.0) });
    }
    scene
}

pub fn the_numbers_of_the_page_are_those_of_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = fastrand::Rng::with_seed(19);
    let mut lines: Vec<String> =
        (0..SCENES).map(|number| random_scene(&mut random, number).to_string()).collect();
    lines.push("{\"name\": \"nothing else\"}".to_owned());
    let batch = folder.path().join("scenes.jsonl");
    std::fs::write(&batch, lines.join("\n")).unwrap();
    let printed = haptic_reading(&["certify", "--batch", batch.to_str().unwrap()], b"");
    let printed = String::from_utf8(printed.stdout).unwrap();
    let printed: Vec<&str> = printed.lines().collect();
    assert_eq!(printed.len(), lines.len());
    for verdict in ["certified", "rejected"] {
        let of = format!("\"verdict\":\"{verdict}\"");
        let count = printed.iter().filter(|line| line.contains(&of)).count();
        assert!(count > SCENES / 10, "{verdict}: {count} of {SCENES}");
    }

    let mut page = Page::start(1280);
    page.open_file(&explore(folder.path(), WALL));
    let texts =
        page.value(&format!("{}.map((line) => String(window.haptic.certify(line)))", json!(lines)));
    for ((line, of_page), of_program) in lines.iter().zip(texts.as_array().unwrap()).zip(&printed) {
        // The name of the file that a scene is in is not the same.
        let of_program = of_program.replace(&format!("{}:", batch.display()), "scene:");
        let is_wrong = of_program.starts_with("{\"error\"");
        assert!(is_wrong || of_page == of_program.as_str(), "{line}\n{of_page}\n{of_program}");
    }
    assert!(texts[SCENES].as_str().unwrap().contains("device"), "{}", texts[SCENES]);
    page.assert_silent();
}

pub fn the_root_says_the_verdict_for_programs() {
    let folder = tempfile::tempdir().unwrap();
    let file = explore(folder.path(), WALL);
    let scene = folder.path().join("scene.toml");
    let printed = haptic(&["certify", scene.to_str().unwrap(), "--json"]).stdout;
    let printed: Value = serde_json::from_slice(&printed).unwrap();
    let mut page = Page::start(360);
    page.open_file(&file);
    let marks = page.value("({ ...document.documentElement.dataset })");
    assert_eq!(marks["verdict"], "certified");
    for (mark, number) in [
        ("alphaLo", &printed["alpha"]["lo"]),
        ("alphaHi", &printed["alpha"]["hi"]),
        ("delta", &printed["delta"]),
        ("margin", &printed["margin"]),
    ] {
        let shown: f64 = marks[mark].as_str().unwrap().parse().unwrap();
        assert_eq!(shown.to_bits(), number.as_f64().unwrap().to_bits(), "{mark}");
    }
    // An object and a text are both taken, and the answer is both.
    let verdict =
        page.value("JSON.parse(window.haptic.certify(JSON.parse(window.haptic.scene()))).verdict");
    assert_eq!(verdict, "certified");
    assert_eq!(page.value("window.haptic.certify(window.haptic.scene()).verdict"), "certified");
    page.assert_silent();
    // The program has a scene of its own.
    let own = folder.path().join("own.html");
    let run = haptic(&["explore", "-o", own.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let size = read(&file).len();
    assert!(size <= 785_000, "{size} bytes");
    for outside in ["src=\"http", "href=\"http", "@import", "url(http"] {
        assert!(!read(&file).contains(outside), "{outside}");
    }
}
