//! The cost of a tick of any scene on the emulated board, in every number format.
//!
//! A scene's program has its own type of servo: by its environment, its filter, its rest position and its
//! delay. All types of scenes in a file are measured, delays and degrees at a few values: a value between
//! them costs at most as much as the next larger. In `f64`, which is software, the cost of a tick also
//! depends on the numbers, which are those of one scene in one hand.

use haptic_servo::environment::{
    Canceller, Damper, Environment, MAX_DEGREE, MAX_DELAY, Parts, Profile, Rational, Side, Wall,
};
use haptic_servo::number::Arithmetic;

use super::servo::Case;
use super::{Axis, Comparison, Method, Tradeoff};
use crate::program::{Program, knob};
use crate::progress;
use crate::studies::error::StudyError;
use crate::studies::number_format::cost;

/// The comparison: types of scenes are its cases, and it has no error to draw.
pub(crate) static COMPARISON: Comparison = Comparison {
    name: "ticks",
    title: "Servo: number formats, a tick of each type of scene on the emulated Cortex-M4",
    cost: Axis::new("instructions", "most instructions from count to code"),
    errors: &[],
    others: &[],
    kept: include_bytes!("../../../pictures/tradeoff/ticks.csv"),
};

const DELAYS: [usize; 3] = [0, 1, MAX_DELAY];
const DEGREES: [usize; 4] = [1, 2, 4, MAX_DEGREE];

pub(crate) fn measure() -> Result<Tradeoff, StudyError> {
    let (mut board, cases) = (super::any_board()?, cases());
    let bar = progress::bar(cases.len() as u64, "types of scenes");
    let mut methods = Vec::new();
    for case in cases {
        let (motion, name) = (case.motion()?, type_of(&case.problem.scene.environment));
        for arithmetic in Arithmetic::ALL {
            let most = f64::from(cost(&mut board, &motion, arithmetic)?.most);
            methods.push(Method::new(&name, "", arithmetic.name(), [most]));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    board.finish()?;
    Ok(Tradeoff { comparison: &COMPARISON, methods })
}

/// The instructions of a scene in a format, by a table; infinite if no scene of its type was measured.
pub fn instructions(table: &Tradeoff, environment: &Environment, arithmetic: Arithmetic) -> f64 {
    let wanted = type_of(environment);
    let found = table.of(&wanted).find(|method| method.name == arithmetic.name());
    found.and_then(Method::cost).unwrap_or(f64::INFINITY)
}

/// The type of an environment, which determines the instructions of its tick, as text; with the measured
/// delays and degrees.
fn type_of(environment: &Environment) -> String {
    let delay = |delay: usize| format!("delay {}", measured(&DELAYS, delay));
    let parts = match environment {
        Environment::Parts(parts) => parts,
        Environment::Stated(_) => return "of another crate".to_owned(),
        Environment::Rational(rational) => {
            let degree = rational.denominator.as_slice().len().saturating_sub(1);
            let degree = measured(&DEGREES, degree);
            return format!("rational of degree {degree}, {}", delay(rational.delay));
        }
    };
    if parts.others() > 0 {
        return "sum with another part".to_owned();
    }
    match (&parts.canceller, &parts.wall, &parts.profile) {
        (None, None, Some(profile)) => {
            format!("{}, {}", profile_type(profile), delay(profile.delay))
        }
        (_, _, Some(_)) => "sum with a torque profile".to_owned(),
        (None, Some(wall), None) => format!("{}, {}", wall_type(wall), delay(wall.delay)),
        (Some(_), Some(wall), None) => {
            format!("free mode and {}, {}", wall_type(wall), delay(wall.delay))
        }
        (canceller, None, None) => {
            let samples = canceller.map_or(0, |canceller| canceller.delay);
            format!("free mode, {}", delay(samples))
        }
    }
}

fn profile_type(profile: &Profile) -> String {
    let damped = if profile.damping() == 0.0 { "torque profile" } else { "damped torque profile" };
    let endless = if profile.ends.is_some() { "" } else { ", endless" };
    format!("{damped}{endless}")
}

fn wall_type(wall: &Wall) -> String {
    let kind = match wall.damper {
        None => "spring",
        Some(Damper { filter: None, .. }) => "wall",
        Some(Damper { filter: Some(_), .. }) => "filtered wall",
    };
    match wall.side {
        Side::Face(_) => format!("{kind}, one-sided"),
        Side::Displaced(_) => format!("{kind}, placed"),
        Side::Centred => kind.to_owned(),
    }
}

/// The smallest measured value that is not below `one`.
fn measured(values: &[usize], one: usize) -> usize {
    values.iter().copied().find(|value| *value >= one).unwrap_or(one)
}

/// A certified scene of each type.
fn cases() -> Vec<Case> {
    DELAYS.into_iter().flat_map(of_delay).collect()
}

fn of_delay(delay: usize) -> Vec<Case> {
    let soft = delay == MAX_DELAY;
    let stiffness = |stiffness: f64| if soft { 1.0 } else { stiffness };
    let spring = Wall::spring(stiffness(22.0), delay).alone();
    let walls = of_sides(Wall::damped(stiffness(22.0), 0.01, delay)).map(Wall::alone);
    let residual = if delay == 0 { 0.001 } else { 0.01 };
    let free = Canceller { residual, delay }.alone();
    let canceller = Some(Canceller::to(0.018));
    let ended = of_sides(Wall::damped(stiffness(5.0), 0.003, delay))
        .map(|wall| Parts { canceller, wall: Some(wall), ..Parts::NONE }.sum());
    let rational = DEGREES.map(|degree| Environment::Rational(of_degree(degree, delay)));
    let case = |program: &str, environment| {
        Program::find(program).map(|program| Case::of(program).with(program.name, environment))
    };
    let cases = [case("delayed_spring", spring), case("free_mode", free)].into_iter();
    let walls = walls.into_iter().map(|wall| case("damper_wall", wall));
    let knobs = between_ends(delay).into_iter().map(|profile| case("knob", profile));
    let unlimited = ended.into_iter().chain(rational).map(|other| case("free_mode", other));
    cases.chain(walls).chain(unlimited).chain(knobs).flatten().collect()
}

/// The wall with all kinds of rest positions, with and without a filter.
fn of_sides(wall: Wall) -> [Wall; 6] {
    const PLACE: f64 = 0.01;
    let filtered = wall.filtered(0.5);
    let placed = |wall: Wall| wall.placed(PLACE);
    [wall, placed(wall), wall.behind(0.0), filtered, placed(filtered), filtered.behind(0.0)]
}

/// The knob: a profile with ends for latched torques. A profile without ends contains a turn, which not every
/// format can represent, and other types do not fit the board's program.
fn between_ends(delay: usize) -> Option<Environment> {
    let knob = knob::SCENE.environment;
    (knob.delay() == delay).then_some(knob)
}

/// A spring of about 1 N m/rad with the largest number of nonzero coefficients.
fn of_degree(degree: usize, delay: usize) -> Rational {
    let [numerator, denominator] = [0.04, 0.05].map(|rest| {
        let mut values = [rest; MAX_DEGREE + 1];
        values[0] = 1.0;
        values
    });
    let rational = Rational::of(&numerator[..=degree], &denominator[..=degree]);
    Rational { delay, ..rational.expect("no degree is above the largest") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::tradeoff::servo;

    fn kept() -> Tradeoff {
        Tradeoff::kept(&COMPARISON).unwrap()
    }

    /// Whatever a file names has its figures in all formats.
    #[test]
    fn every_type_is_kept() {
        let names: Vec<_> = cases().iter().map(|c| type_of(&c.problem.scene.environment)).collect();
        assert_eq!(names, kept().cases());
        assert_eq!(kept().methods.len(), names.len() * Arithmetic::ALL.len());
    }

    /// The types that have a program were measured by another one, in which a compiler may have
    /// placed a few instructions otherwise.
    #[test]
    fn both_tables_count_alike() {
        let (ticks, formats) = (kept(), Tradeoff::kept(&servo::COMPARISON).unwrap());
        for case in servo::cases() {
            for (method, arithmetic) in formats.of(&case.name).zip(Arithmetic::ALL) {
                let here = instructions(&ticks, &case.problem.scene.environment, arithmetic);
                let off = (here / method.cost().unwrap() - 1.0).abs();
                assert!(off < 0.05, "{} in {}: {here}, off by {off}", case.name, method.name);
            }
        }
    }

    /// A delay takes instructions, and so does a degree.
    #[test]
    fn a_value_between_two_counts_as_the_next_larger() {
        let ticks = kept();
        let of = |degree, delay| {
            let environment = Environment::Rational(of_degree(degree, delay));
            instructions(&ticks, &environment, Arithmetic::F32)
        };
        assert_eq!([of(3, 1), of(5, 1), of(4, 2)], [of(4, 1), of(8, 1), of(4, 8)]);
        assert!(of(2, 1) < of(4, 1) && of(4, 1) < of(8, 1) && of(4, 1) < of(4, 8));
    }
}
