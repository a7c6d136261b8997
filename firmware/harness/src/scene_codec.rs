//! Codec of a scene by the bits of its numbers, and of the board's certify reply.
//!
//! The compiler, the host and the board compute the same certificate; with this codec a test asks a
//! board, so that the three can be compared bit for bit. Scenes do not get to a servo this way.

use firmware::certificate::{Answer, Assessment, assess};
use firmware::environment::{Coefficients, Environment, MAX_DEGREE, Rational, Wall};
use firmware::passivity::interval::Interval;
use firmware::scene::{Coupling, Device, Scene, Timing};

/// Numbers in a polynomial.
const TERMS: usize = MAX_DEGREE + 1;

/// A scene as 64-bit words; an `f64` is its bits.
pub type SceneWords = [u64; WORDS];

/// Words of a scene: 11 around the environment, its kind, a wall and a residual, a rational
/// function.
const WORDS: usize = 11 + 1 + (7 + 1) + (2 + 2 * (1 + TERMS));

/// An enclosure's ends as bits; `None` where the index does not exist.
pub type IntervalBits = Option<(u64, u64)>;

/// Certificate that the board computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CertifyReply {
    /// Index of the environment alone.
    pub alpha: IntervalBits,
    /// Index behind the coupling.
    pub alpha_coupled: IntervalBits,
    /// Equations 17 to 19.
    pub paper: Answer,
    /// Theory, section 4.1.
    pub exact: Answer,
    /// Instructions that certifying took; 0 where nothing counts them.
    pub instructions: u64,
}

/// A [`CertifyReply`] as words.
pub type ReplyWords = [u64; 9];

/// The words of a scene.
pub fn encode(scene: &Scene) -> SceneWords {
    let mut words = Cursor { words: [0; _], next: 0 };
    words.number(scene.device.inertia);
    words.number(scene.device.damping);
    words.optional(scene.device.passivity);
    words.number(scene.timing.period);
    words.optional(scene.timing.worst_period);
    words.optional(match scene.coupling {
        Coupling::Rigid => None,
        Coupling::Spring { stiffness } => Some(stiffness),
    });
    words.optional(scene.torque_limit);
    let (kind, wall, residual, rational) = match scene.environment {
        Environment::DelayedSpring(wall) => (0, wall, 0.0, NO_RATIONAL),
        Environment::DamperWall(wall) => (1, wall, 0.0, NO_RATIONAL),
        Environment::FreeMode { residual, delay } => {
            (2, Wall { delay, ..NO_WALL }, residual, NO_RATIONAL)
        }
        Environment::FreeModeWall { residual, wall } => (3, wall, residual, NO_RATIONAL),
        Environment::Rational(rational) => (4, NO_WALL, 0.0, rational),
    };
    words.push(kind);
    words.wall(&wall);
    words.number(residual);
    words.rational(&rational);
    words.words
}

/// Stands in where an environment has no wall.
const NO_WALL: Wall =
    Wall { stiffness: 0.0, damping: 0.0, filter: None, delay: 0, face: 0.0, one_sided: false };

/// A polynomial that says nothing.
const NOTHING: Coefficients = match Coefficients::new(&[1.0]) {
    Some(one) => one,
    None => panic!("one coefficient fits"),
};

/// Stands in where an environment is no rational function.
const NO_RATIONAL: Rational =
    Rational { numerator: NOTHING, denominator: NOTHING, delay: 0, unit_zeros: 0 };

/// The scene of the words; `None` if they are malformed.
pub fn decode(words: &SceneWords) -> Option<Scene> {
    let mut words = Cursor { words: *words, next: 0 };
    let device = Device {
        inertia: words.take_number(),
        damping: words.take_number(),
        passivity: words.take_optional(),
    };
    let timing = Timing { period: words.take_number(), worst_period: words.take_optional() };
    let coupling = match words.take_optional() {
        None => Coupling::Rigid,
        Some(stiffness) => Coupling::Spring { stiffness },
    };
    let torque_limit = words.take_optional();
    let kind = words.take();
    let wall = words.take_wall();
    let residual = words.take_number();
    let rational = words.take_rational()?;
    let environment = match kind {
        0 => Environment::DelayedSpring(wall),
        1 => Environment::DamperWall(wall),
        2 => Environment::FreeMode { residual, delay: wall.delay },
        3 => Environment::FreeModeWall { residual, wall },
        4 => Environment::Rational(rational),
        _ => return None,
    };
    Some(Scene { device, timing, coupling, environment, torque_limit })
}

/// Certifies the scene of the words; `None` if they are malformed. `count` measures the
/// instructions that this takes.
pub fn certify(
    words: &SceneWords,
    count: impl FnOnce(&mut dyn FnMut()) -> u64,
) -> Option<ReplyWords> {
    let scene = decode(words)?;
    let mut found = None;
    let instructions = count(&mut || found = Some(assess(&scene)));
    let Assessment { alpha, alpha_coupled, paper, exact, .. } = found?;
    let mut words = Cursor { words: [0; _], next: 0 };
    words.interval(alpha);
    words.interval(alpha_coupled);
    words.push(answer_code(paper));
    words.push(answer_code(exact));
    words.push(instructions);
    Some(words.words)
}

/// The reply of the words; `None` if they are malformed.
pub fn decode_reply(words: &ReplyWords) -> Option<CertifyReply> {
    let mut words = Cursor { words: *words, next: 0 };
    Some(CertifyReply {
        alpha: words.take_interval(),
        alpha_coupled: words.take_interval(),
        paper: answer_from_code(words.take())?,
        exact: answer_from_code(words.take())?,
        instructions: words.take(),
    })
}

/// An answer as a word.
fn answer_code(answer: Answer) -> u64 {
    match answer {
        Answer::Pass => 0,
        Answer::Fail => 1,
        Answer::Undecided => 2,
    }
}

/// The answer of a word.
fn answer_from_code(word: u64) -> Option<Answer> {
    [Answer::Pass, Answer::Fail, Answer::Undecided].into_iter().find(|a| answer_code(*a) == word)
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

    fn wall(&mut self, wall: &Wall) {
        self.number(wall.stiffness);
        self.number(wall.damping);
        self.optional(wall.filter);
        self.push(wall.delay as u64);
        self.number(wall.face);
        self.push(wall.one_sided as u64);
    }

    fn take_wall(&mut self) -> Wall {
        Wall {
            stiffness: self.take_number(),
            damping: self.take_number(),
            filter: self.take_optional(),
            delay: self.take() as usize,
            face: self.take_number(),
            one_sided: self.take() != 0,
        }
    }

    fn rational(&mut self, rational: &Rational) {
        self.push(rational.delay as u64);
        self.push(rational.unit_zeros as u64);
        self.polynomial(&rational.numerator);
        self.polynomial(&rational.denominator);
    }

    fn take_rational(&mut self) -> Option<Rational> {
        Some(Rational {
            delay: self.take() as usize,
            unit_zeros: self.take() as usize,
            numerator: self.take_polynomial()?,
            denominator: self.take_polynomial()?,
        })
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
    use super::*;

    fn scene(environment: Environment) -> Scene {
        Scene {
            device: Device { inertia: 0.1, damping: 0.2, passivity: Some(0.3) },
            timing: Timing { period: 0.4, worst_period: None },
            coupling: Coupling::Spring { stiffness: f64::MIN_POSITIVE },
            environment,
            torque_limit: Some(f64::INFINITY),
        }
    }

    #[test]
    fn scenes_survive_their_words() {
        let wall = Wall {
            stiffness: -1.5,
            damping: 2.5,
            filter: Some(0.75),
            delay: 3,
            face: -0.0,
            one_sided: true,
        };
        let rational = Rational {
            numerator: Coefficients::new(&[1.0, -0.0, 5e-324]).unwrap(),
            denominator: Coefficients::new(&[0.1; TERMS]).unwrap(),
            delay: 7,
            unit_zeros: 2,
        };
        for environment in [
            Environment::DelayedSpring(wall),
            Environment::DamperWall(Wall { filter: None, ..wall }),
            Environment::FreeMode { residual: 0.25, delay: 1 },
            Environment::FreeModeWall { residual: 0.25, wall },
            Environment::Rational(rational),
        ] {
            let asked = scene(environment);
            assert_eq!(decode(&encode(&asked)), Some(asked));
        }
    }

    #[test]
    fn words_that_are_no_scene_are_refused() {
        assert!(decode(&[u64::MAX; WORDS]).is_none());
        assert!(decode(&[0; WORDS]).is_none());
    }

    #[test]
    fn a_reply_carries_the_bits_of_the_assessment() {
        let spring = Wall { stiffness: 1.0, delay: 1, ..NO_WALL };
        let scene = Scene {
            torque_limit: None,
            coupling: Coupling::Rigid,
            ..scene(Environment::DelayedSpring(spring))
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
            alpha_coupled: bits(found.alpha_coupled),
            paper: found.paper,
            exact: found.exact,
            instructions: 17,
        };
        assert_eq!(decode_reply(&words.unwrap()), Some(expected));
    }
}
