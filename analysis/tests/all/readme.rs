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

#[test]
fn designs_of_the_guides_answer_what_the_guides_show() {
    let folder = tempfile::tempdir().unwrap();
    let guides = [
        ("docs/torque-profiles.md", "knob", "knob.toml"),
        ("docs/certify.md", "file", "wall.toml"),
    ];
    for (guide, name, file) in guides {
        std::fs::write(folder.path().join(file), block(guide, name)).unwrap();
    }
    let shown = [
        ("docs/torque-profiles.md", "design"),
        ("docs/certify.md", "stiffest"),
        ("docs/power-stage.md", "motor"),
    ];
    let shown = shown.map(|(guide, name)| block(guide, name)).concat();
    for part in shown.split("$ cargo haptic ").skip(1) {
        let (command, answer) = part.split_once('\n').expect("an answer");
        let mut run = program(&command.split(' ').collect::<Vec<_>>());
        let run = run.current_dir(folder.path()).output().unwrap();
        let printed = String::from_utf8(run.stdout).unwrap();
        assert!(printed.starts_with(answer.trim_end()), "{command}\n{printed}");
    }
}

#[test]
fn what_is_flashed_does_on_a_virtual_board_what_the_guide_shows() {
    let shown = block("docs/build.md", "board");
    let (command, shown) = shown.split_once('\n').expect("a command");
    let arguments = command.strip_prefix("$ cargo haptic ").expect("a command of the program");
    let run = haptic(&arguments.split(' ').collect::<Vec<_>>());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let printed = String::from_utf8(run.stdout).unwrap();
    assert_eq!(without_instructions(&printed), without_instructions(shown));
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

/// The names of all commands, as the help lists them.
fn commands() -> Vec<String> {
    let help = String::from_utf8(haptic(&["--help"]).stdout).unwrap();
    let (_, list) = help.split_once("Commands:\n").expect("a list of commands");
    let lines = list.lines().take_while(|line| !line.is_empty());
    // The lines below a command's first are further to the right.
    let named = lines.filter_map(|line| line.strip_prefix("  ").filter(|l| !l.starts_with(' ')));
    let names = named.filter_map(|line| line.split(' ').next());
    names.filter(|&name| name != "help").map(str::to_owned).collect()
}

#[test]
fn the_table_of_the_readme_lists_every_command() {
    let readme = read(root().join("README.md"));
    let rows = readme.lines().filter_map(|line| line.strip_prefix("| `cargo haptic "));
    let mut listed: Vec<_> =
        rows.map(|row| row.split([' ', '`']).next().unwrap().to_owned()).collect();
    let mut wanted = commands();
    assert!(wanted.len() > 15, "{wanted:?}");
    listed.sort();
    wanted.sort();
    assert_eq!(listed, wanted);
}
