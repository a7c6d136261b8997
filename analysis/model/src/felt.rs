//! The effect of a scene on the hand: stiffness and torque at the handle, and damping in free motion.
//!
//! Coupling and environment are two springs in series: a torque `F` moves the handle by `V F` more than the
//! environment's position, where `V` is the coupling's compliance at rest.

use haptic_servo::environment::{Ends, Environment, FULL_SCALE, Profile, Rational};
use haptic_servo::matched::MatchedCoupling;
use haptic_servo::number::Format;
use haptic_servo::rendering::context_beside_anticogging;
use haptic_servo::scene::{Coupling, Scene};

use crate::snap_branches;

/// Compliance in rad/(N m) at rest between handle and environment; 0 if they are rigidly connected, `None` if
/// the coupling does not exist. That of a matched coupling is about `(T + d + tau)/(2 delta)`, with all of its
/// delays and lags.
pub fn compliance(scene: &Scene) -> Option<f64> {
    let (at_rest, of_the_tick) = match scene.coupling {
        Coupling::Rigid => (0.0, 0.0),
        Coupling::Spring { stiffness } => (1.0 / stiffness, 1.0 / stiffness),
        Coupling::Matched => {
            let delta = context_beside_anticogging::<Environment>(scene, Format::F64).passivity;
            let timing = scene.timing;
            let matched = MatchedCoupling::of(
                timing.period,
                timing.worst_period,
                delta,
                &scene.latency,
                Format::F64,
            )?;
            (matched.compliance_at_rest().lo(), matched.compliance)
        }
    };
    // An undelayed torque profile is stated in front of the coupling, for the torque of the same tick (theory,
    // section 14.1).
    let is_in_front = scene.environment.profile().is_some_and(|profile| profile.delay == 0);
    Some(if is_in_front { at_rest - of_the_tick } else { at_rest })
}

/// Stiffness in N m/rad at the handle: the environment's where it is stiffest, in series with the coupling. A
/// wall adds to the steepest slope of a torque profile beside it.
///
/// `None` where there is none: if the torque at rest is not a function of the angle (an environment that is
/// stated by a bound, or a filter with a pole at `z = 1` without a coupling), or if the environment pulls
/// away more than the coupling holds.
pub fn stiffness(scene: &Scene) -> Option<f64> {
    let compliance = compliance(scene)?;
    let stiffness = match (&scene.environment, scene.environment.rational()) {
        (_, Some(rational)) => gain_at_rest(rational)?,
        (Environment::Parts(parts), None) => {
            let wall = parts.wall.map_or(0.0, |wall| wall.stiffness);
            wall + parts.profile.as_ref().map_or(0.0, steepest)
        }
        _ => return None,
    };
    let felt = if stiffness.is_infinite() {
        1.0 / compliance
    } else {
        stiffness / (1.0 + stiffness * compliance)
    };
    let is_held = stiffness * compliance > -1.0 || compliance == 0.0;
    (felt.is_finite() && is_held).then_some(felt)
}

/// Damping in N m s/rad that the hand feels outside of the wall: the device's, or that which a canceller
/// leaves of it, and that of dampers that act everywhere. `None` without free motion: with a filter, an
/// environment of another crate, or a wall on both sides.
pub fn free_damping(scene: &Scene) -> Option<f64> {
    let Environment::Parts(parts) = &scene.environment else { return None };
    if parts.wall.is_some_and(|wall| !wall.is_one_sided()) {
        return None;
    }
    let left = parts.canceller.map_or(scene.device.damping, |canceller| canceller.residual);
    Some(left + parts.damping_everywhere())
}

/// Torque of a filter at rest for 1 rad; infinite if it has a pole at `z = 1`.
fn gain_at_rest(rational: &Rational) -> Option<f64> {
    let [numerator, denominator] = [&rational.numerator, &rational.denominator]
        .map(|polynomial| polynomial.as_slice().iter().sum::<f64>());
    let numerator = if rational.unit_zeros > 0 { 0.0 } else { numerator };
    let gain = numerator / denominator;
    (!gain.is_nan()).then_some(gain)
}

/// The steepest rise in N m/rad of a torque profile, its end stops included.
fn steepest(profile: &Profile) -> f64 {
    let unit = profile.torque / f64::from(FULL_SCALE) * profile.knots_per_rad();
    let table = f64::from(profile.outline().rise) * unit;
    let stops = profile.ends.map_or(0.0, |Ends { stiffness, .. }| stiffness);
    table.max(stops) + profile.snap.map_or(0.0, |snap| snap_branches::slope(&snap, profile))
}

#[cfg(test)]
mod tests {
    use haptic_servo::environment::{Canceller, Rational, Wall};
    use haptic_servo::scene::Latency;

    use super::*;
    use crate::fixture::{STANDARD, file_on_paddle, on_paddle};
    use crate::profile_curve::ProfileCurve;

    fn near(a: Option<f64>, b: f64) {
        assert!(a.is_some_and(|a| (a - b).abs() <= 1e-9 * b.abs()), "{a:?} {b}");
    }

    #[test]
    fn a_wall_is_in_series_with_its_coupling() {
        let wall = |stiffness, coupling| on_paddle(Wall::spring(stiffness, 1).alone(), coupling);
        near(stiffness(&wall(22.0, STANDARD)), 44.0 / 3.0);
        near(stiffness(&wall(22.0, Coupling::Rigid)), 22.0);
        near(stiffness(&wall(1e9, STANDARD)), 44.0 / (1.0 + 44e-9));
        let latency = Latency::delayed(3e-4).with_actuator_lag(1.6e-4);
        let lagging = Scene { latency, ..wall(1e9, Coupling::Matched) };
        let matched = 2.0 * 0.022 / (1e-3 + 4.6e-4);
        near(stiffness(&lagging), matched / (1.0 + matched * 1e-9));
        assert_eq!(stiffness(&wall(-50.0, STANDARD)), None);
        near(stiffness(&wall(-50.0, Coupling::Rigid)), -50.0);
    }

    #[test]
    fn a_profile_is_felt_at_its_steepest() {
        for more in ["", "snap = 0.7\n"] {
            let text = format!(
                "[coupling]\nstiffness = 44.0\n[environment]\ntype = \"profile\"\ndelay = 1\n\
                 damping = 0.003\n[[environment.shape]]\ntype = \"detents\"\ncount = 24\n\
                 torque = 0.05\n{more}"
            );
            let scene = file_on_paddle(&text).scene;
            let slope = ProfileCurve::of(&scene).unwrap().rise.slope;
            near(stiffness(&scene), slope / (1.0 + slope / 44.0));
            near(free_damping(&scene), 0.025);
        }
    }

    #[test]
    fn a_filter_has_its_gain_at_rest_and_an_integrator_that_of_the_coupling() {
        let filter = |numerator: &[f64], denominator: &[f64], unit_zeros, coupling| {
            let rational = Rational::of(numerator, denominator).unwrap();
            let rational = Rational { delay: 1, unit_zeros, ..rational };
            on_paddle(Environment::Rational(rational), coupling)
        };
        near(stiffness(&filter(&[5.0, -2.0], &[1.0, -0.4], 0, Coupling::Rigid)), 5.0);
        assert_eq!(stiffness(&filter(&[5.0], &[1.0], 1, STANDARD)), Some(0.0));
        near(stiffness(&filter(&[1.0], &[1.0, -1.0], 0, STANDARD)), 44.0);
        assert_eq!(stiffness(&filter(&[1.0], &[1.0, -1.0], 0, Coupling::Rigid)), None);
        assert_eq!(stiffness(&filter(&[1.0, -1.0], &[1.0, -1.0], 0, STANDARD)), None);
        assert_eq!(free_damping(&filter(&[5.0], &[1.0], 0, STANDARD)), None);
    }

    #[test]
    fn free_motion_has_the_damping_of_the_device_or_what_is_left_of_it() {
        let free = |environment| free_damping(&on_paddle(environment, STANDARD));
        let wall = Wall::damped(22.0, 0.01, 1);
        assert_eq!(free(wall.behind(0.0).alone()), Some(0.022));
        assert_eq!(free(wall.alone()), None);
        assert_eq!(free(Canceller::to(0.003).alone()), Some(0.003));
    }
}
