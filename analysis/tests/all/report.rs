//! The report as a file; its appearance is tested in `tests/browser`.

use crate::common::{MOTION, WALL, complaint, haptic, report};

#[test]
fn the_page_stands_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (page, _) = report(folder.path(), &format!("{WALL}{MOTION}"));
    let links = page.replace("http://www.w3.org/2000/svg", "");
    for outside in ["http:", "https:", "src=", "href=", "@import", "url(", "<script"] {
        assert!(!links.contains(outside), "{outside}");
    }
}

#[test]
fn the_page_says_what_was_judged_where_from_and_when() {
    let folder = tempfile::tempdir().unwrap();
    let (file, page) = (folder.path().join("scene.toml"), folder.path().join("report.html"));
    std::fs::write(&file, format!("{WALL}{MOTION}")).unwrap();
    let [file, page] = [&file, &page].map(|path| path.to_str().unwrap());
    let write = |epoch: &str| {
        let mut report = crate::common::program(&["report", file, "-o", page]);
        let run = report.env("SOURCE_DATE_EPOCH", epoch).output().unwrap();
        (run, crate::common::read(page))
    };
    let (run, first) = write("951782400");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let version = env!("CARGO_PKG_VERSION");
    for part in [
        format!("Of {file}, by haptic {version}, on 2000-02-29."),
        "damper-wall".to_owned(),
        "22 N m/rad".to_owned(),
        "0.0001 kg m\u{b2}, 0.02 N m s/rad, 4 N m/rad".to_owned(),
    ] {
        assert!(first.contains(&part), "{part}");
    }
    assert!(first == write("951782400").1, "the same input gives the same page");
    assert_eq!(write("soon").0.status.code(), Some(2));
}

#[test]
fn a_page_that_cannot_be_is_a_bad_question() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, WALL).unwrap();
    for (page, words) in [("page.pdf", "must end in .html"), ("no/such/page.html", "No such file")]
    {
        let page_path = folder.path().join(page);
        let question = ["report", file.to_str().unwrap(), "-o", page_path.to_str().unwrap()];
        let said = complaint(haptic(&question));
        assert!(said.contains(page) && said.contains(words), "{said}");
    }
}
