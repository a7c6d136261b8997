//! What the library's users can name is a kept file: `firmware/public-api.txt`, an item a line, with all that
//! needs no board.
//!
//! After an intended change: `PUBLIC_API=overwrite cargo test -p tests --test all public_api`.

use std::collections::{BTreeSet, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Separates what an item is called from what it is.
const SIGNATURE: &str = " : ";

/// What rustdoc says of the library in JSON, which it calls unstable; none where this compiler does not.
fn rustdoc() -> Option<Value> {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("public-api");
    let output = Command::new(env!("CARGO"))
        .args(["rustdoc", "--package", "haptic-servo", "--lib", "--features", "wire", "--offline"])
        .args(["--", "-Z", "unstable-options", "--output-format", "json"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        // A folder of its own: build scripts look at that permission, and all else would be built anew.
        .env("CARGO_TARGET_DIR", &target)
        .env("RUSTC_BOOTSTRAP", "1")
        .env_remove("RUSTDOCFLAGS")
        .output()
        .expect("cargo starts");
    if !output.status.success() {
        eprintln!("skipped: no JSON: {}", String::from_utf8_lossy(&output.stderr));
        return None;
    }
    let text = fs::read_to_string(target.join("doc/haptic_servo.json")).expect("what was written");
    Some(serde_json::from_str(&text).expect("JSON"))
}

/// Kind and content of an item.
fn inner(item: &Value) -> (&str, &Value) {
    let inner = item["inner"].as_object().and_then(|inner| inner.iter().next());
    inner.map(|(kind, content)| (kind.as_str(), content)).expect("an item has a kind")
}

fn ids(list: &Value) -> impl Iterator<Item = String> {
    list.as_array().into_iter().flatten().filter(|id| !id.is_null()).map(Value::to_string)
}

/// Types by their parts, joined.
fn types(list: &Value) -> String {
    let list = list.as_array().into_iter().flatten();
    list.map(type_name).collect::<Vec<_>>().join(", ")
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// A type as it is written.
fn type_name(value: &Value) -> String {
    let Some((kind, of)) = value.as_object().and_then(|value| value.iter().next()) else {
        return text(value).to_owned();
    };
    match kind.as_str() {
        "resolved_path" | "trait" => path(of),
        "primitive" | "generic" => text(of).to_owned(),
        "borrowed_ref" => {
            let mutable = if of["is_mutable"] == true { "mut " } else { "" };
            let lifetime = of["lifetime"].as_str().map(|name| format!("{name} "));
            format!("&{}{mutable}{}", lifetime.unwrap_or_default(), type_name(&of["type"]))
        }
        "tuple" => format!("({})", types(of)),
        "slice" => format!("[{}]", type_name(of)),
        "array" => format!("[{}; {}]", type_name(&of["type"]), text(&of["len"])),
        "impl_trait" => format!("impl {}", bounds(of)),
        "qualified_path" => format!("{}::{}", type_name(&of["self_type"]), text(&of["name"])),
        "function_pointer" => format!("fn{}", function(&of["sig"])),
        other => other.to_owned(),
    }
}

/// A path with its arguments.
fn path(of: &Value) -> String {
    let arguments = &of["args"]["angle_bracketed"]["args"];
    let arguments: Vec<_> = arguments.as_array().into_iter().flatten().map(argument).collect();
    let name = text(&of["path"]);
    if arguments.is_empty() { name.into() } else { format!("{name}<{}>", arguments.join(", ")) }
}

fn argument(of: &Value) -> String {
    match of.as_object().and_then(|of| of.iter().next()) {
        Some((kind, value)) if kind == "type" => type_name(value),
        Some((kind, value)) if kind == "const" => text(&value["expr"]).to_owned(),
        Some((_, value)) => text(value).to_owned(),
        None => text(of).to_owned(),
    }
}

fn bounds(list: &Value) -> String {
    let list = list.as_array().into_iter().flatten();
    let one = |bound: &Value| match &bound["trait_bound"] {
        Value::Null => text(&bound["outlives"]).to_owned(),
        bound => path(&bound["trait"]),
    };
    list.map(one).collect::<Vec<_>>().join(" + ")
}

/// Arguments and result.
fn function(signature: &Value) -> String {
    let inputs = signature["inputs"].as_array().into_iter().flatten();
    let inputs: Vec<_> =
        inputs.map(|input| format!("{}: {}", text(&input[0]), type_name(&input[1]))).collect();
    let output = match &signature["output"] {
        Value::Null => String::new(),
        output => format!(" -> {}", type_name(output)),
    };
    format!("({}){output}", inputs.join(", "))
}

/// The items of the library that a user can name, as lines.
struct Listing<'a> {
    index: &'a Value,
    /// Items that a path of public modules leads to.
    reached: HashSet<String>,
    lines: BTreeSet<String>,
}

impl<'a> Listing<'a> {
    fn of(library: &'a Value) -> BTreeSet<String> {
        let root = library["root"].to_string();
        let mut listing =
            Self { index: &library["index"], reached: HashSet::new(), lines: BTreeSet::new() };
        listing.reach(&root);
        listing.children(&root, "haptic_servo");
        listing.lines
    }

    fn item(&self, id: &str) -> Option<&'a Value> {
        self.index.get(id)
    }

    fn reach(&mut self, module: &str) {
        let Some(item) = self.item(module) else { return };
        for id in ids(&item["inner"]["module"]["items"]) {
            self.reached.insert(id.clone());
            self.reach(&id);
        }
    }

    fn children(&mut self, module: &str, at: &str) {
        let Some(item) = self.item(module) else { return };
        let (_, content) = inner(item);
        let items =
            if content["items"].is_null() { &content["variants"] } else { &content["items"] };
        ids(items).for_each(|id| self.add(&id, at));
    }

    fn line(&mut self, kind: &str, name: &str, signature: &str) {
        let separator = if signature.is_empty() { "" } else { SIGNATURE };
        self.lines.insert(format!("{kind} {name}{separator}{signature}"));
    }

    fn add(&mut self, id: &str, at: &str) {
        let Some(item) = self.item(id) else { return };
        let (kind, content) = inner(item);
        let name = format!("{at}::{}", text(&item["name"]));
        match kind {
            "use" => self.add_use(content, at),
            "module" => {
                self.line("mod", &name, "");
                self.children(id, &name);
            }
            "function" => self.add_function(content, &name),
            "struct" | "enum" | "union" => self.add_type(kind, content, &name),
            "trait" => {
                self.line("trait", &name, &bounds(&content["bounds"]));
                self.children(id, &name);
            }
            "variant" => {
                self.line("variant", &name, "");
                self.fields(&content["kind"], &name);
            }
            "struct_field" => self.line("field", &name, &type_name(content)),
            "constant" | "assoc_const" | "static" => {
                self.line("const", &name, &type_name(&content["type"]));
            }
            "type_alias" | "assoc_type" => self.line("type", &name, &type_name(&content["type"])),
            other => self.line(other, &name, ""),
        }
    }

    fn add_function(&mut self, content: &Value, name: &str) {
        let is = |flag: &str, word: &'static str| match content["header"][flag] == true {
            true => word,
            false => "",
        };
        let required = if content["has_body"] == false { "required " } else { "" };
        let header = [required, is("is_const", "const "), is("is_unsafe", "unsafe ")].concat();
        self.line("fn", name, &format!("{header}{}", function(&content["sig"])));
    }

    /// An item under another path: where it is private at its own, all of it is here.
    fn add_use(&mut self, content: &Value, at: &str) {
        let (id, source) = (content["id"].to_string(), text(&content["source"]));
        let name = format!("{at}::{}", text(&content["name"]));
        if content["is_glob"] == true {
            return self.children(&id, at);
        }
        match self.item(&id) {
            Some(item) if !self.reached.contains(&id) => {
                assert_eq!(item["name"], content["name"], "{source} has another name here");
                self.add(&id, at);
            }
            _ => self.line("use", &name, source),
        }
    }

    fn add_type(&mut self, kind: &str, content: &Value, name: &str) {
        self.line(kind, name, "");
        self.fields(&content["kind"], name);
        ids(&content["variants"]).for_each(|id| self.add(&id, name));
        for id in ids(&content["impls"]) {
            let Some(item) = self.item(&id) else { continue };
            let (_, block) = inner(item);
            if block["is_synthetic"] == true || !block["blanket_impl"].is_null() {
                continue;
            }
            if block["trait"].is_null() {
                ids(&block["items"]).for_each(|id| self.add(&id, name));
            } else {
                self.line("impl", &format!("{} for {name}", path(&block["trait"])), "");
            }
        }
    }

    fn fields(&mut self, kind: &Value, name: &str) {
        for list in [&kind["plain"]["fields"], &kind["struct"]["fields"], &kind["tuple"]] {
            ids(list).for_each(|id| self.add(&id, name));
        }
    }
}

fn names(lines: &BTreeSet<String>) -> BTreeSet<&str> {
    lines.iter().map(|line| line.split(SIGNATURE).next().unwrap_or(line)).collect()
}

#[test]
fn the_public_interface_is_the_kept_one() {
    let Some(library) = rustdoc() else { return };
    let format = format!("format {}", library["format_version"]);
    let found = Listing::of(&library);
    assert!(found.len() > 1000, "only {} items", found.len());
    let file: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware/public-api.txt");
    if std::env::var("PUBLIC_API").is_ok_and(|value| value == "overwrite") {
        let lines: Vec<_> = found.iter().map(String::as_str).collect();
        fs::write(&file, format!("{format}\n{}\n", lines.join("\n"))).expect("a writable file");
    }
    let text = fs::read_to_string(&file).expect("the kept file");
    let mut kept: BTreeSet<String> = text.lines().map(str::to_owned).collect();
    // Another compiler may write the same types otherwise.
    let (gone, new): (Vec<_>, Vec<_>) = if kept.remove(&format) {
        let of = |a: &BTreeSet<String>, b: &BTreeSet<String>| a.difference(b).cloned().collect();
        (of(&kept, &found), of(&found, &kept))
    } else {
        eprintln!("only names are compared: {format} is not that of {}", file.display());
        kept.retain(|line| !line.starts_with("format "));
        let of = |a: &BTreeSet<&str>, b: &BTreeSet<&str>| {
            a.difference(b).map(|name| (*name).to_owned()).collect()
        };
        let (kept, found) = (names(&kept), names(&found));
        (of(&kept, &found), of(&found, &kept))
    };
    assert!(
        gone.is_empty() && new.is_empty(),
        "the public interface has changed. If that is intended, run PUBLIC_API=overwrite cargo test -p tests \
         --test all public_api, and name it in CHANGELOG.md.\ngone:\n  {}\nnew:\n  {}",
        gone.join("\n  "),
        new.join("\n  ")
    );
}
