//! The certificate's answer in words, as `haptic certify` and the page in a browser say it.

use crate::quantity::significant;
use crate::verdict::{Enclosure, VerdictReport};

/// The report for a person, a row a line.
pub fn text(report: &VerdictReport) -> String {
    rows(report).iter().map(|(label, value)| format!("{label:<18} {value}\n")).collect()
}

/// The report for a person: a label and its value in each row; a row that continues the one before has no
/// label.
pub fn rows(report: &VerdictReport) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("scene", report.name.clone()),
        ("verdict", format!("{:?}", report.verdict).to_uppercase()),
        ("", report.message.clone()),
    ];
    // Nothing was computed where a number is out of range.
    if report.delta.is_nan() {
        return rows;
    }
    rows.extend([
        ("alpha", enclosure(report.alpha)),
        ("alpha, coupled", enclosure(report.alpha_coupled)),
    ]);
    if let Some(port) = report.alpha_port {
        rows.push(("alpha, at the port", enclosure(port)));
    }
    if let Some(bound) = report.bound {
        rows.push(("alpha, bound", enclosure(bound)));
    }
    rows.push(("delta", format!("{} N m s/rad", significant(report.delta, 12))));
    let margin = report.margin_in_words();
    let on_board = report.margin_on_board_in_words().filter(|_| report.board.is_none());
    let on_board = on_board.filter(|on_board| margin.as_ref() != Some(on_board));
    rows.extend(margin.map(|margin| ("margin", margin)));
    rows.extend(on_board.map(|margin| ("margin on a board", margin)));
    if let Some(theta) = report.theta {
        let degrees = theta.to_degrees();
        rows.push(("reached at", format!("theta = {theta:.6} rad ({degrees:.2} degrees)")));
    }
    rows.push(("rule of the paper", format!("{:?}", report.rules.paper).to_lowercase()));
    rows.push(("exact rule", format!("{:?}", report.rules.exact).to_lowercase()));
    rows.extend(report.format.clone().map(|format| ("rounded to", format)));
    rows.extend(report.board.clone().map(|why| ("not on a board", why)));
    list(&mut rows, "remedies", &report.remedies);
    rows.extend(report.supply.iter().map(|supply| ("supply", supply.message.clone())));
    list(&mut rows, "WARNING", &report.warnings);
    let holding = report.assumptions.iter().filter(|one| !report.warnings.contains(one));
    list(&mut rows, "assumes", &holding.cloned().collect::<Vec<_>>());
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
