//! Makes pictures smaller: a broken line is drawn as hundreds of short lines, which are joined to one path.

/// Beginning of an opaque stroke.
const OPAQUE: &str = "<polyline fill=\"none\" opacity=\"1\" ";

/// The same picture with consecutive opaque strokes of one style as one path. Overlapping strokes of a path
/// look the same; transparent strokes would become lighter.
pub fn join_strokes(svg: &str) -> String {
    let mut lines = svg.lines().peekable();
    let mut joined = String::with_capacity(svg.len());
    while let Some(line) = lines.next() {
        let Some((style, points)) = stroke(line) else {
            joined += line;
            joined.push('\n');
            continue;
        };
        joined += &format!("<path fill=\"none\" {style} d=\"M{points}");
        while let Some((_, more)) =
            lines.peek().and_then(|next| stroke(next)).filter(|s| s.0 == style)
        {
            joined += &format!("M{more}");
            lines.next();
        }
        joined += "\"/>\n";
    }
    joined
}

/// Style and points of an opaque stroke.
fn stroke(line: &str) -> Option<(&str, &str)> {
    let (style, points) = line.strip_prefix(OPAQUE)?.split_once(" points=\"")?;
    Some((style, points.strip_suffix("\"/>")?.trim_end()))
}
