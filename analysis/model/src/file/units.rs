//! A number that was written with a unit, in the unit of its key: for the suggestion beside an error.

use std::f64::consts::{PI, TAU};

/// Units by which a key's unit is multiplied: the key's unit, the unit as it is written, and its size.
const MULTIPLES: &[(&str, &str, f64)] = &[
    ("rad", "deg", PI / 180.0),
    ("rad", "degrees", PI / 180.0),
    ("rad", "°", PI / 180.0),
    ("rad", "turns", TAU),
    ("rad/s", "deg/s", PI / 180.0),
    ("rad/s", "rpm", TAU / 60.0),
    ("kgm^2", "gcm^2", 1e-7),
    ("kgm^2", "kgcm^2", 1e-4),
    ("Nm", "Ncm", 1e-2),
    ("Nm/rad", "Nm/deg", 180.0 / PI),
    ("counts", "cpr", 1.0),
    ("counts", "CPR", 1.0),
    ("counts", "lines", 4.0),
    ("counts", "PPR", 4.0),
];

/// Units of the reciprocal, in the same way: the value is the size over the written number.
const RECIPROCALS: &[(&str, &str, f64)] = &[
    ("s", "Hz", 1.0),
    ("s", "kHz", 1e-3),
    ("Hz", "s", 1.0),
    ("Hz", "ms", 1e3),
    ("Hz", "us", 1e6),
    ("rad", "counts", TAU),
    ("rad", "counts/turn", TAU),
    ("rad", "cpr", TAU),
    ("rad", "CPR", TAU),
    ("counts", "rad", TAU),
    ("counts", "deg", 360.0),
];

const PREFIXES: &[(&str, f64)] =
    &[("", 1.0), ("m", 1e-3), ("u", 1e-6), ("µ", 1e-6), ("n", 1e-9), ("k", 1e3)];

/// The number of a text such as `1.5 ms` or `1,5`, in `unit`; `None` if it is not a number with a unit of that
/// kind. A number without a unit has the key's.
pub fn in_unit(text: &str, unit: &str) -> Option<f64> {
    let text = &text.trim().replacen(',', ".", 1);
    let end = (0..=text.len())
        .rev()
        .find(|&end| text.get(..end).is_some_and(|number| number.parse::<f64>().is_ok()))?;
    let number: f64 = text[..end].parse().ok()?;
    let bare = |text: &str| text.replace([' ', '*', '·'], "");
    let (written, unit) = (bare(&text[end..]), bare(unit));
    let of = |table: &[(&str, &str, f64)]| {
        let row = table.iter().find(|(own, other, _)| *own == unit && *other == written);
        row.map(|(.., size)| *size)
    };
    let prefixed = || {
        let prefix = if written.is_empty() { "" } else { written.strip_suffix(unit.as_str())? };
        PREFIXES.iter().find(|(name, _)| *name == prefix).map(|(_, size)| *size)
    };
    let value = match of(RECIPROCALS) {
        Some(size) => size / number,
        None => number * of(MULTIPLES).or_else(prefixed)?,
    };
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_read_in_the_unit_of_its_key() {
        for (text, unit, expected) in [
            ("1 ms", "s", 1e-3),
            ("2kHz", "s", 5e-4),
            ("1e-3", "s", 1e-3),
            ("1e-3s", "s", 1e-3),
            ("4096 counts", "rad", TAU / 4096.0),
            ("0.09 deg", "rad", 0.09 * PI / 180.0),
            ("300 g cm^2", "kg m^2", 3e-5),
            ("3 mN m s/rad", "N m s/rad", 3e-3),
            ("470 uF", "F", 4.7e-4),
            ("0,003", "N m s/rad", 3e-3),
            ("1024 PPR", "counts", 4096.0),
        ] {
            let found = in_unit(text, unit).unwrap_or_else(|| panic!("{text}"));
            assert!((found / expected - 1.0).abs() < 1e-12, "{text}: {found}");
        }
        for (text, unit) in [("", "s"), ("fast", "s"), ("1 N m", "s"), ("0 Hz", "s"), ("é", "s")] {
            assert_eq!(in_unit(text, unit), None, "{text}");
        }
    }
}
