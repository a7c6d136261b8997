//! `haptic identify`: a device's inertia, damping and passivity, and the lag and the delay of its torque,
//! from a measurement.

mod age;
mod device_file;
mod linearity;
mod port;
pub mod target;
mod turns;

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use haptic_servo::current::TorqueSource;
use haptic_servo::servo::Transducers;
use serde::Serialize;

use super::output_file::{FileArgument, check_writable, refuse_overwriting};
use super::shared_arguments::{JsonOption, write};
use super::status::{CommandError, CommandStatus};
use super::value_parsers::{bounded, counts, positive};
use crate::file::{self, StatedTransducers, key};
use crate::identify::record::Recorder;
use crate::identify::{
    self, Correction, Disk, Estimate, Identification, Latency, Record, torque_source,
};
use crate::link::Address;
use crate::program;
use crate::program::identify::{PERIOD, TRANSDUCERS};
use crate::quantity::significant;
use age::KnownDelays;
use target::Origin;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Record of stepped sines, each frequency at two amplitudes of torque: CSV with the columns `time` in s,
    /// `torque` in N m, `counts`, and optionally `frequency` in Hz; or with units, as `time [ms]`, `torque
    /// (mNm)`, `angle (deg)`. `,`, `;` or tabs separate; `-` is standard input. With --target: scene file, or a file
    /// with a table `device` alone
    #[arg(value_name = "FILE", required_unless_present_any = ["target", "port"])]
    pub file: Option<PathBuf>,
    /// Encoder counts per turn; without a default for a record, with --target: those of FILE or 61440, with --port:
    /// those of the board
    #[arg(long, value_name = "N", value_parser = counts, allow_hyphen_values = true)]
    pub counts_per_rev: Option<f64>,
    /// Measure with the board at this address, which runs the program `identify` (`haptic flash identify --device FILE`): /dev/ttyACM0
    /// (@BAUD), tcp://HOST:PORT, unix:PATH. The motor moves the device; nobody may hold it
    #[arg(long, value_name = "PORT", group = "measured", conflicts_with = "file")]
    pub port: Option<Address>,
    /// Write the record to this file, with --port or --target
    #[arg(long, value_name = "FILE.csv", requires = "measured")]
    pub record: Option<PathBuf>,
    /// The record is of slow whole turns in both directions at three speeds or more, and shows friction and
    /// cogging. With --port the board runs the program `turns`, with --target it is simulated
    #[arg(long, conflicts_with_all = ["settle", "longest_lag"])]
    pub turns: bool,
    /// The record is of whole turns with two encoders on the shaft, in the columns `counts` and `reference`, and
    /// shows the nonlinearity and the age of the first: counts of the second per turn
    #[arg(long, value_name = "N", value_parser = counts, conflicts_with_all = ["turns", "measured", "settle", "longest_lag", "torque_delay", "count_delay",
          "torque_noise", "skew", "output_delay", "seed"],
          requires = "file", allow_hyphen_values = true)]
    pub reference_per_rev: Option<f64>,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub answer: JsonOption,
    /// Write the device to this file, which a scene file names: `device = "FILE.toml"` at its top. Of a
    /// file that exists only the table `device` and `encoder.age` are replaced; with --turns or --reference-per-rev only their numbers, in a file that exists
    #[arg(short, long, value_name = "FILE.toml")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub target: target::Simulated,
}

/// The corrections for reading a record.
#[derive(Debug, Args)]
pub struct Reading {
    /// Time from the time stamp of a row until its torque is applied, in s, at most 0.1
    #[arg(long, value_name = "S", value_parser = delay, allow_hyphen_values = true)]
    pub torque_delay: Option<f64>,
    /// Age of the counts of a row at its time stamp, in s, at most 0.1
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = delay,
          allow_hyphen_values = true)]
    pub count_delay: f64,
    /// Fraction of each sine to skip while the device settles, 0 to 0.9; default: 0.25, with
    /// --target: 0, because the record starts after the settling
    #[arg(long, value_name = "PART", value_parser = part, allow_hyphen_values = true)]
    pub settle: Option<f64>,
    /// Longest time constant that the amplifier may have, in s, as its bandwidth in the data sheet says:
    /// 1/(2 pi f). The shorter, the narrower are the intervals of lag and delay; default: half a period
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub longest_lag: Option<f64>,
    /// The current loop of the board's own bridge that the record is from, as eight numbers with commas between,
    /// which the measurement with --port has printed; default with --port: those of the board
    #[arg(long, value_name = "NUMBERS", value_parser = current_loop)]
    pub current_loop: Option<TorqueSource>,
}

impl Reading {
    /// The stated corrections of the measurement, with `settle` as the default.
    fn correction(&self, counts_per_turn: f64, settle: f64) -> Correction {
        Correction {
            torque_delay: self.torque_delay.unwrap_or(0.0),
            count_delay: self.count_delay,
            settle: self.settle.unwrap_or(settle),
            longest_lag: self.longest_lag,
            source: self.current_loop,
            ..Correction::of_encoder(counts_per_turn)
        }
    }
}

/// Default of the part of a sine to skip.
const SETTLE: f64 = 0.25;

#[derive(Debug, Serialize)]
struct Point {
    /// Hz.
    frequency: f64,
    /// Real part of `J` in rad/(N m s).
    re: f64,
    im: f64,
    /// Real part of `1/J` in N m s/rad.
    impedance_re: f64,
    impedance_im: f64,
    /// Standard deviation of both parts of `1/J`.
    deviation: f64,
}

/// Delay in s that was removed from the responses before the fit.
#[derive(Debug, Serialize)]
struct TakenOut {
    /// Half a period, the mean delay of a held torque.
    hold: f64,
    /// As declared: from the time of a row to its torque.
    torque_delay: f64,
    /// As declared: age of a row's counts at its time.
    count_delay: f64,
}

impl TakenOut {
    fn of(record: &Record, correction: &Correction) -> Self {
        let &Correction { torque_delay, count_delay, .. } = correction;
        Self { hold: 0.5 * record.period, torque_delay, count_delay }
    }

    fn row(&self) -> String {
        let micro = |time: f64| significant(1e6 * time, 4);
        format!(
            "{} us, half of the period that a torque is held for; {} us and {} us, declared for torque \
             and counts. The torque of a row counts from the row's time, at which the board's DAC is \
             latched, so the period from computing a code to its latch is in none of the numbers",
            micro(self.hold),
            micro(self.torque_delay),
            micro(self.count_delay)
        )
    }
}

#[derive(Debug, Serialize)]
struct Report<'a> {
    inertia: Estimate,
    damping: Estimate,
    /// Coulomb friction in N m.
    friction: Estimate,
    /// Whether friction can be told from damping.
    friction_told: bool,
    /// Mean delay of the torque's step response in s: the sum of lag and delay.
    skew: Estimate,
    skew_significant: bool,
    /// Lag and delay; `None` if no valid intervals exist.
    latency: Option<Latency>,
    /// Whether the responses exclude a lag alone or a delay alone.
    told_apart: bool,
    no_latency: Option<String>,
    /// Age of a reading in s, where the delay of the torque is declared.
    age: Option<Estimate>,
    taken_out: TakenOut,
    /// The board's own current loop, if there is one.
    current_loop: Option<TorqueSource>,
    bias: f64,
    disk: Disk,
    misfit: f64,
    rigid: bool,
    passivity: Option<f64>,
    confidence: f64,
    measured: Option<&'a Origin>,
    responses: Vec<Point>,
    notes: &'a [String],
}

/// Prints the device; the status is negative if it has no passivity for a certificate, or if a code of the
/// emulated board differs from this machine's.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    check_files(arguments)?;
    if let Some(reference) = arguments.reference_per_rev {
        let (file, counts) = recorded(arguments)?;
        return linearity::run(arguments, file, counts, reference);
    }
    // The file of which the turns replace numbers has to be there before a motor turns for minutes.
    if let Some(path) = arguments.output.as_deref().filter(|_| arguments.turns) {
        file::load_device(&path.to_string_lossy())?;
    }
    let mut recorder = Recorder::new(arguments.record.as_deref());
    let measured = measured(arguments, &mut recorder)?;
    recorder.end().map_err(identify::IdentifyError::from)?;
    if arguments.turns {
        return turns::run(arguments, &measured);
    }
    let Measured { record, origin, counts_per_turn, full_scale, torque_source } = measured;
    let settle = if origin.is_some() { 0.0 } else { SETTLE };
    let stated = arguments.reading.correction(counts_per_turn, settle);
    let correction = Correction { source: stated.source.or(torque_source), ..stated };
    let found =
        identify::identify(&record, &correction)?.with_linearity(stated_linearity(arguments));
    let mut notes = notes(&found);
    let delays = KnownDelays::of(arguments)?;
    let age = found.latency.ok().and_then(|latency| delays.age(&latency));
    let table = device_table(&found, &delays);
    let mut table = match arguments.output.as_deref().filter(|path| path.exists()) {
        Some(path) => device_file::replaced(path, &table, counts_per_turn)?,
        None => device_file(&table, arguments, counts_per_turn, full_scale)?,
    };
    if let Some(latency) = found.latency.ok().filter(|_| !has_bridge(&found)) {
        let path = arguments.output.as_deref().unwrap_or(Path::new("the device"));
        table = device_file::edited(path, &table, &[delays.number(&latency)])?;
    }
    match &arguments.output {
        // Its numbers are better than those of a fit that explains nothing.
        Some(path) if path.exists() && !found.is_rigid() => {
            notes.push(format!("{} is left as it is, because of the residuals", path.display()));
        }
        Some(path) => write(path, &table)?,
        None => {}
    }
    let taken_out = TakenOut::of(&record, &correction);
    let report = Report { age, ..report(&found, taken_out, &notes, origin.as_ref()) };
    arguments
        .answer
        .print(&report, |report| text(&found, report, &delays, origin.as_ref()) + "\n" + &table)?;
    let differs = origin.and_then(|origin| origin.difference);
    if let Some(difference) = differs {
        eprintln!("{difference}");
    }
    Ok(CommandStatus::of(found.passivity().is_some() && differs.is_none()))
}

/// Refuses outputs that would overwrite a file or cannot be written, before a motor moves for minutes. The simulated
/// device is an input: a measurement that writes half of its friction into it would find half of that the next time.
fn check_files(arguments: &Arguments) -> Result<(), CommandError> {
    let Arguments { file, record, output, .. } = arguments;
    let outputs = [
        FileArgument::of("--record", record.as_deref()),
        FileArgument::of("-o", output.as_deref()),
    ];
    refuse_overwriting(&[FileArgument::of("FILE", file.as_deref())], &outputs)?;
    outputs.into_iter().flatten().try_for_each(|output| check_writable(output.path))
}

impl Arguments {
    /// The file of the device that is simulated.
    fn simulated(&self) -> Option<&Path> {
        self.file.as_deref().filter(|_| self.target.target.is_some())
    }

    /// Checks that a file that exists can take the device with an encoder of these counts.
    fn check_output(&self, counts_per_turn: f64) -> Result<(), CommandError> {
        let output = self.output.as_deref().filter(|path| path.exists());
        output.map_or(Ok(()), |path| device_file::check(path, self.turns, counts_per_turn))
    }
}

/// The largest nonlinearity of the encoder in the files that say something of it: a simulated device's, and that of
/// which numbers are replaced.
fn stated_linearity(arguments: &Arguments) -> f64 {
    let files = [arguments.file.as_deref(), arguments.output.as_deref()];
    let linearity = |path: &Path| {
        let device = file::load_device(&path.to_string_lossy()).ok()?;
        Some(device.reading.linearity)
    };
    files.into_iter().flatten().filter_map(linearity).fold(0.0, f64::max)
}

/// A record and its known properties.
struct Measured {
    record: Record,
    origin: Option<Origin>,
    counts_per_turn: f64,
    /// The motor's torque in N m at the largest code, if the program `identify` of this workspace drove it.
    full_scale: Option<f64>,
    /// The board's current loop, if it has one.
    torque_source: Option<TorqueSource>,
}

/// The record of a file, or a new record.
fn measured(arguments: &Arguments, recorder: &mut Recorder<'_>) -> Result<Measured, CommandError> {
    let (file, stated) = (arguments.file.as_deref(), arguments.counts_per_rev);
    if let Some(address) = &arguments.port {
        let (record, board) = port::measure(address, recorder, arguments.turns, |board| {
            arguments.check_output(stated.unwrap_or(board.counts_per_turn))
        })?;
        let is_paddle =
            board.counts_per_turn == TRANSDUCERS.counts_per_turn && board.source.is_none();
        return Ok(Measured {
            record,
            origin: None,
            counts_per_turn: stated.unwrap_or(board.counts_per_turn),
            full_scale: is_paddle.then_some(TRANSDUCERS.full_scale_torque),
            torque_source: board.source,
        });
    }
    if arguments.target.target.is_some() {
        let device = file.map(|file| file::load_device(&file.to_string_lossy())).transpose()?;
        let device = device.as_ref();
        let of_file = device.map_or(StatedTransducers::default(), |device| device.transducers);
        let encoder = of_file.encoder_step.map(|_| of_file.or_defaults().counts_per_turn);
        let transducers = Transducers {
            counts_per_turn: stated.or(encoder).unwrap_or(TRANSDUCERS.counts_per_turn),
            full_scale_torque: of_file.full_scale.unwrap_or(TRANSDUCERS.full_scale_torque),
            ..TRANSDUCERS
        };
        arguments.check_output(transducers.counts_per_turn)?;
        let simulated = &arguments.target;
        let (measured, origin) = match arguments.turns {
            true => {
                let sweep = program::turns::sweep(&transducers);
                target::measure(simulated, ("turns", &sweep), device, recorder, &transducers)?
            }
            false => {
                let sweep = program::identify::sweep(&transducers);
                target::measure(simulated, ("identify", &sweep), device, recorder, &transducers)?
            }
        };
        return Ok(Measured {
            record: measured.record,
            origin: Some(origin),
            counts_per_turn: transducers.counts_per_turn,
            full_scale: Some(transducers.full_scale_torque),
            torque_source: None,
        });
    }
    let (file, counts_per_turn) = recorded(arguments)?;
    let record = load(file, counts_per_turn)?;
    Ok(Measured { record, origin: None, counts_per_turn, full_scale: None, torque_source: None })
}

/// The file of a record, and its counts per turn.
fn recorded(arguments: &Arguments) -> Result<(&Path, f64), CommandError> {
    let file = arguments.file.as_deref().unwrap_or(Path::new("-"));
    is_record(file)?;
    let missing = "--counts-per-rev N is missing: the encoder's counts per turn in this record";
    let counts = arguments.counts_per_rev.ok_or_else(|| CommandError::Failed(missing.into()))?;
    Ok((file, counts))
}

/// Checks that a file is not that of a device or a scene. No line of a record is a key of these.
fn is_record(file: &Path) -> Result<(), CommandError> {
    let keys = (file != Path::new("-")).then(|| file::load_json(&file.to_string_lossy()).ok());
    match keys.flatten().is_some_and(|keys| keys.get("device").is_some()) {
        true => Err(CommandError::NoRecord { path: file.to_owned() }),
        false => Ok(()),
    }
}

/// Identifies the device of a recorded file.
pub fn of_file(
    file: &Path,
    counts_per_turn: f64,
    reading: &Reading,
) -> Result<Identification, CommandError> {
    is_record(file)?;
    Ok(identify::identify(
        &load(file, counts_per_turn)?,
        &reading.correction(counts_per_turn, SETTLE),
    )?)
}

/// A record from a file or, as `-`, from standard input.
fn load(file: &Path, counts_per_turn: f64) -> Result<Record, CommandError> {
    let count_angle = std::f64::consts::TAU / counts_per_turn;
    let record = match file == Path::new("-") {
        true => identify::record::parse("<stdin>", io::stdin().lock(), count_angle),
        false => identify::record::load(file, count_angle),
    };
    Ok(record.map_err(identify::IdentifyError::from)?)
}

fn report<'a>(
    found: &Identification,
    taken_out: TakenOut,
    notes: &'a [String],
    measured: Option<&'a Origin>,
) -> Report<'a> {
    let point = |r: &identify::FrequencyPoint| Point {
        frequency: r.omega / std::f64::consts::TAU,
        re: r.admittance.re,
        im: r.admittance.im,
        impedance_re: r.impedance().re,
        impedance_im: r.impedance().im,
        deviation: r.deviation,
    };
    Report {
        inertia: found.inertia,
        damping: found.damping,
        friction: found.friction,
        friction_told: found.tells_friction,
        skew: found.mean_delay,
        skew_significant: found.mean_delay.is_significant(),
        latency: found.latency.ok(),
        told_apart: found.latency.is_ok_and(|latency| latency.is_told_apart()),
        no_latency: found.latency.err().map(|reason| reason.to_string()),
        age: None,
        taken_out,
        current_loop: found.model.source,
        bias: found.bias,
        disk: found.disk,
        misfit: found.misfit,
        rigid: found.is_rigid(),
        passivity: found.passivity(),
        confidence: identify::CONFIDENCE,
        measured,
        responses: found.responses.iter().map(point).collect(),
        notes,
    }
}

fn notes(found: &Identification) -> Vec<String> {
    let mut notes: Vec<String> = identify::left_out::grouped(&found.left_out);
    // If no rigid device explains the responses, the fitted times are meaningless.
    if found.is_rigid() && found.mean_delay.is_significant() {
        notes.push(format!(
            "the counts are {} us late against the torque: uncorrected, the damping would be {} N \
             m s/rad at {} Hz; inertia and damping are corrected for it",
            significant(1e6 * found.mean_delay.value, 3),
            significant(found.disk.delta, 3),
            significant(found.disk.omega / std::f64::consts::TAU, 3),
        ));
        notes.push(match &found.latency {
            Ok(latency) => split(found, latency),
            Err(reason) => format!("no interval of lag and delay: {reason}"),
        });
    }
    if !found.is_rigid() {
        notes.push(format!(
            "inertia and damping do not explain the responses (residuals {} times the noise): the \
             device is not one rigid mass, or its motor cogs, which slow turns show (--turns). Its passivity in a hand cannot be measured at the motor \
             alone, because a hand that holds the far end takes the damping of that end away. \
             Describe it as masses and links, and use `haptic device`",
            significant(found.misfit.sqrt(), 2),
        ));
    }
    if found.is_rigid() && !found.tells_friction {
        let [least, most] = found.speeds.map(|speed| significant(speed, 3));
        notes.push(format!(
            "no passivity is stated from one amplitude: all sines move at {least} to {most} rad/s, where \
             Coulomb friction of up to {} N m looks like damping. Record the same frequencies again at a \
             second amplitude of torque, for example half, in the same file",
            significant(found.friction.hi, 3),
        ));
    } else if found.is_rigid() && found.damping.hi > 0.0 && found.passivity().is_none() {
        notes.push(format!(
            "the device has no passivity: its damping may be as low as {} N m s/rad. Record the same \
             frequencies again at a second amplitude of torque, for example twice, in the same file, so that \
             friction is told from damping",
            significant(found.damping.lo, 3),
        ));
    } else if let Some(negative) = negative_damping(found) {
        notes.push(format!(
            "the device has no passivity: {negative}. Check the sign of torque and counts, the declared delays, and \
             that motor and encoder are on the same mass"
        ));
    }
    notes
}

/// The text on a damping that is not positive: as corrected for lag and delay, where the device is rigid.
fn negative_damping(found: &Identification) -> Option<String> {
    let Disk { delta, omega, .. } = found.disk;
    let hertz = significant(omega / std::f64::consts::TAU, 3);
    let damping = significant(found.damping.value, 3);
    match found.is_rigid() {
        true => found.passivity().is_none().then(|| format!("its damping is {damping} N m s/rad")),
        false => (delta <= 0.0)
            .then(|| format!("Re(1/J) is {} N m s/rad at {hertz} Hz", significant(delta, 3))),
    }
}

/// The text on lag and delay separately.
fn split(found: &Identification, latency: &Latency) -> String {
    let micro = |[lo, hi]: [f64; 2]| {
        format!("{} to {} us", significant(1e6 * lo, 3), significant(1e6 * hi, 3))
    };
    let (lag, delay) = (micro(latency.lag_range()), micro(latency.delay_range()));
    let sum = micro([found.mean_delay.lo.max(0.0), found.mean_delay.hi]);
    let skew = "A skew of the record that was not declared counts as delay";
    match (latency.actuator_lag.lo > 0.0, latency.output_delay.lo > 0.0) {
        (false, false) => format!(
            "lag and delay cannot be told apart: a lag alone explains the responses, and so does a delay \
             alone. Their sum is {sum}. A scene is safe with both ranges, a lag of {lag} and a delay of \
             {delay}, because the truth is in them; faster tones, a larger torque or --longest-lag make \
             them narrower. {skew}"
        ),
        (false, true) => format!(
            "there may be no lag, but at most {lag}, in a sum of {sum}; the delay is {delay}. {skew}"
        ),
        (true, false) => format!(
            "there may be no delay, but at most {delay}, in a sum of {sum}; the lag is {lag}. {skew}"
        ),
        (true, true) => format!("the lag is {lag}, the delay {delay}, their sum {sum}. {skew}"),
    }
}

/// Whether the torque was that of a board's own bridge, of which a scene states all times by its current loop.
fn has_bridge(found: &Identification) -> bool {
    found.model.source.is_some()
}

/// The range of the lag for the table of a device, and the sum of lag and delay.
fn latency_lines(found: &Identification, delays: &KnownDelays) -> String {
    let latency = match &found.latency {
        Ok(latency) => latency,
        Err(reason) => return format!("# actuator_lag and encoder.age: none; {reason}\n"),
    };
    // Rounded outwards, so that no end is rounded into the interval.
    let outward = |value: f64, part: f64| significant(value * (1.0 + part), 4);
    let [lo, hi] = delays.actuator_lag(latency);
    let delay = match has_bridge(found) {
        true => "the delay, which a scene states by its current loop,",
        false => "`encoder.age`",
    };
    let Estimate { lo: least, hi: most, .. } = found.mean_delay;
    format!(
        "actuator_lag = [{}, {}] # s, at 95 %; with {delay} {} to {} s at 95 %\n",
        outward(lo, -5e-4),
        outward(hi, 5e-4),
        significant(least, 4),
        significant(most, 4),
    )
}

/// The device file: the device, its encoder, and its motor if that is known.
fn device_file(
    table: &str,
    arguments: &Arguments,
    counts_per_turn: f64,
    full_scale: Option<f64>,
) -> Result<String, CommandError> {
    let step = std::f64::consts::TAU / counts_per_turn;
    let full_scale = match full_scale {
        Some(torque) => format!("full_scale = {torque:?} # N m, as the program states it"),
        None => {
            "# full_scale = the motor's torque in N m at the largest code; a board needs it".into()
        }
    };
    let reading = arguments.simulated().map(reading).transpose()?.unwrap_or_default();
    Ok(format!(
        "{table}{reading}\n[limits]\nencoder_step = {step:?} # rad, {counts_per_turn} counts per turn\n{full_scale}\n"
    ))
}

/// The table of the readings of a simulated device's encoder, which its measured delay is without; empty where its
/// file has none. The limits have its counts.
fn reading(simulated: &Path) -> Result<String, CommandError> {
    let file = file::load_json(&simulated.to_string_lossy())?;
    let keys = file.get(key::READING.path).and_then(serde_json::Value::as_object);
    let lines = keys.into_iter().flatten().filter(|(name, _)| *name != key::READING_COUNTS.name());
    let lines: String = lines.map(|(name, value)| format!("{name} = {value}\n")).collect();
    Ok(if lines.is_empty() { lines } else { format!("\n[encoder] # as it was stated\n{lines}") })
}

fn device_table(found: &Identification, delays: &KnownDelays) -> String {
    let range = |e: &Estimate| format!("{} to {}", significant(e.lo, 4), significant(e.hi, 4));
    let less = match found.motion_loss() {
        loss if loss > 0.0 => format!(" less {} by the current loop", significant(loss, 3)),
        _ => String::new(),
    };
    let less = match found.linearity {
        linearity if linearity > 0.0 => format!(", times {}{less}", 1.0 - linearity),
        _ => less,
    };
    // Rounded down.
    let passivity = found.passivity().map(|passivity| significant(passivity * (1.0 - 5e-4), 4));
    let passivity = match (passivity, found.latency) {
        (Some(passivity), Ok(_)) => format!(
            "passivity = {passivity} # N m s/rad, the damping less twice its uncertainty{less}; valid if the device is \
             rigid from motor to hand\n",
        ),
        // Else a scene would certify as if each torque were there at once.
        (Some(passivity), Err(_)) => format!(
            "passivity = 0.0 # nothing certifies without lag and delay: {passivity} N m s/rad once `actuator_lag` \
             and `encoder.age` are stated\n"
        ),
        // Else a scene would certify with all of the damping.
        (None, _) => "passivity = 0.0 # none: nothing certifies with this device\n".to_owned(),
    };
    let latency = latency_lines(found, delays);
    let at_least = 0.5 * found.friction.lo;
    let friction = match found.tells_friction && at_least > 0.0 {
        // Rounded down.
        true => format!(
            "friction = {} # N m, half of the least of",
            significant(at_least * (1.0 - 5e-3), 3)
        ),
        false => "# Coulomb friction:".to_owned(),
    };
    format!(
        "[device]\ninertia = {} # kg m^2, {} at 95 %\ndamping = {} # N m s/rad, {} at 95 %\n\
         {passivity}{friction} {} N m at 95 %\n{latency}",
        significant(found.inertia.value, 5),
        range(&found.inertia),
        significant(found.damping.value.max(0.0), 5),
        range(&found.damping),
        range(&found.friction),
    )
}

fn text(
    found: &Identification,
    report: &Report<'_>,
    delays: &KnownDelays,
    origin: Option<&Origin>,
) -> String {
    let estimate = |e: &Estimate, unit: &str| {
        let reach = significant(0.5 * (e.hi - e.lo), 2);
        format!("{} +- {reach} {unit}", significant(e.value, 5))
    };
    let hertz = |omega: f64| significant(omega / std::f64::consts::TAU, 4);
    let disk = match found.disk.delta {
        delta if delta > 0.0 => format!(
            "delta {} N m s/rad at {} Hz, radius {} rad/(N m s)",
            significant(delta, 5),
            hertz(found.disk.omega),
            significant(0.5 / delta, 4)
        ),
        _ => "none: some response is outside of every disk".to_owned(),
    };
    let mut rows = vec![
        ("damping", estimate(&found.damping, "N m s/rad")),
        (
            "friction",
            format!(
                "{} to {} N m",
                significant(found.friction.lo, 3),
                significant(found.friction.hi, 3)
            ),
        ),
        ("inertia", estimate(&found.inertia, "kg m^2")),
        ("lag + delay", estimate(&found.mean_delay, "s")),
        ("disk", disk),
        ("residuals", format!("{} times the noise", significant(found.misfit.sqrt(), 2))),
    ];
    if let Ok(Latency { actuator_lag, output_delay }) = &found.latency {
        let range =
            |e: &Estimate| format!("{} to {} s", significant(e.lo, 3), significant(e.hi, 3));
        rows.extend([("lag", range(actuator_lag)), ("delay", range(output_delay))]);
    }
    let age = found.latency.ok().and_then(|latency| delays.row(&latency));
    rows.extend(age.map(|age| ("age", age)));
    rows.push(("taken out", report.taken_out.row()));
    rows.extend(found.model.source.map(|source| ("current loop", current_loop_row(&source))));
    rows.extend(origin.map(Origin::row));
    rows.extend(report.notes.iter().map(|note| ("note", note.clone())));
    let rows: String = rows.iter().map(|(label, value)| format!("{label:<12} {value}\n")).collect();
    format!("{rows}\n{}", points(found))
}

fn current_loop_row(source: &TorqueSource) -> String {
    format!(
        "that of the board's bridge; what the motion moves through it is not counted as inertia or damping. To \
         read the record again: --current-loop {}",
        torque_source::numbers(source)
    )
}

fn points(found: &Identification) -> String {
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    table.set_header(["Hz", "Re 1/J, N m s/rad", "+-", "Im 1/J", "counts"]);
    for r in &found.responses {
        table.add_row([
            significant(r.omega / std::f64::consts::TAU, 4),
            significant(r.impedance().re, 4),
            significant(r.deviation, 2),
            significant(r.impedance().im, 4),
            significant(r.counts, 3),
        ]);
    }
    format!("{table}\n")
}

fn current_loop(text: &str) -> Result<TorqueSource, String> {
    torque_source::parse(text).ok_or_else(|| {
        format!("expected the eight numbers of a current loop, above 0 and with commas between, got `{text}`")
    })
}

/// A delay of a torque or of counts. No amplifier and no encoder has a longer one: such a number is in another
/// unit, and would turn the phase of each sine by many periods.
fn delay(text: &str) -> Result<f64, String> {
    let bound = "a number of seconds from 0 to 0.1; 80 us are 80e-6";
    bounded(text, bound, |value| (0.0..=0.1).contains(&value))
}

fn part(text: &str) -> Result<f64, String> {
    bounded(text, "a number from 0 to 0.9", |value| (0.0..=0.9).contains(&value))
}
