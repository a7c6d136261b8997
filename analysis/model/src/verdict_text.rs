//! The certificate's answer in words, as `haptic certify` and the page in a browser say it.

use haptic_servo::text::RoundUp3;

use crate::quantity::{rounded_down, significant};
use crate::verdict::{Enclosure, VerdictReport};

/// The report for a person, a row a line.
pub fn text(report: &VerdictReport) -> String {
    lines(&rows(report))
}

/// The same with the numbers of the proof.
pub fn detailed_text(report: &VerdictReport) -> String {
    lines(&[rows(report), details(report)].concat())
}

fn lines(rows: &[(&str, String)]) -> String {
    rows.iter().map(|(label, value)| format!("{label:<18} {value}\n")).collect()
}

/// The report for a person, in the order of its questions: a label and its value in each row; a row that
/// continues the one before has no label.
pub fn rows(report: &VerdictReport) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("scene", report.name.clone()),
        ("verdict", report.verdict_in_words().to_owned()),
        ("", report.summary.clone()),
    ];
    // Nothing was computed where a number is out of range.
    if report.delta.is_nan() {
        return rows;
    }
    rows.extend(felt(report));
    let margin = report.margin_in_words();
    let on_board = report.margin_on_board_in_words().filter(|_| report.board.is_none());
    let on_board = on_board.filter(|on_board| margin.as_ref() != Some(on_board));
    rows.extend(margin.map(|margin| ("margin", margin)));
    rows.extend(on_board.map(|margin| ("margin on a board", margin)));
    let not_on_a_board = report.board.clone().filter(|_| !report.is_for_a_board);
    rows.extend(not_on_a_board.map(|why| ("not on a board", why)));
    rows.extend(report.host.clone().map(|host| ("host", host)));
    list(&mut rows, "remedies", &report.remedies);
    rows.extend(report.no_remedy.map(|sentence| ("remedies", sentence.to_owned())));
    rows.extend(report.supply.iter().map(|supply| ("supply", supply.message.clone())));
    list(&mut rows, "WARNING", &report.warnings);
    rows.extend(report.friction.clone().map(|friction| ("friction", friction)));
    let named =
        |one: &&String| report.warnings.contains(one) || report.friction.as_ref() == Some(one);
    let holding = report.assumptions.iter().filter(|one| !named(one));
    list(&mut rows, "assumes", &holding.cloned().collect::<Vec<_>>());
    rows
}

/// The effect on the hand.
fn felt(report: &VerdictReport) -> impl Iterator<Item = (&'static str, String)> {
    let stiffness = report.felt_stiffness.map_or_else(
        || {
            "none: the torque at rest does not follow from the angle, or no coupling exists"
                .to_owned()
        },
        |felt| format!("{} N m/rad at the handle, where it is stiffest", significant(felt, 4)),
    );
    let free = report.free_damping.map(|felt| {
        ("free motion", format!("{} N m s/rad of damping at the handle", significant(felt, 4)))
    });
    let rest = report
        .rest
        .map(|rest| ("torque at rest", format!("off by up to {} N m", RoundUp3(rest.hum))));
    [("felt stiffness", stiffness)].into_iter().chain(free).chain(rest)
}

/// The numbers of the proof.
pub fn details(report: &VerdictReport) -> Vec<(&'static str, String)> {
    if report.delta.is_nan() {
        return Vec::new();
    }
    let mut rows = vec![
        ("alpha", enclosure(report.alpha)),
        ("alpha, coupled", enclosure(report.alpha_coupled)),
    ];
    if let Some(port) = report.alpha_port {
        rows.push(("alpha, at the port", enclosure(port)));
    }
    if let Some(bound) = report.bound {
        rows.push(("alpha, bound", enclosure(bound)));
    }
    rows.push(("delta", format!("{} N m s/rad", rounded_down(report.delta, 12))));
    if let Some(theta) = report.theta {
        let degrees = theta.to_degrees();
        rows.push(("reached at", format!("theta = {theta:.6} rad ({degrees:.2} degrees)")));
    }
    rows.push(("rule of the paper", format!("{:?}", report.rules.paper).to_lowercase()));
    rows.push(("exact rule", format!("{:?}", report.rules.exact).to_lowercase()));
    rows.extend(report.format.clone().map(|format| ("rounded to", format)));
    rows
}

fn list(rows: &mut Vec<(&'static str, String)>, label: &'static str, items: &[String]) {
    for (index, item) in items.iter().enumerate() {
        rows.push((if index == 0 { label } else { "" }, item.clone()));
    }
}

/// The middle of an enclosure, and half its width.
fn enclosure(enclosure: Enclosure) -> String {
    match enclosure {
        Enclosure { lo: Some(lo), hi: Some(hi) } => {
            let reach = significant(0.5 * (hi - lo), 2);
            format!("{} N m s/rad, to within {reach}", significant(0.5 * (lo + hi), 12))
        }
        _ => "does not exist".to_owned(),
    }
}
