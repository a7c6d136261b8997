//! What stops the servo, one test each; and that arming again is refused while the cause is there.

use super::*;
use crate::current::{HeatStep, PowerFault};
use crate::reset::ResetCause;

/// The servo has just been stopped by this fault: no torque, amplifier off, a record of it.
fn assert_stopped(bench: &mut Bench<Environment, f32, Latched>, fault: Fault) {
    assert_eq!(bench.servo_loop.state(), State::Faulted);
    assert_eq!(bench.servo_loop.fault(), Some(fault));
    assert!(!bench.board.is_on());
    assert_eq!(bench.board.codes().last(), Some(&2048));
    assert_eq!(bench.notices(), [Notice::Stopped(fault)]);
    let stored = FaultRecord::decode(&bench.board.stored).unwrap();
    assert_eq!((stored.fault, stored.count), (fault, bench.board.count));
    // It stays so, without torque for any motion of the device.
    bench.board.events.clear();
    bench.stand(bench.board.count, 50);
    assert!(bench.board.codes().iter().all(|code| *code == 2048) && !bench.board.is_on());
    assert_eq!(bench.servo_loop.fault(), Some(fault));
}

/// Arms again, which works: the clamp opens from nothing.
fn assert_armed_again(bench: &mut Bench<Environment, f32, Latched>) {
    bench.requests.arm();
    bench.stand(bench.board.count, 102);
    assert_eq!(bench.notices(), [Notice::Armed]);
    assert_eq!((bench.servo_loop.state(), bench.servo_loop.fault()), (State::Running, None));
    assert!(bench.board.is_on());
    assert_eq!(bench.board.stored, FaultRecord::NOTHING);
}

#[test]
fn a_tick_that_begins_late() {
    let mut bench = running(&SPRING, 500);
    bench.board.passed = 2;
    let frame = bench.tick(500);
    assert_eq!((frame.code.get(), frame.state), (2048, State::Faulted));
    assert_stopped(&mut bench, Fault::MissedTick { missed: 1, tolerated: 0 });
    assert_eq!(bench.status().missed, 1);
    assert_armed_again(&mut bench);
}

#[test]
fn a_tick_that_ends_late() {
    let mut bench = running(&SPRING, 500);
    bench.board.elapsed = PERIOD;
    let frame = bench.tick(500);
    assert_eq!((frame.slack, frame.state), (0, State::Faulted));
    assert_stopped(&mut bench, Fault::MissedTick { missed: 1, tolerated: 0 });
    assert_armed_again(&mut bench);
}

/// What the bridge of a motor board says, which has taken its gates away before.
const OVER_CURRENT: Fault = Fault::Power(PowerFault::OverCurrent { current: 9000, largest: 8000 });

#[test]
fn a_bridge_that_took_the_torque_away() {
    let mut bench = running(&SPRING, 500);
    bench.board.output_event = Some(OutputEvent::Fault(OVER_CURRENT));
    let frame = bench.tick(500);
    assert_eq!((frame.code.get(), frame.state), (2048, State::Faulted));
    assert_stopped(&mut bench, OVER_CURRENT);
    assert_armed_again(&mut bench);
}

/// As a supply that is too low before the gates are ever on.
#[test]
fn a_bridge_that_cannot_start_is_not_armed_until_it_can() {
    let mut bench: Bench<Environment, f32, Latched> = Bench::boot(&SPRING, Board::new()).unwrap();
    bench.board.output_event = Some(OutputEvent::Fault(OVER_CURRENT));
    bench.stand(0, 1);
    assert_eq!(bench.notices(), []);
    bench.requests.arm();
    bench.stand(0, 1);
    assert_eq!(bench.notices(), [Notice::NotArmed(OVER_CURRENT)]);
    assert!(!bench.board.is_on());
    bench.stand(0, 2000);
    assert_armed_again(&mut bench);
}

/// A spring that stands two missed updates in a row.
fn with_misses() -> Program<Environment> {
    let mut program = SPRING;
    program.scene.timing.worst_period = Some(3e-3);
    program.scene.environment.wall_mut().unwrap().stiffness = 2.5;
    program.scene.coupling = Coupling::Spring { stiffness: 14.0 };
    program
}

#[test]
fn the_worst_period_is_how_many_updates_may_be_missed_in_a_row() {
    let program = with_misses();
    let mut bench = running(&program, 500);
    for _ in 0..3 {
        (bench.board.passed, bench.board.elapsed) = (3, 1);
        bench.tick(500);
    }
    bench.tick(500);
    assert_eq!(bench.servo_loop.state(), State::Running);
    assert_eq!(bench.status().missed, 6);
    // One more than that.
    bench.board.passed = 4;
    bench.notices();
    bench.tick(500);
    assert_stopped(&mut bench, Fault::MissedTick { missed: 3, tolerated: 2 });
}

/// Its torque was solved for and never reached the motor: no certificate is of such a loop.
#[test]
fn no_worst_period_covers_a_code_that_is_late() {
    let mut bench = running(&with_misses(), 500);
    bench.board.elapsed = PERIOD;
    bench.tick(500);
    assert_stopped(&mut bench, Fault::MissedTick { missed: 1, tolerated: 0 });
}

/// The count is then another one than that at the beginning of the period.
#[test]
fn a_tick_that_begins_in_time_for_its_code_but_not_for_its_count() {
    let mut bench = running(&SPRING, 500);
    (bench.board.passed, bench.board.elapsed) = (BEGAN_LATE, 40);
    let tick = bench.tick(500).tick;
    assert_stopped(&mut bench, Fault::LateTick { late: 40, allowed: 1 });
    // It was one period, and no update was missed.
    assert_eq!((bench.tick(500).tick, bench.status().missed), (tick + 51, 0));
    assert_armed_again(&mut bench);
}

#[test]
fn where_updates_may_be_missed_a_tick_may_begin_late_instead() {
    let began = |ticks: &[(u32, u32)]| {
        let mut bench = running(&with_misses(), 500);
        for &(passed, late) in ticks {
            (bench.board.passed, bench.board.elapsed) = (passed, late);
            bench.tick(500);
        }
        bench.servo_loop.fault()
    };
    assert_eq!(began(&[(BEGAN_LATE, 490), (1, 0), (BEGAN_LATE, 490)]), None);
    // With half a period or less to the latch, any next tick would have to be too early.
    assert_eq!(began(&[(BEGAN_LATE, 510)]), Some(Fault::LateTick { late: 510, allowed: 500 }));
    // Two and a half periods, and the last two of three.
    assert_eq!(began(&[(2, 490)]), None);
    assert_eq!(began(&[(3, 40)]), Some(Fault::LateTick { late: 40, allowed: 1 }));
    // From a late count to its latch there is less time, of which three times has to be enough:
    // 3 (1 - 0.3) = 2.1 = 2 + 0.4 - 0.3.
    assert_eq!(began(&[(BEGAN_LATE, 300), (2, 399)]), None);
    let Some(Fault::LateTick { late: 402, allowed }) = began(&[(BEGAN_LATE, 300), (2, 402)]) else {
        panic!("it was not too late")
    };
    assert!((399..=401).contains(&allowed), "{allowed}");
    // After half a period, not even a tick that is in time may be missed.
    let error = began(&[(BEGAN_LATE, 500), (2, 1)]);
    assert_eq!(error, None);
    let error = began(&[(BEGAN_LATE, 500), (3, 1)]);
    assert_eq!(error, Some(Fault::LateTick { late: 1, allowed: 0 }));
}

#[test]
fn an_encoder_that_jumps() {
    // 100 rad/s are 977.8 counts a millisecond; one more for the encoder's edges.
    let mut bench = running(&SPRING, 500);
    bench.tick(500 + 978);
    assert_eq!(bench.servo_loop.state(), State::Running);
    bench.tick(500 - 1);
    assert_stopped(&mut bench, Fault::EncoderJump { counts: 979, largest: 978 });
    assert_armed_again(&mut bench);
}

#[test]
fn an_encoder_that_goes_on_jumping_keeps_the_servo_from_being_armed() {
    let mut bench = running(&SPRING, 0);
    let mut jumping = (0..).map(|k: i32| if k % 2 == 0 { 5000 } else { 0 });
    let mut jump = |bench: &mut Bench<_, _, _>| bench.tick(jumping.next().unwrap());
    jump(&mut bench);
    let fault = Fault::EncoderJump { counts: 5000, largest: 978 };
    assert_eq!(bench.notices(), [Notice::Stopped(fault)]);
    bench.requests.arm();
    jump(&mut bench);
    assert_eq!(bench.notices(), [Notice::NotArmed(fault)]);
    assert!(!bench.board.is_on());
    bench.stand(0, 20);
    assert_armed_again(&mut bench);
}

#[test]
fn a_torque_that_is_not_a_number() {
    let mut bench = running(&SPRING, 500);
    bench.servo_loop.rendering.servo_mut().poison(f32::NAN);
    let frame = bench.tick(500);
    assert_eq!((frame.code, frame.limit), (DacCode::MID_SCALE, LimitReason::NotANumber));
    assert_stopped(&mut bench, Fault::NotANumber);
    assert_armed_again(&mut bench);
}

#[test]
fn a_fault_before_the_servo_is_armed_keeps_it_from_being_armed() {
    let mut board = Board::new();
    board.reset = ResetCause::IndependentWatchdog;
    let mut bench: Bench<Environment, f32, Latched> = Bench::boot(&SPRING, board).unwrap();
    bench.board.passed = 2;
    bench.requests.arm();
    bench.tick(0);
    assert_eq!(bench.notices(), [Notice::NotArmed(Fault::MissedTick { missed: 1, tolerated: 0 })]);
    bench.stand(0, 20);
    assert_armed_again(&mut bench);
}

#[test]
fn what_was_left_from_before_a_reset_is_reported_and_must_be_cleared() {
    let panicked = FaultRecord { fault: Fault::Panic { line: 12, column: 5 }, tick: 77, count: -3 };
    let watchdog = FaultRecord { fault: Fault::Watchdog, tick: 0, count: 0 };
    let by_watchdog = ResetCause::IndependentWatchdog;
    for (stored, reset, previous_fault) in [
        (panicked.encode(), by_watchdog, panicked),
        (panicked.encode(), ResetCause::Software, panicked),
        (FaultRecord::NOTHING, by_watchdog, watchdog),
    ] {
        let board = Board { stored, reset, ..Board::new() };
        let mut bench: Bench<Environment, f32, Latched> = Bench::boot(&SPRING, board).unwrap();
        assert_eq!(bench.previous_fault, Some(previous_fault));
        bench.stand(300, 200);
        assert!(!bench.board.is_on() && bench.board.codes().iter().all(|code| *code == 2048));
        assert_eq!(bench.notices(), []);
        let status = bench.status();
        assert_eq!((status.state, status.fault), (State::Disarmed, Some(previous_fault.fault)));
        assert_armed_again(&mut bench);
    }
}

fn with_link(link: LinkPolicy) -> Program<Environment> {
    Program { options: Options { link, link_timeout: 0.2, ..Options::DEFAULT }, ..SPRING }
}

#[test]
fn a_host_that_falls_silent_lets_the_device_go() {
    let mut bench = running(&with_link(LinkPolicy::Release), 500);
    for _ in 0..10 {
        bench.requests.host_alive();
        bench.stand(500, 199);
        assert_eq!(bench.servo_loop.state(), State::Running);
    }
    bench.tick(500);
    assert_eq!(bench.servo_loop.state(), State::Running);
    bench.tick(500);
    assert_eq!(bench.servo_loop.state(), State::FadingOut);
    // At once, but step by step: 3 codes at most are the spring's own.
    let before = bench.board.codes();
    bench.stand(500, 100);
    let codes = bench.board.codes();
    let largest = codes.windows(2).skip(before.len() - 1).map(|pair| (pair[1] - pair[0]).abs());
    assert!(largest.max().unwrap() <= 11 + 3);
    let lost = Fault::LinkLost { allowed: 200 };
    assert_stopped(&mut bench, lost);
    // The cause is still there, until the host is heard.
    bench.requests.arm();
    bench.tick(500);
    assert!(matches!(bench.notices()[..], [Notice::NotArmed(Fault::LinkLost { .. })]));
    bench.requests.host_alive();
    assert_armed_again(&mut bench);
}

#[test]
fn a_host_that_falls_silent_may_also_be_missed_in_silence() {
    for (link, lost) in [(LinkPolicy::Hold, true), (LinkPolicy::Ignore, false)] {
        let mut bench = running(&with_link(link), 500);
        bench.stand(500, 500);
        assert_eq!(bench.servo_loop.state(), State::Running);
        assert_eq!(bench.status().link_lost, lost);
        bench.requests.host_alive();
        assert!(!bench.status().link_lost);
    }
}

/// The limit falls by a step of the clamp, a hundredth, with the reason; it is no fault, and rises again.
#[test]
fn a_hot_bridge_lowers_the_limit_and_does_not_stop() {
    let mut bench = running(&SPRING, 900);
    bench.stand(1_800, 20);
    let full = bench.tick(1_800);
    assert_eq!((full.limit, full.state), (LimitReason::Torque, State::Running));
    let offset = |frame: Frame| frame.code.offset().unsigned_abs();
    for _ in 0..50 {
        bench.board.output_event = Some(OutputEvent::Heat(HeatStep::Lower));
        bench.tick(1_800);
    }
    let hot = bench.tick(1_800);
    assert_eq!((hot.limit, hot.state), (LimitReason::Heat, State::Running));
    assert!(offset(hot).abs_diff(offset(full) / 2) <= offset(full) / 50, "{hot:?}, {full:?}");
    // It does not push the hand back by itself: it rises while the hand takes less.
    let mut raise_at = |count| {
        bench.stand(1_000, 1);
        for _ in 0..60 {
            bench.board.output_event = Some(OutputEvent::Heat(HeatStep::Raise));
            bench.tick(count);
        }
        bench.stand(1_000, 1);
        bench.tick(1_800)
    };
    assert_eq!(raise_at(1_800).code, hot.code);
    assert_eq!(raise_at(100).code, full.code);
}
