//! What the README shows is what the program prints, and what the repository holds.

use std::path::Path;

use crate::common::{answer, haptic, program, read, root};

/// The fenced block behind `<!-- name -->` in the README.
fn block(readme: &str, name: &str) -> String {
    let (_, rest) = readme.split_once(&format!("<!-- {name} -->\n```")).expect("a marked block");
    let (_, body) = rest.split_once('\n').expect("a line");
    body.split_once("```").expect("an end").0.to_owned()
}

/// Instruction counts depend on the compiler that the machine has; everything else does not.
fn without_instructions(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.contains("instructions per tick")).collect()
}

/// Also compares the picture that the README shows.
#[test]
fn the_demo_prints_what_the_readme_shows() {
    let out = tempfile::tempdir().unwrap();
    let pictures = out.path().to_str().unwrap();
    let run = program(&["demo", "--out", pictures]).current_dir(root()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let printed = String::from_utf8(run.stdout).unwrap().replace(pictures, "target/demo");
    let shown = block(&read(root().join("README.md")), "demo");
    assert_eq!(without_instructions(&printed), without_instructions(&shown));

    let name = "nyquist_delayed_wall.svg";
    let kept = read(root().join("analysis/pictures").join(name));
    assert!(kept == read(out.path().join(name)), "{name} is not what the demo draws");
}

#[test]
fn the_scene_of_the_readme_is_the_program_and_its_refusal_the_compilers() {
    let readme = read(root().join("README.md"));
    let program = read(root().join("firmware/src/bin/damper_wall.rs"));
    // The program has more, before and behind.
    let mut lines = program.lines();
    for line in block(&readme, "scene").lines() {
        assert!(
            lines.any(|other| other == line),
            "the README's scene is not the program's: {line}"
        );
    }

    let scene = block(&readme, "file").replace("damping = 0.01 ", "damping = 0.0115 ");
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), scene).unwrap();
    let judge = |path: &Path| {
        answer(&haptic(&["certify", "--json", path.to_str().unwrap()]))["message"].to_string()
    };
    let sentence = judge(file.path());
    let refusal = block(&readme, "refusal");
    assert!(refusal.contains(sentence.trim_matches('"')), "{sentence}");
    std::fs::write(file.path(), block(&readme, "file")).unwrap();
    assert!(judge(file.path()).contains("certified"));
}
