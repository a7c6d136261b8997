//! The pictures of the README are what its commands draw. With `PICTURES=overwrite` they become it.

mod common;

use std::path::PathBuf;

use common::{program, read, root};

/// The commands of the README that draw, each as its arguments.
fn commands(readme: &str) -> Vec<Vec<String>> {
    let (_, marked) = readme.split_once("<!-- pictures -->\n```sh\n").expect("a marked block");
    let (lines, _) = marked.split_once("```").expect("an end");
    lines.lines().map(|line| words(line.strip_prefix("cargo haptic ").unwrap())).collect()
}

/// The words of a command line, of which some are in quotes.
fn words(line: &str) -> Vec<String> {
    let part = |(index, part): (usize, &str)| match index % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    };
    line.split('"').enumerate().flat_map(part).collect()
}

#[test]
fn the_pictures_of_the_readme_are_what_its_commands_draw() {
    let overwrite = std::env::var_os("PICTURES").is_some_and(|value| value == "overwrite");
    let readme = read(root().join("README.md"));
    let folder = tempfile::tempdir().unwrap();
    let mut drawn = Vec::new();
    for mut command in commands(&readme) {
        let output = command.iter().position(|word| word == "-o").expect("a picture") + 1;
        let kept = PathBuf::from(&command[output]);
        let picture = folder.path().join(kept.file_name().unwrap());
        command[output] = picture.to_str().unwrap().to_owned();
        let run = program(&[]).args(&command).current_dir(root()).output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        if overwrite {
            std::fs::copy(&picture, root().join(&kept)).unwrap();
        }
        let same = read(root().join(&kept)) == read(&picture);
        assert!(
            same,
            "{} is not what its command draws; PICTURES=overwrite keeps what it draws now",
            kept.display()
        );
        drawn.push(kept);
    }
    // Nothing is shown or kept that no command draws.
    let shown = readme.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for picture in shown.filter(|link| link.ends_with(".svg")) {
        assert!(drawn.contains(&PathBuf::from(picture)), "{picture}");
    }
    for file in std::fs::read_dir(root().join("analysis/pictures")).unwrap() {
        let file = file.unwrap().path();
        let file = file.strip_prefix(root()).unwrap().to_owned();
        let is_table = file.ends_with("tradeoff");
        let is_scene = file.extension().is_some_and(|extension| extension == "toml");
        assert!(is_table || is_scene || drawn.contains(&file), "{file:?}");
    }
}

#[test]
fn the_pictures_of_the_tables_are_drawn_of_them() {
    let kept = root().join("analysis/pictures/tradeoff");
    let folder = tempfile::tempdir().unwrap();
    let files = std::fs::read_dir(&kept).unwrap().map(|file| file.unwrap().path());
    let (tables, pictures): (Vec<_>, Vec<_>) =
        files.partition(|file| file.extension().unwrap() == "csv");
    for table in &tables {
        let name = table.file_stem().unwrap().to_str().unwrap();
        std::fs::copy(table, folder.path().join(table.file_name().unwrap())).unwrap();
        let draw = ["chart", "tradeoff", name, "--draw-only", "-o"];
        let run = program(&draw).arg(folder.path()).output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    }
    assert_eq!(pictures.len(), 2 * tables.len());
    for picture in pictures {
        let drawn = folder.path().join(picture.file_name().unwrap());
        let same = std::fs::read(&picture).unwrap() == std::fs::read(drawn).unwrap();
        assert!(same, "{} is not drawn of its table", picture.display());
    }
}
