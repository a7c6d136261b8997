//! The advice of a rejection is true: the scene passes with the number changed to the printed value, or to
//! any value of the printed range, and no much smaller change of that number would have done.

use std::collections::BTreeMap;

use haptic_servo::certificate::{
    Parameter, PassivityProblem, Rejection, Rule, assess, assess_in, certify_in,
};
use haptic_servo::environment::Environment;
use haptic_servo::number::Format;
use haptic_servo::passivity::poles::UndecidedReason;
use haptic_servo::scene::{Coupling, Scene};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::scenes::{self, Poles};

/// The scene with one number changed; `None` if it does not have that number.
fn with(scene: &Scene, parameter: Parameter, value: f64) -> Option<Scene> {
    let mut scene = *scene;
    match (parameter, &mut scene.environment) {
        (Parameter::Period, _) => scene.timing.period = value,
        (Parameter::DeviceDamping, _) => scene.device.damping = value,
        (Parameter::Passivity, _) => scene.device.passivity = Some(value),
        (Parameter::CouplingStiffness, _) => scene.coupling = Coupling::Spring { stiffness: value },
        (Parameter::Stiffness, environment) => environment.wall_mut()?.stiffness = value,
        (Parameter::Damping, environment) => {
            environment.wall_mut()?.damper.as_mut()?.damping = value;
        }
        (Parameter::Residual, Environment::Parts(parts)) => {
            parts.canceller.as_mut()?.residual = value;
        }
        _ => return None,
    }
    Some(scene)
}

/// A remedy as it is printed.
#[derive(Clone, Copy, Debug)]
struct Printed {
    parameter: Parameter,
    lowest: Option<f64>,
    highest: Option<f64>,
}

/// Reads a remedy as a person would: `name <= X unit`, `X <= name <= Y unit` and so on.
fn read(text: &str) -> Printed {
    const NAMES: [Parameter; 7] = [
        Parameter::Stiffness,
        Parameter::Damping,
        Parameter::Residual,
        Parameter::CouplingStiffness,
        Parameter::Period,
        Parameter::Passivity,
        Parameter::DeviceDamping,
    ];
    let named = |words: &str| NAMES.into_iter().find(|name| name.name_and_unit().0 == words);
    let mut words: Vec<&str> = text.split(' ').collect();
    let number = |word: &str| word.parse::<f64>().unwrap_or_else(|_| panic!("{text}"));
    let mut lowest = None;
    if words[1] == "<=" && words[0].parse::<f64>().is_ok() {
        lowest = Some(number(words[0]));
        words.drain(..2);
    }
    let relation = words.iter().position(|word| ["<=", ">=", "="].contains(word)).unwrap();
    let parameter = named(&words[..relation].join(" ")).unwrap_or_else(|| panic!("{text}"));
    assert_eq!(words[relation + 2..].join(" "), parameter.name_and_unit().1, "{text}");
    let value = Some(number(words[relation + 1]));
    let (lowest, highest) = match words[relation] {
        "<=" => (lowest, value),
        ">=" => (value, None),
        _ => (value, value),
    };
    Printed { parameter, lowest, highest }
}

/// How far along a half-line is looked.
const FAR: f64 = 1e6;

impl Printed {
    fn kind(&self) -> &'static str {
        match (self.lowest, self.highest) {
            (None, _) => "<=",
            (_, None) => ">=",
            (lowest, highest) if lowest == highest => "=",
            _ => "range",
        }
    }

    /// From where to where the values go that are meant.
    fn ends(&self, scene: &Scene) -> (f64, f64) {
        match (self.lowest, self.highest, self.parameter) {
            (Some(lowest), Some(highest), _) => (lowest, highest),
            (None, Some(highest), Parameter::Period) => (highest / FAR, highest),
            (None, Some(highest), _) => (0.0, highest),
            (Some(lowest), None, Parameter::DeviceDamping) => (lowest, FAR * lowest),
            (Some(lowest), None, _) => (lowest, scene.device.damping),
            (None, None, _) => panic!("{self:?}"),
        }
    }

    /// Both ends, values next to them, and many in between, as many near zero as far from it.
    fn values(&self, scene: &Scene, rng: &mut ChaCha8Rng) -> Vec<f64> {
        const EACH: usize = 8;
        let (lo, hi) = self.ends(scene);
        assert!(lo <= hi, "{self:?} of {scene:?}");
        let mut values = vec![lo, hi];
        if lo < hi {
            let least = lo.max(hi / FAR);
            for _ in 0..EACH {
                values.push(rng.random_range(lo..hi));
                values.push(scenes::log_uniform(rng, least, hi));
                let next_to = scenes::log_uniform(rng, 1e-9, 1.0);
                values.push(lo + next_to * (hi - lo));
                values.push(hi - next_to * (hi - lo));
            }
        }
        values
    }

    /// A value that is not much nearer to what failed; `None` where the end is not a limit.
    fn too_near(&self) -> Option<f64> {
        match (self.parameter, self.lowest, self.highest) {
            (Parameter::CouplingStiffness, ..) => None,
            // A residual that was none before starts somewhere.
            (Parameter::Residual, ..) => None,
            (Parameter::Passivity | Parameter::DeviceDamping, lowest, _) => Some(lowest? / 1.03),
            (_, _, highest) => Some(highest? * 1.03),
        }
    }
}

fn passes(scene: &Scene, format: Format, printed: &Printed, value: f64) -> bool {
    let changed = with(scene, printed.parameter, value)
        .unwrap_or_else(|| panic!("{printed:?} names a number that {scene:?} does not have"));
    PassivityProblem::in_format(&changed, format).is_ok_and(|posed| posed.is_certified())
}

/// Whether a stiffness is so small that the two coefficients of the wall, which are nearly equal,
/// hide the sign of the residue. The scene passes, but its assessment is undecided.
fn is_hidden(scene: &Scene, format: Format, printed: &Printed, value: f64) -> bool {
    let is_small = printed.highest.is_some_and(|highest| value < 1e-4 * highest);
    if printed.parameter != Parameter::Stiffness || !is_small || format == Format::F64 {
        return false;
    }
    let changed = with(scene, printed.parameter, value).expect("it has a stiffness");
    let outcome = assess_in(&changed, format).outcome;
    matches!(outcome, Err(Rejection::Undecided { doubt: UndecidedReason::ResidueSign, .. }))
}

/// Every kind of environment and coupling, some of them one-sided or limited, with a longest period
/// or a declared passivity.
fn drawn(seed: u64) -> (Scene, Format) {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let mut scene = match seed % 8 {
        0..4 => scenes::wall(rng),
        4..7 => scenes::free(rng),
        _ => scenes::rational(rng, Poles { count: 3, nearest: 0.02, delay: 2 }),
    }
    .scene;
    let format = match rng.random_range(0..8) {
        0 | 1 => Format::F32,
        2 => Format::Fixed { fraction_bits: 16 },
        3 => Format::Fixed { fraction_bits: 24 },
        _ => Format::F64,
    };
    if rng.random_bool(0.4) {
        scene.torque_limit = Some(1.0);
        // Softer than the standard coupling, without which nothing passes.
        let standard = 2.0 * scene.device.damping / scene.timing.period;
        let part = [1.0, 1.0, scenes::log_uniform(rng, 0.1, 1.0)][rng.random_range(0..3)];
        scene.coupling = Coupling::Spring { stiffness: scenes::short(part * standard, 20) };
    }
    if rng.random_bool(0.15) {
        scene.timing.worst_period = Some(scene.timing.period * rng.random_range(1.0..2.0));
    }
    if rng.random_bool(0.2) {
        scene.device.passivity = Some(scene.device.damping * rng.random_range(0.3..=1.0));
    }
    (scene, format)
}

/// A number's name, how its values are printed, and whether coefficients are rounded.
type Parts = (&'static str, &'static str, bool);

/// As many remedies of a kind as have to be drawn for the test to say anything.
const LEAST: [(Parts, Rule, u32); 22] = [
    (("stiffness", "<=", false), Rule::Exact, 400),
    (("stiffness", "<=", false), Rule::Nonlinear, 300),
    (("stiffness", "<=", true), Rule::Exact, 400),
    (("stiffness", "<=", true), Rule::Nonlinear, 300),
    (("stiffness", "=", false), Rule::Exact, 70),
    (("damping", "<=", false), Rule::Exact, 35),
    (("damping", "<=", false), Rule::Nonlinear, 50),
    (("damping", "<=", true), Rule::Nonlinear, 50),
    (("damping", "range", false), Rule::Exact, 6),
    (("damping", "range", true), Rule::Exact, 8),
    (("residual", ">=", false), Rule::Exact, 50),
    (("residual", ">=", false), Rule::Nonlinear, 100),
    (("residual", "=", true), Rule::Exact, 150),
    (("coupling stiffness", "=", false), Rule::Exact, 150),
    (("coupling stiffness", "=", true), Rule::Nonlinear, 200),
    (("period", "<=", false), Rule::Exact, 250),
    (("period", "<=", true), Rule::Exact, 150),
    (("period", "<=", false), Rule::Nonlinear, 15),
    (("period", "range", false), Rule::Nonlinear, 50),
    (("device damping", ">=", false), Rule::Exact, 350),
    (("device damping", ">=", false), Rule::Nonlinear, 30),
    (("device passivity", ">=", false), Rule::Exact, 60),
];

#[test]
fn remedies_help() {
    const SCENES: u64 = 12_000;
    let (mut rejected, mut hidden, mut looked_at) = (0, 0, 0);
    let mut counts = BTreeMap::<(Parts, bool), u32>::new();
    for seed in 0..SCENES {
        let (scene, format) = drawn(seed);
        let Err(rejection) = certify_in(&scene, format) else { continue };
        rejected += 1;
        let rule = assess(&scene).rule;
        let sentence = rejection.sentence_in(format);
        for remedy in rejection.remedies().iter() {
            let text = remedy.to_string();
            assert!(sentence.as_str().contains(&text), "seed {seed}: {text} is cut off");
            let printed = read(&text);
            let is_the_same = (printed.parameter, printed.lowest, printed.highest)
                == (remedy.parameter, remedy.lowest, remedy.highest);
            assert!(is_the_same, "seed {seed}: {text} is not {remedy:?}");
            let rng = &mut ChaCha8Rng::seed_from_u64(seed);
            for value in printed.values(&scene, rng) {
                let is_hidden = is_hidden(&scene, format, &printed, value);
                looked_at += 1;
                hidden += u32::from(is_hidden);
                assert!(
                    is_hidden || passes(&scene, format, &printed, value),
                    "seed {seed}, {format}: {text} does not help with {value:e}: {scene:?}"
                );
            }
            let needless = |value| passes(&scene, format, &printed, value);
            assert!(
                !printed.too_near().is_some_and(needless),
                "seed {seed}, {format}: {text} asks too much"
            );
            let parameter = remedy.parameter.name_and_unit().0;
            let is_rounded = format != Format::F64;
            *counts
                .entry(((parameter, printed.kind(), is_rounded), rule == Rule::Exact))
                .or_default() += 1;
        }
    }
    println!("{counts:#?}");
    for (parts, rule, least) in LEAST {
        let count = counts.get(&(parts, rule == Rule::Exact)).copied().unwrap_or_default();
        assert!(count >= least, "{count} of {parts:?} {rule:?}");
    }
    println!("rejected={rejected} looked_at={looked_at} hidden={hidden}");
    assert!(1000 * hidden < looked_at, "{hidden} of {looked_at}");
}
