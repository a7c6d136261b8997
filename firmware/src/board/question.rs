//! A scene put to a board by the bits of its numbers, and the board's answer.
//!
//! The certificate is judged by the compiler, by the host and by the board; this is how a test asks
//! a board, so that the three can be compared bit for bit. It is not how a scene gets to a servo.

use crate::certificate::{Answer, Assessment, assess};
use crate::environment::{Coefficients, Environment, MAX_DEGREE, Rational};
use crate::passivity::interval::Interval;
use crate::scene::{Coupling, Device, Scene, Timing};

/// Numbers in a polynomial.
const TERMS: usize = MAX_DEGREE + 1;

/// A scene with a rational environment as 64-bit words; an `f64` is its bits.
pub type Question = [u64; 14 + 2 * TERMS];

/// An enclosure's ends as bits; `None` where the index does not exist.
pub type Ends = Option<(u64, u64)>;

/// What the board found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reply {
    /// Index of the environment alone.
    pub alpha: Ends,
    /// Index behind the coupling.
    pub alpha_coupled: Ends,
    /// Equations 17 to 19.
    pub paper: Answer,
    /// Theory, section 4.1.
    pub exact: Answer,
    /// Instructions that the judgement took; 0 where nothing counts them.
    pub instructions: u64,
}

/// A [`Reply`] as words.
pub type ReplyWords = [u64; 9];

/// The words of a scene.
pub fn ask(scene: &Scene<Rational>) -> Question {
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
    words.push(scene.environment.delay as u64 | (scene.environment.unit_zeros as u64) << 32);
    words.polynomial(&scene.environment.numerator);
    words.polynomial(&scene.environment.denominator);
    words.words
}

/// The scene of the words; `None` if they are none.
pub fn read(question: &Question) -> Option<Scene> {
    let mut words = Cursor { words: *question, next: 0 };
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
    let counts = words.take();
    let environment = Environment::Rational(Rational {
        delay: (counts & 0xFFFF_FFFF) as usize,
        unit_zeros: (counts >> 32) as usize,
        numerator: words.take_polynomial()?,
        denominator: words.take_polynomial()?,
    });
    Some(Scene { device, timing, coupling, environment, torque_limit })
}

/// Judges the scene of a question; `None` if the question is not one. `count` measures the
/// judgement in instructions.
pub fn answer(
    question: &Question,
    count: impl FnOnce(&mut dyn FnMut()) -> u64,
) -> Option<ReplyWords> {
    let scene = read(question)?;
    let mut found = None;
    let instructions = count(&mut || found = Some(assess(&scene)));
    let Assessment { alpha, alpha_coupled, paper, exact, .. } = found?;
    let mut words = Cursor { words: [0; _], next: 0 };
    words.ends(alpha);
    words.ends(alpha_coupled);
    words.push(code(paper));
    words.push(code(exact));
    words.push(instructions);
    Some(words.words)
}

/// The reply of the words; `None` if they are none.
pub fn reply(words: &ReplyWords) -> Option<Reply> {
    let mut words = Cursor { words: *words, next: 0 };
    Some(Reply {
        alpha: words.take_ends(),
        alpha_coupled: words.take_ends(),
        paper: decode(words.take())?,
        exact: decode(words.take())?,
        instructions: words.take(),
    })
}

/// An answer as a word.
fn code(answer: Answer) -> u64 {
    match answer {
        Answer::Pass => 0,
        Answer::Fail => 1,
        Answer::Undecided => 2,
    }
}

/// The answer of a word.
fn decode(word: u64) -> Option<Answer> {
    [Answer::Pass, Answer::Fail, Answer::Undecided].into_iter().find(|a| code(*a) == word)
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

    fn ends(&mut self, interval: Option<Interval>) {
        self.push(interval.is_some() as u64);
        self.number(interval.map_or(0.0, Interval::lo));
        self.number(interval.map_or(0.0, Interval::hi));
    }

    fn take_ends(&mut self) -> Ends {
        let is_some = self.take() != 0;
        let ends = (self.take(), self.take());
        is_some.then_some(ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_survives_its_words() {
        let scene = Scene {
            device: Device { inertia: 0.1, damping: 0.2, passivity: Some(0.3) },
            timing: Timing { period: 0.4, worst_period: None },
            coupling: Coupling::Spring { stiffness: f64::MIN_POSITIVE },
            environment: Rational {
                numerator: Coefficients::new(&[1.0, -0.0, 5e-324]).unwrap(),
                denominator: Coefficients::new(&[0.1; TERMS]).unwrap(),
                delay: 7,
                unit_zeros: 2,
            },
            torque_limit: Some(f64::INFINITY),
        };
        let Some(back) = read(&ask(&scene)) else { panic!("the words are a scene") };
        let Environment::Rational(environment) = back.environment else { panic!("rational") };
        assert_eq!(ask(&with(back, environment)), ask(&scene));
    }

    fn with(scene: Scene, environment: Rational) -> Scene<Rational> {
        let Scene { device, timing, coupling, torque_limit, .. } = scene;
        Scene { device, timing, coupling, environment, torque_limit }
    }

    #[test]
    fn words_that_are_no_polynomial_are_no_scene() {
        assert!(read(&[u64::MAX; 14 + 2 * TERMS]).is_none());
        assert!(read(&[0; 14 + 2 * TERMS]).is_none());
    }

    #[test]
    fn a_reply_carries_the_bits_of_the_assessment() {
        let scene = Scene {
            device: Device { inertia: 1.0, damping: 1.0, passivity: None },
            timing: Timing { period: 0.001, worst_period: None },
            coupling: Coupling::Rigid,
            environment: Rational {
                numerator: Coefficients::new(&[1.0]).unwrap(),
                denominator: Coefficients::new(&[1.0]).unwrap(),
                delay: 1,
                unit_zeros: 0,
            },
            torque_limit: None,
        };
        let question = ask(&scene);
        let words = answer(&question, |run| {
            run();
            17
        });
        let found = assess(&read(&question).unwrap());
        let bits = |i: Option<Interval>| i.map(|i| (i.lo().to_bits(), i.hi().to_bits()));
        let expected = Reply {
            alpha: bits(found.alpha),
            alpha_coupled: bits(found.alpha_coupled),
            paper: found.paper,
            exact: found.exact,
            instructions: 17,
        };
        assert_eq!(reply(&words.unwrap()), Some(expected));
    }
}
