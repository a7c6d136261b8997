//! The layout of a Rust expression: on one line if that is short enough, otherwise with one field per line.

/// Longest line in columns.
const WIDTH: usize = 100;
/// Columns of an indentation.
const INDENT: usize = 4;

/// After the `=` of a constant whose beginning has `columns` columns: on its own line if it fits only there.
pub fn after(columns: usize, expression: &str) -> String {
    if columns + 1 + expression.len() < WIDTH {
        return format!(" {expression}");
    }
    if INDENT + expression.len() < WIDTH {
        return format!("\n{}{expression}", " ".repeat(INDENT));
    }
    format!(" {}", broken(0, expression))
}

/// A structure with one field per line, or a list with one value per line, below a line with this
/// indentation: also as the argument of a call, or before the method that ends an environment. Anything else
/// stays on its line.
pub fn broken(indent: usize, expression: &str) -> String {
    let within = indent + INDENT;
    let [outer, inner] = [indent, within].map(|columns| " ".repeat(columns));
    for method in [".alone()", ".sum()"] {
        if let Some(of) = expression.strip_suffix(method) {
            return format!("{}\n{outer}{method}", broken(indent, of));
        }
    }
    let argument = expression.strip_suffix(')').filter(|rest| rest.ends_with(['}', ']']));
    if let Some((call, argument)) = argument.and_then(|call| call.split_once('(')) {
        return format!("{call}({})", broken(indent, argument));
    }
    if let Some(values) = expression.strip_prefix("&[").and_then(|list| list.strip_suffix(']')) {
        let lines = parts(values).map(|value| format!("{inner}{value},\n"));
        return format!("&[\n{}{outer}]", lines.collect::<String>());
    }
    let structure = expression.strip_suffix(" }").and_then(|text| text.split_once(" { "));
    let Some((name, fields)) = structure else { return expression.to_owned() };
    let lines = parts(fields).map(|field| match field.split_once(": ") {
        // The comma needs a column, too.
        Some((name, value)) if within + field.len() >= WIDTH => {
            format!("{inner}{name}: {},\n", broken(within, value))
        }
        Some(_) => format!("{inner}{field},\n"),
        None => format!("{inner}{field}\n"),
    });
    format!("{name} {{\n{}{outer}}}", lines.collect::<String>())
}

/// The parts of a list between the commas that are in no brackets.
fn parts(list: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0;
    let ends = move |letter: char| {
        depth += i32::from("([{".contains(letter)) - i32::from(")]}".contains(letter));
        letter == ',' && depth == 0
    };
    list.split(ends).map(str::trim_start)
}
