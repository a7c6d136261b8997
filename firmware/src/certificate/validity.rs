//! The valid range of each number of a scene.

use crate::environment::{
    Canceller, Environment, MOST_KNOTS, Parts, Profile, ProfileUse, StatedModel,
};
use crate::latency::{LONGEST_DELAY, LONGEST_LAG, TimeRange};
use crate::parameter::{Parameter, Range};
use crate::scene::Scene;
use crate::text::Text;

/// A number that is invalid in any scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidParameter {
    /// Which number.
    pub parameter: Parameter,
    /// Its value.
    pub value: f64,
    /// Its valid range.
    pub bound: &'static str,
    /// The number of the scene at the end of the text of `bound`, in the same unit; `None` if `bound` is
    /// complete.
    pub limit: Option<f64>,
}

impl InvalidParameter {
    /// "the period is 0 s, and must be finite and greater than 0"
    pub(super) const fn write<const N: usize>(&self, text: &mut Text<N>) {
        let (name, unit) = self.parameter.name_and_unit();
        text.push("the ");
        text.push(name);
        text.push(" is ");
        text.push_number(self.value);
        if !unit.is_empty() {
            text.push(" ");
            text.push(unit);
        }
        text.push(", and must be ");
        text.push(self.bound);
        if let Some(limit) = self.limit {
            text.push(" ");
            text.push_number(limit);
            if !unit.is_empty() {
                text.push(" ");
                text.push(unit);
            }
        }
    }
}

/// Without a hand, `Re(1/J)` approaches the device's damping at low speed.
const NO_MORE_THAN_DAMPING: &str =
    "finite and at most the device damping, which no device's passivity exceeds:";

const NO_LONGER_DELAY: &str = "at most eight periods:";
const NO_LONGER_LAG: &str = "at most a hundred periods:";
const NO_LONGER_RESPONSE: &str = "at most the period:";
const NO_LAG_BESIDE: &str = "0 beside a lag of amplifier or sensor";
/// No torque comes before its count.
const NO_TORQUE_BEFORE: &str = "at most the time from a count to its torque:";

/// Beside an output jitter, what the proof for both requires (theory, section 13.4).
const BESIDE_OUTPUT_JITTER: [&str; 3] = [
    "at most the time from a count to its torque, less the output jitter:",
    "0 beside an output jitter and a lag that is known in a range",
    "below half of what the ranges of delay and response leave of a period, less the output jitter:",
];

const fn requirement(range: Range) -> &'static str {
    match range {
        Range::Finite => "finite",
        Range::Positive => "finite and greater than 0",
        Range::NotNegative => "finite and not below 0",
        Range::Fraction => "at least 0 and below 1",
        Range::Whole(..) => "a whole number up to 8",
    }
}

/// The first number of the scene that is out of its range.
pub(super) const fn first_invalid(scene: &Scene) -> Option<InvalidParameter> {
    if let Some(invalid) = first_invalid_number(scene, ProfileUse::ANY) {
        return Some(invalid);
    }
    if scene.latency.actuator_updates != 0
        && let Some(conflict) = updates_conflict(scene)
    {
        return Some(conflict);
    }
    let Some(rational) = scene.environment.rational() else { return None };
    match first_not_finite(rational.numerator.as_slice()) {
        Some(value) => Some(not_finite(Parameter::Numerator, value)),
        None => match first_not_finite(rational.denominator.as_slice()) {
            Some(value) => Some(not_finite(Parameter::Denominator, value)),
            None => None,
        },
    }
}

/// The same without polynomials, on which no bound for a board depends. A program omits the code for the
/// parts of torque profiles that its environment does not have, and the text if it only needs to know whether
/// a problem exists.
#[inline(always)]
pub(super) const fn first_invalid_number(
    scene: &Scene,
    profile: ProfileUse,
) -> Option<InvalidParameter> {
    let environment = &scene.environment;
    let (own, numbers) = (scene.own_numbers(), environment.numbers());
    let whole = [
        (Parameter::Delay, environment.get(Parameter::Delay)),
        (Parameter::UnitZeros, environment.get(Parameter::UnitZeros)),
    ];
    let lists: [&[(Parameter, Option<f64>)]; 3] = [&own, &numbers, &whole];
    let mut list = 0;
    while list < lists.len() {
        let mut i = 0;
        while i < lists[list].len() {
            if let (parameter, Some(value)) = lists[list][i]
                && let Some(invalid) = invalid(scene, parameter, value, profile, list > 0)
            {
                return Some(invalid);
            }
            i += 1;
        }
        list += 1;
    }
    sum_conflict(environment.parts(), profile)
}

/// A number that is out of the range of all numbers of its kind.
#[inline(always)]
const fn out_of_range(parameter: Parameter, value: f64) -> Option<InvalidParameter> {
    if parameter.range().admits(value) {
        return None;
    }
    let bound = requirement(parameter.range());
    Some(InvalidParameter { parameter, value, bound, limit: None })
}

/// The fault of a number of the scene: it is out of its range or conflicts with another.
#[inline(always)]
const fn invalid(
    scene: &Scene,
    parameter: Parameter,
    value: f64,
    profile: ProfileUse,
    is_environments: bool,
) -> Option<InvalidParameter> {
    if let Some(out) = out_of_range(parameter, value) {
        return Some(out);
    }
    if let Some(conflict) = conflict(scene, parameter, value) {
        return Some(conflict);
    }
    if profile.exists
        && is_environments
        && let Some(of) = profile_of(&scene.environment, parameter)
    {
        return profile_conflict(of, parameter, value, profile);
    }
    None
}

/// A number in its range that conflicts with another number of the scene.
#[inline(always)]
const fn conflict(scene: &Scene, parameter: Parameter, value: f64) -> Option<InvalidParameter> {
    let (bound, limit) = match parameter {
        Parameter::Passivity if value > scene.device.damping => {
            (NO_MORE_THAN_DAMPING, Some(scene.device.damping))
        }
        Parameter::WorstPeriod if value < scene.timing.period => {
            ("finite and not below the period", None)
        }
        Parameter::Delay
            if value == 0.0
                && matches!(
                    scene.environment,
                    Environment::Stated(StatedModel::Bounded { .. })
                ) =>
        {
            ("at least 1 where no transfer function is stated", None)
        }
        _ if scene.latency.is_none() => return None,
        _ => return latency_conflict(scene, parameter, value),
    };
    Some(InvalidParameter { parameter, value, bound, limit })
}

/// The torque profile that has the number: in a sum with a wall, stiffness and damping are the wall's.
const fn profile_of(environment: &Environment, parameter: Parameter) -> Option<&Profile> {
    match (environment.wall(), parameter) {
        (Some(_), Parameter::Stiffness | Parameter::Damping) => None,
        _ => environment.profile(),
    }
}

/// A number of a sum that conflicts with another part, or has no name there.
const fn sum_conflict(parts: &Parts, has: ProfileUse) -> Option<InvalidParameter> {
    let Parts { canceller, wall, profile } = parts;
    if parts.count() < 2 {
        return None;
    }
    if let Some(Canceller { delay, .. }) = canceller
        && *delay > 0
    {
        let value = *delay as f64;
        let bound = "0 for a canceller beside another part";
        return Some(InvalidParameter { parameter: Parameter::Delay, value, bound, limit: None });
    }
    let Some(profile) = profile else { return None };
    if !has.is_composed {
        return None;
    }
    if profile.delay == 0 {
        let bound = "at least 1 where a wall or a canceller is beside the torque profile";
        return Some(InvalidParameter {
            parameter: Parameter::Delay,
            value: 0.0,
            bound,
            limit: None,
        });
    }
    let Some(wall) = wall else { return None };
    let Some(ends) = profile.ends else {
        let (parameter, value) = (Parameter::Face, wall.face());
        return Some(InvalidParameter { parameter, value, bound: BESIDE_ENDS, limit: None });
    };
    let hidden = [
        (Parameter::Delay, wall.delay as f64),
        (Parameter::Stiffness, ends.stiffness),
        (Parameter::Damping, profile.damping()),
    ];
    let mut i = 0;
    while i < hidden.len() {
        let (parameter, value) = hidden[i];
        if let Some(out) = out_of_range(parameter, value) {
            return Some(out);
        }
        if let Some(invalid) = profile_conflict(profile, parameter, value, ProfileUse::ANY) {
            return Some(invalid);
        }
        i += 1;
    }
    None
}

/// Without ends, a profile's angles are within a turn.
const BESIDE_ENDS: &str = "beside a torque profile with end stops: one without them repeats in every turn, \
                           and a wall stands in one of them";

/// The same of a number of a torque profile.
#[inline(always)]
const fn profile_conflict(
    profile: &Profile,
    parameter: Parameter,
    value: f64,
    has: ProfileUse,
) -> Option<InvalidParameter> {
    let outline = profile.outline();
    let cell = 1.0 / profile.knots_per_rad();
    let most = MOST_KNOTS as f64 / outline.knots as f64;
    let (bound, limit) = match (parameter, profile.ends) {
        (Parameter::Count, _) if value > most => ("finite, greater than 0 and at most", Some(most)),
        (Parameter::Count, None) if value as u32 as f64 != value => {
            ("a whole number where the profile has no end stops", None)
        }
        (Parameter::Centre, _) if value.abs() > LARGEST_ANGLE => {
            ("of a magnitude up to", Some(LARGEST_ANGLE))
        }
        (Parameter::From | Parameter::To, _)
            if (value - profile.centre).abs() > MOST_KNOTS as f64 * cell =>
        {
            ("no farther from the profile's centre than, in rad,", Some(MOST_KNOTS as f64 * cell))
        }
        (Parameter::From, Some(ends)) if value >= ends.to => {
            ("below the upper end stop:", Some(ends.to))
        }
        (Parameter::From, Some(_)) if !outline.wraps && value < profile.centre + 0.5 * cell => {
            ("within the table of the profile: at least", Some(profile.centre + 0.5 * cell))
        }
        (Parameter::To, Some(_)) if has.snaps && holds_nothing(profile) => {
            ("such that the centre of a detent with a snap point is between the end stops", None)
        }
        (Parameter::To, Some(_)) if !outline.wraps => {
            let last = profile.centre + (outline.knots as f64 - 1.5) * cell;
            if value <= last {
                return None;
            }
            ("within the table of the profile: at most", Some(last))
        }
        (Parameter::Stiffness, Some(_)) if value <= 0.0 => {
            ("greater than 0 beyond end stops", None)
        }
        (Parameter::Mode, _) if has.has_modes => match &profile.modes {
            Some(modes) if modes.index().is_none() => {
                ("a whole number from 0 to", Some(modes.last() as f64))
            }
            _ => return None,
        },
        (Parameter::Damping, _) if has.is_damped && value != 0.0 && profile.delay == 0 => {
            ("0 beside a torque profile that is not late", None)
        }
        _ => return None,
    };
    Some(InvalidParameter { parameter, value, bound, limit })
}

/// Whether a profile has detents with a snap point, none of them between its ends.
const fn holds_nothing(profile: &Profile) -> bool {
    match &profile.snap {
        Some(snap) => {
            let (lowest, highest) = snap.branches(&profile.layout());
            lowest > highest
        }
        None => false,
    }
}

/// In rad: beyond a few turns, a centre is equivalent to another centre of the same profile.
const LARGEST_ANGLE: f64 = 100.0;

/// The same for a time between count and torque.
#[inline(always)]
const fn latency_conflict(
    scene: &Scene,
    parameter: Parameter,
    value: f64,
) -> Option<InvalidParameter> {
    let (period, latency) = (scene.timing.period, &scene.latency);
    let (range, longest) = match parameter {
        Parameter::OutputDelay => (latency.output_delay, LONGEST_DELAY * period),
        Parameter::OutputJitter if value > scene.largest_jitter() => {
            let limit = Some(scene.largest_jitter());
            return Some(InvalidParameter { parameter, value, bound: NO_TORQUE_BEFORE, limit });
        }
        Parameter::CountJitter => {
            return match count_jitter_conflict(scene) {
                Some((bound, limit)) => Some(InvalidParameter { parameter, value, bound, limit }),
                None => None,
            };
        }
        Parameter::ActuatorLag => (latency.actuator_lag, LONGEST_LAG * period),
        Parameter::SensorLag => (latency.sensor_lag, LONGEST_LAG * period),
        Parameter::ActuatorResponse => {
            let has_lag = !latency.actuator_lag.is_zero() || !latency.sensor_lag.is_zero();
            if has_lag && !latency.actuator_response.is_zero() {
                let bound = NO_LAG_BESIDE;
                return Some(InvalidParameter { parameter, value, bound, limit: None });
            }
            (latency.actuator_response, period)
        }
        _ => return None,
    };
    if value == 0.0 && range.least == 0.0 {
        return None;
    }
    let TimeRange { least, .. } = range;
    if !Range::NotNegative.admits(least) {
        return Some(InvalidParameter {
            parameter,
            value: least,
            bound: requirement(Range::NotNegative),
            limit: None,
        });
    }
    let (value, bound, limit) = if value > longest {
        let bound = match parameter {
            Parameter::OutputDelay => NO_LONGER_DELAY,
            Parameter::ActuatorResponse => NO_LONGER_RESPONSE,
            _ => NO_LONGER_LAG,
        };
        (value, bound, longest)
    } else if least > value {
        (least, "at most the other end of its range:", value)
    } else {
        return None;
    };
    Some(InvalidParameter { parameter, value, bound, limit: Some(limit) })
}

/// What the count jitter must be, if it is not: alone, or beside an output jitter.
const fn count_jitter_conflict(scene: &Scene) -> Option<(&'static str, Option<f64>)> {
    let (latency, largest) = (&scene.latency, scene.largest_jitter());
    let (beside, sum) = (latency.output_jitter, latency.total_jitter());
    if !latency.jitters_twice() {
        return if sum > largest { Some((NO_TORQUE_BEFORE, Some(largest))) } else { None };
    }
    if sum > largest {
        return Some((BESIDE_OUTPUT_JITTER[0], Some(largest - beside)));
    }
    match latency.bound_on_two_jitters(scene.timing.period) {
        None => Some((BESIDE_OUTPUT_JITTER[1], None)),
        Some(bound) if sum >= bound => Some((BESIDE_OUTPUT_JITTER[2], Some(bound - beside))),
        Some(_) => None,
    }
}

/// A number of the scene that conflicts with an updated current loop. A board does not check this: with an
/// invalid number its coupling has no coefficients.
const fn updates_conflict(scene: &Scene) -> Option<InvalidParameter> {
    let (period, latency) = (scene.timing.period, &scene.latency);
    let worst = scene.timing.worst_period;
    let (parameter, value, bound, limit) = match worst {
        Some(worst) if worst != period => {
            (Parameter::WorstPeriod, worst, BESIDE_UPDATES[0], Some(period))
        }
        _ if latency.actuator_lag.least <= 0.0 => {
            (Parameter::ActuatorLag, latency.actuator_lag.least, BESIDE_UPDATES[1], None)
        }
        _ if !latency.sensor_lag.is_zero() => {
            (Parameter::SensorLag, latency.sensor_lag.most, BESIDE_UPDATES[2], None)
        }
        _ if !latency.actuator_response.is_zero() => {
            (Parameter::ActuatorResponse, latency.actuator_response.most, BESIDE_UPDATES[2], None)
        }
        _ if !latency.output_delay.is_exact() => {
            (Parameter::OutputDelay, latency.output_delay.most, BESIDE_UPDATES[3], None)
        }
        _ if latency.delay_in_updates(period).is_none() => {
            let nearest = latency.delay_at_update(latency.nearest_update(period), period);
            (Parameter::OutputDelay, latency.output_delay.most, NO_WHOLE_UPDATES, Some(nearest))
        }
        _ => return None,
    };
    Some(InvalidParameter { parameter, value, bound, limit })
}

const BESIDE_UPDATES: [&str; 4] = [
    "that of the servo where the amplifier is updated in each period:",
    "greater than 0 where the amplifier is updated in each period",
    "0 where the amplifier is updated in each period",
    "known exactly where the amplifier is updated in each period",
];
const NO_WHOLE_UPDATES: &str =
    "a whole number of the amplifier's updates, of which the nearest is at";

const fn not_finite(parameter: Parameter, value: f64) -> InvalidParameter {
    InvalidParameter { parameter, value, bound: requirement(parameter.range()), limit: None }
}

const fn first_not_finite(coefficients: &[f64]) -> Option<f64> {
    let mut i = 0;
    while i < coefficients.len() {
        if !coefficients[i].is_finite() {
            return Some(coefficients[i]);
        }
        i += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Rejection, certify};
    use crate::environment::Wall;
    use crate::scene::{Coupling, Device, Latency, Timing};

    fn with_passivity(passivity: f64) -> Result<(), Rejection> {
        let wall = Wall::spring(21.0, 1);
        let scene = Scene {
            device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(passivity) },
            timing: Timing { period: 0.001, worst_period: None },
            coupling: Coupling::Spring { stiffness: 44.0 },
            environment: wall.alone(),
            latency: Latency::NONE,
            torque_limit: None,
        };
        certify(&scene).map(|_| ())
    }

    #[test]
    fn no_device_has_more_passivity_than_damping() {
        assert_eq!(with_passivity(0.022), Ok(()));
        for passivity in [0.022_f64.next_up(), 0.22, f64::MAX] {
            let refused = with_passivity(passivity).unwrap_err();
            assert!(matches!(refused, Rejection::Invalid(_)), "{refused:?}");
        }
        assert_eq!(
            with_passivity(0.22).unwrap_err().sentence().as_str(),
            "rejected: the device passivity is 0.22 N m s/rad, and must be finite and at most the \
             device damping, which no device's passivity exceeds: 0.022 N m s/rad"
        );
        // An invalid passivity keeps its own reason.
        for passivity in [0.0, -1.0] {
            let refused = with_passivity(passivity).unwrap_err();
            assert!(matches!(refused, Rejection::NoPassivity { .. }), "{refused:?}");
        }
        let infinite = with_passivity(f64::INFINITY).unwrap_err().sentence();
        assert!(infinite.as_str().ends_with("must be finite"), "{}", infinite.as_str());
    }
}
