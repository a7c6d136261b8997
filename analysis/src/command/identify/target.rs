//! The target of a measurement that `haptic identify` simulates: a device, driven by the program `identify`.

use clap::{Args, ValueEnum};
use haptic_servo::excitation::Sweep;
use haptic_servo::servo::Transducers;
use serde::Serialize;

use crate::command::building::emulated;
use crate::command::status::CommandError;
use crate::command::value_parsers::not_negative;
use crate::file::DeviceFile;
use crate::identify::measurement::{self, Measurement};
use crate::identify::record::Recorder;
use crate::identify::rig::{MeasuredDevice, Sensing};
use crate::lockstep::Difference;
use crate::program::damper_wall;
use crate::program::identify::PERIOD;
use crate::progress;
use crate::simulation::SimulationError;
use crate::simulation::plant::Plant;
use crate::toolchain::NumberFormat;

/// The target that drives the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Target {
    /// This machine.
    Host,
    /// The emulated board; every code is compared with that of this machine.
    Qemu,
}

/// Torque noise as a part of the motor's full scale.
const TORQUE_NOISE: f64 = 0.0025;

/// A simulated measurement.
#[derive(Debug, Args)]
#[command(next_help_heading = "With --target")]
pub struct Simulated {
    /// Measure a simulated device, with the program `identify` on this machine or the emulated
    /// board
    #[arg(long, value_enum, group = "measured")]
    pub target: Option<Target>,
    /// Standard deviation of the torque noise in N m, new in every tick and not recorded; default: 0.0025 of the
    /// motor's full scale
    #[arg(long, value_name = "TORQUE", value_parser = not_negative, allow_hyphen_values = true,
          requires = "target")]
    pub torque_noise: Option<f64>,
    /// Time by which the simulated counts are late besides the age of the file's encoder, in s; less than a period
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = skew,
          allow_hyphen_values = true, requires = "target")]
    pub skew: f64,
    /// Time by which the simulated torques are later than their codes, in s; the file's
    /// `device.actuator_lag` is the simulated amplifier's lag
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = output_delay,
          allow_hyphen_values = true, requires = "target")]
    pub output_delay: f64,
    /// Seed of the noise
    #[arg(long, value_name = "N", default_value_t = 1, requires = "target")]
    pub seed: u64,
}

/// The origin of a record in the JSON output.
#[derive(Debug, Serialize)]
pub struct Origin {
    pub target: Target,
    pub ticks: usize,
    /// Codes of the board that were equal to this machine's.
    pub codes_equal: Option<usize>,
    pub difference: Option<Difference>,
}

impl Origin {
    /// Its name and its text in a report.
    pub fn row(&self) -> (&'static str, String) {
        match self.codes_equal {
            Some(equal) => ("codes equal", format!("{equal} of {}", self.ticks)),
            None => ("ticks", self.ticks.to_string()),
        }
    }
}

/// Measures the device of a file with its encoder and its motor, or those of the paddle, by the program of this
/// name, which plays this sweep.
pub fn measure<const N: usize>(
    arguments: &Simulated,
    (program, sweep): (&str, &Sweep<N>),
    file: Option<&DeviceFile>,
    recorder: &mut Recorder<'_>,
    transducers: &Transducers,
) -> Result<(Measurement, Origin), CommandError> {
    let target = arguments.target.unwrap_or(Target::Host);
    let &Simulated { skew, output_delay, seed, .. } = arguments;
    let sensing = sensing(file, transducers);
    let torque_noise = arguments.torque_noise.unwrap_or(sensing.torque_noise);
    let sensing = Sensing { torque_noise, skew, output_delay, seed, ..sensing };
    let elf = match target {
        Target::Host => None,
        // The program computes its codes in `f32` for every format of the scenes. They are parts of full scale, of
        // any motor.
        Target::Qemu => Some(emulated(program, NumberFormat::F32)?),
    };
    let mut device = device(file, &sensing)?;
    let bar = progress::bar(sweep.ticks(), "identify");
    let stepper = progress::stepper(&bar);
    let measured = measurement::measure(sweep, &mut device, elf.as_deref(), recorder, stepper)?;
    bar.finish_and_clear();
    let origin = Origin {
        target,
        ticks: measured.record.torque.len(),
        codes_equal: measured.equal,
        difference: measured.difference,
    };
    Ok((measured, origin))
}

/// How the device of a file is driven and measured, or the paddle.
pub fn sensing(file: Option<&DeviceFile>, transducers: &Transducers) -> Sensing {
    let torque_noise = TORQUE_NOISE * transducers.full_scale_torque;
    let ideal = Sensing { torque_noise, ..Sensing::ideal(PERIOD, transducers.counts_per_turn) };
    file.map_or(ideal, |file| {
        let &DeviceFile { disturbance, reading: encoder, sensor_lag, .. } = file;
        Sensing { disturbance, encoder, sensor_lag, ..ideal }
    })
}

/// The device of a file that is measured in this way, or the paddle.
pub fn device(
    file: Option<&DeviceFile>,
    sensing: &Sensing,
) -> Result<MeasuredDevice, SimulationError> {
    let plant = match file {
        Some(file) => Plant::of(&file.chain),
        None => Plant::rigid(damper_wall::SCENE.device),
    };
    MeasuredDevice::new(&plant, sensing)
}

fn output_delay(text: &str) -> Result<f64, String> {
    let longest = haptic_servo::latency::LONGEST_DELAY * PERIOD;
    let value = not_negative(text)?;
    if value <= longest { Ok(value) } else { Err(format!("it must be at most {longest} s")) }
}

fn skew(text: &str) -> Result<f64, String> {
    let period = PERIOD;
    let value = not_negative(text)?;
    if value < period { Ok(value) } else { Err(format!("it must be less than {period} s")) }
}
