//! Changes of a board's parameters as they are typed.

use haptic_servo::certificate::Parameter;
use haptic_servo::tuning::{self, TUNABLE};
use haptic_servo::wire::message::Changes;
use thiserror::Error;

use super::formatting;

/// A parameter was given two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{name} is given twice")]
pub struct DuplicateParameter {
    /// Its name.
    pub name: &'static str,
}

/// One change: `stiffness=30`.
///
/// # Errors
/// A sentence if the text is not a name and a finite number.
pub fn change(text: &str) -> Result<(Parameter, f64), String> {
    let (name, value) =
        text.split_once('=').ok_or_else(|| format!("expected NAME=VALUE, got `{text}`"))?;
    let parameter = tuning::parameter(name).ok_or_else(|| {
        let names: Vec<&str> = TUNABLE.iter().map(|(name, _)| *name).collect();
        format!("there is no parameter `{name}`; the parameters are {}", names.join(", "))
    })?;
    match value.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((parameter, value)),
        _ => Err(format!("`{value}` is not a finite number")),
    }
}

/// Collects changes into the type of the wire protocol.
///
/// # Errors
/// Where a parameter is given twice.
pub fn collect(changes: &[(Parameter, f64)]) -> Result<Changes, DuplicateParameter> {
    for (i, (parameter, _)) in changes.iter().enumerate() {
        if changes[..i].iter().any(|(earlier, _)| earlier == parameter) {
            return Err(DuplicateParameter { name: formatting::name(*parameter) });
        }
    }
    // More changes than parameters would contain a duplicate, which is refused above.
    Ok(changes.iter().copied().collect())
}

/// Parses changes from a typed line, with spaces or commas between them and with or without
/// spaces at the equals sign: `stiffness = 20, damping = 0.01`.
///
/// # Errors
/// A sentence if the line has no change, an invalid change or a duplicate parameter.
pub fn line(text: &str) -> Result<Changes, String> {
    let sides: Vec<&str> = text.split('=').map(str::trim).collect();
    let together = sides.join("=");
    let words = together.split([' ', '\t', ',']).filter(|word| !word.is_empty());
    let changes = words.map(change).collect::<Result<Vec<_>, _>>()?;
    if changes.is_empty() {
        return Err("expected NAME=VALUE, got nothing".to_owned());
    }
    collect(&changes).map_err(|twice| twice.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_a_name_and_a_number() {
        assert_eq!(change("stiffness=30"), Ok((Parameter::Stiffness, 30.0)));
        assert_eq!(change("coupling.stiffness=4e1"), Ok((Parameter::CouplingStiffness, 40.0)));
        for (text, part) in [
            ("stiffness", "NAME=VALUE"),
            ("stiffnes=3", "the parameters are stiffness, damping"),
            ("damping=soft", "not a finite number"),
            ("damping=inf", "not a finite number"),
        ] {
            let refused = change(text).unwrap_err();
            assert!(refused.contains(part), "{refused}");
        }
    }

    #[test]
    fn a_line_may_have_spaces_and_commas() {
        let both = [(Parameter::Stiffness, 20.0), (Parameter::Damping, 0.01)];
        for text in ["stiffness = 20 damping=0.01", " stiffness=20,damping =0.01 "] {
            assert_eq!(line(text).unwrap().as_slice(), both, "{text}");
        }
        for (text, part) in [
            ("", "NAME=VALUE"),
            ("stiffness", "NAME=VALUE"),
            ("stiffness = = 3", "not a finite number"),
            ("damping = 1, damping = 1", "damping is given twice"),
            ("stiffness 20", "NAME=VALUE"),
        ] {
            let refused = line(text).unwrap_err();
            assert!(refused.contains(part), "{text}: {refused}");
        }
    }
}
