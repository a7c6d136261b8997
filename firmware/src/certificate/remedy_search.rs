//! The search for remedies: inverts the condition of a rejection for one number at a time.

use super::anticogging::passivity_for_anticogging;
use super::between::passes_upwards;
use super::digits::{Digits, Side};
use super::loop_intervals::LoopIntervals;
use super::problem::PassivityProblem;
use super::rejection::Rejection;
use super::remedy::{CANDIDATES, ORDER, Remedies, Remedy};
use super::varied::{FARTHEST, Varied};
use crate::environment::Environment;
use crate::number::Format;
use crate::parameter::Parameter;
use crate::scene::{Coupling, Scene};

/// The rejection with its remedies, if a remedy makes sense.
pub(super) const fn with_remedies(
    rejection: Rejection,
    scene: &Scene,
    format: Format,
) -> Rejection {
    let mut out = rejection;
    match &mut out {
        Rejection::Shortage { remedies, .. }
        | Rejection::Steep { remedies, .. }
        | Rejection::Missed { remedies, .. }
        | Rejection::Anticogging { remedies, .. }
        | Rejection::Coupling { remedies, .. }
        | Rejection::Undecided { remedies, .. } => *remedies = search(scene, format),
        Rejection::MotorByInl { anticogs: true, remedies, .. } => {
            let varied = Varied { scene, format, parameter: Parameter::Anticogging };
            if let Some(share) = varied.smaller_share() {
                remedies.put(CANDIDATES - 1, Some(Remedy::exactly(varied.parameter, share)));
            }
        }
        Rejection::UnstablePole { of_coupling: true, remedies, behind_standard, .. } => {
            *remedies = search(scene, format);
            *behind_standard = softer_behind_standard(scene, format);
        }
        _ => {}
    }
    out
}

const fn search(scene: &Scene, format: Format) -> Remedies {
    // The statement of another crate's environment may change with any number of the scene.
    if matches!(scene.environment, Environment::Stated(_)) {
        return Remedies::NONE;
    }
    let own = shortage(scene, format);
    let mut found = Remedies::NONE;
    if passes_behind_matched(scene, format) {
        found.put_matched();
    }
    each!(i in 0..CANDIDATES => {
        let parameter = match ORDER[i] {
            Parameter::Residual if scene.environment.profile().is_some() => {
                Parameter::ProfileTorque
            }
            Parameter::Damping
                if scene.environment.profile().is_some()
                    && scene.environment.canceller().is_some() =>
            {
                Parameter::Residual
            }
            parameter => parameter,
        };
        let varied = Varied { scene, format, parameter };
        let remedy = match ORDER[i] {
            // It includes the age of a reading, which is the encoder's.
            Parameter::OutputDelay if !scene.latency.encoder.age.is_zero() => None,
            // If only this number changes, the delay is no longer a whole number of updates.
            Parameter::Period | Parameter::OutputDelay if scene.latency.actuator_updates != 0 => {
                None
            }
            Parameter::Count => varied.fewer_repetitions(),
            Parameter::CouplingStiffness => standard_coupling(&varied),
            Parameter::Passivity => more_damping(scene, format),
            Parameter::Anticogging => less_anticogging(&varied),
            _ => varied.remedy(own),
        };
        found.put(i, remedy);
    });
    found
}

/// Whether a scene whose torques lag passes behind the matched coupling, if it has another coupling.
#[inline(never)]
const fn passes_behind_matched(scene: &Scene, format: Format) -> bool {
    if scene.latency.is_none() || matches!(scene.coupling, Coupling::Matched) {
        return false;
    }
    let matched = Scene { coupling: Coupling::Matched, ..*scene };
    match &PassivityProblem::in_format(&matched, format) {
        Ok(posed) => posed.is_certified(),
        Err(_) => false,
    }
}

/// The stiffness, to three digits on the soft side, with which the scene passes behind the standard coupling,
/// if that coupling alone is not sufficient. Not inlined, because of the frame of the second scene.
#[inline(never)]
const fn softer_behind_standard(scene: &Scene, format: Format) -> Option<(f64, Remedy)> {
    let numbers = LoopIntervals::of(scene, format);
    let standard = numbers.standard_stiffness().midpoint();
    let stiffness = Digits::of(standard, Side::Below).value();
    let standard = Scene { coupling: Coupling::Spring { stiffness }, ..*scene };
    let own = shortage(&standard, format);
    if matches!(own, Some(own) if own < 0.0) {
        return None;
    }
    let varied = Varied { scene: &standard, format, parameter: Parameter::Stiffness };
    let remedy = some!(varied.remedy(own));
    Some((stiffness, remedy))
}

/// The scene's own shortage.
#[inline(never)]
const fn shortage(scene: &Scene, format: Format) -> Option<f64> {
    let Ok(posed) = &PassivityProblem::in_format(scene, format) else { return None };
    posed.shortage()
}

/// The standard coupling, `2 delta / T`, if the scene passes with it and has another: with as few digits as
/// pass, on the soft side.
const fn standard_coupling(varied: &Varied) -> Option<Remedy> {
    let numbers = LoopIntervals::of(varied.scene, varied.format);
    if numbers.is_standard {
        return None;
    }
    let value = numbers.standard_stiffness().midpoint();
    let mut digits = Digits::of(value, Side::Below);
    if digits.value() != value && !varied.is_certified(value) {
        return None;
    }
    let mut count = 3;
    loop {
        if digits.are_read_back() && varied.is_certified(digits.value()) {
            return Some(Remedy::exactly(varied.parameter, digits.value()));
        }
        if count == Digits::MOST || digits.value() == value {
            return None;
        }
        count += 1;
        digits = Digits::so_many(count, value, Side::Below);
    }
}

/// A device with more damping or, if its passivity is declared, with more passivity, up to the damping. With
/// a canceller there is no such remedy, because the residual damping depends on it.
const fn more_damping(scene: &Scene, format: Format) -> Option<Remedy> {
    let cancels = scene.environment.canceller().is_some();
    let parameter = match scene.device.passivity {
        Some(_) => Parameter::Passivity,
        None if !cancels => Parameter::DeviceDamping,
        None => return None,
    };
    let numbers = LoopIntervals::of(scene, format);
    let Some(needed) = needed_passivity(scene, format) else { return None };
    // A longer worst period reduces the usable passivity.
    let scale = match scene.timing.worst_period {
        Some(worst) => worst / scene.timing.period,
        None => 1.0,
    };
    if needed > FARTHEST * numbers.delta.hi() {
        return None;
    }
    let varied = Varied { scene, format, parameter };
    let taken = or!(passivity_for_anticogging(scene, format), 0.0);
    match varied.certified(Digits::of(needed * scale + taken, Side::Above), Side::Above) {
        Some(value) if passes_upwards(scene, &numbers, (value - taken) / scale) => {
            Some(Remedy::at_least(parameter, value))
        }
        Some(value) => Some(Remedy::exactly(parameter, value)),
        None => None,
    }
}

/// A smaller share of the anticogging.
const fn less_anticogging(varied: &Varied) -> Option<Remedy> {
    let parameter = varied.parameter;
    let highest = some!(varied.smaller_share());
    Some(Remedy { parameter, lowest: varied.other_end(highest), highest: Some(highest) })
}

/// Not inlined, like the function that it calls.
#[inline(never)]
const fn needed_passivity(scene: &Scene, format: Format) -> Option<f64> {
    let Ok(posed) = &PassivityProblem::in_format(scene, format) else { return None };
    posed.needed_passivity()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::certify;
    use crate::environment::{Profile, Rational, Shape, Wall};
    use crate::scene::Latency;
    use crate::test_scene;

    fn scene(stiffness: f64, coupling: Coupling) -> Scene {
        Scene { coupling, ..test_scene::scene(Wall::damped(stiffness, 0.01, 1).alone()) }
    }

    /// An undelayed wall beyond a face, whose torque lags: a bound asks for a softer one behind a spring.
    #[test]
    fn a_face_behind_a_lag_passes_behind_the_matched_coupling() {
        let wall = Wall::damped(100.0, 0.0, 0).behind(0.0);
        let lagging = Scene {
            environment: wall.alone(),
            latency: Latency::delayed(1e-5).with_actuator_lag(5.3e-5),
            ..scene(100.0, Coupling::Spring { stiffness: 44.0 })
        };
        let rejection = certify(&lagging).unwrap_err();
        assert!(rejection.remedies().matched().is_some(), "{rejection}");
        let sentence = rejection.to_string();
        assert!(sentence.contains("; it would pass behind the matched coupling, or with period"));
        assert!(certify(&Scene { coupling: Coupling::Matched, ..lagging }).is_ok());
        // Nothing lags, or nothing helps.
        let at_once = scene(100.0, Coupling::Spring { stiffness: 44.0 });
        let active = Wall { stiffness: -1.0, ..wall };
        let pulling = Scene { environment: active.alone(), ..lagging };
        for scene in [at_once, pulling] {
            assert_eq!(certify(&scene).unwrap_err().remedies().matched(), None);
        }
    }

    /// The README's wall, too stiff for its device and with a coupling that makes it swing by itself.
    #[test]
    fn a_pole_that_the_coupling_makes_has_remedies() {
        for coupling in [Coupling::Rigid, Coupling::Spring { stiffness: 1e4 }] {
            let rejection = certify(&scene(100.0, coupling)).unwrap_err();
            let sentence = rejection.sentence();
            let sentence = sentence.as_str();
            assert_eq!(rejection.reason(), "unstable_pole", "{sentence}");
            assert!(sentence.contains("behind this coupling"), "{sentence}");
            let softer = rejection.remedies().iter().find_map(|remedy| match remedy.parameter {
                Parameter::Stiffness => remedy.highest,
                _ => None,
            });
            let softer = softer.unwrap_or_else(|| panic!("{sentence}"));
            assert!(certify(&scene(softer, coupling)).is_ok(), "{sentence}");
            let Rejection::UnstablePole { behind_standard: Some((stiffness, remedy)), .. } =
                rejection
            else {
                panic!("{sentence}");
            };
            let (standard, most) = (Coupling::Spring { stiffness }, remedy.highest.unwrap());
            assert_eq!((stiffness, most), (44.0, 23.9), "{sentence}");
            assert!(most > softer && certify(&scene(most, standard)).is_ok(), "{sentence}");
        }
        // Nothing is said of a coupling where the environment swings alone.
        let mut alone = scene(20.0, Coupling::Rigid);
        alone.environment = Environment::Rational(Rational::of(&[1.0], &[1.0, -1.5]).unwrap());
        let rejection = certify(&alone).unwrap_err();
        assert_eq!((rejection.reason(), rejection.remedies()), ("unstable_pole", Remedies::NONE));
        assert!(!rejection.to_string().contains("coupling"), "{rejection}");
    }

    fn detents(count: u32, torque: f64, delay: usize, coupling: Coupling) -> Scene {
        let units = vec![0; 16].leak();
        let profile = Profile::sampled(&[Shape::detents(count, torque)], units, delay).unwrap();
        Scene { environment: profile.alone(), ..scene(0.0, coupling) }
    }

    /// The largest values by the formulas of the theory: slope `4 count torque / (2 pi)`, to be below
    /// `2 delta / T` behind the coupling a sample late, at the port below `delta / (1.5 T)`, and without
    /// delay below the coupling's.
    #[test]
    fn a_profile_that_is_too_steep_has_remedies() {
        let standard = Coupling::Spring { stiffness: 44.0 };
        let cases = [
            (24, 5.0, 1, standard, 44.0, None),
            (24, 1.0, 1, Coupling::Rigid, 22.0 / 1.5, Some(22.0 / 1.5)),
            (1000, 0.5, 2, standard, 44.0 / 3.0, None),
            (24, 5.0, 0, standard, 44.0, None),
        ];
        for (count, torque, delay, coupling, slope, at_port) in cases {
            let scene = detents(count, torque, delay, coupling);
            let rejection = certify(&scene).unwrap_err();
            let sentence = rejection.sentence();
            let sentence = sentence.as_str();
            let found = |parameter| {
                rejection.remedies().iter().find(|remedy| remedy.parameter == parameter)
            };
            let most = |parameter| {
                let remedy: Remedy = found(parameter).unwrap_or_else(|| panic!("{sentence}"));
                assert_eq!(remedy.lowest, None, "{sentence}");
                let highest = remedy.highest.unwrap();
                assert!(certify(&scene.with(parameter, highest).unwrap()).is_ok(), "{sentence}");
                for part in [0.5, 0.1] {
                    let less = (part * highest).ceil().min(highest);
                    let less = if parameter == Parameter::Count { less } else { part * highest };
                    assert!(certify(&scene.with(parameter, less).unwrap()).is_ok(), "{sentence}");
                }
                highest
            };
            let per_torque = 4.0 * f64::from(count) / core::f64::consts::TAU;
            let limit = slope / per_torque;
            let highest = most(Parameter::ProfileTorque);
            assert!(highest < limit && highest > 0.99 * limit, "{limit}: {sentence}");
            let fewer = most(Parameter::Count);
            let fewest = slope / (4.0 * torque / core::f64::consts::TAU);
            assert_eq!(fewer, fewest.floor(), "{sentence}");
            assert!(sentence.contains(&format!("turn <= {fewer}")), "{sentence}");
            match at_port {
                Some(slope) => {
                    let limit = 1e-3 * slope / (per_torque * torque);
                    let period = most(Parameter::Period);
                    assert!(period < limit && period > 0.99 * limit, "{limit}: {sentence}");
                    let least = found(Parameter::DeviceDamping).unwrap().lowest.unwrap();
                    assert!((least - 1.5e-3 * per_torque * torque).abs() < 1e-3, "{sentence}");
                    let mut more = scene;
                    more.device.damping = least;
                    assert!(certify(&more).is_ok(), "{sentence}");
                }
                None => assert!(found(Parameter::Period).is_none() || delay != 1, "{sentence}"),
            }
            assert!(found(Parameter::Residual).is_none(), "{sentence}");
        }
    }
}
