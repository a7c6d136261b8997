//! Text at a width.

/// Breaks the lines of a text that are wider than `width` columns between words; the lines that continue one
/// are indented by `hang` columns. Without a width nothing is broken.
pub fn wrapped(text: &str, width: Option<usize>, hang: usize) -> String {
    let Some(width) = width else { return text.to_owned() };
    let indent = " ".repeat(if hang < width / 2 { hang } else { 0 });
    let options = textwrap::Options::new(width).subsequent_indent(&indent).break_words(false);
    let lines = text.lines().map(|line| textwrap::wrap(line, &options).join("\n"));
    let mut wrapped = lines.collect::<Vec<_>>().join("\n");
    if text.ends_with('\n') {
        wrapped.push('\n');
    }
    wrapped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_and_hang() {
        let text = "label   a sentence that is longer than the terminal is wide\nshort\n";
        let broken =
            "label   a sentence that is longer\n        than the terminal is wide\nshort\n";
        assert_eq!(wrapped(text, Some(34), 8), broken);
        assert_eq!(wrapped(text, None, 8), text);
        assert!(wrapped(text, Some(20), 12).lines().all(|line| line.len() <= 20));
    }
}
