//! A brushless motor: aligned on request, and then with the torque of the code.

use std::sync::{Arc, Mutex};

use haptic_servo::current::Drive;
use haptic_servo::fault::Fault;
use haptic_servo::servo::Transducers;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{Outcome, ToBoard};
use virtual_board::motor::{Motor, Winding};
use virtual_board::power_stage::gate_log::any_high;

use super::bench::{INSTANT, asked_torque, boot_program, circuit, motor, run_to_valley};
use super::brushless_wall::{DRIVE, TRANSDUCERS};
use super::paddle::shaft;
use crate::bench::Bench;
use crate::stub::{Masks, hold_up};

/// Samples within which an alignment ends: ten seconds.
const LONGEST: u64 = 100_000;
/// Torque of the hand in N m that leans against the wall.
const LEANS: f64 = 0.07;

/// A bench with a hand at the shaft.
pub struct Held {
    pub bench: Bench,
    pub hand: Arc<Mutex<f64>>,
}

impl Held {
    /// With a program of this shaft.
    pub fn new(program: &str, motor: Motor) -> Self {
        let hand = Arc::<Mutex<f64>>::default();
        let bench = boot_program(program, motor, shaft(hand.clone()));
        Self { bench, hand }
    }

    /// The torque of the hand in N m.
    pub fn push(&self, torque: f64) {
        *self.hand.lock().unwrap() = torque;
    }
}

/// The program's motor, with its magnets anywhere and its wires in this order.
pub fn wired(wires: [usize; 3], offset: f64) -> Motor {
    wired_to(&DRIVE, wires, offset)
}

/// The same of another drive.
pub fn wired_to(drive: &Drive, wires: [usize; 3], offset: f64) -> Motor {
    let mut motor = motor(drive);
    if let Winding::Brushless { pole_pairs, .. } = motor.winding {
        motor.winding = Winding::Brushless { pole_pairs, offset };
    }
    motor.wires = wires;
    motor
}

/// A hand that leans against the wall comes to rest: the torque is that of the code, and the hand's.
pub fn check_torque(held: &mut Held, what: &str) {
    check_torque_of(held, &TRANSDUCERS, what);
}

/// The same of another motor.
pub fn check_torque_of(held: &mut Held, transducers: &Transducers, what: &str) {
    assert_eq!(held.bench.arm(), Outcome::Done, "{what}");
    // After the pulses that check a stated phase.
    held.bench.run(600);
    held.push(LEANS);
    let bench = &mut held.bench;
    bench.run(8000);
    let wanted = asked_torque(bench, transducers);
    let made = circuit(bench).mean_torque();
    println!("{what}: {made:.5} N m of {wanted:.5}, {:?}", bench.fault());
    assert!((made / wanted - 1.0).abs() < 0.03, "{what}: {made} N m of {wanted}");
    assert!((made + LEANS).abs() < 0.004, "{what}: {made} N m against {LEANS}");
}

/// With two wires swapped, so that the phase falls while the count rises; the other orders are tested on the host.
#[test]
fn an_aligned_motor_gives_the_torque_of_its_code() {
    let mut held = Held::new("brushless_wall", wired([1, 0, 2], -2.0));
    align(&mut held.bench);
    check_torque(&mut held, "aligned");
}

/// Aligns the motor.
pub fn align(bench: &mut Bench) {
    bench.run(200);
    assert_eq!(bench.request(|id| ToBoard::Align { id }), Outcome::Done);
    let has_ended = |bench: &mut Bench| bench.status().state != State::Aligning;
    assert!(bench.run_until(2000, LONGEST, has_ended), "it does not end");
    assert_eq!((bench.fault(), bench.is_on()), (None, false));
}

/// It is asked to be armed, and no gate is high for it.
pub fn check_stays_off(bench: &mut Bench) {
    bench.board_mut().gates = Some(Vec::new());
    bench.arm();
    bench.run(50);
    assert!(bench.status().fault.is_some());
    assert!(!any_high(bench.board().gates.as_deref().unwrap(), 0, u64::MAX));
}

/// As an instant of the servo's torque is: for five sixths of a period, over an update.
#[test]
fn an_alignment_whose_instant_is_late_ends() {
    let mut held = Held::new("brushless_wall", wired([0, 1, 2], 0.7));
    let bench = &mut held.bench;
    bench.run(200);
    bench.say(&ToBoard::Align { id: 9 });
    bench.run(1000);
    assert_eq!(bench.status().state, State::Aligning);
    run_to_valley(bench);
    hold_up(bench, INSTANT * 5 / 6, Masks::All);
    bench.run(20);
    let told = bench.fault().map(Fault::as_str);
    assert_eq!(told, Some("current-interrupt-late"));
    assert!(!bench.is_on());
}
