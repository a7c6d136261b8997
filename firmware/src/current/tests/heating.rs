//! The limit of the torque by the heat of the current.

use super::*;

/// Full scale is 20 A, and the current of 10 A may last.
const HOT: CurrentLoop = {
    let stage = PowerStage { continuous_current: 10.0, ..STAGE };
    let motor = Motor { resistance: 0.1, inductance: 0.05e-3, ..DRIVE.motor };
    let drive = Drive { motor, ..DRIVE };
    let transducers = Transducers { full_scale_torque: 1.0, ..TRANSDUCERS };
    CurrentLoop::checked(&drive, &stage, &transducers, PERIOD)
};

/// The currents in A at the ends of so many seconds, for a servo that wants this current, with a limit that steps by
/// a hundredth of full scale.
fn currents(heating: &mut Heating, limit: &mut f64, wanted: f64, seconds: usize) -> Vec<f64> {
    let second = |limit: &mut f64, heating: &mut Heating| {
        let mut current = 0.0;
        for _ in 0..1000 {
            current = wanted.min(*limit);
            let code = (current / 20.0 * 1791.0).round() as i16;
            match heating.observe(current as f32, code) {
                Some(HeatStep::Lower) => *limit = (*limit - 0.2).max(0.0),
                Some(HeatStep::Raise) => *limit = (*limit + 0.2).min(20.0),
                None => {}
            }
        }
        current
    };
    (0..seconds).map(|_| second(limit, heating)).collect()
}

#[test]
fn the_peak_falls_to_the_continuous_current_and_comes_back_after_a_rest() {
    let (mut heating, mut limit) = (HOT.heating(), 20.0);
    let hot = currents(&mut heating, &mut limit, 20.0, 60);
    // From cold the square of 20 A reaches nine tenths of that of 10 A after 4 s times ln(400/310).
    assert!(hot[0] > 19.9 && hot[4] < 15.0, "{hot:?}");
    let end = hot[59];
    assert!((9.5..=10.3).contains(&end), "{end} A");
    let mean = hot[20..].iter().map(|current| current * current).sum::<f64>() / 40.0;
    assert!(mean.sqrt() < 10.5, "{} A", mean.sqrt());
    currents(&mut heating, &mut limit, 0.0, 5);
    assert!(limit > 19.9, "{limit} A");
}

#[test]
fn the_continuous_current_is_never_limited() {
    let (mut heating, mut limit) = (HOT.heating(), 20.0);
    currents(&mut heating, &mut limit, 9.9, 60);
    assert_eq!(limit, 20.0);
    // Nor any current of a loop whose full scale the board bears.
    let mut heating = BRUSHED.heating();
    assert!((0..100_000).all(|_| heating.observe(4.0, 1791).is_none()));
}
