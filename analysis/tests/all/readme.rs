//! The README and the guides show the output of the program, and the contents of the repository.

use std::path::Path;

use crate::common::{answer, documents, haptic, program, read, root};

/// The fenced block behind `<!-- name -->` in a document.
pub fn block(document: &str, name: &str) -> String {
    let text = read(root().join(document));
    let marked = text.split_once(&format!("<!-- {name} -->\n```"));
    let (_, rest) = marked.unwrap_or_else(|| panic!("{document} has no block `{name}`"));
    let (_, body) = rest.split_once('\n').expect("a line");
    body.split_once("```").expect("an end").0.to_owned()
}

/// Instruction counts depend on the compiler that the machine has; everything else does not.
fn without_instructions(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.contains("instructions per tick")).collect()
}

/// Also compares the picture that the guide shows.
#[test]
fn the_demo_prints_what_the_guide_shows() {
    let out = tempfile::tempdir().unwrap();
    let pictures = out.path().to_str().unwrap();
    let run = program(&["demo", "--out", pictures]).current_dir(root()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let printed = String::from_utf8(run.stdout).unwrap().replace(pictures, "target/demo");
    let shown = block("docs/set-up.md", "demo");
    assert_eq!(without_instructions(&printed), without_instructions(&shown));

    let name = "nyquist_delayed_wall.svg";
    let kept = read(root().join("analysis/pictures").join(name));
    assert!(kept == read(out.path().join(name)), "{name} is not what the demo draws");
}

#[test]
fn the_scene_of_the_readme_is_the_program_and_its_refusal_the_compilers() {
    let program = read(root().join("firmware/src/bin/damper_wall.rs"));
    // The program has more, before and behind.
    let mut lines = program.lines();
    for line in block("README.md", "scene").lines() {
        assert!(
            lines.any(|other| other == line),
            "the README's scene is not the program's: {line}"
        );
    }

    let scene = block("docs/certify.md", "file").replace("damping = 0.01 ", "damping = 0.0115 ");
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), scene).unwrap();
    let judge = |path: &Path| {
        answer(&haptic(&["certify", "--json", path.to_str().unwrap()]))["message"].to_string()
    };
    let sentence = judge(file.path());
    let refusal = block("README.md", "refusal");
    assert!(refusal.contains(sentence.trim_matches('"')), "{sentence}");
    std::fs::write(file.path(), block("docs/certify.md", "file")).unwrap();
    assert!(judge(file.path()).contains("certified"));
}

/// Runs the commands of a guide's blocks in a folder with its files, each a block with the name before the dot.
fn play(guide: &str, files: &[&str], blocks: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    for file in files {
        let name = file.strip_suffix(".toml").expect("the name of a block and its file");
        std::fs::write(folder.path().join(file), block(guide, name)).unwrap();
    }
    let shown: String = blocks.iter().map(|name| block(guide, name)).collect();
    for part in shown.split("$ cargo haptic ").skip(1) {
        let (command, answer) = part.split_once('\n').expect("an answer");
        let mut run = program(&command.split(' ').collect::<Vec<_>>());
        let run = run.current_dir(folder.path()).output().unwrap();
        let printed = String::from_utf8(run.stdout).unwrap();
        let answer = without_instructions(answer.trim_end());
        assert!(without_instructions(&printed).starts_with(&answer), "{command}\n{printed}");
    }
}

#[test]
fn commands_of_the_guides_answer_what_the_guides_show() {
    play("docs/torque-profiles.md", &["knob.toml"], &["design"]);
    play("docs/first-hour.md", &["knob.toml", "wall.toml"], &["verdict", "measured", "stiffest"]);
    play("docs/gimbal-knob.md", &["knob.toml"], &["turns"]);
    play("docs/power-stage.md", &[], &["motor"]);
    play("docs/host-torque.md", &["wheel.toml", "direct.toml"], &["host", "direct-host"]);
    let printed = block("docs/first-hour.md", "stiffest");
    for line in block("README.md", "stiffest").lines() {
        assert!(printed.contains(line), "{line}");
    }
}

#[test]
#[ignore = "builds for minutes"]
fn what_is_flashed_does_on_a_virtual_board_what_the_guide_shows() {
    play("docs/first-hour.md", &["knob.toml", "wall.toml"], &["stiffest", "board"]);
    play("docs/host-torque.md", &["direct.toml"], &["direct-board"]);
}

/// The help of the command that the first of these words name.
fn help(words: &str) -> String {
    let (mut path, mut said) = (Vec::new(), None);
    for word in words.split_whitespace() {
        path.push(word);
        let output = haptic(&[&path[..], &["--help"]].concat());
        if !output.status.success() {
            break;
        }
        let help = String::from_utf8(output.stdout).unwrap();
        let has_more = help.contains("Commands:");
        said = Some(help);
        if !has_more {
            break;
        }
    }
    said.unwrap_or_else(|| panic!("there is no `haptic {words}`"))
}

/// The options that a text names.
fn options(text: &str) -> impl Iterator<Item = &str> {
    let is_part = |c: char| c == '-' || c.is_ascii_lowercase();
    let words = text.split(move |c| !is_part(c));
    words.filter(|word| word.starts_with("--") && word.len() > 2)
}

#[test]
fn commands_and_options_that_documents_name_are_there() {
    let mut count = 0;
    for document in documents() {
        for line in read(root().join(&document)).lines() {
            let after = |word| line.split_once(word).map(|(_, after)| after);
            let Some(after) = after("cargo haptic ").or_else(|| after("`haptic ")) else {
                continue;
            };
            let words = after.split(['`', '#', '>']).next().unwrap();
            // `haptic` alone, or a placeholder for any command.
            if !words.starts_with(|c: char| c.is_ascii_lowercase()) {
                continue;
            }
            let help = help(words);
            // In a table, the answer to a command names options of it, too.
            let said = if line.starts_with('|') { line } else { words };
            for option in options(said) {
                assert!(help.contains(option), "{document}: no {option} in `haptic {words}`");
                count += 1;
            }
        }
    }
    assert!(count > 30, "only {count} options were seen");
}
