//! The cost of a tick of any scene on the emulated board, in every number format.
//!
//! A scene's program has its own type of servo: by its environment, its filter, its rest position and its
//! delay. All types of scenes in a file are measured, delays and degrees at a few values: a value between
//! them costs at most as much as the next larger. In `f64`, which is software, the cost of a tick also
//! depends on the numbers, which are those of one scene in one hand.

use std::io::Write;

use haptic_servo::environment::{
    AnyProfile, Coefficients, Environment, MAX_DEGREE, MAX_DELAY, Rational, Wall,
};
use haptic_servo::number::Arithmetic;

use super::NUMBER;
use super::servo::Case;
use crate::emulator::BenchClient;
use crate::program::{Program, knob};
use crate::studies::number_format::{FormatError, cost};
use crate::table::{Column, Table, TableError};

/// Largest number of instructions of a tick from count to code, by type of scene and format.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    rows: Vec<(String, [f64; FORMATS])>,
}

const FORMATS: usize = Arithmetic::ALL.len();
/// Measured delays.
const DELAYS: [usize; 3] = [0, 1, MAX_DELAY];
/// Measured degrees.
const DEGREES: [usize; 4] = [1, 2, 4, MAX_DEGREE];

const TYPE: Column = Column { names: &["type"], bound: "a type of scene" };
static FORMAT_NAMES: [[&str; 1]; FORMATS] = {
    let mut names = [[""]; FORMATS];
    let mut i = 0;
    while i < FORMATS {
        names[i] = [Arithmetic::ALL[i].name()];
        i += 1;
    }
    names
};

impl Ticks {
    /// Measures all types in all formats; `step` is called after each type.
    ///
    /// # Errors
    /// If the board fails, or its results differ from this machine's.
    pub fn measure(board: &mut BenchClient, mut step: impl FnMut()) -> Result<Self, FormatError> {
        let mut rows = Vec::new();
        for case in cases() {
            let motion = case.motion()?;
            let mut most = [0.0; FORMATS];
            for (most, arithmetic) in most.iter_mut().zip(Arithmetic::ALL) {
                *most = cost(board, &motion, arithmetic)?.most.into();
            }
            rows.push((type_of(&case.problem.scene.environment), most));
            step();
        }
        Ok(Self { rows })
    }

    /// The stored figures.
    ///
    /// # Errors
    /// If the file is not such a table.
    pub fn kept() -> Result<Self, TableError> {
        let kept = include_bytes!("../../../pictures/tradeoff/ticks.csv");
        let mut table = Table::new("ticks.csv", &kept[..])?;
        let name = table.column(TYPE)?;
        let mut places = Vec::new();
        for names in &FORMAT_NAMES {
            places.push(table.column(Column { names, bound: NUMBER })?);
        }
        let mut rows = Vec::new();
        while let Some(row) = table.row()? {
            let mut most = [0.0; FORMATS];
            for (most, place) in most.iter_mut().zip(&places) {
                *most = row.number(*place, |value: &f64| *value > 0.0)?;
            }
            rows.push((row.text(name).to_owned(), most));
        }
        table.at_least(1)?;
        Ok(Self { rows })
    }

    /// Writes the figures.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write(&self, to: impl Write) -> std::io::Result<()> {
        let mut file = csv::Writer::from_writer(to);
        let formats = FORMAT_NAMES.iter().map(|[name]| *name);
        file.write_record(TYPE.names.iter().copied().chain(formats))?;
        for (name, most) in &self.rows {
            let most = most.iter().map(f64::to_string);
            file.write_record(std::iter::once(name.clone()).chain(most))?;
        }
        file.flush()
    }

    /// The instructions of a scene in a format; infinite if no scene of its type was measured.
    pub fn of(&self, environment: &Environment, arithmetic: Arithmetic) -> f64 {
        let wanted = type_of(environment);
        let row = self.rows.iter().find(|(name, _)| *name == wanted);
        let formats = Arithmetic::ALL.iter().position(|other| *other == arithmetic);
        row.zip(formats).map_or(f64::INFINITY, |((_, most), format)| most[format])
    }
}

/// Number of types.
pub fn types() -> usize {
    cases().len()
}

/// The type of an environment, which determines the instructions of its tick, as text; with the measured
/// delays and degrees.
fn type_of(environment: &Environment) -> String {
    let delay = |delay: usize| format!("delay {}", measured(&DELAYS, delay));
    match environment {
        Environment::DelayedSpring(wall) => format!("spring, {}", delay(wall.delay)),
        Environment::DamperWall(wall) => format!("{}, {}", wall_type(wall), delay(wall.delay)),
        Environment::FreeMode { delay: samples, .. } => format!("free mode, {}", delay(*samples)),
        Environment::FreeModeWall { wall, .. } => {
            format!("free mode and {}, {}", wall_type(wall), delay(wall.delay))
        }
        Environment::Stated(_) => "of another crate".to_owned(),
        Environment::Profile(profile) => {
            format!("{}, {}", profile_type(profile), delay(profile.delay))
        }
        Environment::Composed(_) => "sum with a torque profile".to_owned(),
        Environment::Rational(rational) => {
            let degree = rational.denominator.as_slice().len().saturating_sub(1);
            format!("rational of degree {}, {}", measured(&DEGREES, degree), delay(rational.delay))
        }
    }
}

fn profile_type(profile: &AnyProfile) -> String {
    let damped = if profile.damping == 0.0 { "torque profile" } else { "damped torque profile" };
    let endless = if profile.ends.is_some() { "" } else { ", endless" };
    format!("{damped}{endless}")
}

fn wall_type(wall: &Wall) -> String {
    let filter = if wall.filter.is_some() { "filtered wall" } else { "wall" };
    match wall {
        Wall { one_sided: true, .. } => format!("{filter}, one-sided"),
        Wall { face: 0.0, .. } => filter.to_owned(),
        _ => format!("{filter}, placed"),
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
    let wall = |stiffness: f64, damping: f64| {
        let stiffness = if soft { 1.0 } else { stiffness };
        Wall { stiffness, damping, filter: None, delay, face: 0.0, one_sided: false }
    };
    let spring = Environment::DelayedSpring(wall(22.0, 0.0));
    let walls = of_sides(wall(22.0, 0.01)).map(Environment::DamperWall);
    let residual = if delay == 0 { 0.001 } else { 0.01 };
    let free = Environment::FreeMode { residual, delay };
    let ended = |wall| Environment::FreeModeWall { residual: 0.018, wall };
    let ended = of_sides(wall(5.0, 0.003)).map(ended);
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
    let filtered = Wall { filter: Some(0.5), ..wall };
    let [placed, one_sided] =
        [|wall| Wall { face: PLACE, ..wall }, |wall| Wall { one_sided: true, ..wall }];
    [wall, placed(wall), one_sided(wall), filtered, placed(filtered), one_sided(filtered)]
}

/// The knob: a profile with ends for latched torques. A profile without ends contains a turn, which not every
/// format can represent, and other types do not fit the board's program.
fn between_ends(delay: usize) -> Option<Environment> {
    let knob = knob::SCENE.environment.as_any();
    (knob.delay == delay).then_some(Environment::Profile(knob))
}

/// A spring of about 1 N m/rad with the largest number of nonzero coefficients.
fn of_degree(degree: usize, delay: usize) -> Rational {
    let coefficients = |rest: f64| {
        let mut values = [rest; MAX_DEGREE + 1];
        values[0] = 1.0;
        Coefficients::new(&values[..=degree]).expect("no degree is above the largest")
    };
    let (numerator, denominator) = (coefficients(0.04), coefficients(0.05));
    Rational { numerator, denominator, delay, unit_zeros: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::tradeoff::servo;

    /// Whatever a file names has a row.
    #[test]
    fn every_type_is_kept() {
        let kept = Ticks::kept().unwrap();
        let names: Vec<_> = cases().iter().map(|c| type_of(&c.problem.scene.environment)).collect();
        let rows: Vec<_> = kept.rows.iter().map(|(name, _)| name.clone()).collect();
        assert_eq!(names, rows);
        let unlike = |a: &String| names.iter().filter(|b| a == *b).count() == 1;
        assert!(names.iter().all(unlike), "{names:?}");
    }

    /// The types that have a program were measured by another one, in which a compiler may have
    /// placed a few instructions otherwise.
    #[test]
    fn both_tables_count_alike() {
        let (ticks, formats) = (Ticks::kept().unwrap(), servo::kept().unwrap());
        for case in servo::cases() {
            for (method, arithmetic) in formats.of(case.name).zip(Arithmetic::ALL) {
                let here = ticks.of(&case.problem.scene.environment, arithmetic);
                let off = (here / method.cost().unwrap() - 1.0).abs();
                assert!(off < 0.05, "{} in {}: {here}, off by {off}", case.name, method.name);
            }
        }
    }

    /// A delay takes instructions, and so does a degree.
    #[test]
    fn a_value_between_two_counts_as_the_next_larger() {
        let ticks = Ticks::kept().unwrap();
        let of = |degree, delay| {
            ticks.of(&Environment::Rational(of_degree(degree, delay)), Arithmetic::F32)
        };
        assert_eq!([of(3, 1), of(5, 1), of(4, 2)], [of(4, 1), of(8, 1), of(4, 8)]);
        assert!(of(2, 1) < of(4, 1) && of(4, 1) < of(8, 1) && of(4, 1) < of(4, 8));
    }
}
