//! The last number that passes.

/// The end of the range of values that pass.
pub enum Edge {
    /// After this value, the last one to pass.
    At(f64),
    /// Nowhere; the start passes like all others.
    Always,
    /// Nothing passes.
    Never,
}

/// Looks for the last value that passes in the direction of `outward`, a factor; if a value passes, so do all
/// values in the other direction. Numbers are tried up to 60 octaves from `start`, which is not 0.
pub fn edge(passes: impl Fn(f64) -> bool, start: f64, outward: f64) -> Edge {
    /// Octaves in each direction: more than any two numbers of one machine are apart.
    const OCTAVES: usize = 60;
    let (mut inside, mut outside) = (start, start);
    let mut octaves = 0;
    while !passes(inside) {
        (outside, inside) = (inside, inside / outward);
        octaves += 1;
        if octaves > OCTAVES {
            return Edge::Never;
        }
    }
    octaves = 0;
    while inside == outside || passes(outside) {
        (inside, outside) = (outside, outside * outward);
        octaves += 1;
        if octaves > OCTAVES {
            return Edge::Always;
        }
    }
    loop {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            return Edge::At(inside);
        }
        if passes(middle) { inside = middle } else { outside = middle }
    }
}
