//! Numbers as people write them.

/// A number with `digits` significant digits and no trailing zeros, in exponential form where
/// plain digits would be long.
///
/// ```
/// use haptic_model::quantity::significant;
/// assert_eq!(significant(0.021_000_000_000_06, 6), "0.021");
/// assert_eq!(significant(-1234.567, 3), "-1230");
/// assert_eq!(significant(1.234e-9, 2), "1.2e-9");
/// assert_eq!(significant(0.0, 3), "0");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    let precision = digits.saturating_sub(1);
    let exponential = format!("{value:.precision$e}");
    let rounded = rounded(value, digits);
    let exponent = if rounded == 0.0 { 0.0 } else { rounded.abs().log10().floor() };
    if !rounded.is_finite() || (-4.0..7.0).contains(&exponent) {
        return format!("{rounded}");
    }
    match exponential.split_once('e') {
        Some((mantissa, power)) if mantissa.contains('.') => {
            format!("{}e{power}", mantissa.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => exponential,
    }
}

/// The number nearest to `value` of those with `digits` significant digits.
///
/// ```
/// use haptic_model::quantity::rounded;
/// assert_eq!(rounded(1144.0 * 0.001, 15), 1.144);
/// assert_eq!(rounded(f64::INFINITY, 3), f64::INFINITY);
/// ```
pub fn rounded(value: f64, digits: usize) -> f64 {
    let precision = digits.saturating_sub(1);
    format!("{value:.precision$e}").parse().unwrap_or(value)
}

/// The same as [`significant`], not above the value but for the rounding of a double: for a passivity, of which
/// more than there is must not be stated.
///
/// ```
/// use haptic_model::quantity::rounded_down;
/// assert_eq!(rounded_down(0.021_98, 3), "0.0219");
/// assert_eq!(rounded_down(0.022, 3), "0.022");
/// assert_eq!(rounded_down(-0.021_92, 3), "-0.022");
/// ```
pub fn rounded_down(value: f64, digits: usize) -> String {
    let nearest = rounded(value, digits);
    if nearest - value <= 4.0 * f64::EPSILON * value.abs() {
        return significant(nearest, digits);
    }
    let last_digit = nearest.abs().log10().floor() as i32 + 1 - digits as i32;
    significant(nearest - 10.0_f64.powi(last_digit), digits)
}

/// A name of at most `letters` characters, with dots in place of the rest.
///
/// ```
/// use haptic_model::quantity::shortened;
/// assert_eq!(shortened("wall", 8), "wall");
/// assert_eq!(shortened("a wall of great height", 8), "a wal...");
/// ```
pub fn shortened(name: &str, letters: usize) -> String {
    const DOTS: &str = "...";
    if name.chars().count() <= letters {
        return name.to_owned();
    }
    name.chars().take(letters.saturating_sub(DOTS.len())).chain(DOTS.chars()).collect()
}
