//! The cycle on a board that exists in memory only.

mod board;
mod faults;
mod frames;
mod modes;
mod swap;

use board::{Bench, Board, Event, PERIOD};

use super::*;
use crate::boot::Program;
use crate::encoder::CounterWidth;
use crate::environment::DelayedSpring;
use crate::fault::Retained;
use crate::scene::{Coupling, Device, Scene, Timing};
use crate::servo::{Latched, RenderingOptions, Step, Transducers};

/// A spring that pulls to both sides, so that any deflection shows.
type Spring = DelayedSpring<1>;

/// The paper's device and coupling; ramps of a hundred ticks.
const fn program<E: Copy>(environment: E) -> Program<E> {
    Program {
        scene: Scene {
            device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
            timing: Timing { period: 1e-3, worst_period: None },
            coupling: Coupling::Spring { stiffness: 44.0 },
            environment,
            torque_limit: Some(1.0),
        },
        transducers: Transducers {
            counts_per_turn: 61_440.0,
            counter: CounterWidth::Bits16,
            full_scale_torque: 2.0,
            largest_speed: 100.0,
        },
        rendering: RenderingOptions { fade: 0.1, injection: None },
        options: Options::DEFAULT,
    }
}

const SPRING: Program<Spring> = program(DelayedSpring { stiffness: 11.0 });

fn bench(program: &Program<Spring>) -> Bench<Spring, f32, Latched> {
    Bench::boot(program, Board::new()).unwrap()
}

/// A bench whose servo runs, with the device at this count.
fn running(program: &Program<Spring>, count: i32) -> Bench<Spring, f32, Latched> {
    let mut bench = bench(program);
    bench.stand(count, 102);
    assert_eq!(bench.cycle.state(), State::Running);
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
    // From there on the clamp opens by a hundredth of the torque limit a tick, whatever the
    // spring asks for: 1 N m is 1023.5 codes, and at 900 counts the spring wants 828.9.
    for ticks in 1..=80 {
        let (code, level) = (bench.tick(900).code, 10.235 * f64::from(ticks));
        assert!((f64::from(-code.offset()) - level).abs() <= 0.51, "{code:?} for {level}");
    }
    bench.stand(900, 20);
    assert_eq!(bench.tick(900).code.offset(), -829);
    assert_eq!(bench.cycle.state(), State::Running);
    assert_eq!(bench.notices(), [Notice::Armed]);
}

#[test]
fn a_scene_that_fails_the_self_check_leaves_the_amplifier_off() {
    let mut program = SPRING;
    program.scene.environment.stiffness = 45.0;
    let mut board = Board::new();
    let mut mailbox = Mailbox::<Rendering<Spring, f32, Latched>>::new();
    let (requests, _inbox) = mailbox.split();
    let result = crate::boot::boot(&program, &mut board, &requests);
    let error = result.map(|_| ()).unwrap_err();
    assert_eq!(error, Step::Certificate);
    assert_eq!(board.events, [Event::Amplifier(false), Event::Write(2048)]);
}
