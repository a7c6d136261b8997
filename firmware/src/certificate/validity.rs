//! The valid range of each number of a scene.

use super::linearity::is_static_at_port;
use crate::environment::{
    Canceller, Environment, EnvironmentModel, MOST_KNOTS, Parts, Profile, ProfileUse, StatedModel,
    is_late,
};
use crate::latency::{LONGEST_DELAY, LONGEST_LAG, TimeRange};
use crate::parameter::{Parameter, Range};
use crate::scene::Scene;
use crate::text::{Text, push};

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
        push!(*text, "the " {name} " is " {self.value});
        text.push_unit(unit);
        push!(*text, ", and must be " {self.bound});
        if let Some(limit) = self.limit {
            push!(*text, " " {limit});
            text.push_unit(unit);
        }
    }
}

/// The result of a check: the first number that is not as it must be.
type Checked = Result<(), InvalidParameter>;

/// The number is not as it must be.
const fn must_be(
    parameter: Parameter,
    value: f64,
    bound: &'static str,
    limit: Option<f64>,
) -> Checked {
    Err(InvalidParameter { parameter, value, bound, limit })
}

/// Without a hand, `Re(1/J)` approaches the device's damping at low speed.
const NO_MORE_THAN_DAMPING: &str =
    "finite and at most the device damping, which no device's passivity exceeds:";

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
        Range::Share => "from 0 to 1",
        Range::Whole(..) => "a whole number up to 8",
    }
}

/// Checks every number of a scene.
pub(super) const fn check(scene: &Scene) -> Checked {
    ok!(check_numbers::<Environment>(scene));
    if scene.latency.actuator_updates != 0 {
        ok!(check_updates(scene));
    }
    ok!(check_encoder(scene));
    ok!(check_range(Parameter::Delay, scene.environment.parts().longest_delay() as f64));
    let Some(rational) = scene.environment.rational() else { return Ok(()) };
    ok!(check_coefficients(Parameter::Numerator, rational.numerator.as_slice()));
    check_coefficients(Parameter::Denominator, rational.denominator.as_slice())
}

/// The same without polynomials, on which no bound for a board depends. A program omits the code for the
/// parts of torque profiles that its environment does not have, that for delays that no change alters, and the
/// text if it only needs to know whether a problem exists.
#[inline(always)]
pub(super) const fn check_numbers<E: EnvironmentModel>(scene: &Scene) -> Checked {
    let environment = &scene.environment;
    let (own, numbers) = (scene.own_numbers(), environment.numbers());
    let whole = [Parameter::Delay, Parameter::UnitZeros];
    let whole = match E::IS_SUM {
        true => [(whole[0], None), (whole[1], None)],
        false => [(whole[0], environment.get(whole[0])), (whole[1], environment.get(whole[1]))],
    };
    let lists: [&[(Parameter, Option<f64>)]; 3] = [&own, &numbers, &whole];
    each!(list in 0..lists.len() => {
        each!(i in 0..lists[list].len() => {
            if let (parameter, Some(value)) = lists[list][i] {
                ok!(check_number::<E>(scene, parameter, value, list > 0));
            }
        });
    });
    check_sum(environment.parts(), E::PROFILE)
}

const fn check_coefficients(parameter: Parameter, coefficients: &[f64]) -> Checked {
    each!(i in 0..coefficients.len() => {
        ok!(check_range(parameter, coefficients[i]));
    });
    Ok(())
}

/// Whether a number is in the range of all numbers of its kind.
#[inline(always)]
const fn check_range(parameter: Parameter, value: f64) -> Checked {
    let range = parameter.range();
    if range.admits(value) { Ok(()) } else { must_be(parameter, value, requirement(range), None) }
}

/// Whether a number of the scene is in its range, and agrees with the others.
#[inline(always)]
const fn check_number<E: EnvironmentModel>(
    scene: &Scene,
    parameter: Parameter,
    value: f64,
    is_environments: bool,
) -> Checked {
    ok!(check_range(parameter, value));
    ok!(check_beside_others::<E>(scene, parameter, value));
    if E::PROFILE.exists
        && is_environments
        && let Some(of) = profile_of(&scene.environment, parameter)
    {
        return check_profile(of, parameter, value, E::PROFILE);
    }
    Ok(())
}

/// Whether a number in its range agrees with the other numbers of the scene.
#[inline(always)]
const fn check_beside_others<E: EnvironmentModel>(
    scene: &Scene,
    parameter: Parameter,
    value: f64,
) -> Checked {
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
        _ if scene.latency.is_none() => return Ok(()),
        _ => return check_latency::<E>(scene, parameter, value),
    };
    must_be(parameter, value, bound, limit)
}

/// The torque profile that has the number: in a sum with a wall, stiffness and damping are the wall's.
const fn profile_of(environment: &Environment, parameter: Parameter) -> Option<&Profile> {
    match (environment.wall(), parameter) {
        (Some(_), Parameter::Stiffness | Parameter::Damping) => None,
        _ => environment.profile(),
    }
}

/// Whether the numbers of a sum agree, also those that have no name there.
const fn check_sum(parts: &Parts, has: ProfileUse) -> Checked {
    let Parts { canceller, wall, profile, .. } = parts;
    if parts.count() < 2 {
        return Ok(());
    }
    if let Some(Canceller { delay, .. }) = canceller
        && *delay > 0
    {
        let bound = "0 for a canceller beside another part";
        return must_be(Parameter::Delay, *delay as f64, bound, None);
    }
    let (Some(profile), true) = (profile, has.is_composed) else { return Ok(()) };
    if profile.delay == 0 {
        let bound = "at least 1 where another part is beside the torque profile";
        return must_be(Parameter::Delay, 0.0, bound, None);
    }
    let Some(wall) = wall else { return Ok(()) };
    let Some(ends) = profile.ends else {
        return must_be(Parameter::Face, wall.face(), BESIDE_ENDS, None);
    };
    let hidden = [
        (Parameter::Delay, wall.delay as f64),
        (Parameter::Stiffness, ends.stiffness),
        (Parameter::Damping, profile.damping()),
    ];
    each!(i in 0..hidden.len() => {
        let (parameter, value) = hidden[i];
        ok!(check_range(parameter, value));
        ok!(check_profile(profile, parameter, value, ProfileUse::ANY));
    });
    Ok(())
}

/// Without ends, a profile's angles are within a turn.
const BESIDE_ENDS: &str = "beside a torque profile with end stops: one without them repeats in every turn, \
                           and a wall stands in one of them";

/// The same of a number of a torque profile.
#[inline(always)]
const fn check_profile(
    profile: &Profile,
    parameter: Parameter,
    value: f64,
    has: ProfileUse,
) -> Checked {
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
                return Ok(());
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
            _ => return Ok(()),
        },
        (Parameter::Damping, _) if has.is_damped && value != 0.0 && profile.delay == 0 => {
            ("0 beside a torque profile that is not late", None)
        }
        _ => return Ok(()),
    };
    must_be(parameter, value, bound, limit)
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

/// [`Scene::largest_jitter`] of an environment of the type `E`.
const fn largest_jitter<E: EnvironmentModel>(scene: &Scene) -> f64 {
    scene.latency.largest_jitter(is_late::<E>(&scene.environment), scene.timing.period)
}

/// The same for a time between count and torque.
#[inline(always)]
const fn check_latency<E: EnvironmentModel>(
    scene: &Scene,
    parameter: Parameter,
    value: f64,
) -> Checked {
    let (period, latency) = (scene.timing.period, &scene.latency);
    let most_lag = (LONGEST_LAG * period, "at most a hundred periods:");
    let (TimeRange { least, .. }, (longest, bound)) = match parameter {
        Parameter::OutputDelay => {
            (latency.output_delay, (LONGEST_DELAY * period, "at most eight periods:"))
        }
        Parameter::OutputJitter if value > largest_jitter::<E>(scene) => {
            let largest = largest_jitter::<E>(scene);
            return must_be(parameter, value, NO_TORQUE_BEFORE, Some(largest));
        }
        Parameter::CountJitter => return check_count_jitter::<E>(scene, value),
        Parameter::ActuatorLag => (latency.actuator_lag, most_lag),
        Parameter::SensorLag => (latency.sensor_lag, most_lag),
        Parameter::ActuatorResponse => {
            let has_lag = !latency.actuator_lag.is_zero() || !latency.sensor_lag.is_zero();
            if has_lag && !latency.actuator_response.is_zero() {
                return must_be(parameter, value, NO_LAG_BESIDE, None);
            }
            (latency.actuator_response, (period, "at most the period:"))
        }
        _ => return Ok(()),
    };
    if value == 0.0 && least == 0.0 {
        Ok(())
    } else if !Range::NotNegative.admits(least) {
        must_be(parameter, least, requirement(Range::NotNegative), None)
    } else if value > longest {
        must_be(parameter, value, bound, Some(longest))
    } else if least > value {
        must_be(parameter, least, "at most the other end of its range:", Some(value))
    } else {
        Ok(())
    }
}

/// Whether the count jitter may be so large: alone, or beside an output jitter.
const fn check_count_jitter<E: EnvironmentModel>(scene: &Scene, value: f64) -> Checked {
    let (latency, largest) = (&scene.latency, largest_jitter::<E>(scene));
    let (beside, sum) = (latency.output_jitter, latency.total_jitter());
    let (bound, limit) = if !latency.jitters_twice() {
        if sum <= largest {
            return Ok(());
        }
        (NO_TORQUE_BEFORE, Some(largest))
    } else if sum > largest {
        (BESIDE_OUTPUT_JITTER[0], Some(largest - beside))
    } else {
        match latency.bound_on_two_jitters(scene.timing.period) {
            None => (BESIDE_OUTPUT_JITTER[1], None),
            Some(bound) if sum >= bound => (BESIDE_OUTPUT_JITTER[2], Some(bound - beside)),
            Some(_) => return Ok(()),
        }
    };
    must_be(Parameter::CountJitter, value, bound, limit)
}

/// Whether the numbers of the scene agree with an updated current loop. A board does not check this: with an
/// invalid number its coupling has no coefficients.
const fn check_updates(scene: &Scene) -> Checked {
    let (period, latency) = (scene.timing.period, &scene.latency);
    let worst = scene.timing.worst_period;
    let (parameter, value, bound, limit) = match worst {
        Some(worst) if worst != period => {
            (Parameter::WorstPeriod, worst, BESIDE_UPDATES[0], Some(period))
        }
        _ if latency.actuator_lag.least <= 0.0 => {
            (Parameter::ActuatorLag, latency.actuator_lag.least, BESIDE_UPDATES[1], None)
        }
        _ if !latency.output_delay.is_exact() => {
            (Parameter::OutputDelay, latency.output_delay.most, BESIDE_UPDATES[2], None)
        }
        _ if latency.delay_in_updates(period).is_none() => {
            let nearest = latency.delay_at_update(latency.nearest_update(period), period);
            (Parameter::OutputDelay, latency.output_delay.most, NO_WHOLE_UPDATES, Some(nearest))
        }
        _ => return Ok(()),
    };
    must_be(parameter, value, bound, limit)
}

/// Whether the readings of the encoder have a meaning, and the scene's times include them. A board has the
/// encoder of its program.
const fn check_encoder(scene: &Scene) -> Checked {
    let (latency, encoder) = (&scene.latency, scene.latency.encoder);
    let dropped = encoder.dropped as f64;
    let numbers = [
        (Parameter::Age, encoder.age.least),
        (Parameter::Age, encoder.age.most),
        (Parameter::Window, encoder.window),
        (Parameter::Linearity, encoder.linearity),
        (Parameter::Noise, encoder.noise),
        (Parameter::Hysteresis, encoder.hysteresis),
        (Parameter::Dropped, dropped),
    ];
    each!(i in 0..numbers.len() => {
        ok!(check_range(numbers[i].0, numbers[i].1));
    });
    let TimeRange { least, most } = encoder.age;
    if least > most {
        return must_be(Parameter::Age, least, "at most the other end of its range:", Some(most));
    }
    let is_included = latency.output_delay.least >= encoder.age.middle()
        && latency.count_jitter >= encoder.deviation_of_age();
    if !is_included {
        let (bound, limit) = (
            "a part of the output delay and the count jitter, of which the first is",
            latency.output_delay.least,
        );
        return must_be(Parameter::Age, most, bound, Some(limit));
    }
    let response = latency.actuator_response;
    if encoder.window > 0.0 && (response.least != 0.0 || response.most != encoder.window) {
        return must_be(Parameter::Window, encoder.window, NO_RESPONSE_BESIDE, None);
    }
    let period = scene.timing.period;
    let worst = or!(scene.timing.worst_period, period);
    let held = (dropped + 1.0) * period;
    if encoder.dropped > 0 && !is_static_at_port(scene) && worst < held {
        return must_be(Parameter::WorstPeriod, worst, HELD_WHILE_DROPPED, Some(held));
    }
    Ok(())
}

const NO_RESPONSE_BESIDE: &str = "0 beside a response or a lag of the amplifier";
const HELD_WHILE_DROPPED: &str = "as long as the torque is held while readings are dropped, because only a torque \
                                  of one position may come from an older reading: at least";

const BESIDE_UPDATES: [&str; 3] = [
    "that of the servo where the amplifier is updated in each period:",
    "greater than 0 where the amplifier is updated in each period",
    "known exactly where the amplifier is updated in each period",
];
const NO_WHOLE_UPDATES: &str =
    "a whole number of the amplifier's updates, of which the nearest is at";

#[cfg(test)]
mod tests {
    use crate::certificate::{Rejection, certify};
    use crate::environment::Wall;
    use crate::test_scene::scene;

    fn with_passivity(passivity: f64) -> Result<(), Rejection> {
        let mut scene = scene(Wall::spring(21.0, 1).alone());
        scene.device.passivity = Some(passivity);
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
