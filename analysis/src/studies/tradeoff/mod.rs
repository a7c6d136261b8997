//! Speed against accuracy: tables of measured methods, each with its cost and its error, and their
//! Pareto front.
//!
//! A `Comparison` has the topic and its columns; a `Tradeoff` is the measured table, kept as CSV
//! beside its chart.

pub mod certificate;
mod comparison;
pub mod servo;
pub mod sine;
pub(crate) mod ticks;

use std::io::{Read, Write};

pub(crate) use comparison::{Axis, Comparison};

use crate::emulator::Client;
use crate::progress;
use crate::quantity::significant;
use crate::studies::bench::figure::seconds;
use crate::studies::error::StudyError;
use crate::table::{Column, Table, TableError};
use crate::toolchain::{self, Tools};

/// Digits of the numbers in a table: more than the precision of a measured time, and enough to detect a wrong
/// error.
const DIGITS: usize = 6;

const CASE: Column = Column { names: &["case"], bound: "a name" };
const FAMILY: Column = Column { names: &["family"], bound: "a name" };
const NAME: Column = Column { names: &["name"], bound: "a name" };

/// A method with its figures.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Method {
    /// Its case: only methods of one case are compared.
    pub case: String,
    /// Its family: drawn with the same mark, joined by a line in the order of the table.
    pub family: String,
    /// Its own name, short enough to stand beside its mark.
    pub name: String,
    /// The figures in the order of [`Comparison::columns`]; infinite if the method fails, `None` if it does
    /// not have the figure.
    pub values: Vec<Option<f64>>,
}

impl Method {
    fn new(
        case: &str,
        family: &str,
        name: &str,
        values: impl IntoIterator<Item = impl Into<Option<f64>>>,
    ) -> Self {
        let [case, family, name] = [case, family, name].map(str::to_owned);
        Self { case, family, name, values: values.into_iter().map(Into::into).collect() }
    }

    pub fn cost(&self) -> Option<f64> {
        self.values[0]
    }

    /// Its error with this index.
    pub fn error(&self, number: usize) -> Option<f64> {
        self.values[1 + number]
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tradeoff {
    pub comparison: &'static Comparison,
    pub methods: Vec<Method>,
}

impl Tradeoff {
    /// The cases, in the order of the table.
    pub fn cases(&self) -> Vec<&str> {
        distinct(self.methods.iter().map(|method| &*method.case))
    }

    /// The families, in the order of the table.
    pub fn families(&self) -> Vec<&str> {
        distinct(self.methods.iter().map(|method| &*method.family))
    }

    pub fn of<'t, 'c>(&'t self, case: &'c str) -> impl Iterator<Item = &'t Method> + use<'t, 'c> {
        self.methods.iter().filter(move |method| method.case == case)
    }

    /// The Pareto front of a case: each method has the best value of the error with this index among all
    /// methods of at most its cost. From the cheapest to the best. A failing method is never on a front.
    pub fn front(&self, case: &str, error: usize) -> Vec<&Method> {
        let (cost, error_axis) = (&self.comparison.cost, &self.comparison.errors[error]);
        let figures = |m: &Method| Some((m.cost()?, m.error(error)?));
        let finite = |m: &&Method| figures(m).is_some_and(|(c, e)| c.is_finite() && e.is_finite());
        let mut front: Vec<_> = self.of(case).filter(finite).collect();
        let is_beaten = |m: &Method, by: &Method| {
            let (Some((c, e)), Some((by_c, by_e))) = (figures(m), figures(by)) else {
                return false;
            };
            let worse = cost.is_better(c, by_c) || error_axis.is_better(e, by_e);
            !worse && (cost.is_better(by_c, c) || error_axis.is_better(by_e, e))
        };
        let all = front.clone();
        front.retain(|method| !all.iter().any(|other| is_beaten(method, other)));
        let by_cost = |m: &&Method| m.cost().unwrap_or(f64::INFINITY);
        front.sort_by(|a, b| by_cost(a).total_cmp(&by_cost(b)));
        front
    }

    pub fn read<R: Read>(
        comparison: &'static Comparison,
        mut table: Table<R>,
    ) -> Result<Self, TableError> {
        let words = [table.column(CASE)?, table.column(FAMILY)?, table.column(NAME)?];
        let places: Vec<_> =
            comparison.columns().map(|column| table.column(column)).collect::<Result<_, _>>()?;
        let mut methods = Vec::new();
        while let Some(row) = table.row()? {
            let [case, family, name] = words.map(|place| row.text(place).to_owned());
            let value = |&place| match row.text(place) {
                "" => Ok(None),
                _ => row.number(place, |value: &f64| *value >= 0.0).map(Some),
            };
            let values = places.iter().map(value).collect::<Result<_, _>>()?;
            methods.push(Method { case, family, name, values });
        }
        table.at_least(1)?;
        Ok(Self { comparison, methods })
    }

    pub fn kept(comparison: &'static Comparison) -> Result<Self, TableError> {
        Self::read(comparison, Table::new(comparison.name, comparison.kept)?)
    }

    pub fn write(&self, to: impl Write) -> std::io::Result<()> {
        let mut file = csv::Writer::from_writer(to);
        let words = [CASE, FAMILY, NAME].into_iter();
        file.write_record(words.chain(self.comparison.columns()).map(|column| column.names[0]))?;
        for method in &self.methods {
            let words = [&method.case, &method.family, &method.name].into_iter().cloned();
            let written = |value| significant(value, DIGITS);
            let number = |value: &Option<f64>| value.map_or_else(String::new, written);
            file.write_record(words.chain(method.values.iter().map(number)))?;
        }
        file.flush()
    }
}

/// The shortest time in s of each work over a number of alternating rounds: the time without other load. Each
/// runs twice in a round, and the second run counts, so that the caches are filled.
fn fastest(rounds: usize, works: &mut [impl FnMut()]) -> Vec<f64> {
    let mut times = vec![f64::INFINITY; works.len()];
    for _ in 0..rounds {
        for (time, work) in times.iter_mut().zip(&mut *works) {
            work();
            *time = time.min(seconds(work));
        }
    }
    times
}

/// An emulated board that computes the scenes that have a program, and sines.
pub(crate) fn board() -> Result<Client, StudyError> {
    boot("building the trial of the formats", "bench_programs")
}

/// The same for any scene; its program takes longer to build.
pub(crate) fn any_board() -> Result<Client, StudyError> {
    boot("building all types of scenes in all formats", "bench_all")
}

fn boot(what: &str, program: &str) -> Result<Client, StudyError> {
    let toolchain = toolchain::prepare(Tools::CompilerAndEmulator)?;
    let spinner = progress::spinner(what);
    let elf = toolchain.build_harness(program)?;
    spinner.finish_and_clear();
    Ok(Client::boot(&elf)?)
}

/// Each once, in order of appearance.
fn distinct<'t>(words: impl Iterator<Item = &'t str>) -> Vec<&'t str> {
    let mut seen = Vec::new();
    for word in words {
        if !seen.contains(&word) {
            seen.push(word);
        }
    }
    seen
}

#[cfg(test)]
mod tests;
