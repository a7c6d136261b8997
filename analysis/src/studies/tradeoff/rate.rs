//! The sample rate: the stiffest wall, the ripple by the encoder, and the share of the processor.

use std::f64::consts::TAU;

use super::{Axis, Comparison, Method, Tradeoff};
use crate::limits::{Limit, at_period, largest_stiffness, with_wall};
use crate::program::Program;
use crate::studies::bench::CORE_CLOCK;

/// The comparison.
pub static COMPARISON: Comparison = Comparison {
    name: "rate",
    title: "Sample rate: walls one sample late behind the standard coupling, 65536 counts a turn",
    cost: Axis::least("processor", "part of a core of 170 MHz (%)"),
    errors: &[
        Axis::most("stiffness", "largest certified stiffness (N m/rad)"),
        Axis::least("ripple", "step of torque by one count at that stiffness (N m)"),
    ],
    others: &["rate", "instructions"],
    kept: include_bytes!("../../../pictures/tradeoff/rate.csv"),
};

/// Sample rates in Hz.
const RATES: [f64; 8] = [500.0, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5];
/// Counts of the encoder per turn.
const COUNTS: f64 = 65536.0;

/// The table of some programs' walls, each with the instructions that its interrupt takes. A core is assumed
/// to execute one instruction per cycle, as in `haptic bench`.
pub fn table(programs: &[(&Program, f64)]) -> Tradeoff {
    let rows = programs.iter().flat_map(|&(program, instructions)| {
        RATES.iter().filter_map(move |&rate| row(program, instructions, rate))
    });
    Tradeoff { comparison: &COMPARISON, methods: rows.collect() }
}

/// The stiffest wall; `None` if no stiffness is certified, or every one.
fn row(program: &Program, instructions: f64, rate: f64) -> Option<Method> {
    let scene = at_period(&program.scene, 1.0 / rate);
    let Limit::AtMost(stiffness) = largest_stiffness(&with_wall(&scene, 0.0, Some(1))) else {
        return None;
    };
    // The delay is one sample with any coupling.
    let damping = scene.environment.wall()?.damping();
    let ripple = (stiffness + damping * rate) * TAU / COUNTS;
    let processor = 100.0 * instructions * rate / CORE_CLOCK;
    let family = program.name.replace('_', " ");
    let short = family.rsplit(' ').next()?;
    let name = match rate {
        rate if rate < 1e3 => format!("{short}, {rate} Hz"),
        rate => format!("{short}, {} kHz", rate / 1e3),
    };
    let figures = [processor, stiffness, ripple, rate, instructions];
    Some(Method::new("paddle of the paper", &family, name, &figures))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::ALL;

    /// `alpha = K T/2 + B < delta` (equation 27).
    #[test]
    fn stiffness_and_ripple_are_those_of_the_formula() {
        let programs: Vec<_> = ALL.iter().map(|program| (program, 150.0)).collect();
        let table = table(&programs);
        assert_eq!(table.families(), ["delayed spring", "damper wall"]);
        for method in &table.methods {
            let damping = if method.family == "damper wall" { 0.01 } else { 0.0 };
            let [processor, stiffness, ripple, rate] =
                [0, 1, 2, 3].map(|i| method.values[i].unwrap());
            let near =
                |is: f64, should: f64| assert!((is / should - 1.0).abs() < 1e-6, "{method:?}");
            near(stiffness, 2.0 * (0.022 - damping) * rate);
            near(ripple, (stiffness + damping * rate) * 9.587_379_924e-5);
            near(processor, rate * 150.0 / 1.7e6);
        }
    }
}
