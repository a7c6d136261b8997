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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_of_one_style_are_one_path() {
        let line = |style: &str, points: &str| format!("{OPAQUE}{style} points=\"{points} \"/>\n");
        let faint = "<polyline fill=\"none\" opacity=\"0.5\" points=\"1,1 2,2 \"/>\n";
        let [a, b, c] =
            [("k", "1,2 3,4"), ("k", "5,6 7,8"), ("r", "0,0 9,9")].map(|(s, p)| line(s, p));
        let path = |style: &str, d: &str| format!("<path fill=\"none\" {style} d=\"{d}\"/>\n");
        let (both, red) = (path("k", "M1,2 3,4M5,6 7,8"), path("r", "M0,0 9,9"));
        assert_eq!(join_strokes(&[&*a, &b, &c].concat()), [both, red].concat());
        // Not across another element, and nothing transparent.
        let (first, second) = (path("k", "M1,2 3,4"), path("k", "M5,6 7,8"));
        assert_eq!(join_strokes(&[&*a, faint, &b].concat()), [&*first, faint, &second].concat());
    }
}
