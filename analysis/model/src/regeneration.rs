//! Whether the supply of a scene's bridge stays below the fault level after a hand's push (theory, section 17).

use haptic_servo::current::{Bus, Push, RegenerationError};
use serde::Serialize;

use crate::file::SceneFile;
use crate::file::supply::FileSupply;
use crate::quantity::significant;

/// The answer for a supply.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SupplyReport {
    /// Whether it stays below the fault level; `None` if no bound on the energy is known.
    pub stays_below: Option<bool>,
    /// Whether it takes energy back.
    pub sinks: bool,
    /// Largest energy in J that the scene returns; `None` if no bound is known or needed.
    pub energy: Option<f64>,
    /// Highest voltage in V after that.
    pub voltage: Option<f64>,
    /// Lowest voltage in V at which the bridge may switch itself off.
    pub fault_voltage: Option<f64>,
    /// Least capacitance in F for that energy, where it is the only change.
    pub least_capacitance: Option<f64>,
    /// Largest voltage in V of the supply, in the same way.
    pub largest_voltage: Option<f64>,
    /// Largest torque limit in N m, in the same way; `None` where it may stay, or none is low enough.
    pub largest_torque: Option<f64>,
    /// The answer as a sentence.
    pub message: String,
}

/// The condition of the answer.
pub const ASSUMPTION: &str = "supply: a hand pushes in one direction, no farther than where the scene at rest has \
                              its torque limit, over one period of a torque profile or its range, and lets go; \
                              a hand that goes on turning against the torque feeds the supply for as long, \
                              which only a sinking supply bears";

/// The answer for the supply of a scene file; `None` if the file states none.
pub fn judge(file: &SceneFile) -> Option<SupplyReport> {
    let (bus, largest_speed) = match file.supply? {
        FileSupply::Sinks { .. } => return Some(sinking()),
        FileSupply::Stores { bus, largest_speed } => (bus, largest_speed),
    };
    // The reader has refused a file with neither.
    let torque = file.scene.torque_limit.or(file.full_scale).unwrap_or(f64::INFINITY);
    let links = file.chain.links().iter().map(|link| link.stiffness);
    // A link without a stiffness stores nothing.
    let stored = links.filter(|&stiffness| stiffness > 0.0).map(|it| 0.5 * torque * torque / it);
    let push =
        Push { torque, speed: largest_speed, injected: 0.0, stored: rounded_up(stored.sum()) };
    Some(match bus.check(&file.scene, &push) {
        Ok(energy) => {
            let (energy, level) = (energy.total(), bus.fault_level);
            let voltage = bus.voltage_after(energy);
            let [joules, volts] = [energy, voltage].map(|value| significant(value, 4));
            let message = format!(
                "a push returns up to {joules} J, which raises it to {volts} V, below the {level} V at which \
                 the bridge may switch itself off"
            );
            of(&bus, Some(true), Some(energy), message)
        }
        Err(error @ RegenerationError::Unbounded) => of(&bus, None, None, error.to_string()),
        Err(error @ RegenerationError::OverVoltage { energy, torque, .. }) => {
            let report = of(&bus, Some(false), Some(energy.total()), error.to_string());
            SupplyReport { largest_torque: (torque > 0.0).then_some(torque), ..report }
        }
    })
}

/// Above the errors of a short sum.
fn rounded_up(sum: f64) -> f64 {
    sum * (1.0 + 1e-12)
}

fn sinking() -> SupplyReport {
    SupplyReport {
        stays_below: Some(true),
        sinks: true,
        message: "takes back what the motor returns, and keeps its voltage".to_owned(),
        ..SupplyReport::default()
    }
}

fn of(bus: &Bus, stays_below: Option<bool>, energy: Option<f64>, message: String) -> SupplyReport {
    SupplyReport {
        stays_below,
        energy,
        voltage: energy.map(|energy| bus.voltage_after(energy)),
        fault_voltage: Some(bus.fault_level),
        least_capacitance: energy.and_then(|energy| bus.least_capacitance(energy)),
        largest_voltage: energy.and_then(|energy| bus.largest_voltage(energy)),
        message,
        ..SupplyReport::default()
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::certificate::certify_scene;
    use haptic_servo::number::Format;

    use super::*;
    use crate::controller::controller;
    use crate::file::{self, parse};
    use crate::verdict::{Verdict, judge_file};

    const DEVICE: &str =
        "name = \"a\"\n[device]\ninertia = 2.2e-5\ndamping = 0.04\n[servo]\nperiod = 0.001\n";
    const SPRING: &str = "[environment]\ntype = \"delayed-spring\"\nstiffness = 20.0\ndelay = 1\n";
    const WALL: &str = "[environment]\ntype = \"damper-wall\"\nstiffness = 20.0\ndamping = 0.009\n\
                        delay = 1\none_sided = true\n";
    const LIMIT: &str = "[limits]\ntorque = 1.0\n";

    fn scene(coupling: &str, environment: &str, supply: &str) -> SceneFile {
        let text = format!("{DEVICE}{coupling}{environment}{LIMIT}[supply]\n{supply}");
        parse("a.toml", file::Format::Toml, &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    fn stores(voltage: f64, capacitance: f64) -> String {
        format!(
            "voltage = {voltage:?}\nfault_voltage = 25.2\ncapacitance = {capacitance:?}\n\
             largest_speed = 25.0\n"
        )
    }

    fn judged(file: &SceneFile) -> SupplyReport {
        judge(file).expect("it states a supply")
    }

    /// By hand: `L^2/(2 K)` = 25 mJ of the spring and `J w^2/2` = 6.875 mJ of the device; 1 mF at 24 V stores
    /// 29.52 mJ up to 25.2 V.
    #[test]
    fn the_energy_is_that_of_the_spring_at_the_limit_and_of_the_device_at_its_speed() {
        let report = judged(&scene("", SPRING, &stores(24.0, 1e-3)));
        assert!((report.energy.unwrap() / 0.031_875 - 1.0).abs() < 1e-12, "{report:?}");
        let voltage = (24.0_f64.powi(2) + 2.0 * 0.031_875 / 1e-3).sqrt();
        assert!((report.voltage.unwrap() / voltage - 1.0).abs() < 1e-12, "{report:?}");
        assert_eq!(report.stays_below, Some(false));
        assert!(report.message.contains("25.29") && report.message.contains("brake resistor"));
        assert_eq!(judged(&scene("", SPRING, &stores(12.0, 1e-3))).stays_below, Some(true));
        assert_eq!(judged(&scene("", SPRING, "sinks = true\n")).stays_below, Some(true));
    }

    #[test]
    fn a_supply_that_rises_too_far_fails_the_report_and_not_the_verdict() {
        let file = scene("", SPRING, &stores(24.0, 1e-3));
        let report = judge_file(&file, Format::F64);
        assert_eq!((report.verdict, report.passes()), (Verdict::Certified, false));
        assert!(report.assumptions.iter().any(|one| one == ASSUMPTION));
        assert!(judge_file(&scene("", SPRING, &stores(20.0, 1e-3)), Format::F64).passes());
        assert!(judge_file(&scene("", SPRING, "sinks = true\n"), Format::F64).passes());
    }

    /// Each alone, and no more than it needs.
    #[test]
    fn each_remedy_passes_and_little_less_does_not() {
        let coupling = "[coupling]\nstiffness = 44.0\n";
        for (coupling, environment) in [("", SPRING), (coupling, WALL)] {
            let at = |voltage, capacitance, torque| {
                let mut file = scene(coupling, environment, &stores(voltage, capacitance));
                file.scene.torque_limit = Some(torque);
                judged(&file).stays_below == Some(true)
            };
            let told = judged(&scene(coupling, environment, &stores(24.0, 1e-3)));
            let [capacitance, voltage, torque] =
                [told.least_capacitance, told.largest_voltage, told.largest_torque]
                    .map(Option::unwrap);
            let less = 1.0 - 1e-6;
            assert!(at(24.0, capacitance, 1.0) && !at(24.0, capacitance * less, 1.0));
            assert!(at(voltage, 1e-3, 1.0) && !at(voltage / less, 1e-3, 1.0));
            assert!(at(24.0, 1e-3, torque) && !at(24.0, 1e-3, torque / less));
        }
    }

    /// Without a spring that ends the push, nothing is known.
    #[test]
    fn an_environment_without_a_known_end_of_the_push_is_not_certified_for_a_supply() {
        let damper =
            "[environment]\ntype = \"damper-wall\"\nstiffness = 0.0\ndamping = 0.009\ndelay = 1\n";
        let file = scene("", damper, &stores(12.0, 1e-3));
        assert_eq!((judged(&file).stays_below, judged(&file).energy), (None, None));
        assert!(!judge_file(&file, Format::F64).passes());
    }

    #[test]
    fn a_supply_is_read_with_clear_errors() {
        for (supply, parts) in [
            ("voltage = 24.0\nfault_voltage = 25.2\n", ["supply.capacitance", "greater than 0 F"]),
            (
                "voltage = 24.0\nfault_voltage = 25.2\ncapacitance = 0.0\n",
                ["0.0", "greater than 0 F"],
            ),
            ("voltage = 24.0\nfault_voltage = 25.2\ncapacitance = -1e-3\n", ["-1e-3", "greater"]),
            ("voltage = 24.0\nfault_voltage = 25.2\ncapacitance = nan\n", ["nan", "greater"]),
            ("voltage = 26.0\nfault_voltage = 25.2\ncapacitance = 1e-3\n", ["26.0", "25.2 V"]),
            ("sinks = 1\n", ["supply.sinks", "true or false"]),
            ("sinks = true\nvoltage = -1.0\n", ["supply.voltage", "greater than 0 V"]),
            ("sink = true\n", ["supply.sink", "`sinks`"]),
        ] {
            let text = format!("{DEVICE}{SPRING}{LIMIT}[supply]\n{supply}");
            let told = parse("a.toml", file::Format::Toml, &text).unwrap_err().to_string();
            assert!(parts.iter().all(|part| told.contains(part)), "{told}");
        }
        let text = format!("{DEVICE}{SPRING}[supply]\n{}", stores(12.0, 1e-3));
        let told = parse("a.toml", file::Format::Toml, &text).unwrap_err().to_string();
        assert!(told.contains("limits.torque"), "{told}");
    }

    /// Steps of the motion in a tick.
    const STEPS: usize = 50;

    /// Energy in J that a motor without losses has put into the supply, above what the supply itself keeps: the
    /// largest over a push at this speed to this depth, after which the hand lets go.
    fn returned(file: &SceneFile, speed: f64, depth: f64) -> f64 {
        let certified = certify_scene(file.scene, Format::F64).unwrap();
        let mut servo = controller::<_, f32>(&certified, &file.transducers(None, None)).unwrap();
        let (device, period) = (file.scene.device, file.scene.timing.period);
        let step = period / STEPS as f64;
        let (mut angle, mut rate, mut energy, mut most) = (0.0, speed, 0.0_f64, 0.0_f64);
        let ticks = ((depth / speed + 0.1) / period) as usize;
        let mut is_held = true;
        for _ in 0..ticks {
            let torque = servo.tick_at(angle).unwrap();
            for _ in 0..STEPS {
                is_held &= angle < depth;
                if !is_held {
                    rate -= (torque + device.damping * rate) / device.inertia * step;
                }
                angle += rate * step;
                energy = (energy + torque * rate * step).max(0.0);
                most = most.max(energy);
            }
        }
        most
    }

    /// The depth in rad at which the servo has its torque limit, for a hand that leans slowly.
    fn leaned(file: &SceneFile) -> f64 {
        let certified = certify_scene(file.scene, Format::F64).unwrap();
        let mut servo = controller::<_, f32>(&certified, &file.transducers(None, None)).unwrap();
        let step = 1e-5;
        let reached = |angle: f64, torque: f64| (torque > 0.999).then_some(angle);
        (0..100_000)
            .find_map(|tick| {
                let angle = f64::from(tick) * step;
                reached(angle, servo.tick_at(angle).unwrap())
            })
            .expect("the spring reaches the limit")
    }

    /// A knob without end is turned on by a detent at most, and one with end stops over its range.
    #[test]
    fn no_simulated_turn_of_a_knob_returns_more() {
        let endless = "[environment]\ntype = \"profile\"\ndelay = 1\n[[environment.shape]]\n\
                       type = \"detents\"\ncount = 24\ntorque = 0.04\n";
        let file = scene("[coupling]\nstiffness = 44.0\n", endless, &stores(12.0, 1e-3));
        let energy = judged(&file).energy.unwrap();
        let detent = std::f64::consts::TAU / 24.0;
        let depth = detent + 1.0 / 44.0;
        assert!((energy / (depth + 0.006_875) - 1.0).abs() < 1e-9, "{energy}");
        for speed in [1.0, 10.0, 24.0] {
            assert!(returned(&file, speed, detent) < energy);
        }
    }

    /// The servo itself, with a motor that has no losses: no push returns more than equation 62 says, and one
    /// returns more than two fifths of it.
    #[test]
    fn no_simulated_push_returns_more_and_one_nearly_as_much() {
        let spring = "[coupling]\nstiffness = 44.0\n";
        let matched = "[coupling]\ntype = \"matched\"\n";
        for (coupling, environment) in
            [("", SPRING), (spring, SPRING), (spring, WALL), (matched, SPRING), (matched, WALL)]
        {
            let file = scene(coupling, environment, &stores(24.0, 1e-3));
            let (bound, depth) = (judged(&file).energy.unwrap(), leaned(&file));
            let speeds = [0.2, 1.0, 3.0, 6.0, 12.0, 18.0, 24.9];
            let most =
                speeds.map(|speed| returned(&file, speed, depth)).into_iter().fold(0.0, f64::max);
            println!("{coupling:?} {environment:?}: {most:.5} of {bound:.5} J, {depth:.4} rad");
            assert!(most <= bound && most >= 0.4 * bound, "{most} of {bound} J");
        }
    }
}
