//! Number formats of the servo: what a tick takes on the emulated board, and what is lost of the
//! torque (theory, section 9).

use firmware::encoder::CounterWidth;
use firmware::number::Arithmetic;
use firmware::servo::Transducers;

use super::{Axis, Method, NUMBER, Subject, Tradeoff};
use crate::arithmetic::{self, HALF_A_TURN, Losses, Motion, cost};
use crate::command::CommandError;
use crate::emulator::Trials;
use crate::program::{self, Program};
use crate::table::Column;

/// What is compared.
pub static SUBJECT: Subject = Subject {
    name: "servo",
    title: "Servo: number formats, a tick of each scene at 1 kHz on the emulated Cortex-M4",
    cost: Axis::least(&["instructions"], "most instructions from count to code"),
    errors: &[
        Axis::least(&["error"], "largest error of the torque (N m)").floored(FLOOR, NONE),
        Axis::least(&["error_at_1_rad"], "the same around 1 rad (N m)").floored(FLOOR, NONE),
        Axis::least(&["hum"], "hum at rest, without encoder (N m)").floored(FLOOR, NONE),
        Axis::least(&["cycle"], "smallest limit cycle (rad)").floored(FLOOR, NONE),
    ],
    others: &[
        Column { names: &["mean_instructions"], bound: NUMBER },
        Column { names: &["hum_with_encoder"], bound: NUMBER },
        Column { names: &["cycle_with_encoder"], bound: NUMBER },
    ],
};

/// What `f64` itself rounds away of numbers around 1.
const FLOOR: f64 = 1e-16;
const NONE: &str = "none";
/// Time in s of the motion.
const SECONDS: f64 = 5.0;

/// A program's scene, whose counter does not wrap.
pub fn subject(program: &Program) -> arithmetic::Subject {
    let transducers = Transducers { counter: CounterWidth::Bits32, ..program.transducers };
    arithmetic::Subject { scene: program.scene, transducers, range: HALF_A_TURN }
}

/// What the device does meanwhile.
///
/// # Errors
/// Where the scene cannot be simulated.
pub fn motion(program: &Program) -> Result<Motion, CommandError> {
    Motion::new(&subject(program), (program.script)(), SECONDS)
}

/// Measures all formats on all scenes.
///
/// # Errors
/// Where the board cannot be built or fails.
pub fn measure() -> Result<Tradeoff, CommandError> {
    let mut board = super::board()?;
    let mut methods = Vec::new();
    for program in program::ALL {
        let motion = motion(program)?;
        for arithmetic in Arithmetic::ALL {
            methods.push(row(program, &motion, &mut board, arithmetic)?);
        }
    }
    board.finish()?;
    Ok(Tradeoff { subject: &SUBJECT, methods })
}

fn row(
    program: &Program,
    motion: &Motion,
    board: &mut Trials,
    arithmetic: Arithmetic,
) -> Result<Method, CommandError> {
    let cost = cost(board, motion, arithmetic)?;
    let Losses { error, error_elsewhere, alone, with_encoder } = Losses::of(motion, arithmetic)?;
    let values = [
        Some(cost.most.into()),
        Some(error),
        error_elsewhere,
        Some(alone.hum),
        Some(alone.cycle),
        Some(cost.mean),
        Some(with_encoder.hum),
        Some(with_encoder.cycle),
    ];
    let method = Method::new(program.name, family(arithmetic), arithmetic.name(), &[]);
    Ok(Method { values: values.to_vec(), ..method })
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
    use crate::arithmetic::{Rest, Units, at_rest};
    use crate::table::Table;

    /// The kept figures that do not depend on a compiler for the board.
    #[test]
    fn the_kept_losses_are_what_they_are() {
        let kept = include_bytes!("../../pictures/tradeoff/servo.csv");
        let kept = Tradeoff::read(&SUBJECT, Table::new("servo.csv", &kept[..]).unwrap()).unwrap();
        let mut methods = kept.methods.iter();
        for program in program::ALL {
            let motion = motion(program).unwrap();
            for arithmetic in Arithmetic::ALL {
                let kept = methods.next().unwrap();
                let names = (&*kept.case, &*kept.name);
                assert_eq!(names, (program.name, arithmetic.name()));
                let Losses { error, error_elsewhere, alone, with_encoder } =
                    Losses::of(&motion, arithmetic).unwrap();
                let Rest { hum, cycle } = with_encoder;
                let alone = [Some(alone.hum), Some(alone.cycle)];
                let fresh =
                    [Some(error), error_elsewhere, alone[0], alone[1], Some(hum), Some(cycle)];
                let at = [1, 2, 3, 4, 6, 7].map(|column| kept.values[column]);
                for (kept, fresh) in at.into_iter().zip(fresh) {
                    let (kept, fresh) = (kept.unwrap(), fresh.unwrap());
                    assert!((kept - fresh).abs() <= 1e-5 * kept, "{names:?}: {kept} {fresh}");
                }
            }
        }
        assert!(methods.next().is_none());
    }

    /// Theory, section 9: the paper's wall at rest. What it says is of one filter that has all of
    /// the controller; here three products are rounded, each with a coefficient as fine as 31 bits.
    #[test]
    fn the_wall_hums_as_much_as_experiments_found() {
        let program = Program::find("damper_wall").unwrap();
        let subject = arithmetic::Subject { range: 0.9, ..subject(program) };
        assert_eq!(subject.units(Arithmetic::I1F31), Units { angle: 1.0, torque: 2.0 });
        let hum =
            |arithmetic, with_encoder| at_rest(&subject, arithmetic, with_encoder).unwrap().hum;
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
