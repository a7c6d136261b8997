//! The cheapest sufficient number format for a scene.

use haptic_servo::certificate::QuantizationBound;
use haptic_servo::number::Arithmetic;
use serde::{Serialize, Serializer};

use super::{Losses, Motion};
use crate::quantity::significant;
use crate::studies::bench::CORE_CLOCK;
use crate::studies::error::StudyError;
use crate::verdict::AtRest;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Requirements {
    /// Largest torque of a limit cycle at rest in N m, peak to peak: by the format, and by the encoder.
    pub hum: f64,
    /// Largest error of the torque in N m, if there is one.
    pub error: Option<f64>,
    /// Largest fraction of a core's time for a tick.
    pub share: f64,
    pub rate: f64,
}

/// A format with its cost and its errors.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    pub format: &'static str,
    /// Largest number of instructions of a tick from count to code.
    pub instructions: f64,
    /// Fraction of the core's time at the rate.
    pub share: f64,
    /// Its errors; `None` if the format cannot represent the scene.
    pub losses: Option<Losses>,
    /// Certified bound on the torque's error, with encoder and DAC, and the device's friction
    /// against it; `None` without a bound.
    #[serde(serialize_with = "at_rest")]
    pub rest: Option<QuantizationBound>,
    /// The reasons for rejecting it; empty if it is sufficient.
    pub rejected: Vec<String>,
}

impl Candidate {
    /// Whether the device's friction ends every limit cycle of the stated encoder and DAC.
    pub fn is_still(&self) -> bool {
        is_still(self.rest.as_ref())
    }
}

fn is_still(rest: Option<&QuantizationBound>) -> bool {
    rest.is_some_and(|rest| rest.friction.is_some() && rest.comes_to_rest() != Some(false))
}

fn at_rest<S: Serializer>(rest: &Option<QuantizationBound>, to: S) -> Result<S::Ok, S::Error> {
    rest.as_ref().map(AtRest::of).serialize(to)
}

#[derive(Clone, Debug)]
pub struct Advice {
    pub candidates: Vec<Candidate>,
    /// Torque in N m of the limit cycle by the encoder alone, in the finest format; `None` if its
    /// resolution is not stated.
    pub encoder_hum: Option<f64>,
    /// The largest allowed limit cycle.
    hum: f64,
}

impl Advice {
    /// Evaluates all formats; `instructions` returns those of a tick in each.
    pub fn new(
        motion: &Motion,
        requirements: &Requirements,
        mut instructions: impl FnMut(Arithmetic) -> Result<f64, StudyError>,
    ) -> Result<Self, StudyError> {
        let mut candidates = Vec::new();
        let mut encoder_hum = None;
        for arithmetic in Arithmetic::ALL {
            let losses = match Losses::of(motion, arithmetic) {
                Ok(losses) => Ok(losses),
                Err(error @ (StudyError::Servo(_) | StudyError::Angle(_))) => Err(error),
                Err(error) => return Err(error),
            };
            if let (Arithmetic::F64, Ok(losses)) = (arithmetic, &losses) {
                encoder_hum = losses.with_encoder.map(|cycle| cycle.torque);
            }
            let instructions = match losses {
                Ok(_) => instructions(arithmetic)?,
                Err(_) => f64::INFINITY,
            };
            let rest = motion.problem().rest(arithmetic);
            candidates.push(candidate(arithmetic, instructions, losses, rest, requirements));
        }
        candidates.sort_by(|a, b| {
            a.instructions.total_cmp(&b.instructions).then(hum(a).total_cmp(&hum(b)))
        });
        Ok(Self { candidates, encoder_hum, hum: requirements.hum })
    }

    /// The cheapest format that satisfies the requirements, with the encoder if it is stated.
    pub fn choice(&self) -> Option<&Candidate> {
        let keep = || self.candidates.iter().filter(|candidate| candidate.rejected.is_empty());
        keep().find(|candidate| !self.hums(candidate)).or_else(|| keep().next())
    }

    /// Whether the encoder's limit cycle is above the bound, and no friction ends it.
    pub fn hums(&self, candidate: &Candidate) -> bool {
        !candidate.is_still() && self.encoder_hum.is_some_and(|hum| hum > self.hum)
    }
}

/// The limit cycle of a format at rest; of two formats with the same cost the smaller is better.
fn hum(candidate: &Candidate) -> f64 {
    candidate.losses.map_or(f64::INFINITY, |losses| losses.alone.torque)
}

fn candidate(
    arithmetic: Arithmetic,
    instructions: f64,
    losses: Result<Losses, StudyError>,
    rest: Option<QuantizationBound>,
    requirements: &Requirements,
) -> Candidate {
    let share = instructions * requirements.rate / CORE_CLOCK;
    let mut rejected = Vec::new();
    let mut beyond = |what: &str, value: f64, bound: f64, unit: &str| {
        if value > bound {
            let (value, bound) = (significant(value, 3), significant(bound, 3));
            rejected.push(format!("{what} {value}{unit} is above {bound}{unit}"));
        }
        value > bound
    };
    match &losses {
        Ok(losses) => {
            let hums = !is_still(rest.as_ref())
                && beyond("limit cycle", losses.alone.torque, requirements.hum, " N m");
            if let Some(bound) = requirements.error {
                let elsewhere = losses.error_elsewhere.unwrap_or_default();
                beyond("error", losses.error.max(elsewhere), bound, " N m");
            }
            if instructions.is_finite() {
                beyond("share of the core", 100.0 * share, 100.0 * requirements.share, " %");
            } else {
                let unknown = "instructions of its tick are not known: `--measure` counts them";
                rejected.push(unknown.to_owned());
            }
            let too_little = rest.filter(|rest| hums && rest.friction.is_some());
            rejected.extend(too_little.map(|rest| rest.to_string()));
        }
        Err(error) => rejected.push(error.to_string()),
    }
    let (format, losses) = (arithmetic.name(), losses.ok());
    Candidate { format, instructions, share, losses, rest, rejected }
}
