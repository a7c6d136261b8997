//! Number formats of the servo: instructions of a tick on the emulated board, and errors of the
//! torque (theory, section 9).

use haptic_servo::certificate::Resolution;
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::{Environment, Side, Wall};
use haptic_servo::number::Arithmetic;
use haptic_servo::servo::Transducers;

use super::{Axis, Comparison, Method, Tradeoff};
use crate::emulator::Client;
use crate::hand::HandTrajectory;
use crate::program::{self, Program};
use crate::studies::error::StudyError;
use crate::studies::number_format::{Cost, FormatProblem, HALF_A_TURN, Losses, Motion, cost};

pub(crate) static COMPARISON: Comparison = Comparison {
    name: "servo",
    title: "Servo: number formats, a tick of each scene at 1 kHz on the emulated Cortex-M4",
    cost: Axis::new("instructions", "most instructions from count to code"),
    errors: &[
        Axis::new("error", "largest error of the torque (N m)").floored(FLOOR, NONE),
        Axis::new("error_at_1_rad", "largest error of the torque around 1 rad (N m)")
            .floored(FLOOR, NONE),
        Axis::new("hum", "limit cycle at rest, without encoder (N m)").floored(FLOOR, NONE),
        Axis::new("cycle", "smallest limit cycle (rad)").floored(FLOOR, NONE),
    ],
    others: &["mean_instructions", "hum_with_encoder", "cycle_with_encoder"],
    kept: include_bytes!("../../../pictures/tradeoff/servo.csv"),
};

/// The rounding error of `f64` for numbers around 1.
const FLOOR: f64 = 1e-16;
const NONE: &str = "none";
/// Time in s of the motion.
const SECONDS: f64 = 5.0;

/// A scene whose tick is measured, and the device's motion.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// The scene with its sensor and motor.
    pub problem: FormatProblem,
    /// The hand's trajectory.
    pub trajectory: HandTrajectory,
}

impl Case {
    /// The case of a program, with a counter that does not wrap.
    pub(super) fn of(program: &Program) -> Self {
        let transducers = Transducers { counter: CounterWidth::Bits32, ..program.transducers };
        let (scene, range) = (program.scene, HALF_A_TURN);
        let steps = Resolution::of(&transducers, None);
        let problem = FormatProblem { scene, transducers, steps, range };
        Self { name: program.name.to_owned(), problem, trajectory: (program.trajectory)() }
    }

    /// The same in another environment.
    pub(super) fn with(mut self, name: &str, environment: Environment) -> Self {
        self.problem.scene.environment = environment;
        Self { name: name.to_owned(), ..self }
    }

    /// The motion of the device.
    pub fn motion(&self) -> Result<Motion, StudyError> {
        Motion::new(&self.problem, self.trajectory.clone(), SECONDS)
    }
}

/// The programs' scenes that are linear except for faces and limits, and a wall that also pulls.
pub fn cases() -> Vec<Case> {
    let is_linear = |program: &&Program| program.scene.environment.has_transfer();
    let mut cases: Vec<_> = program::ALL.iter().filter(is_linear).map(Case::of).collect();
    let pulls = |case: &Case| {
        let wall = case.problem.scene.environment.wall().filter(|wall| wall.is_one_sided())?;
        let wall = Wall { side: Side::Centred, ..*wall };
        Some(case.clone().with("damper_wall, two-sided", wall.alone()))
    };
    cases.extend(cases.iter().filter_map(pulls).collect::<Vec<_>>());
    cases
}

pub(crate) fn measure() -> Result<Tradeoff, StudyError> {
    let mut board = super::board()?;
    let mut methods = Vec::new();
    for case in cases() {
        let motion = case.motion()?;
        for arithmetic in Arithmetic::ALL {
            methods.push(row(&case, &motion, &mut board, arithmetic)?);
        }
    }
    board.finish()?;
    Ok(Tradeoff { comparison: &COMPARISON, methods })
}

fn row(
    case: &Case,
    motion: &Motion,
    board: &mut Client,
    arithmetic: Arithmetic,
) -> Result<Method, StudyError> {
    let Cost { most, mean } = cost(board, motion, arithmetic)?;
    let [drawn @ .., torque, angle] = Losses::of(motion, arithmetic)?.figures();
    let values = [&[Some(most.into())], &drawn[..], &[Some(mean), torque, angle]].concat();
    Ok(Method::new(&case.name, family(arithmetic), arithmetic.name(), values))
}

fn family(arithmetic: Arithmetic) -> &'static str {
    match arithmetic {
        Arithmetic::F32 => "floating point of the unit",
        Arithmetic::F64 => "floating point in software",
        Arithmetic::I16F16 | Arithmetic::I8F24 | Arithmetic::I1F31 => "fixed point, rounded",
        _ => "fixed point, truncated",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::number_format::{Units, at_rest};

    /// The kept figures that do not depend on a compiler for the board.
    #[test]
    fn the_kept_losses_are_what_they_are() {
        let kept = Tradeoff::kept(&COMPARISON).unwrap();
        let mut methods = kept.methods.iter();
        for case in cases() {
            let motion = case.motion().unwrap();
            for arithmetic in Arithmetic::ALL {
                let kept = methods.next().unwrap();
                let names = (&*kept.case, &*kept.name);
                assert_eq!(names, (&*case.name, arithmetic.name()));
                let fresh = Losses::of(&motion, arithmetic).unwrap().figures();
                let at = [1, 2, 3, 4, 6, 7].map(|column| kept.values[column]);
                for (kept, fresh) in at.into_iter().zip(fresh) {
                    let (kept, fresh) = (kept.unwrap(), fresh.unwrap());
                    assert!((kept - fresh).abs() <= 1e-5 * kept, "{names:?}: {kept} {fresh}");
                }
            }
        }
        assert!(methods.next().is_none());
    }

    /// Theory, section 9: the paper's wall at rest. Its bound is for one filter with the whole
    /// controller; here three products are rounded, each with a coefficient as fine as 31 bits.
    #[test]
    fn the_wall_hums_as_much_as_experiments_found() {
        let case = Case::of(Program::find("damper_wall").unwrap());
        let problem = FormatProblem { range: 0.9, ..case.problem };
        assert_eq!(problem.units(Arithmetic::I1F31), Units { angle: 1.0, torque: 2.0 });
        let hum =
            |arithmetic, with_encoder| at_rest(&problem, arithmetic, with_encoder).unwrap().torque;
        assert!(hum(Arithmetic::F64, false) <= 2e-16);
        let near = |hum: f64, found: f64| assert!(hum < 2.0 * found && hum > 0.1 * found, "{hum}");
        near(hum(Arithmetic::F32, false), 1.6e-7);
        near(hum(Arithmetic::I1F31, false), 3e-7);
        near(hum(Arithmetic::I16F16, false), 1.9e-3);
        near(hum(Arithmetic::I16F16Truncated, false), 3.9e-3);
        // The encoder is no format's fault.
        let encoder = hum(Arithmetic::F64, true);
        assert!(encoder > 3.6e-3 && (hum(Arithmetic::F32, true) / encoder - 1.0).abs() < 1e-3);
    }
}
