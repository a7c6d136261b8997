//! The cycle on a board that exists in memory only.

mod alignment;
pub(crate) mod board;
mod faults;
mod frames;
mod host;
mod mailbox;
mod modes;
mod phase;
mod profiles;
mod swap;

use board::{Bench, Board, Event, Notice, PERIOD};

use super::*;
use crate::boot::Program;
use crate::environment::{Environment, Wall};
use crate::fault::FaultRecord;
use crate::reset::ResetCause;
use crate::scene::{Coupling, Scene, Timing};
use crate::servo::{Latched, RenderingOptions, Step, Transducers};
use crate::test_scene;

/// The paper's device and coupling; ramps of a hundred ticks.
const fn program<E: Copy>(environment: E) -> Program<E> {
    Program {
        scene: Scene { torque_limit: Some(1.0), ..test_scene::scene(environment) },
        transducers: test_scene::PADDLE,
        rendering: RenderingOptions { fade: 0.1, injection: None, ..RenderingOptions::DEFAULT },
        options: Options::DEFAULT,
    }
}

/// A spring that pulls to both sides, so that any deflection shows.
const SPRING: Program<Environment> = program(Wall::spring(11.0, 1).alone());

/// A bench that was asked to be armed.
fn bench(program: &Program<Environment>) -> Bench<Environment, f32, Latched> {
    Bench::armed(program, Board::new()).unwrap()
}

/// A bench whose servo runs, with the device at this count.
fn running(program: &Program<Environment>, count: i32) -> Bench<Environment, f32, Latched> {
    let mut bench = bench(program);
    bench.stand(count, 102);
    assert_eq!(bench.servo_loop.state(), State::Running);
    bench.notices();
    bench
}

#[test]
fn boots_in_an_order_in_which_nothing_can_move() {
    let mut bench = bench(&SPRING);
    let start = [Event::Amplifier(false), Event::Write(2048), Event::Zero, Event::Guard];
    assert_eq!(bench.board.events, start);
    bench.board.events.clear();
    bench.tick(900);
    assert_eq!(bench.board.events, [Event::Write(2048), Event::Amplifier(true), Event::Feed]);
    // From there on the clamp opens by a hundredth of the torque limit a tick, for any torque of
    // the spring: 1 N m is 895.5 codes, and at 900 counts the spring has 725.3.
    for ticks in 1..=80 {
        let (code, level) = (bench.tick(900).code, 8.955 * f64::from(ticks));
        assert!((f64::from(-code.offset()) - level).abs() <= 0.51, "{code:?} for {level}");
    }
    bench.stand(900, 20);
    assert_eq!(bench.tick(900).code.offset(), -725);
    assert_eq!(bench.servo_loop.state(), State::Running);
    assert_eq!(bench.notices(), [Notice::Armed]);
}

/// A bridge charges the supplies of its high sides first: no torque, and then the clamp opens.
#[test]
fn the_clamp_stays_shut_until_the_output_has_started_up() {
    let mut board = Board::new();
    board.start_up_ticks = 12;
    let mut bench: Bench<Environment, f32, Latched> = Bench::boot(&SPRING, board).unwrap();
    bench.requests.arm();
    for tick in 0..=12 {
        let frame = bench.tick(500);
        let state = if tick >= 11 { State::FadingIn } else { State::Settling };
        assert_eq!((frame.code.get(), bench.servo_loop.state()), (2048, state), "tick {tick}");
    }
    bench.stand(500, 3);
    assert_ne!(bench.tick(500).code.get(), 2048);
    assert!(bench.board.is_on());
}

#[test]
fn a_scene_that_fails_the_self_check_leaves_the_amplifier_off() {
    let mut program = SPRING;
    program.scene.environment.wall_mut().unwrap().stiffness = 45.0;
    let mut board = Board::new();
    let mut mailbox = Mailbox::<PreparedServo<Environment, f32, Latched>>::new();
    let (requests, _inbox) = mailbox.split();
    let result = crate::boot::boot(&program, &mut board, &requests);
    let error = result.map(|_| ()).unwrap_err();
    assert_eq!(error, Step::Certificate);
    assert_eq!(board.events, [Event::Amplifier(false), Event::Write(2048)]);
}

/// After any reset the servo stays off until it is armed.
#[test]
fn no_reset_arms_a_servo_that_nobody_has_asked_to_arm() {
    for reset in ResetCause::ALL {
        let board = Board { reset, ..Board::new() };
        let mut bench: Bench<Environment, f32, Latched> = Bench::boot(&SPRING, board).unwrap();
        bench.stand(900, 300);
        assert_eq!(bench.servo_loop.state(), State::Disarmed, "{reset:?}");
        assert!(!bench.board.is_on(), "{reset:?}");
        assert!(bench.board.codes().iter().all(|code| *code == 2048), "{reset:?}");
        assert_eq!((bench.notices(), bench.reset), (vec![], reset));
        bench.requests.arm();
        bench.tick(900);
        assert!(bench.board.is_on(), "{reset:?}");
    }
}

#[test]
fn a_program_that_says_so_is_armed_at_power_on_and_after_no_other_reset() {
    const OPTIONS: Options = Options::DEFAULT.armed_at_power_on("nobody can reach it");
    let program = Program { options: OPTIONS, ..SPRING };
    for reset in ResetCause::ALL {
        let board = Board { reset, ..Board::new() };
        let mut bench: Bench<Environment, f32, Latched> = Bench::boot(&program, board).unwrap();
        let arms = reset == ResetCause::PowerOn;
        let because = arms.then_some(Reason::new("nobody can reach it"));
        assert_eq!(bench.arms_because, because, "{reset:?}");
        bench.stand(0, 300);
        assert_eq!(bench.board.is_on(), arms, "{reset:?}");
    }
}

#[test]
#[should_panic(expected = "arming at power-on needs a reason")]
fn no_program_arms_itself_without_a_reason() {
    let _ = Options::DEFAULT.armed_at_power_on(" ");
}

/// `scene_program!` has these checks evaluated at compile time.
#[test]
fn numbers_that_no_board_can_run_are_refused() {
    assert!(SPRING.check().is_ok());
    let Program { scene, transducers, rendering, options } = SPRING;
    let timed = |period| Program {
        scene: Scene { timing: Timing { period, ..scene.timing }, ..scene },
        ..SPRING
    };
    let with = |transducers| Program { transducers, ..SPRING };
    let limited = Scene { torque_limit: Some(1e3), ..scene };
    for (program, told) in [
        (timed(1e-6), "the period of 1e-6 s is not between 0.00001 and 0.06396875 s"),
        (timed(0.0), "the period of 0 s"),
        (with(Transducers { counts_per_turn: 0.0, ..transducers }), "the counts per turn"),
        (with(Transducers { full_scale_torque: -1.0, ..transducers }), "the full-scale torque"),
        (with(Transducers { largest_speed: 1e9, ..transducers }), "at the largest speed"),
        (Program { scene: limited, ..SPRING }, "the torque limit of 1000 N m"),
        (Program { rendering: RenderingOptions { fade: 0.0, ..rendering }, ..SPRING }, "the time"),
        (Program { options: Options { link_timeout: 0.0, ..options }, ..SPRING }, "the link"),
    ] {
        let error = program.check().unwrap_err().to_string();
        assert!(error.starts_with(told), "{error}");
    }
}

/// RAM may keep a record through a supply that was off for a moment.
#[test]
fn a_fault_that_was_kept_is_armed_at_no_power_on() {
    let stored = FaultRecord { fault: Fault::ClockLost, tick: 0, count: 0 }.encode();
    let options = Options::DEFAULT.armed_at_power_on("nobody can reach it");
    let program = Program { options, ..SPRING };
    let board = Board { stored, ..Board::new() };
    let mut bench: Bench<Environment, f32, Latched> = Bench::boot(&program, board).unwrap();
    bench.stand(0, 300);
    assert!(!bench.board.is_on());
    assert_eq!(bench.status().fault, Some(Fault::ClockLost));
}
