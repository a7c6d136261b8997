//! `haptic design motor`: the largest bandwidth, torque and speed of a motor on a board's bridge.

use clap::Args;
use haptic_servo::current::{
    B_G431B_ESC1, CurrentLoop, Drive, DriveError, DriveLimits, Motor, Supply, Winding,
};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::servo::Transducers;
use serde::Serialize;

use crate::command::shared_arguments::{JsonOption, warned};
use crate::command::status::{CommandError, CommandStatus};
use crate::command::value_parsers::{counts, positive};
use crate::file::supply::FileSupply;
use crate::file::{self, SceneFile};
use crate::quantity::significant;
use crate::text_table::table_of;
use crate::toolchain::BoardModel;

/// Arguments of `haptic design motor`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file: of its numbers, those of the options that are left out
    pub file: Option<String>,
    /// Voltage in V of the supply, under load; from a file: `motor.lowest_supply` or `supply.voltage`
    #[arg(long, value_name = "V", value_parser = positive, allow_hyphen_values = true,
          required_unless_present = "file")]
    pub supply: Option<f64>,
    /// Resistance in ohm: between the terminals of a brushed motor, of one phase of a brushless one; from a file: `motor.resistance`
    #[arg(long, value_name = "OHM", value_parser = positive, allow_hyphen_values = true,
          required_unless_present = "file")]
    pub resistance: Option<f64>,
    /// Inductance in H, of the same; from a file: `motor.inductance`
    #[arg(long, value_name = "H", value_parser = positive, allow_hyphen_values = true,
          required_unless_present = "file")]
    pub inductance: Option<f64>,
    /// Torque at the handle in N m/A; of a brushless motor per ampere of a phase current's amplitude; from a file: `motor.torque_constant`
    #[arg(long, value_name = "N m/A", value_parser = positive, allow_hyphen_values = true,
          required_unless_present = "file")]
    pub torque_constant: Option<f64>,
    /// Electrical turns in a turn of the handle, of a brushless motor; from a file: `motor.pole_pairs`
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub pole_pairs: Option<u16>,
    /// Bandwidth in Hz of the current loop; from a file: by `device.actuator_lag`; otherwise 1000
    #[arg(long, value_name = "HZ", value_parser = positive, allow_hyphen_values = true)]
    pub bandwidth: Option<f64>,
    /// Full-scale torque in N m; from a file: `limits.full_scale`; otherwise that of the current that the
    /// board bears for ever
    #[arg(long, value_name = "N m", value_parser = positive, allow_hyphen_values = true)]
    pub torque: Option<f64>,
    /// Largest speed in rad/s; from a file: `supply.largest_speed`; otherwise 25
    #[arg(long, value_name = "RAD/S", value_parser = positive, allow_hyphen_values = true)]
    pub speed: Option<f64>,
    /// Period in s of the servo; from a file: `servo.period`; otherwise 0.001
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub period: Option<f64>,
    /// Encoder counts in a turn of the handle; from a file: by `limits.encoder_step`; otherwise 4096
    #[arg(long, value_name = "N", value_parser = counts, allow_hyphen_values = true)]
    pub counts_per_turn: Option<f64>,
    /// The board, with a bridge
    #[arg(long, value_parser = BoardModel::find, default_value = "b-g431b-esc1")]
    pub board: BoardModel,
}

/// A number of the drive and its bound.
#[derive(Serialize)]
struct Row {
    number: &'static str,
    unit: &'static str,
    /// As it was stated, or assumed.
    value: f64,
    /// The largest that passes with the other numbers, or the least of a supply; null if none does.
    limit: Option<f64>,
    limited_by: &'static str,
}

/// The answer as JSON.
#[derive(Serialize)]
struct Report {
    board: &'static str,
    possible: bool,
    message: String,
    numbers: Vec<Row>,
    /// Bandwidth, torque and speed that pass, all changed by the same factor.
    together: Option<[f64; 3]>,
}

/// A drive in the hands of a servo.
#[derive(Clone, Copy)]
struct Case {
    drive: Drive,
    transducers: Transducers,
    period: f64,
}

/// Runs the command; the status is negative if the motor cannot run with the stated numbers.
pub fn run(arguments: &Arguments, output: &JsonOption) -> Result<CommandStatus, CommandError> {
    if !arguments.board.has_bridge() {
        let error = format!("the board {} has no bridge that drives a motor", arguments.board);
        return Err(CommandError::Failed(error.into()));
    }
    let file = arguments.file.as_deref().map(file::load).transpose()?.map(warned);
    let missing = |key: &str| format!("the file states no `{key}`: state it, or the option");
    let case = arguments.case(file.as_ref());
    let case = case.map_err(|key| CommandError::Failed(missing(key).into()))?;
    let report = report(arguments.board, &case);
    output.print(&report, text)?;
    Ok(CommandStatus::of(report.possible))
}

impl Arguments {
    /// With the numbers of a file where none is stated.
    ///
    /// # Errors
    /// The key that the file lacks.
    fn case(&self, file: Option<&SceneFile>) -> Result<Case, &'static str> {
        let supplied = file.and_then(|file| match file.supply {
            Some(FileSupply::Stores { bus, .. }) => Some(bus.voltage),
            _ => None,
        });
        let speed = file.and_then(|file| match file.supply? {
            FileSupply::Stores { largest_speed, .. } | FileSupply::Sinks { largest_speed } => {
                Some(largest_speed)
            }
        });
        let of_file = |number: fn(&SceneFile) -> Option<f64>| file.and_then(number);
        let lag =
            of_file(|file| Some(file.scene.latency.actuator_lag.most)).filter(|&lag| lag > 0.0);
        let turn = std::f64::consts::TAU;
        let bandwidth = self.bandwidth.or(lag.map(|lag| 1.0 / (turn * lag))).unwrap_or(1000.0);
        let torque = self.torque.or(of_file(|file| file.full_scale));
        let counts = of_file(|file| file.encoder_step).map(|step| (turn / step).round());
        let stated = file.and_then(|file| file.motor);
        let lowest = stated.map(|it| it.lowest_supply).or(supplied);
        let voltage = self.supply.or(lowest).ok_or("supply.voltage")?;
        let number = |own: Option<f64>, key, of: fn(&Motor) -> f64| {
            own.or(stated.map(|it| of(&it.motor))).ok_or(key)
        };
        let torque_constant =
            number(self.torque_constant, "motor.torque_constant", |it| it.torque_constant)?;
        let winding = match self.pole_pairs {
            Some(pole_pairs) => Winding::Brushless { pole_pairs },
            None => stated.map_or(Winding::Brushed, |it| it.motor.winding),
        };
        Ok(Case {
            drive: Drive {
                motor: Motor {
                    winding,
                    resistance: number(self.resistance, "motor.resistance", |it| it.resistance)?,
                    inductance: number(self.inductance, "motor.inductance", |it| it.inductance)?,
                    torque_constant,
                },
                supply: Supply::sinking(voltage, voltage),
                bandwidth,
                largest_temperature: B_G431B_ESC1.largest_temperature,
            },
            transducers: Transducers {
                counts_per_turn: self.counts_per_turn.or(counts).unwrap_or(4096.0),
                counter: CounterWidth::Bits32,
                full_scale_torque: torque
                    .unwrap_or(B_G431B_ESC1.continuous_current * torque_constant),
                largest_speed: self.speed.or(speed).unwrap_or(25.0),
            },
            period: self.period.or(of_file(|file| Some(file.scene.timing.period))).unwrap_or(0.001),
        })
    }
}

/// A number in a case.
type Place = fn(&mut Case) -> &mut f64;

fn report(board: BoardModel, case: &Case) -> Report {
    let Case { drive, transducers, period } = case;
    let limits = DriveLimits::of(drive, &B_G431B_ESC1, transducers, *period);
    let rows: [(&str, &str, Option<f64>, f64, Place); 4] = [
        ("bandwidth", "Hz", limits.bandwidth, 1.02, |case| &mut case.drive.bandwidth),
        ("full-scale torque", "N m", limits.torque, 1.02, |case| {
            &mut case.transducers.full_scale_torque
        }),
        ("largest speed", "rad/s", limits.speed, 1.02, |case| &mut case.transducers.largest_speed),
        ("supply", "V", limits.supply, 0.98, |case| &mut case.drive.supply.lowest),
    ];
    let row = |(number, unit, limit, beyond, place): (_, _, Option<f64>, f64, Place)| {
        let mut case = *case;
        let value = *place(&mut case);
        *place(&mut case) = beyond * limit.unwrap_or(value);
        case.drive.supply.highest = case.drive.supply.highest.max(case.drive.supply.lowest);
        Row { number, unit, value, limit, limited_by: case.refusal().map_or("", limited_by) }
    };
    let refusal = case.refusal();
    Report {
        board: board.name(),
        possible: refusal.is_none(),
        message: refusal.map_or("the motor runs".to_owned(), reason),
        numbers: rows.map(row).into(),
        together: limits.together,
    }
}

impl Case {
    /// The reason why the motor cannot run.
    fn refusal(&self) -> Option<DriveError> {
        CurrentLoop::design(&self.drive, &B_G431B_ESC1, &self.transducers, self.period).err()
    }
}

/// An error as a sentence, without the limits that the table has.
fn reason(error: DriveError) -> String {
    error.with_limits(DriveLimits::NONE).to_string()
}

/// The bound of an error in a few words.
fn limited_by(error: DriveError) -> &'static str {
    match error {
        DriveError::Bandwidth { .. } => "two periods of the modulation",
        DriveError::Current { .. } => "the board's current",
        DriveError::Voltage { .. } => "the supply's voltage",
        DriveError::ElectricalSpeed { .. } => "32 periods of the modulation in an electrical turn",
        DriveError::Supply { .. } => "the board's supply",
        _ => "another number",
    }
}

fn text(report: &Report) -> String {
    let number = |value: f64, unit: &str| format!("{} {unit}", significant(value, 4));
    let table = table_of(
        &report.numbers,
        &[
            ("number", false, |row| row.number.to_owned()),
            ("stated", true, |row| format!("{} {}", significant(row.value, 4), row.unit)),
            ("largest, or least supply", true, |row| {
                row.limit.map_or("none".to_owned(), |limit| format!("{limit} {}", row.unit))
            }),
            ("limited by", false, |row| row.limited_by.to_owned()),
        ],
    );
    let together = report.together.map_or_else(String::new, |[bandwidth, torque, speed]| {
        let [bandwidth, torque, speed] =
            [(bandwidth, "Hz"), (torque, "N m"), (speed, "rad/s")].map(|(v, unit)| number(v, unit));
        format!("all three by the same factor: {bandwidth}, {torque}, {speed}\n")
    });
    format!("{}: {}\n{table}\n{together}", report.board, report.message)
}
