//! What keeps the gates from being switched on, and what does not keep the motor from its torque.

use haptic_servo::fault::Fault;
use haptic_servo::wire::message::{Outcome, ToBoard};
use virtual_board::power_stage::gate_log::any_high;
use virtual_board::power_stage::parts::Parts;
use virtual_board::power_stage::{Circuit, Supply};

use super::bench::{INSTANT, armed, asked_torque, boot, circuit, gates};
use super::bridge_wall::TRANSDUCERS;
use super::brushless::{Held, wired};
use super::gates::INTO;
use super::paddle::still;
use crate::stub::{Masks, hold_up};

/// No gate is high in any of them, not for a clock.
#[test]
fn a_stage_that_is_not_in_order_is_never_switched_on() {
    type Cause = (&'static str, fn(&mut Circuit));
    let causes: [Cause; 7] = [
        ("over-voltage", |circuit| circuit.supply = Supply::stiff(27.0)),
        ("under-voltage", |circuit| circuit.supply = Supply::stiff(12.0)),
        ("over-temperature", |circuit| circuit.temperature = 95.0),
        ("current-offset", |circuit| circuit.amplifier_errors[0] = 0.3),
        ("current-offset", |circuit| circuit.amplifier_errors[1] = -1.6),
        // Open, and shorted.
        ("thermistor", |circuit| circuit.parts.thermistor[0] = 1e9),
        ("thermistor", |circuit| circuit.parts.thermistor[0] = 1.0),
    ];
    for (fault, cause) in causes {
        let mut bench = boot(still());
        cause(circuit(&mut bench));
        bench.run(20);
        let outcome = bench.arm();
        bench.run(20);
        let told = bench.fault();
        println!("{fault}: {outcome:?}, {told:?}");
        assert_eq!(told.map(Fault::as_str), Some(fault));
        assert!(!any_high(gates(&bench), 0, bench.now()), "{fault}");
        // And once it is in order again, it is switched on.
        circuit(&mut bench).supply = Supply::stiff(24.0);
        circuit(&mut bench).parts = Parts::NOMINAL;
        (circuit(&mut bench).temperature, circuit(&mut bench).amplifier_errors) = (25.0, [0.0; 3]);
        bench.run(20);
        assert_eq!(bench.arm(), Outcome::Done, "{fault}");
        bench.run(2);
        assert!(bench.is_on(), "{fault}");
    }
}

/// A comparator that does not trip within its range has a fault with its phase's name, and no gate is high.
#[test]
fn a_comparator_that_cannot_protect_is_refused() {
    for (phase, name) in ["U", "V", "W"].into_iter().enumerate() {
        for volts in [-0.03, 0.03] {
            let mut bench = boot(still());
            circuit(&mut bench).parts.senses[phase].comparator_offset = volts;
            bench.run(20);
            bench.arm();
            bench.run(20);
            let told = bench.fault().expect("there is a fault");
            assert_eq!(told.as_str(), "comparator", "{told}");
            assert!(told.to_string().contains(&format!("phase {name} ")), "{told}");
            assert!(!any_high(gates(&bench), 0, bench.now()), "{told}");
        }
    }
}

/// With parts at the ends of their tolerances each comparator alone breaks the outputs, while no program runs: not
/// at 8 A, and at 15 A at the latest, which are 9 A above the measured trip, and of V and W the difference of their
/// offsets. The low sides of all three phases conduct while they charge the supplies of the high sides.
#[test]
fn each_comparator_trips_by_current_with_parts_at_the_ends_of_their_tolerances() {
    for (name, parts) in Parts::CORNERS.into_iter().chain([("nominal", Parts::NOMINAL)]) {
        for phase in 0..3 {
            let what = format!("{name}, phase {phase}");
            let mut held = Held::new("brushless_wall", wired([0, 1, 2], 0.7));
            let bench = &mut held.bench;
            circuit(bench).parts = parts;
            bench.run(200);
            bench.say(&ToBoard::Align { id: 9 });
            bench.run(40);
            assert!(bench.is_on(), "{what}: {:?}", bench.fault());
            hold_up(bench, 12 * INSTANT, Masks::All);
            circuit(bench).leaks[phase] = 8.0;
            bench.run_for(3 * INSTANT);
            assert!(bench.is_on(), "{what}: a break at 8 A");
            circuit(bench).leaks[phase] = 15.0;
            bench.run_for(2 * INSTANT);
            assert!(!bench.is_on(), "{what}: no break at 15 A");
        }
    }
}

/// With the same parts the scene is felt, and no high side is switched on before its gate has a supply.
#[test]
fn boards_with_parts_at_the_ends_of_their_tolerances_give_their_torque() {
    for (name, parts) in Parts::CORNERS.into_iter().chain([("nominal", Parts::NOMINAL)]) {
        let mut bench = boot(still());
        circuit(&mut bench).parts = parts;
        armed(&mut bench);
        bench.run(125);
        circuit(&mut bench).is_blocked = true;
        bench.turn(INTO);
        bench.run(200);
        assert!(bench.is_on(), "{name}: {:?}", bench.fault());
        let wanted = asked_torque(&mut bench, &TRANSDUCERS);
        let made = circuit(&mut bench).mean_torque();
        println!("{name}: {made:.4} N m of {wanted:.4}");
        // Shunt and gain, and the three resistors, which the divider weakens: 1, 2 and 1 per cent.
        let most = if parts == Parts::NOMINAL { 0.005 } else { 0.045 * wanted.abs() };
        assert!(wanted < -0.2 && (made - wanted).abs() < most, "{name}: {made} of {wanted}");
        let stage = &bench.board().power_stage;
        assert_eq!((stage.uncharged(), stage.shoot_through()), (None, None), "{name}");
    }
}
