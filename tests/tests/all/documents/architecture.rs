//! `ARCHITECTURE.md` says that dependencies point one way: no files of a crate import each other, directly or
//! through others.

use std::collections::{BTreeMap, BTreeSet};

use super::{regex, sources};

/// The crates' sources.
const CRATES: [&str; 8] = [
    "firmware/src",
    "firmware/harness/src",
    "analysis/src",
    "analysis/model/src",
    "analysis/client/src",
    "analysis/explore/src",
    "analysis/python/src",
    "analysis/virtual-board/src",
];

/// Which module imports which.
type Imports = BTreeMap<String, BTreeSet<String>>;

/// The module of a file by its path in the crate's folder.
fn module(path: &str) -> String {
    let mut parts: Vec<_> = path.trim_end_matches(".rs").split('/').collect();
    parts.pop_if(|last| ["mod", "lib", "main"].contains(last));
    parts.join("::")
}

/// The paths of a tree of imports.
fn expanded(tree: &str) -> Vec<String> {
    let Some((head, rest)) = tree.split_once('{') else { return vec![tree.to_owned()] };
    // A sentence that begins with the word is not an import.
    let Some((inner, _)) = rest.rsplit_once('}') else { return Vec::new() };
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for letter in inner.chars() {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        if letter == ',' && depth == 0 {
            parts.push(String::new());
        } else {
            parts.last_mut().expect("there is one from the beginning").push(letter);
        }
    }
    parts.iter().flat_map(|part| expanded(&format!("{head}{part}"))).collect()
}

/// All paths of the crate that a file names outside of its tests, as they are written.
fn paths(text: &str) -> Vec<String> {
    let text = regex(r"//[^\n]*").replace_all(text, "");
    let code = regex(r"#\[cfg\(test\)\]\s*mod ").split(&text).next().unwrap_or_default().to_owned();
    let imports = regex(r"\buse\s+([^;]+);");
    let trees = imports.captures_iter(&code).map(|found| found[1].split_whitespace().collect());
    let mut paths: Vec<_> = trees.flat_map(|tree: String| expanded(&tree)).collect();
    let rest = imports.replace_all(&code, "");
    let named = regex(r"(?:^|[^\w:$])((?:crate|super|self)(?:::\w+)+)");
    paths.extend(named.captures_iter(&rest).map(|found| found[1].to_owned()));
    paths
}

/// The module that a path is in, seen from a module.
fn resolved(path: &str, from: &str, modules: &BTreeSet<String>) -> Option<String> {
    let mut steps = path.split("::").peekable();
    let mut place: Vec<_> = from.split("::").filter(|part| !part.is_empty()).collect();
    match *steps.peek()? {
        "crate" => place.clear(),
        "self" | "super" => {}
        _ => return None,
    }
    while let Some(step) = steps.next_if(|step| ["crate", "self", "super"].contains(step)) {
        if step == "super" {
            place.pop();
        }
    }
    place.extend(steps);
    while !place.is_empty() && !modules.contains(&place.join("::")) {
        place.pop();
    }
    (!place.is_empty()).then(|| place.join("::"))
}

/// What the files of a crate import, by their paths in its folder and their texts.
fn imports(files: &[(String, String)]) -> Imports {
    let modules: BTreeSet<_> = files.iter().map(|(path, _)| module(path)).collect();
    let of_file = |(path, text): &(String, String)| {
        let from = module(path);
        let all = paths(text).into_iter().filter_map(|path| resolved(&path, &from, &modules));
        let others = all.filter(|to| *to != from).collect();
        (from.clone(), others)
    };
    files.iter().map(of_file).collect()
}

/// All that a module imports, directly or through others.
fn reached(from: &str, imports: &Imports) -> BTreeSet<String> {
    let (mut found, mut left) = (BTreeSet::new(), vec![from.to_owned()]);
    while let Some(module) = left.pop() {
        for next in imports.get(&module).into_iter().flatten() {
            if found.insert(next.clone()) {
                left.push(next.clone());
            }
        }
    }
    found
}

/// The imports that are part of a circle.
fn circles(imports: &Imports) -> Vec<String> {
    let edges = imports.iter().flat_map(|(from, all)| all.iter().map(move |to| (from, to)));
    let circular = edges.filter(|(from, to)| reached(to, imports).contains(*from));
    circular.map(|(from, to)| format!("{from} -> {to}")).collect()
}

#[test]
fn no_files_of_a_crate_import_each_other() {
    for folder in CRATES {
        let of_crate = |(path, text): (String, String)| {
            let path = path.strip_prefix(folder).expect("it is below the folder");
            (path.trim_start_matches('/').to_owned(), text)
        };
        // Programs are crates of their own.
        let is_module = |(path, _): &(String, String)| !path.starts_with("bin/");
        let files: Vec<_> = sources(folder).into_iter().map(of_crate).filter(is_module).collect();
        let imports = imports(&files);
        assert!(imports.values().any(|all| !all.is_empty()), "{folder}: nothing is imported");
        assert_eq!(circles(&imports), [""; 0], "{folder}");
    }
}

#[test]
fn a_circle_is_found_whatever_its_imports_look_like() {
    let files = [
        ("lib.rs", "mod a;\nmod b;\nmod c;"),
        ("a/mod.rs", "use crate::b::{X, deeper::{Y, Z}};\nmod inner;"),
        ("a/inner.rs", "use super::super::c;\n// use crate::b::X;"),
        ("b.rs", "fn f() { crate::c::g() }\n#[cfg(test)]\nmod tests { use crate::a::inner; }"),
        ("c.rs", "use std::fmt;\npub use crate::a::Name as Other;"),
    ];
    let files = files.map(|(path, text)| (path.to_owned(), text.to_owned()));
    assert_eq!(circles(&imports(&files)), ["a -> b", "b -> c", "c -> a"]);
}
