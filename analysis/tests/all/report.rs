//! The report as a file; what its reader sees of it is looked at in `tests/browser`.

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
