//! Turns the reference cases into constants, so that the compiler certifies each of them too.

use serde_json::Value;
use std::fmt::Write as _;
use std::{env, fs, path::Path};

fn main() {
    println!("cargo::rerun-if-changed=data/vectors.json");
    let text = fs::read_to_string("data/vectors.json").expect("data/vectors.json is readable");
    let cases: Vec<Value> = serde_json::from_str(&text).expect("data/vectors.json is JSON");
    let mut out = String::from("const CASES: &[(&str, Scene, Assessment)] = &[\n");
    for case in &cases {
        let scene = scene(case).expect("data/vectors.json has the fields of a case");
        let name = &case["name"];
        writeln!(out, "({name}, {scene}, {{ const A: Assessment = assess(&{scene}); A }}),")
            .expect("a string grows");
    }
    out.push_str("];\n");
    let folder = env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    fs::write(Path::new(&folder).join("vectors.rs"), out).expect("OUT_DIR is writable");
}

/// The case as an expression, its decimals as they are written.
fn scene(case: &Value) -> Option<String> {
    let coupling = match case.get("K_vc").and_then(Value::as_str) {
        Some(stiffness) => format!("Some({})", literal(stiffness)),
        None => "None".to_owned(),
    };
    Some(format!(
        "scene({}, {}, {coupling}, &[{}], &[{}])",
        literal(case["T"].as_str()?),
        literal(case["delta"].as_str()?),
        list(&case["E_num"])?,
        list(&case["E_den"])?,
    ))
}

fn list(values: &Value) -> Option<String> {
    let each: Option<Vec<String>> =
        values.as_array()?.iter().map(|v| v.as_str().map(literal)).collect();
    Some(each?.join(", "))
}

fn literal(decimal: &str) -> String {
    format!("{decimal}_f64")
}
