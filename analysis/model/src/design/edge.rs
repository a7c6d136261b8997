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

/// Numbers of three digits from a positive `edge` towards the values that pass, which are the smaller ones
/// where `outward` is above 1; none from 0. The first may be beyond the edge by a rounding error.
pub fn inward(edge: f64, outward: f64) -> impl Iterator<Item = f64> {
    /// Numbers that are tried: the first ones nearly always pass.
    const TRIES: u32 = 20;
    /// Relative rounding error of an edge that has three digits.
    const ROUNDING: f64 = 1e-12;
    let tries = if edge > 0.0 { TRIES } else { 0 };
    let power = (edge.log10().floor() as i32).saturating_sub(2);
    let scaled = edge / 10.0_f64.powi(power);
    let (first, step) = match outward > 1.0 {
        true => ((scaled * (1.0 + ROUNDING)).floor(), -1.0),
        false => ((scaled * (1.0 - ROUNDING)).ceil(), 1.0),
    };
    // Read as a decimal, so that it is written with as few digits.
    let number = move |tried| format!("{}e{power}", first + step * f64::from(tried)).parse();
    (0..tries).filter_map(move |tried| number(tried).ok())
}

/// Looks for the last value that passes in the direction of `outward`, a factor; if a value passes, so do all
/// values in the other direction. Numbers are tried up to 60 octaves from `start`, which is not 0. The edge
/// may be short of the last value by the relative `tolerance`.
pub fn edge(passes: impl Fn(f64) -> bool, start: f64, outward: f64, tolerance: f64) -> Edge {
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
        let is_near = (outside - inside).abs() <= tolerance * inside;
        if is_near || middle == inside || middle == outside {
            return Edge::At(inside);
        }
        if passes(middle) { inside = middle } else { outside = middle }
    }
}
