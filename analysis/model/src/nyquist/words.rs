//! Describes a Nyquist plot in sentences.

use std::f64::consts::PI;

use super::{Curve, NyquistScene, Role};
use crate::quantity::significant;
use crate::unit_circle_poles::UnitCirclePole;

/// The meaning of the two halves of a curve.
pub const HALVES: &str =
    "thick: frequencies from 0 to half the sample rate; thin: their mirror image";

/// Describes a curve, and its mark if there is one scene only.
pub fn curve(name: &str, scene: &NyquistScene, curve: &Curve, is_single: bool) -> Vec<String> {
    let what = match curve.role {
        Role::Judged => "",
        Role::JudgedLatched => "judged, with missed updates: ",
        Role::JudgedAtPort => "judged, at the port with delay and lags: ",
        Role::Linear => "grey, environment, of which only the poles are judged: ",
        Role::Alone => "grey, environment without its coupling, not judged: ",
    };
    let coupled = scene.curves.iter().any(|other| other.role == Role::Alone);
    let what = match curve.role {
        Role::Judged if coupled => "judged, environment with coupling: ",
        _ => what,
    };
    let mark =
        if is_single && curve.role.is_judged() && curve.alpha.is_some() { "circle: " } else { "" };
    let least = match curve.minimum {
        Some(_) => "least real part, -alpha",
        None => "real part everywhere, -alpha",
    };
    let alpha = curve.alpha.map_or_else(
        || "no alpha: its poles forbid it".to_owned(),
        |alpha| format!("{least} = {} N m s/rad", significant(-alpha, 4)),
    );
    let mut words = vec![format!("{name}{mark}{what}{alpha}")];
    if curve.role == Role::Alone {
        return words;
    }
    words.extend(curve.poles.iter().map(sentence));
    if curve.outside > 0 {
        words.push(format!(
            "poles outside of the unit circle: {}: not passive, wherever the curve runs",
            curve.outside
        ));
    }
    if let Some(re) = curve.asymptote.filter(|_| curve.role.is_judged()) {
        let re = significant(re, 3);
        words.push(format!("dotted line: real part towards frequency 0, {re} N m s/rad"));
    }
    if let Some((turn, theta, _)) = scene.phase_margin(curve) {
        let degrees = significant(turn.to_degrees(), 3);
        let hertz = significant(theta / (2.0 * PI * scene.period), 3);
        words.push(format!(
            "square: phase margin {degrees} degrees, at {hertz} Hz: rotated by it, the curve \
             touches the line"
        ));
    }
    if curve.role == Role::Judged {
        words.extend(margins(scene));
    }
    words
}

/// Describes the bound that is judged in place of a curve; `None` for a scene whose curve is judged.
pub fn bound(name: &str, scene: &NyquistScene) -> Option<Vec<String>> {
    let linear = scene.curves.iter().any(|curve| curve.role == Role::Linear);
    let mut words = match scene.bound {
        _ if !linear => return None,
        None => vec![format!("{name}one-sided or limited, and no bound is known: undecided")],
        Some(bound) => {
            let bound = significant(-bound, 4);
            vec![format!("{name}one-sided or limited: judged by the bound, {bound} N m s/rad")]
        }
    };
    words.extend(margins(scene));
    Some(words)
}

/// The gain margin, or the reason why there is no critical line.
fn margins(scene: &NyquistScene) -> Vec<String> {
    if scene.limit.is_none() {
        let words = "no critical line: the rule for one-sided or limited scenes passes none behind a \
                     coupling that is rigid or stiffer than 2 delta/T";
        return vec![words.to_owned()];
    }
    let Some(factor) = scene.gain_margin() else { return Vec::new() };
    let decibels = significant(20.0 * factor.log10(), 3);
    vec![format!(
        "gain margin {} ({decibels} dB): multiplied by it, the curve touches the line",
        significant(factor, 4)
    )]
}

/// The effect of a pole on the curve.
fn sentence(pole: &UnitCirclePole) -> String {
    let place = match pole.theta {
        0.0 => "pole at rest, z = 1".to_owned(),
        PI => "pole at z = -1".to_owned(),
        theta => format!("poles at +-{} rad", significant(theta, 4)),
    };
    match pole.residue() {
        Some(k) if k > 0.0 => format!(
            "{place}: residue {} N m s/rad > 0, closes through infinity on the right: allowed",
            significant(k, 4)
        ),
        Some(k) => format!(
            "{place}: residue {} N m s/rad < 0, closes through infinity on the left: not passive",
            significant(k, 4)
        ),
        None if pole.is_simple() => {
            format!("{place}: residue of the wrong angle, askew at infinity: not passive")
        }
        None => format!("{place}: repeated, a whole turn or more at infinity: not passive"),
    }
}
