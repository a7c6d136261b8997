//! A [`SceneFile`] written as the text that reads back as the same, to the last bit.

mod moving;
mod shaped;

use haptic_servo::current::IndexOffset;
use haptic_servo::environment::{Environment, Wall};
use haptic_servo::host::HostTorque;
use haptic_servo::magnetic::Chip;
use haptic_servo::parameter::{Parameter, Range};
use haptic_servo::scene::{Coupling, EncoderReading, Scene, TimeRange};

use super::key::{self, Bound, Key, Presence};
use super::kind::Kind;
use super::motor::FileMotor;
use super::scene::SceneFile;
use super::supply::FileSupply;
use crate::chain::{Chain, EncoderPlace};
use crate::disturbance::{Cogging, Sine};

/// The text of a scene file in TOML: all keys of the file, and no others.
pub fn toml(file: &SceneFile) -> String {
    let SceneFile {
        name,
        scene,
        chain,
        simulation,
        hand,
        encoder_step,
        full_scale,
        friction,
        cogging,
        host,
        supply,
        motor,
        shapes,
        chip,
    } = file;
    let mut lines = vec![format!("name = {}", quoted(name)), "[device]".to_owned()];
    device(&mut lines, chain, scene, *friction, *cogging);
    lines.push(format!("[servo]\nperiod = {:?}", scene.timing.period));
    number(&mut lines, "worst_period", scene.timing.worst_period);
    let EncoderReading { age, .. } = *scene.latency.encoder;
    let TimeRange { least, most } = scene.latency.output_delay;
    let delay = TimeRange::between(less(least, age.middle()), less(most, age.middle()));
    time(&mut lines, "output_delay", delay);
    time(&mut lines, "output_jitter", TimeRange::exactly(scene.latency.output_jitter));
    let jitter = less(scene.latency.count_jitter, scene.latency.encoder.deviation_of_age());
    time(&mut lines, "count_jitter", TimeRange::exactly(jitter));
    encoder(&mut lines, scene.latency.encoder, *chip);
    if let Some(learnt) = &scene.environment.parts().anticogging {
        let torques: Vec<_> = learnt.torques().collect();
        lines.push(format!("[anticogging]\ntorque = {torques:?}"));
        number(&mut lines, "share", Some(learnt.share).filter(|share| *share != 1.0));
    }
    match scene.coupling {
        Coupling::Rigid => {}
        Coupling::Spring { stiffness } => {
            lines.push(format!("[coupling]\nstiffness = {stiffness:?}"));
        }
        Coupling::Matched => {
            lines.push(format!("[coupling]\ntype = {}", quoted(super::scene::MATCHED)));
        }
    }
    lines.push("[environment]".to_owned());
    match (scene.environment.profile(), shapes) {
        (Some(profile), Some(shapes)) => {
            shaped::profile(&mut lines, &scene.environment, profile, shapes);
            lines.extend(scene.environment.wall().into_iter().flat_map(shaped::wall));
        }
        _ => environment(&mut lines, &scene.environment),
    }
    if let Some(simulation) = simulation {
        moving::simulation(&mut lines, simulation);
    }
    if let Some(hand) = hand {
        moving::hand(&mut lines, hand);
    }
    let limits = [
        (&key::TORQUE_LIMIT, scene.torque_limit),
        (&key::ENCODER_STEP, *encoder_step),
        (&key::FULL_SCALE, *full_scale),
    ];
    table(&mut lines, &key::LIMITS, limits);
    if let Some(HostTorque { energy, power, damping, torque, timeout }) = *host {
        let numbers = [
            (&key::HOST_ENERGY, energy),
            (&key::HOST_POWER, power),
            (&key::HOST_DAMPING, damping),
            (&key::HOST_TORQUE, torque),
            (&key::HOST_TIMEOUT, timeout),
        ];
        table(&mut lines, &key::HOST, numbers.map(|(key, value)| (key, Some(value))));
    }
    match *supply {
        None => {}
        Some(FileSupply::Sinks { largest_speed }) => {
            lines.push("[supply]\nsinks = true".to_owned());
            number(&mut lines, key::LARGEST_SPEED.name(), Some(largest_speed));
        }
        Some(FileSupply::Stores { bus, largest_speed }) => {
            let numbers = [
                (&key::SUPPLY_VOLTAGE, bus.voltage),
                (&key::FAULT_VOLTAGE, bus.fault_level),
                (&key::CAPACITANCE, bus.capacitance),
                (&key::LARGEST_SPEED, largest_speed),
            ];
            table(&mut lines, &key::SUPPLY, numbers.map(|(key, value)| (key, Some(value))));
        }
    }
    if let Some(FileMotor { motor, lowest_supply, highest_supply, index_offset }) = *motor {
        let numbers = [
            (&key::RESISTANCE, motor.resistance),
            (&key::INDUCTANCE, motor.inductance),
            (&key::TORQUE_CONSTANT, motor.torque_constant),
            (&key::LOWEST_SUPPLY, lowest_supply),
            (&key::HIGHEST_SUPPLY, highest_supply),
        ];
        table(&mut lines, &key::MOTOR, numbers.map(|(key, value)| (key, Some(value))));
        if motor.winding.is_brushless() {
            lines.push(format!("pole_pairs = {}", motor.winding.pole_pairs()));
        }
        lines.extend(index_offset.map(|IndexOffset { counts, is_reversed }| {
            format!("index_offset = {{ counts = {counts}, is_reversed = {is_reversed} }}")
        }));
    }
    lines.join("\n") + "\n"
}

/// A table of optional keys, if one of them is there.
fn table<const N: usize>(lines: &mut Vec<String>, key: &Key, numbers: [(&Key, Option<f64>); N]) {
    if numbers.iter().any(|(_, value)| value.is_some()) {
        lines.push(format!("[{}]", key.path));
        numbers.iter().for_each(|(key, value)| number(lines, key.name(), *value));
    }
}

/// An optional key.
fn number(lines: &mut Vec<String>, key: &str, value: Option<f64>) {
    lines.extend(value.map(|value| format!("{key} = {value:?}")));
}

/// A time or its range, unless it is 0, the default.
fn time(lines: &mut Vec<String>, key: &str, TimeRange { least, most }: TimeRange) {
    // By their bits: -0.0 is another number than 0.0.
    match (least.to_bits(), most.to_bits()) {
        (0, 0) => {}
        (a, b) if a == b => lines.push(format!("{key} = {least:?}")),
        _ => lines.push(format!("{key} = [{least:?}, {most:?}]")),
    }
}

/// The number in fewest digits to which adding `part` gives `sum`.
fn less(sum: f64, part: f64) -> f64 {
    if part == 0.0 {
        return sum;
    }
    let difference = (sum - part).max(0.0);
    let in_digits = |digits: usize| format!("{difference:.digits$e}").parse().unwrap_or(difference);
    (0..17).map(in_digits).find(|rest| rest + part == sum).unwrap_or(difference)
}

/// Writes the encoder's table, if it is not that of a quadrature encoder.
fn encoder(lines: &mut Vec<String>, reading: &EncoderReading, chip: Option<&Chip>) {
    let EncoderReading { age, window, linearity, noise, hysteresis, dropped, .. } = *reading;
    if *reading == EncoderReading::IDEAL && chip.is_none() {
        return;
    }
    lines.push("[encoder]".to_owned());
    lines.extend(chip.map(|chip| format!("chip = {}", quoted(chip.name))));
    time(lines, "age", age);
    let numbers = [
        ("window", window),
        ("linearity", linearity),
        ("noise", noise),
        ("hysteresis", hysteresis),
    ];
    for (key, value) in numbers {
        number(lines, key, Some(value).filter(|value| *value != 0.0));
    }
    if dropped > 0 {
        lines.push(format!("dropped = {dropped}"));
    }
}

fn cogging_of(harmonics: &[Sine]) -> String {
    let of = |&Sine { torque, count, phase }: &Sine| {
        let phase = if phase == 0.0 { String::new() } else { format!(", phase = {phase:?}") };
        format!("{{ torque = {torque:?}, count = {count}{phase} }}")
    };
    match harmonics {
        [one] => of(one),
        all => format!("[{}]", all.iter().map(of).collect::<Vec<_>>().join(", ")),
    }
}

/// Writes the passivity only if it was declared and differs from the chain's own.
fn device(
    lines: &mut Vec<String>,
    chain: &Chain,
    scene: &Scene,
    friction: Option<f64>,
    cogging: Option<Cogging>,
) {
    let own = chain.as_rigid().ok().and_then(|own| own.passivity);
    let declared = scene.device.passivity.filter(|passivity| !passivity.is_nan());
    let passivity = declared.filter(|&declared| Some(declared) != own);
    if let [mass] = chain.masses() {
        lines.push(format!("inertia = {:?}\ndamping = {:?}", mass.inertia, mass.damping));
    }
    number(lines, "passivity", passivity);
    number(lines, "friction", friction);
    lines.extend(cogging.map(|cogging| format!("cogging = {}", cogging_of(cogging.harmonics))));
    if chain.encoder() == EncoderPlace::Hand {
        lines.push(format!("encoder = {}", quoted(EncoderPlace::Hand.as_str())));
    }
    time(lines, "actuator_lag", scene.latency.actuator_lag);
    time(lines, "sensor_lag", scene.latency.sensor_lag);
    if scene.latency.encoder.window == 0.0 {
        time(lines, "actuator_response", scene.latency.actuator_response);
    }
    if scene.latency.actuator_updates > 0 {
        lines.push(format!("actuator_updates = {}", scene.latency.actuator_updates));
    }
    if chain.masses().len() > 1 {
        let damped = |table: &str, key: &str, value: f64, damping: f64| {
            format!("[[device.{table}]]\n{key} = {value:?}\ndamping = {damping:?}")
        };
        let masses = chain.masses().iter();
        lines.extend(masses.map(|mass| damped("mass", "inertia", mass.inertia, mass.damping)));
        let links = chain.links().iter();
        lines.extend(links.map(|link| damped("link", "stiffness", link.stiffness, link.damping)));
    }
}

/// The name of an environment's type in a file.
pub fn kind(environment: &Environment) -> &'static str {
    Kind::of(environment).map_or("stated", |kind| kind.name)
}

fn environment(lines: &mut Vec<String>, environment: &Environment) {
    let Some(kind) = Kind::of(environment) else { return };
    lines.push(format!("type = \"{}\"", kind.name));
    for key in kind.keys() {
        // By its bits: -0.0 is another number than 0.0.
        let is_default = |value: f64| {
            let left_out = |default: f64| default.to_bits() == value.to_bits();
            !kind.needed.contains(&key)
                && matches!(key.presence, Presence::Default(default) if left_out(default))
        };
        // A part that is written as a wall has a damping of 0, or a stiffness.
        let value = match key.parameter {
            Some(parameter @ (Parameter::Stiffness | Parameter::Damping)) => {
                environment.get(parameter).or(Some(0.0))
            }
            Some(parameter) => environment.get(parameter),
            None => None,
        };
        match (value, environment.rational()) {
            (Some(value), _) if !is_default(value) => {
                lines.push(format!("{} = {}", key.name(), number_of(key, value)));
            }
            (None, Some(rational)) if *key == key::NUMERATOR => {
                lines.push(format!("numerator = {:?}", rational.numerator.as_slice()));
            }
            (None, Some(rational)) if *key == key::DENOMINATOR => {
                lines.push(format!("denominator = {:?}", rational.denominator.as_slice()));
            }
            _ => {}
        }
    }
    if environment.wall().is_some_and(Wall::is_one_sided) {
        lines.push("one_sided = true".to_owned());
    }
}

/// A number in the notation of TOML, a whole number without a point.
fn number_of(key: &Key, value: f64) -> String {
    match key.bound {
        Bound::Number(Range::Whole(..)) => format!("{value}"),
        _ => format!("{value:?}"),
    }
}

/// A string in the notation of TOML's basic strings, which is that of JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::{Format, Purpose, parse_for};

    /// The file as it is read, written and read again.
    fn again(text: &str) -> [SceneFile; 2] {
        let first = parse_for(Purpose::Simulate, "a.toml", Format::Toml, text).unwrap();
        let written = toml(&first);
        let second = parse_for(Purpose::Simulate, "b.toml", Format::Toml, &written);
        let second = second.unwrap_or_else(|error| panic!("{error}\n{written}"));
        [first, second]
    }

    const RIGID: &str = "inertia = 2.2e-5\ndamping = 0.1\npassivity = 0.07\nfriction = 0.003\n\
                         cogging = { torque = 0.005, count = 84 }\n";
    const SERVO: &str = "period = 0.001\nworst_period = 0.003\n";
    const SPRING: &str = "[environment]\ntype = \"delayed-spring\"\nstiffness = 0.1\ndelay = 3\n";
    const CHAIN: &str = "[[device.mass]]\ninertia = 1e-5\ndamping = 0.3\n[[device.mass]]\n\
                         inertia = 2e-5\ndamping = 0.1\n[[device.link]]\nstiffness = 60\ndamping = 0.2\n";

    fn text(device: &str, servo: &str, rest: &str) -> String {
        format!("name = \"a \\\"b\\\"\"\n[servo]\n{servo}[device]\n{device}{rest}")
    }

    #[test]
    fn what_is_written_reads_back_as_the_same_scene_to_the_last_bit() {
        let environments = [
            "type = \"delayed-spring\"\nstiffness = 0.1\ndelay = 3\n[coupling]\nstiffness = 44\n\
             [limits]\ntorque = 0.7\n",
            "type = \"damper-wall\"\nstiffness = 1e-30\ndamping = -0.3\ndelay = 0\n\
             filter = 0.3\nface = -0.2\none_sided = true\n",
            "type = \"free-mode\"\nresidual = 0.001\ndelay = 1\n",
            "type = \"free-mode\"\nresidual = 0.001\ndelay = 1\ndrag = -0.002\n",
            "type = \"damper-wall\"\nstiffness = 0\ndamping = 0\ndelay = 2\ndrag = 0.01\n",
            "type = \"free-mode-wall\"\nresidual = 0.001\nstiffness = 3\ndamping = 0.2\ndelay = 1\n",
            "type = \"rational\"\nnumerator = [1, -0.3]\ndenominator = [1, 0.1, 0.7]\ndelay = 2\n\
             unit_zeros = 1\n",
        ];
        let environments =
            environments.map(|it| text(RIGID, SERVO, &format!("[environment]\n{it}")));
        let latencies = [
            ("actuator_lag = [1e-5, 1.0000000000000002e-5]\n", "", ""),
            ("sensor_lag = 3e-5\n", "output_delay = [0, 5e-6]\n", "type = \"matched\"\n"),
            ("actuator_response = [1e-5, 3e-4]\n", "output_delay = 5e-6\n", "stiffness = 3\n"),
            ("actuator_lag = 3e-4\nactuator_updates = 5\n", "output_delay = 5e-4\n", ""),
            (
                "",
                "output_delay = 0.0081\noutput_jitter = 1e-6\n",
                "type = \"spring\"\nstiffness = 4\n",
            ),
            ("", "output_delay = 5e-6\noutput_jitter = 1e-6\ncount_jitter = 3e-6\n", ""),
            ("actuator_lag = -0.0\n", "output_delay = [1e-6, 1e-6]\noutput_jitter = 1e-6\n", ""),
            (
                "[encoder]\nage = [1e-5, 3.1e-5]\nlinearity = 0.03\nnoise = 2\nhysteresis = 0.5\n",
                "output_delay = 5e-6\ncount_jitter = 1e-6\n",
                "",
            ),
            (
                "[encoder]\nage = 1e-4\nwindow = 9e-5\ndropped = 2\n",
                "output_delay = [1e-6, 7e-6]\n",
                "",
            ),
        ];
        let latencies = latencies.map(|(device, servo, coupling)| {
            let table = if coupling.is_empty() { "" } else { "[coupling]\n" };
            let rest = format!("{SPRING}{table}{coupling}");
            text(&format!("{RIGID}{device}"), &format!("period = 0.00125\n{servo}"), &rest)
        });
        let motions = [
            "torque = [0.1, -2e-9]",
            "torque_file = \"a \\\"push\\\".csv\"",
            "torque_sine = { amplitude = 0.1, omega = 60, phase = 0.2 }",
            "torque_sine = { amplitude = 0.1, omega = 60, held = true }",
            "torque_pulses = { amplitude = -0.1, every = 50, length = 7 }",
            "missed = { every = 7, length = 3 }",
            "dropped = { fraction = 0.1, seed = 3 }",
            "missed = { fraction = 0.1, seed = 3 }\nlatency = 0.0002\nfriction = 0.01",
            "position = 0.1\nvelocity = -2",
        ];
        let motions = motions.map(|motion| {
            let rest = format!(
                "{SPRING}[simulation]\nsamples = 9\n{motion}\n[human]\ninertia = 0.1\n\
                 stiffness = 3\n[limits]\nencoder_step = 1e-4\nfull_scale = 0.7\n"
            );
            text(RIGID, SERVO, &rest)
        });
        let supplies = [
            "sinks = true\n",
            "voltage = 24.0\nfault_voltage = 25.2\ncapacitance = 1e-3\nlargest_speed = 25.0\n",
        ];
        let supplies = supplies.map(|supply| {
            text(RIGID, SERVO, &format!("{SPRING}[limits]\ntorque = 1.0\n[supply]\n{supply}"))
        });
        let chains =
            ["", "passivity = 0.3\n"].map(|more| text(&format!("{more}{CHAIN}"), SERVO, SPRING));
        for text in [&environments[..], &latencies, &motions, &supplies, &chains].concat() {
            let [first, second] = again(&text);
            assert_eq!(first, second);
            let bits = |file: &SceneFile| file.scene.latency.actuator_lag.least.to_bits();
            assert_eq!(bits(&first), bits(&second));
            let is_declared = text.contains("passivity");
            assert_eq!(toml(&first).contains("passivity"), is_declared, "{text}");
        }
    }

    #[test]
    fn a_default_is_left_out_and_a_chain_without_passivity_stays_one() {
        let wall =
            "[environment]\ntype = \"damper-wall\"\nstiffness = 3\ndamping = 0.2\ndelay = 1\n";
        let [absent, zero] =
            ["", "face = 0.0\n"].map(|face| again(&text(RIGID, SERVO, &format!("{wall}{face}"))));
        assert_eq!(absent, zero);
        let lagging = format!("encoder = \"hand\"\nactuator_lag = 1e-4\n{CHAIN}");
        let [first, second] = again(&text(&lagging, SERVO, SPRING));
        assert_eq!(first.scene.latency.actuator_lag, TimeRange::exactly(1e-4));
        // Its passivity is NaN, which equals nothing.
        assert_eq!((&first.chain, toml(&first)), (&second.chain, toml(&second)));
    }
}
