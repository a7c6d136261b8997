//! The alignment of a brushless motor: on request only, never beside a scene, and gone with any fault.

use super::board::NO_MOTOR;
use super::*;
use crate::current::PowerFault;

/// A board whose motor is being aligned, for so many ticks.
fn aligning(ticks: u32) -> Bench<Environment, f32, Latched> {
    let mut bench = Bench::boot(&SPRING, Board { alignment: Some(ticks), ..Board::new() }).unwrap();
    bench.requests.align();
    bench.stand(0, 1);
    assert_eq!(bench.notices(), [Notice::Aligning]);
    assert_eq!(bench.servo_loop.state(), State::Aligning);
    bench.board.events.clear();
    bench
}

#[test]
fn ends_by_itself_without_a_torque_of_the_scene() {
    let mut bench = aligning(100);
    bench.stand(500, 50);
    assert_eq!(bench.servo_loop.state(), State::Aligning);
    bench.stand(700, 60);
    assert_eq!(bench.servo_loop.state(), State::Disarmed);
    assert!(bench.board.codes().iter().all(|code| *code == 2048));
    assert!(!bench.board.is_on());
}

#[test]
fn a_fault_ends_it_and_takes_the_gates_away() {
    let mut bench = aligning(100);
    let fault = Fault::Power(PowerFault::OverCurrent { current: 9000, largest: 8000 });
    bench.board.output_event = Some(OutputEvent::Fault(fault));
    bench.stand(0, 1);
    assert_eq!((bench.servo_loop.state(), bench.servo_loop.fault()), (State::Faulted, Some(fault)));
    assert_eq!(bench.notices(), [Notice::Stopped(fault)]);
    assert_eq!(
        bench.board.events.iter().filter(|event| **event == Event::Amplifier(false)).count(),
        1
    );
    let mut bench = aligning(100);
    bench.board.passed = 5;
    bench.stand(0, 1);
    assert_eq!(bench.servo_loop.state(), State::Faulted);
}

#[test]
fn disarming_ends_it_and_arming_waits_for_its_end() {
    let mut bench = aligning(100);
    bench.requests.arm();
    bench.stand(0, 1);
    assert_eq!(
        bench.notices(),
        [Notice::NotArmed(Fault::Power(PowerFault::NotAligned { by_index: false }))]
    );
    assert_eq!(bench.servo_loop.state(), State::Aligning);
    bench.requests.disarm();
    bench.stand(0, 1);
    assert_eq!(bench.notices(), [Notice::Disarmed]);
    assert_eq!(bench.servo_loop.state(), State::Disarmed);
    assert!(!bench.board.is_on());
}

#[test]
fn is_refused_by_an_armed_servo_and_by_a_board_without_such_a_motor() {
    let mut bench = running(&SPRING, 500);
    bench.board.alignment = Some(100);
    bench.requests.align();
    bench.stand(500, 1);
    assert_eq!(bench.notices(), [Notice::NotAligning(None)]);
    assert_eq!(bench.servo_loop.state(), State::Running);
    let mut bench: Bench<Environment, f32, Latched> = Bench::boot(&SPRING, Board::new()).unwrap();
    bench.requests.align();
    bench.stand(0, 1);
    assert_eq!(bench.notices(), [Notice::NotAligning(Some(NO_MOTOR))]);
    assert_eq!(bench.servo_loop.state(), State::Disarmed);
}
