//! What coverage-guided search has found to take every branch that it reached, once more.

#[path = "../../../firmware/fuzz/bodies/decoder.rs"]
mod decoder;
#[path = "../../../firmware/fuzz/bodies/parameters.rs"]
mod parameters;

/// Runs every input: a line of hexadecimal digits each.
fn replay(name: &str, corpus: &str, run: impl Fn(&[u8])) {
    let mut inputs = 0;
    for (number, line) in corpus.lines().enumerate() {
        let input =
            bytes(line).unwrap_or_else(|| panic!("{name}: line {} is not an input", number + 1));
        run(&input);
        inputs += 1;
    }
    assert!(inputs >= 100, "{name}: only {inputs} inputs");
}

fn bytes(line: &str) -> Option<Vec<u8>> {
    let (pairs, []) = line.as_bytes().as_chunks::<2>() else { return None };
    let digits = pairs.iter().map(|pair| std::str::from_utf8(pair).ok());
    digits.map(|pair| u8::from_str_radix(pair?, 16).ok()).collect()
}

#[test]
fn any_bytes_on_the_wire() {
    replay("decoder", include_str!("../../../firmware/fuzz/corpus/decoder.hex"), decoder::run);
}

#[test]
fn any_changes_of_any_scene() {
    replay(
        "parameters",
        include_str!("../../../firmware/fuzz/corpus/parameters.hex"),
        parameters::run,
    );
}
