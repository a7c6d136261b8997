//! The programs' servos around the simulated device: the torque that a hand feels.

use analysis::compare_run::{Input, RunOutcome, run_with_backend};
use analysis::program::{ALL, Program};
use analysis::toolchain::NumberFormat;
use haptic_servo::torque::LimitReason;

fn outcome(program: &Program, format: NumberFormat) -> RunOutcome {
    let mut controller = program.controller(format, &program.transducers).unwrap();
    run_with_backend(
        Input::Hand(Box::new(program.device())),
        controller.as_mut(),
        None,
        5000,
        || {},
    )
    .unwrap()
}

#[test]
fn no_hand_gets_back_more_than_it_put_in_and_the_device_comes_to_rest() {
    for program in ALL {
        for format in NumberFormat::ALL {
            let outcome = outcome(program, format);
            let energy = outcome.energy.unwrap();
            assert!(energy.given > 1e-3, "{}: the hand does something", program.name);
            assert!(energy.got_back < energy.given, "{} in {format}: {energy:?}", program.name);
            let speed = outcome.final_speed.unwrap();
            assert!(speed < 0.1, "{} in {format} still turns at {speed} rad/s", program.name);
        }
    }
}

#[test]
fn the_wall_is_felt_on_one_side_and_only_pushes() {
    let wall = Program::find("damper_wall").unwrap();
    let run = outcome(wall, NumberFormat::F32).run;
    assert!(run.peak_torque() > 0.3, "the hand reaches the wall");
    assert!(run.ticks.iter().any(|tick| tick.angle < -0.04), "and goes out of it");
    for (before, tick) in run.ticks.iter().zip(&run.ticks[1..]) {
        assert!(tick.torque >= 0.0 && tick.code <= 2048);
        assert!(before.angle > -0.01 || tick.torque == 0.0, "no torque outside: {tick:?}");
        assert_eq!(tick.limit, LimitReason::None);
    }
}
