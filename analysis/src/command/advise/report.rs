//! The report of `haptic advise` on number formats, as text and as JSON.

use std::cmp::Ordering;

use haptic_servo::certificate::QuantizationBound;
use haptic_servo::number::Arithmetic;
use haptic_servo::text::RoundUp3;
use serde::Serialize;

use crate::quantity::significant;
use crate::studies::bench::CORE_CLOCK;
use crate::studies::number_format::{Advice, Candidate, FormatProblem};
use crate::text_table::table_of;

#[derive(Serialize)]
pub struct FormatReport {
    pub scene: String,
    pub rate: f64,
    /// Stiffness in N m/rad of the coupling at that rate; `None`: rigid.
    pub coupling_stiffness: Option<f64>,
    /// The cheapest format that satisfies the requirements.
    pub format: Option<&'static str>,
    /// Limit cycle in N m caused by the encoder alone.
    pub encoder_hum: Option<f64>,
    pub formats: Vec<Candidate>,
    pub message: String,
}

pub fn message(problem: &FormatProblem, allowed: f64, advice: &Advice) -> String {
    let choice = advice.choice();
    let format = choice.map_or_else(|| none(advice), |choice| chosen(problem, choice));
    let cheapest = choice.or_else(|| advice.candidates.first());
    let rest = cheapest.and_then(|candidate| candidate.rest.as_ref());
    match advice.encoder_hum {
        Some(hum) if cheapest.is_some_and(|candidate| advice.hums(candidate)) => {
            format!("{}. As to the formats: {format}", coarse(problem, allowed, hum, rest))
        }
        hum => {
            let unknown = match hum {
                Some(_) => "",
                None => {
                    "; the scene does not state the encoder's resolution, so its part of the limit \
                     cycle is not included"
                }
            };
            format!("{format}{}{unknown}", as_certified(rest))
        }
    }
}

/// The text for an encoder that is too coarse for any format, with a sufficient resolution.
fn coarse(
    problem: &FormatProblem,
    allowed: f64,
    hum: f64,
    rest: Option<&QuantizationBound>,
) -> String {
    let counts = problem.transducers.counts_per_turn;
    format!(
        "no: in every format the encoder alone causes a limit cycle of {} N m in a device without \
         friction, above {} N m. About {} counts per turn instead of {} are enough, or a softer \
         scene{}",
        number(hum),
        number(allowed),
        number(counts * hum / allowed),
        significant(counts, 7),
        as_certified(rest),
    )
}

/// The certificate's bound at rest.
fn as_certified(rest: Option<&QuantizationBound>) -> String {
    rest.map_or_else(String::new, |rest| format!("; as certified {rest}"))
}

/// The reason if no format was chosen.
fn none(advice: &Advice) -> String {
    let hum = |candidate: &&Candidate| candidate.losses.map(|losses| losses.alone.torque);
    let built = advice.candidates.iter().filter(|candidate| hum(candidate).is_some());
    let quietest = built.min_by(|a, b| hum(a).partial_cmp(&hum(b)).unwrap_or(Ordering::Equal));
    let reason = quietest.map_or_else(String::new, |candidate| {
        format!(
            ": of the format with the smallest limit cycle, {}, the {}",
            candidate.format,
            candidate.rejected.join("; ")
        )
    });
    format!("no format is within the limits{reason}")
}

/// The reason for the chosen format.
fn chosen(problem: &FormatProblem, choice: &Candidate) -> String {
    let hum = choice.losses.map_or(f64::NAN, |losses| losses.alone.torque);
    let its_cycle = match choice.is_still() {
        true => "its own limit cycle without friction would be",
        false => "its own limit cycle is",
    };
    let arithmetic = Arithmetic::ALL.into_iter().find(|format| format.name() == choice.format);
    let units = arithmetic.filter(|format| format.is_scaled()).map(|format| problem.units(format));
    let scaled = units.map_or_else(String::new, |units| {
        format!(", with angles in {} rad and torques in {} N m,", units.angle, units.torque)
    });
    format!(
        "{}{scaled} is the cheapest within the limits: {} instructions a tick, {} % of a core of \
         {} MHz, and {its_cycle} at most {} N m",
        choice.format,
        number(choice.instructions),
        number(100.0 * choice.share),
        number(CORE_CLOCK / 1e6),
        number(hum),
    )
}

/// Formats a figure for text or a table.
fn number(value: f64) -> String {
    significant(value, 3)
}

/// The result as text with a table.
pub fn text(answered: &FormatReport) -> String {
    let table = table_of(
        &answered.formats,
        &[
            ("format", false, |of| of.format.to_owned()),
            ("instructions", true, |of| figure(Some(of.instructions))),
            ("share of the core", true, |of| match of.share.is_finite() {
                true => format!("{} %", number(100.0 * of.share)),
                false => "none".to_owned(),
            }),
            ("error", true, |of| figure(of.losses.map(|losses| losses.error))),
            ("around 1 rad", true, |of| figure(of.losses.and_then(|it| it.error_elsewhere))),
            ("limit cycle", true, |of| figure(of.losses.map(|losses| losses.alone.torque))),
            ("with encoder", true, |of| {
                figure(of.losses.and_then(|it| it.with_encoder).map(|cycle| cycle.torque))
            }),
            ("friction needed", true, |of| {
                of.rest.map_or_else(|| "not known".to_owned(), |it| RoundUp3(it.hum()).to_string())
            }),
            ("rejected", false, |of| of.rejected.join("; ")),
        ],
    );
    let coupling = answered.coupling_stiffness.map_or_else(
        || "rigid".to_owned(),
        |stiffness| format!("{} N m/rad, the standard one", significant(stiffness, 6)),
    );
    let FormatReport { scene, rate, message, .. } = answered;
    format!(
        "scene     {scene}, certified at {rate} Hz\ncoupling  {coupling}\n\n{table}\n\n{message}\n"
    )
}

fn figure(value: Option<f64>) -> String {
    match value {
        Some(value) if value.is_finite() => number(value),
        _ => "none".to_owned(),
    }
}
