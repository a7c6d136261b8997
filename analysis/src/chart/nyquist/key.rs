//! What is written below a Nyquist picture.

use std::f64::consts::PI;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::Curve;
use crate::chart::dash::Dash;
use crate::chart::{Area, Drawn, anchored, units};
use crate::circle::{CirclePole, Kind};
use crate::quantity::{shortened, significant};

/// Height of a line of the key in pixels.
const ROW: i32 = 19;
/// Longest name in the key, in letters.
const LONGEST_NAME: usize = 48;

fn least_words(curve: &Curve) -> &'static str {
    if curve.minimum.is_some() { "least real part, -alpha" } else { "real part everywhere, -alpha" }
}

/// Height of the key in units of the drawing.
pub(super) fn height(curves: &[Curve]) -> i32 {
    let rows: usize = key(curves).iter().map(|(_, lines)| lines.len()).sum();
    units(ROW * rows as i32 + 10)
}

/// What is written below the picture, with the pattern that it is about.
fn key(curves: &[Curve]) -> Vec<(Dash, Vec<String>)> {
    let entry = |(index, curve): (usize, &Curve)| {
        let alpha = curve.alpha.map_or_else(
            || "no alpha: its poles forbid it".to_owned(),
            |alpha| format!("{} = {} N m s/rad", least_words(curve), significant(-alpha, 4)),
        );
        let mut lines = if curves.len() > 1 {
            vec![format!("{}: {}: {alpha}", index + 1, shortened(&curve.name, LONGEST_NAME))]
        } else {
            let mark = if curve.alpha.is_some() { "circle: " } else { "" };
            let halves = "thick: angles from 0 to pi; thin: from -pi to 0";
            vec![halves.to_owned(), format!("{mark}{alpha}")]
        };
        lines.extend(curve.poles.iter().map(sentence));
        if let Some(re) = curve.asymptote {
            let re = significant(re, 3);
            lines.push(format!("hairline of dots: its real part near rest, {re} N m s/rad"));
        }
        lines.extend(curve.judged.clone());
        (Dash::of(index), lines)
    };
    curves.iter().enumerate().map(entry).collect()
}

/// What a pole does to the curve.
fn sentence(pole: &CirclePole) -> String {
    let place = match pole.theta {
        0.0 => "pole at rest, z = 1".to_owned(),
        PI => "pole at z = -1".to_owned(),
        theta => format!("poles at +-{} rad", significant(theta, 4)),
    };
    match (pole.residue(), pole.kind) {
        (Some(k), _) if k > 0.0 => format!(
            "{place}: residue {} N m s/rad > 0, closes through infinity on the right: allowed",
            significant(k, 4)
        ),
        (Some(k), _) => format!(
            "{place}: residue {} N m s/rad < 0, closes through infinity on the left: not passive",
            significant(k, 4)
        ),
        (None, Kind::Repeated) => {
            format!("{place}: repeated, a whole turn or more at infinity: not passive")
        }
        (None, Kind::Simple(_)) => {
            format!(
                "{place}: residue of the wrong angle, askew at infinity (shown at +): not passive"
            )
        }
    }
}

pub(super) fn write(area: &Area<'_>, curves: &[Curve]) -> Drawn<()> {
    let mut row = 0;
    for (dash, lines) in key(curves) {
        for (index, line) in lines.into_iter().enumerate() {
            let middle = units(ROW * row + ROW / 2);
            if index == 0 {
                dash.draw(area, &[(units(20), middle), (units(76), middle)], 2)?;
            }
            let style = anchored(HPos::Left, VPos::Center);
            area.draw(&Text::new(line, (units(88), middle), style))?;
            row += 1;
        }
    }
    Ok(())
}
