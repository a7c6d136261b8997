//! A stream of torques from a host at 1 kHz, over the board's serial port.

use analysis::link::Message;
use haptic_servo::dac::DacCode;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::host::{HostCommand, HostReport, HostRequest};
use haptic_servo::wire::message::ToBoard;
use virtual_board::chip::NUCLEO_G474RE;
use virtual_board::device::FixedDevice;

use crate::bench::{Bench, build};

/// N m for a code of the program's motor.
const STEP: f64 = 2.0 / DacCode::CODES_TO_FULL_SCALE as f64;

#[test]
fn a_stream_at_1_khz_loses_no_tick_and_no_report() {
    let files = build(&NUCLEO_G474RE, &["hosted_wall"]);
    let mut bench = Bench::boot_file(&NUCLEO_G474RE, &files[0], FixedDevice);
    bench.armed();
    bench.run(110);
    bench.hear();
    let before = bench.pins().samples.len();
    let mut states = Vec::new();
    let torque = |number: u16| 0.3 * (f32::from(number) * 0.02).sin();
    for number in 1..=1000 {
        let command = HostCommand { number, torque: torque(number), ramp: 0 };
        bench.say(&ToBoard::Host(HostRequest::Torque(command)));
        bench.run(1);
        states.extend(bench.hear().into_iter().filter_map(|message| match message {
            Message::Host(HostReport::State(state)) => Some(state),
            _ => None,
        }));
    }
    let codes: Vec<_> = bench.pins().samples[before..].iter().map(|sample| sample.code).collect();
    let status = bench.status();
    assert_eq!((status.missed, status.dropped, status.state), (0, 0, State::Running));
    assert!(states.len() >= 995, "{} reports", states.len());
    assert!(states.windows(2).all(|two| two[1].number == two[0].number + 1));
    assert!(states.iter().all(|state| state.refused == 0.0 && state.energy > 0.03), "{states:?}");
    // Each torque reaches the motor a fixed number of samples later.
    let given = |code: Option<u16>| (f64::from(code.unwrap()) - 2048.0) * STEP;
    let follows = |late: usize| {
        (100..900_u16).all(|number| {
            let code = given(codes[usize::from(number) + late]);
            (code - f64::from(torque(number))).abs() < STEP
        })
    };
    assert!((0..8).any(follows), "{:?}", &codes[..40]);
    println!("worst slack: {} timer counts", status.worst_slack);
}
