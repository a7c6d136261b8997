//! Changes of a board's parameters as they are typed.

use haptic_servo::certificate::Parameter;
use haptic_servo::tuning::{self, TUNABLE};
use haptic_servo::wire::message::MAX_CHANGES;
use thiserror::Error;

use super::request::Request;
use super::{budget, formatting};

/// A parameter of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// A number of its scene.
    Scene(Parameter),
    /// A number of its host's budget.
    Host(&'static str),
}

impl Name {
    /// The parameter of this name.
    pub fn find(text: &str) -> Option<Self> {
        tuning::parameter(text).map(Self::Scene).or_else(|| budget::name(text).map(Self::Host))
    }

    fn text(self) -> &'static str {
        match self {
            Self::Scene(parameter) => formatting::name(parameter),
            Self::Host(name) => name,
        }
    }
}

/// Why changes are not one request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum CollectError {
    #[error("{name} is given twice")]
    Twice { name: &'static str },
    #[error(
        "{scene} is of the scene and {host} of its host's budget: change one of them, and the other after that"
    )]
    Both { scene: &'static str, host: &'static str },
    #[error(
        "{count} parameters are to be changed at once, and a board changes at most {MAX_CHANGES}"
    )]
    TooMany { count: usize },
}

/// One change: `stiffness=30`.
///
/// # Errors
/// A sentence if the text is not a name and a finite number.
pub fn change(text: &str) -> Result<(Name, f64), String> {
    let (name, value) =
        text.split_once('=').ok_or_else(|| format!("expected NAME=VALUE, got `{text}`"))?;
    let found = Name::find(name).ok_or_else(|| {
        let names = TUNABLE.iter().map(|(name, _)| *name).chain(budget::NAMES);
        let names: Vec<&str> = names.collect();
        format!("there is no parameter `{name}`; the parameters are {}", names.join(", "))
    })?;
    match value.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((found, value)),
        _ => Err(format!("`{value}` is not a finite number")),
    }
}

/// Collects changes into a request: of the scene, or of its host's budget.
///
/// # Errors
/// Where a parameter is given twice, both are changed, or more than a board changes at once.
pub fn collect(changes: &[(Name, f64)]) -> Result<Request, CollectError> {
    let (mut scene, mut host) = (Vec::new(), Vec::new());
    for (i, (name, value)) in changes.iter().enumerate() {
        if changes[..i].iter().any(|(earlier, _)| earlier == name) {
            return Err(CollectError::Twice { name: name.text() });
        }
        match name {
            Name::Scene(parameter) => scene.push((*parameter, *value)),
            Name::Host(name) => host.push((*name, *value)),
        }
    }
    match (scene.first(), host.first()) {
        (Some((scene, _)), Some((host, _))) => {
            Err(CollectError::Both { scene: formatting::name(*scene), host })
        }
        (None, Some(_)) => Ok(Request::Budget(host)),
        _ if scene.len() > MAX_CHANGES => Err(CollectError::TooMany { count: scene.len() }),
        _ => Ok(Request::Set(scene.into_iter().collect())),
    }
}

/// Parses changes from a typed line, with spaces or commas between them and with or without
/// spaces at the equals sign: `stiffness = 20, damping = 0.01`.
///
/// # Errors
/// A sentence if the line has no change, an invalid change or a duplicate parameter.
pub fn line(text: &str) -> Result<Request, String> {
    let sides: Vec<&str> = text.split('=').map(str::trim).collect();
    let together = sides.join("=");
    let words = together.split([' ', '\t', ',']).filter(|word| !word.is_empty());
    let changes = words.map(change).collect::<Result<Vec<_>, _>>()?;
    if changes.is_empty() {
        return Err("expected NAME=VALUE, got nothing".to_owned());
    }
    collect(&changes).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_a_name_and_a_number() {
        assert_eq!(change("stiffness=30"), Ok((Name::Scene(Parameter::Stiffness), 30.0)));
        assert_eq!(
            change("coupling.stiffness=4e1"),
            Ok((Name::Scene(Parameter::CouplingStiffness), 40.0))
        );
        for (text, part) in [
            ("stiffness", "NAME=VALUE"),
            ("stiffnes=3", "the parameters are stiffness, damping"),
            ("host.watts=3", "host.energy, host.power, host.damping, host.torque, host.timeout"),
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
            let Ok(Request::Set(changes)) = line(text) else { panic!("{text}") };
            assert_eq!(changes.as_slice(), both, "{text}");
        }
        for (text, part) in [
            ("", "NAME=VALUE"),
            ("stiffness", "NAME=VALUE"),
            ("stiffness = = 3", "not a finite number"),
            ("damping = 1, damping = 1", "damping is given twice"),
            ("stiffness 20", "NAME=VALUE"),
            (
                "stiffness=1 damping=1 filter=1 face=1 residual=1 torque=1 count=1 centre=1 mode=1",
                "at most 8",
            ),
            ("host.power = 1 host.power = 1", "host.power is given twice"),
            ("host.power = 1, damping = 1", "damping is of the scene and host.power of its host"),
        ] {
            let refused = line(text).unwrap_err();
            assert!(refused.contains(part), "{text}: {refused}");
        }
    }
}
