//! The published packages: `haptic-servo` and `haptic-model`. Cargo packages both, the library's package
//! builds by itself, and both have the files and keys that a registry and a reader need.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::documents::{regex, root};

/// Name and folder of each.
const PUBLISHED: [(&str, &str); 2] =
    [("haptic-servo", "firmware"), ("haptic-model", "analysis/model")];

/// What cargo prints, without the network, of files that need not be committed yet.
fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .arg("--offline")
        .current_dir(root())
        .env("CARGO_TARGET_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("packages"))
        .env_remove("RUSTFLAGS")
        .output()
        .expect("cargo starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo {}: {error}", arguments.join(" "));
    String::from_utf8(output.stdout).expect("text")
}

/// The files of a package, by their paths in it.
fn files(package: &str) -> BTreeSet<String> {
    let listed = cargo(&["package", "--package", package, "--allow-dirty", "--list"]);
    listed.lines().map(str::to_owned).collect()
}

/// The packages of the workspace as cargo reads them.
fn manifests() -> Vec<Value> {
    let text = cargo(&["metadata", "--no-deps", "--format-version", "1"]);
    let metadata: Value = serde_json::from_str(&text).expect("JSON");
    metadata["packages"].as_array().expect("packages").clone()
}

fn manifest(package: &str) -> Value {
    let mut manifests = manifests().into_iter();
    manifests.find(|one| one["name"] == package).expect("a package of the workspace")
}

#[test]
fn these_and_no_others_can_be_published() {
    let open = |one: &Value| one["publish"].is_null().then(|| one["name"].to_string());
    let found: BTreeSet<_> = manifests().iter().filter_map(open).collect();
    assert_eq!(found, PUBLISHED.map(|(name, _)| format!("{name:?}")).into());
}

#[test]
fn a_registry_has_what_it_shows() {
    for (name, folder) in PUBLISHED {
        let manifest = manifest(name);
        for key in ["description", "documentation", "license", "readme", "rust_version"] {
            assert!(manifest[key].as_str().is_some_and(|text| !text.is_empty()), "{name}: {key}");
        }
        assert_eq!(manifest["documentation"], format!("https://docs.rs/{name}"));
        // The registry takes no more of either, and no longer words.
        for key in ["keywords", "categories"] {
            let words = manifest[key].as_array().expect("a list");
            assert!((1..=5).contains(&words.len()), "{name}: {key}");
        }
        for word in manifest["keywords"].as_array().expect("a list") {
            assert!(word.as_str().expect("a word").len() <= 20, "{name}: {word}");
        }
        let version = manifest["rust_version"].as_str().expect("a version");
        for file in ["README.md", "src/lib.rs"] {
            let text = fs::read_to_string(root().join(folder).join(file)).expect("text");
            let text = text.replace("\n//! ", " ");
            let stated = text.to_lowercase().contains("minimum supported rust version");
            assert!(stated && text.contains(version), "{name}: {file} does not say {version}");
        }
    }
}

#[test]
fn the_packages_have_all_that_they_speak_of_and_no_more() {
    // Files as documents name them: in a package, and not in the repository.
    let named = regex(r"`((?:examples/\w+\.rs)|(?:\w+\.md)|(?:memory\.x))`");
    let link = regex(r"\]\(([^)#:]+)\)");
    for (name, folder) in PUBLISHED {
        let folder = root().join(folder);
        let files = files(name);
        // Those of the repository, and not a name of where they are.
        for file in ["LICENSE-MIT", "LICENSE-APACHE", "memory.x"] {
            if !files.contains(file) {
                assert!(file == "memory.x" && name != "haptic-servo", "{name}: {file}");
                continue;
            }
            let [ours, kept] =
                [root(), folder.clone()].map(|folder| fs::read(folder.join(file)).unwrap());
            assert!(ours == kept, "{name}: {file} is not that of the repository");
        }
        let read = |file: &str| fs::read_to_string(folder.join(file)).expect("text");
        let texts = [read("README.md"), read("src/lib.rs")];
        let mut wanted: BTreeSet<_> =
            named.captures_iter(&texts.concat()).map(|c| c[1].to_owned()).collect();
        wanted.extend(link.captures_iter(&texts[0]).map(|c| c[1].to_owned()));
        // Of another package, which it says.
        wanted.retain(|file| name == "haptic-servo" || file != "THEORY.md");
        assert!(
            wanted.iter().any(|file| file.starts_with("examples/")),
            "{name}: no example is named"
        );
        for file in &wanted {
            assert!(files.contains(file), "{name}: {file} is not in the package");
        }
        let others = ["src/bin/", "tests/", "fuzz/", "harness/", "own-"];
        let strange = |file: &&String| others.iter().any(|at| file.starts_with(at));
        assert_eq!(files.iter().find(strange), None, "{name}");
        assert!(files.len() > 100, "{name}: {} files", files.len());
    }
}

/// Nothing is above a published package, so it may take in only its own files, and those that are published.
#[test]
fn no_source_takes_in_a_file_that_is_not_published() {
    for (name, folder) in PUBLISHED {
        let package = root().join(folder).canonicalize().unwrap();
        let files = files(name);
        for file in files.iter().filter(|file| file.ends_with(".rs")) {
            let path = package.join(file);
            let source = fs::read_to_string(&path).expect("text");
            for included in source.split("include_str!(\"").skip(1) {
                let taken = included.split('"').next().expect("a name");
                let taken = path.parent().expect("a folder").join(taken).canonicalize();
                let taken = taken.expect("a file of the repository");
                let inside = taken.strip_prefix(&package).ok();
                let is_published =
                    inside.is_some_and(|path| files.contains(&*path.to_string_lossy()));
                assert!(is_published, "{name}: {file}: {taken:?}");
            }
        }
    }
}

/// The library's package is built as a stranger gets it. The other is packaged on top of it, out of a
/// registry that has only that; to build it, too, would take minutes.
#[test]
#[ignore = "builds for minutes"]
fn cargo_packages_both() {
    cargo(&["package", "--package", "haptic-servo", "--allow-dirty"]);
    let [(servo, _), (model, _)] = PUBLISHED;
    cargo(&["package", "--package", servo, "--package", model, "--allow-dirty", "--no-verify"]);
}
