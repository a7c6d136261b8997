//! Torques that are put out at a phase of their own period: a tick's deadline, and what a late one leaves.

use super::*;
use crate::scene::Latency as Between;
use crate::servo::AtPhase;

/// Half a period: a board here takes 300 of 1000 timer counts for a tick.
type Half = AtPhase<500_000>;

/// Timer counts up to the phase.
const DEADLINE: u32 = PERIOD / 2;
/// Timer counts after which a count is read too late: two per cent of a period.
const READ: u32 = 20;

const WALL: Program<Environment> = {
    let wall = program(Wall::damped(5.0, 0.001, 0).alone());
    let latency = Between { output_jitter: 2e-5, ..Between::delayed(Half::DELAY) };
    Program { scene: Scene { coupling: Coupling::Matched, latency, ..wall.scene }, ..wall }
};

fn running(count: i32) -> Bench<Environment, f32, Half> {
    let mut bench: Bench<Environment, f32, Half> = Bench::armed(&WALL, Board::new()).unwrap();
    bench.stand(count, 102);
    assert_eq!(bench.servo_loop.state(), State::Running);
    bench.notices();
    bench.board.events.clear();
    bench
}

/// Stopped by this fault in the last tick, and nothing but mid-scale is left to be put out.
fn assert_stopped(bench: &mut Bench<Environment, f32, Half>, fault: Fault) {
    assert_eq!((bench.servo_loop.state(), bench.servo_loop.fault()), (State::Faulted, Some(fault)));
    assert!(!bench.board.is_on());
    assert_eq!(bench.board.codes().last(), Some(&2048));
    assert_eq!(bench.notices(), [Notice::Stopped(fault)]);
    // It can be armed once the ticks are in time again.
    bench.stand(500, 20);
    bench.requests.arm();
    bench.tick(500);
    assert_eq!(bench.notices(), [Notice::Armed]);
}

/// The code of a tick is that of its own count, and its slack the time left up to the phase.
#[test]
fn a_code_belongs_to_the_count_of_its_own_tick() {
    let mut bench = running(0);
    assert_eq!(bench.tick(0).code.get(), 2048);
    let frame = bench.tick(300);
    assert!(frame.code.get() < 2048, "{frame:?}");
    assert_eq!(frame.slack, DEADLINE - 300);
    assert_eq!(bench.status().worst_slack, DEADLINE - 300);
    assert_eq!(bench.status().period, PERIOD);
}

#[test]
fn a_code_that_is_written_at_the_phase_or_later_is_a_fault_and_is_written_over() {
    for elapsed in [DEADLINE - 1, DEADLINE, PERIOD - 1] {
        let mut bench = running(500);
        bench.board.elapsed = elapsed;
        let frame = bench.tick(500);
        if elapsed < DEADLINE {
            assert_eq!((frame.state, frame.slack), (State::Running, 1));
            continue;
        }
        assert_eq!((frame.state, frame.slack), (State::Faulted, 0));
        // The late code, mid-scale over it, and the amplifier off, before anything else is done.
        let late = Event::Write(frame.code.get());
        let events = [late, Event::Write(2048), Event::Amplifier(false), Event::Feed];
        assert_eq!(bench.board.events, events);
        assert_ne!(frame.code.get(), 2048);
        assert_stopped(&mut bench, Fault::LateTick { late: elapsed, allowed: DEADLINE });
        let status = bench.status();
        assert_eq!((status.worst_slack, status.missed), (0, 1));
    }
}

/// Where torques are latched any slack of the period would do.
#[test]
fn a_count_that_is_read_later_than_the_scene_s_jitter_is_a_fault() {
    for late in [READ - 1, READ, READ + 1] {
        let mut bench = running(500);
        (bench.board.passed, bench.board.elapsed) = (BEGAN_LATE, late);
        let frame = bench.tick(500);
        if late <= READ {
            assert_eq!(frame.state, State::Running, "{late}");
            continue;
        }
        // Found before the tick's code was written, so that there was none.
        let events = [Event::Write(2048), Event::Amplifier(false), Event::Write(2048), Event::Feed];
        assert_eq!((frame.code.get(), &bench.board.events[..]), (2048, &events[..]));
        assert_stopped(&mut bench, Fault::LateTick { late, allowed: READ });
    }
}

#[test]
fn no_update_may_be_missed() {
    let mut bench = running(500);
    bench.board.passed = 2;
    bench.tick(500);
    assert_stopped(&mut bench, Fault::MissedTick { missed: 1, tolerated: 0 });
}

/// The motor has the code of the tick before for half of each period, and then the tick's own.
#[test]
fn the_energy_is_that_of_both_codes_of_a_period() {
    let mut bench: Bench<Environment, f32, Half> = Bench::armed(&WALL, Board::new()).unwrap();
    let (mut twice, mut last) = (0_i64, 0);
    let hand = (0..2000).map(|k: i32| (500.0 * (f64::from(k) * 0.02).sin()) as i32);
    for (k, count) in hand.enumerate() {
        bench.tick(count);
        let codes = bench.board.codes();
        // That which was written at boot, and then one a tick, of which this tick's was not out yet.
        let of =
            |ticks: usize| codes.get((k + 1).wrapping_sub(ticks)).map_or(0, |code| code - 2048);
        twice += i64::from(of(1) + of(2)) * i64::from(count - last);
        last = count;
    }
    assert_eq!(bench.status().energy, twice.div_euclid(2));
    assert_ne!(twice, 0);
}

/// Disarmed, the board writes mid-scale, and the amplifier is off only once that has been computed.
#[test]
fn no_code_is_left_to_be_triggered_once_the_amplifier_is_off() {
    let mut bench = running(500);
    bench.requests.disarm();
    bench.stand(500, 110);
    assert_eq!(bench.servo_loop.state(), State::Disarmed);
    let off = bench.board.events.iter().position(|event| *event == Event::Amplifier(false));
    let written = bench.board.events[..off.unwrap()].iter().rev();
    let last = written.filter(|event| matches!(event, Event::Write(_))).take(1);
    assert!(last.eq(&[Event::Write(2048)]));
    let after = &bench.board.events[off.unwrap()..];
    assert!(after.iter().all(|event| !matches!(event, Event::Write(code) if *code != 2048)));
}
