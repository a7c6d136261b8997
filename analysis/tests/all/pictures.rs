//! The pictures of the documents equal the output of the commands of the charts' guide. With
//! `PICTURES=overwrite` they are replaced by it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::cases::words;
use crate::common::{documents, program, read, root};

/// The commands of the guide that draw, each as its arguments.
fn commands(guide: &str) -> Vec<Vec<String>> {
    let (_, marked) = guide.split_once("<!-- pictures -->\n```sh\n").expect("a marked block");
    let (lines, _) = marked.split_once("```").expect("an end");
    lines.lines().map(|line| words(line.strip_prefix("cargo haptic ").unwrap())).collect()
}

#[test]
fn the_pictures_of_the_documents_are_what_commands_draw() {
    let overwrite = std::env::var_os("PICTURES").is_some_and(|value| value == "overwrite");
    let guide = read(root().join("docs/charts.md"));
    let folder = tempfile::tempdir().unwrap();
    let mut drawn = Vec::new();
    for mut command in commands(&guide) {
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
    // Every picture that is shown or kept is drawn by a command.
    for document in documents() {
        let text = read(root().join(&document));
        let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        // All are in the repository's root or one folder deep.
        let shown = links.map(|link| link.strip_prefix("../").unwrap_or(link));
        let is_kept = |link: &&str| link.starts_with("analysis/") && !link.starts_with(TABLES);
        for picture in shown.filter(|link| link.ends_with(".svg") && is_kept(link)) {
            assert!(drawn.contains(&PathBuf::from(picture)), "{document}: {picture}");
        }
    }
    for file in std::fs::read_dir(root().join("analysis/pictures")).unwrap() {
        let file = file.unwrap().path();
        let file = file.strip_prefix(root()).unwrap().to_owned();
        let is_drawn = drawn.contains(&file) || [TABLES, PAGE].map(Path::new).contains(&&*file);
        assert!(is_drawn || file.extension().unwrap() == "toml", "{file:?}");
    }
}

/// Where tables of measurements are kept, and the pictures of them that documents show. All others are
/// drawn here, too, and not kept.
const TABLES: &str = "analysis/pictures/tradeoff";

/// The page of `haptic explore` as a browser shows it, which the browser's tests keep.
const PAGE: &str = "analysis/pictures/explore.png";

#[test]
fn the_pictures_of_kept_tables_are_what_is_drawn_of_them() {
    let (folder, kept) = (tempfile::tempdir().unwrap(), root().join(TABLES));
    let names = |folder: &Path, extension: &str| -> BTreeSet<PathBuf> {
        let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().into());
        files.filter(|name: &PathBuf| name.extension().is_some_and(|it| it == extension)).collect()
    };
    for name in names(&kept, "csv") {
        std::fs::copy(kept.join(&name), folder.path().join(&name)).unwrap();
    }
    let mut run = program(&["chart", "tradeoff", "--draw-only", "-o"]);
    let run = run.arg(folder.path()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let drawn = names(folder.path(), "svg");
    let guide = read(root().join("docs/charts.md"));
    let shown = |name: &&PathBuf| guide.contains(&format!("(../{TABLES}/{})", name.display()));
    let shown: Vec<_> = drawn.iter().filter(shown).collect();
    assert!(!shown.is_empty());
    assert_eq!(shown.len(), guide.matches(&format!("(../{TABLES}/")).count());
    for name in shown {
        let same = read(kept.join(name)) == read(folder.path().join(name));
        assert!(same, "{name:?} is not the picture of its table; see `haptic chart tradeoff`");
    }
}
