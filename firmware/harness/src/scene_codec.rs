//! Codec of a scene by the bits of its numbers, and of the board's certify reply.
//!
//! The compiler, the host and the board compute the same certificate; with this codec a test gets the
//! board's, to compare the three bit for bit. It is not a way to change the scene of a servo.

use haptic_servo::certificate::{Assessment, Parameter, PassivityProblem, RuleAnswer, assess};
use haptic_servo::environment::{
    Canceller, Coefficients, Environment, MAX_DEGREE, Parts, Rational, Side, Wall,
};
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

use crate::tables;

/// Numbers in a polynomial.
const TERMS: usize = MAX_DEGREE + 1;

/// A scene as 64-bit words; an `f64` is its bits.
pub type SceneWords = [u64; WORDS];

/// Words of a scene: the type of its environment, whether its coupling is matched, the updates of its
/// amplifier, each number with a flag for its presence, the side of a wall, and two polynomials.
const WORDS: usize = 3 + 2 * Parameter::ALL.len() + 1 + 2 * (1 + TERMS);

/// An enclosure's ends as bits; `None` if the index does not exist.
pub type IntervalBits = Option<(u64, u64)>;

/// Certificate that the board computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CertifyReply {
    /// Index of the environment alone.
    pub alpha: IntervalBits,
    /// Index behind the coupling.
    pub alpha_coupled: IntervalBits,
    /// Index at the port of a scene with latency.
    pub alpha_port: IntervalBits,
    /// Equations 17 to 19.
    pub paper: RuleAnswer,
    /// Theory, section 4.1.
    pub exact: RuleAnswer,
    /// Instructions for certifying; 0 if they are not counted.
    pub instructions: u64,
    /// Whether the scene is certified, computed without the numbers of the verdict.
    pub is_certified: bool,
    /// Instructions for that verdict.
    pub verdict_instructions: u64,
}

/// A [`CertifyReply`] as words.
pub type ReplyWords = [u64; 14];

/// The walls of scenes without a torque profile: each has a word alone, and the next with a canceller.
const WALLS: [Option<Wall>; 3] =
    [None, Some(Wall::spring(0.0, 0)), Some(Wall::damped(0.0, 0.0, 0))];
/// The word of a rational environment.
const RATIONAL: u64 = 2 * WALLS.len() as u64;
/// The word of an environment without a law on these boards: a type of another crate, an unknown table, or a
/// sum with a table.
const STATED: u64 = RATIONAL + 1;
/// The word of the first table of a torque profile.
const TABLE: u64 = STATED + 1;

/// The words of a scene.
pub fn encode(scene: &Scene) -> SceneWords {
    let mut words = Cursor { words: [0; _], next: 0 };
    words.push(match scene.environment {
        Environment::Parts(Parts { canceller, wall, profile: None }) => {
            let of_wall = wall.map_or(0, |wall| 1 + u64::from(wall.damper.is_some()));
            2 * of_wall + u64::from(canceller.is_some())
        }
        Environment::Parts(Parts { canceller: None, wall: None, profile: Some(profile) }) => {
            tables::index_of(&profile).map_or(STATED, |table| TABLE + table as u64)
        }
        Environment::Rational(_) => RATIONAL,
        Environment::Parts(_) | Environment::Stated(_) => STATED,
    });
    words.push(matches!(scene.coupling, Coupling::Matched).into());
    words.push(scene.latency.actuator_updates.into());
    for parameter in Parameter::ALL {
        words.optional(scene.get(*parameter));
    }
    words.push(scene.environment.wall().map_or(0, |wall| match wall.side {
        Side::Centred => 0,
        Side::Displaced(_) => 1,
        Side::Face(_) => 2,
    }));
    let rational = scene.environment.rational().unwrap_or(&NO_RATIONAL);
    words.polynomial(&rational.numerator);
    words.polynomial(&rational.denominator);
    words.words
}

/// A placeholder for a polynomial.
const NOTHING: Coefficients = match Coefficients::new(&[1.0]) {
    Some(one) => one,
    None => panic!("one coefficient fits"),
};

/// A placeholder for environments that are not rational.
const NO_RATIONAL: Rational =
    Rational { numerator: NOTHING, denominator: NOTHING, delay: 0, unit_zeros: 0 };

/// A scene without numbers.
const BLANK: Scene = Scene {
    device: Device { inertia: 0.0, damping: 0.0, passivity: None },
    timing: Timing { period: 0.0, worst_period: None },
    coupling: Coupling::Rigid,
    environment: Environment::Rational(NO_RATIONAL),
    latency: Latency::NONE,
    torque_limit: None,
};

/// The scene of the words; `None` if they are invalid. These boards have no law for stated environments, and
/// only the tables of knots in [`tables`].
pub fn decode(words: &SceneWords) -> Option<Scene> {
    let mut words = Cursor { words: *words, next: 0 };
    let kind = words.take();
    let environment = match kind {
        RATIONAL => Environment::Rational(NO_RATIONAL),
        STATED => return None,
        TABLE.. => tables::from_index((kind - TABLE) as usize)?.alone(),
        _ => {
            let canceller = (kind % 2 == 1).then_some(Canceller::to(0.0));
            Parts { canceller, wall: WALLS[kind as usize / 2], profile: None }.sum()
        }
    };
    let mut scene = Scene { environment, ..BLANK };
    if words.take() != 0 {
        scene.coupling = Coupling::Matched;
    }
    scene.latency.actuator_updates = words.take() as u16;
    for parameter in Parameter::ALL {
        let Some(value) = words.take_optional() else { continue };
        match (parameter, &mut scene.environment) {
            // A table's word does not tell whether it is damped.
            (Parameter::Damping, Environment::Parts(Parts { profile: Some(profile), .. })) => {
                profile.damping = Some(value);
            }
            _ => scene = scene.with(*parameter, value)?,
        }
    }
    let side = words.take();
    if let Some(wall) = scene.environment.wall_mut() {
        wall.side = match side {
            0 => Side::Centred,
            1 => Side::Displaced(wall.face()),
            _ => Side::Face(wall.face()),
        };
    }
    let (numerator, denominator) = (words.take_polynomial()?, words.take_polynomial()?);
    if let Environment::Rational(rational) = &mut scene.environment {
        (rational.numerator, rational.denominator) = (numerator, denominator);
    }
    Some(scene)
}

/// Certifies the scene of the words; `None` if they are malformed. `count` measures the
/// instructions that this takes.
pub fn certify(words: &SceneWords, count: impl Fn(&mut dyn FnMut()) -> u64) -> Option<ReplyWords> {
    let scene = decode(words)?;
    let mut found = None;
    let instructions = count(&mut || found = Some(assess(&scene)));
    let mut is_certified = false;
    let verdict_instructions = count(&mut || {
        is_certified = PassivityProblem::of(&scene).is_ok_and(|posed| posed.is_certified());
    });
    let Assessment { alpha, alpha_coupled, alpha_port, paper, exact, .. } = found?;
    let mut words = Cursor { words: [0; _], next: 0 };
    words.interval(alpha);
    words.interval(alpha_coupled);
    words.interval(alpha_port);
    words.push(answer_code(paper));
    words.push(answer_code(exact));
    words.push(instructions);
    words.push(is_certified.into());
    words.push(verdict_instructions);
    Some(words.words)
}

/// The reply of the words; `None` if they are malformed.
pub fn decode_reply(words: &ReplyWords) -> Option<CertifyReply> {
    let mut words = Cursor { words: *words, next: 0 };
    Some(CertifyReply {
        alpha: words.take_interval(),
        alpha_coupled: words.take_interval(),
        alpha_port: words.take_interval(),
        paper: answer_from_code(words.take())?,
        exact: answer_from_code(words.take())?,
        instructions: words.take(),
        is_certified: words.take() != 0,
        verdict_instructions: words.take(),
    })
}

/// An answer as a word.
fn answer_code(answer: RuleAnswer) -> u64 {
    match answer {
        RuleAnswer::Pass => 0,
        RuleAnswer::Fail => 1,
        RuleAnswer::Undecided => 2,
    }
}

/// The answer of a word.
fn answer_from_code(word: u64) -> Option<RuleAnswer> {
    [RuleAnswer::Pass, RuleAnswer::Fail, RuleAnswer::Undecided]
        .into_iter()
        .find(|a| answer_code(*a) == word)
}

/// Words, and the place of the next one.
struct Cursor<const N: usize> {
    words: [u64; N],
    next: usize,
}

impl<const N: usize> Cursor<N> {
    fn push(&mut self, word: u64) {
        self.words[self.next] = word;
        self.next += 1;
    }

    fn take(&mut self) -> u64 {
        self.next += 1;
        self.words[self.next - 1]
    }

    fn number(&mut self, value: f64) {
        self.push(value.to_bits());
    }

    fn take_number(&mut self) -> f64 {
        f64::from_bits(self.take())
    }

    fn optional(&mut self, value: Option<f64>) {
        self.push(value.is_some() as u64);
        self.number(value.unwrap_or(0.0));
    }

    fn take_optional(&mut self) -> Option<f64> {
        let is_some = self.take() != 0;
        let value = self.take_number();
        is_some.then_some(value)
    }

    fn polynomial(&mut self, polynomial: &Coefficients) {
        let values = polynomial.as_slice();
        self.push(values.len() as u64);
        for i in 0..TERMS {
            self.number(values.get(i).copied().unwrap_or(0.0));
        }
    }

    fn take_polynomial(&mut self) -> Option<Coefficients> {
        let len = self.take() as usize;
        let values: [f64; TERMS] = core::array::from_fn(|_| self.take_number());
        Coefficients::new(values.get(..len)?)
    }

    fn interval(&mut self, interval: Option<Interval>) {
        self.push(interval.is_some() as u64);
        self.number(interval.map_or(0.0, Interval::lo));
        self.number(interval.map_or(0.0, Interval::hi));
    }

    fn take_interval(&mut self) -> IntervalBits {
        let is_some = self.take() != 0;
        let ends = (self.take(), self.take());
        is_some.then_some(ends)
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::environment::{Ends, Profile};

    use super::*;

    fn scene(environment: Environment) -> Scene {
        Scene {
            device: Device { inertia: 0.1, damping: 0.2, passivity: Some(0.3) },
            timing: Timing { period: 0.4, worst_period: None },
            coupling: Coupling::Spring { stiffness: f64::MIN_POSITIVE },
            environment,
            latency: Latency::sampled(3, 0.25, 1.5),
            torque_limit: Some(f64::INFINITY),
        }
    }

    #[test]
    fn scenes_survive_their_words() {
        let spring = Wall::spring(-1.5, 3);
        let wall = Wall::damped(-1.5, 2.5, 3);
        let canceller = Canceller { residual: 0.25, delay: 1 };
        let free =
            |wall| Parts { canceller: Some(Canceller::to(0.25)), wall: Some(wall), profile: None };
        let rational = Rational {
            numerator: Coefficients::new(&[1.0, -0.0, 5e-324]).unwrap(),
            denominator: Coefficients::new(&[0.1; TERMS]).unwrap(),
            delay: 7,
            unit_zeros: 2,
        };
        let ends = Some(Ends { from: -1.0, to: 2.0, stiffness: 3.0 });
        let magnet = Profile { ends, count: 3.0, ..Profile::of(&tables::MAGNET, 2) };
        let knob = magnet.damped(0.01);
        for environment in [
            spring.alone(),
            Wall { side: Side::Displaced(-0.0), ..wall }.alone(),
            wall.filtered(0.75).behind(-0.0).alone(),
            canceller.alone(),
            free(spring).sum(),
            free(wall.filtered(0.75).behind(-0.0)).sum(),
            Environment::Rational(rational),
            Profile::of(&tables::DETENTS, 1).alone(),
            knob.alone(),
        ] {
            let asked = scene(environment);
            assert_eq!(decode(&encode(&asked)), Some(asked));
        }
    }

    #[test]
    fn words_that_are_no_scene_are_refused() {
        assert!(decode(&[u64::MAX; WORDS]).is_none());
        assert!(decode(&[0; WORDS]).is_none());
        let mut stated = encode(&scene(Canceller::to(0.0).alone()));
        for kind in [STATED, TABLE + 6, u64::MAX] {
            stated[0] = kind;
            assert!(decode(&stated).is_none(), "{kind}");
        }
    }

    #[test]
    fn a_reply_carries_the_bits_of_the_assessment() {
        let scene = Scene {
            torque_limit: None,
            coupling: Coupling::Rigid,
            ..scene(Wall::spring(1.0, 1).alone())
        };
        let words = encode(&scene);
        let words = certify(&words, |run| {
            run();
            17
        });
        let found = assess(&scene);
        let bits = |i: Option<Interval>| i.map(|i| (i.lo().to_bits(), i.hi().to_bits()));
        let expected = CertifyReply {
            alpha: bits(found.alpha),
            alpha_port: None,
            alpha_coupled: bits(found.alpha_coupled),
            paper: found.paper,
            exact: found.exact,
            instructions: 17,
            is_certified: found.outcome.is_ok(),
            verdict_instructions: 17,
        };
        assert_eq!(decode_reply(&words.unwrap()), Some(expected));
    }
}
