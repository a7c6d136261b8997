//! `haptic demo`: set-up, certificates, runs and charts with one command.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::RangedU64ValueParser;
use haptic_servo::certificate::certify;
use haptic_servo::environment::{Canceller, Environment, Wall};
use haptic_servo::scene::{Coupling, Device, Scene};

use super::building::{building, set_up};
use super::outcome::section;
use super::shared_arguments::{DEFAULT_TICKS, MAX_TICKS};
use super::status::{CommandError, CommandStatus};
use crate::chain::Chain;
use crate::chart::Window;
use crate::chart::growth::growth;
use crate::chart::nyquist::nyquist;
use crate::chart::trace::trace;
use crate::compare_run::{self, Backend, Input, RunOutcome, run_with_backend};
use crate::device::Motion;
use crate::program::{self, Program};
use crate::progress;
use crate::quantity::significant;
use crate::simulation::{Experiment, Integration, simulate};
use crate::toolchain::{NumberFormat, Tools};
use crate::verdict::{self, Verdict};
use crate::worst_hand::{self, HandCase};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder for the charts
    #[arg(long, value_name = "DIR", default_value = "target/demo")]
    pub out: PathBuf,
    /// Number format of the servo
    #[arg(long, value_enum, default_value_t = NumberFormat::F32)]
    pub format: NumberFormat,
    /// Ticks of each run, at least 2
    #[arg(long, value_name = "N", default_value_t = DEFAULT_TICKS,
          value_parser = RangedU64ValueParser::<usize>::new().range(2..=MAX_TICKS))]
    pub ticks: usize,
}

/// Free mode as in the paper's figure 9: damping 1, residual 0.05, the standard coupling.
const FIGURE_9: Scene = Scene {
    coupling: Coupling::Spring { stiffness: 2000.0 },
    ..Scene::of(Device::damped(1e-3, 1.0), 0.001, Canceller::to(0.05).alone())
};

/// The delayed wall as in the paper's last figure (equations 24 to 27).
const DELAYED_WALL: Scene = Scene {
    coupling: Coupling::Spring { stiffness: 44.0 },
    ..Scene::of(Device::damped(2.2e-5, 0.022), 0.001, Wall::damped(22.0, 0.01, 1).alone())
};

/// The same wall with one more sample of delay: beyond the critical line.
const PAST_THE_LINE: Scene =
    Scene { environment: Wall::damped(22.0, 0.01, 2).alone(), ..DELAYED_WALL };

/// Sets up, builds, certifies, runs and draws. The status is negative if a scene is not certified or a code
/// of the emulated board differs from the host's.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let mut out = io::stdout().lock();
    let toolchain = set_up(Tools::CompilerAndEmulator)?;
    let folder = &arguments.out;
    std::fs::create_dir_all(folder)
        .map_err(|source| CommandError::Unwritable { path: folder.clone(), source })?;
    let mut all_well = true;
    let build = || toolchain.build_scenes(program::NAMES, arguments.format);
    let built = building(&program::NAMES.join(", "), build)?;
    for (program, elf) in program::ALL.iter().zip(&built) {
        let report = verdict::judge(program.name, &program.scene);
        let outcome = emulate(program, elf, arguments)?;
        writeln!(out, "{}", section(program, &report, &outcome))?;
        draw_run(folder, program, &outcome)?;
        all_well &= report.verdict == Verdict::Certified && outcome.run.difference.is_none();
    }
    past_the_line(&mut out, folder)?;
    let pictures = [
        (
            "nyquist_free_mode.svg",
            "Free mode: b = 1 N m s/rad, residual 0.05 N m s/rad, T = 1 ms",
            FIGURE_9,
        ),
        (
            "nyquist_delayed_wall.svg",
            "Delayed wall: K = 22 N m/rad, B = 0.01 N m s/rad, T = 1 ms",
            DELAYED_WALL,
        ),
    ];
    for (name, title, scene) in pictures {
        let picture = nyquist(title, &[(name.to_owned(), scene)], &Window::default())?;
        picture.write(&folder.join(name))?;
    }
    writeln!(out, "pictures: {}", folder.display())?;
    out.flush()?;
    Ok(CommandStatus::of(all_well))
}

fn emulate(
    program: &Program,
    elf: &Path,
    arguments: &Arguments,
) -> Result<RunOutcome, CommandError> {
    let mut controller = program.controller(arguments.format, &program.transducers)?;
    let ticks = arguments.ticks;
    let bar = progress::bar(ticks as u64, program.name);
    let stepper = progress::stepper(&bar);
    let outcome = run_with_backend(
        Input::Hand(Box::new(program.device())),
        controller.as_mut(),
        Some(Backend::Emulator(elf)),
        ticks,
        stepper,
    )?;
    bar.finish_and_clear();
    Ok(outcome)
}

fn draw_run(folder: &Path, program: &Program, outcome: &RunOutcome) -> Result<(), CommandError> {
    let trajectory = (program.trajectory)();
    let title = format!("{}: {}", program.name, trajectory.description);
    let mut picture =
        compare_run::trace(title, program.scene.timing.period, &outcome.run, &trajectory);
    picture.face = face(&program.scene.environment);
    picture.torque_limit = program.scene.torque_limit;
    let file = folder.join(program.name).with_extension("svg");
    Ok(trace(&picture, &Window::default())?.write(&file)?)
}

/// The face of a one-sided wall in rad.
fn face(environment: &Environment) -> Option<f64> {
    environment.wall().filter(|wall| wall.is_one_sided()).map(Wall::face)
}

/// The number of ticks in which the motion grows by a factor.
fn ticks_to(factor: f64, held: &HandCase) -> f64 {
    factor.ln() / held.spectral_radius.ln()
}

/// Angle in rad from a touch until the oscillation has grown a thousandfold.
fn touched(device: &Chain, held: &HandCase) -> Result<Vec<f64>, CommandError> {
    const TOUCH: f64 = 0.01;
    let experiment = Experiment {
        plant: worst_hand::plant(device, 1.0, &held.hand),
        start: Motion { position: 0.0, velocity: TOUCH },
        samples: ticks_to(1e3, held) as usize,
        ..Experiment::still(&PAST_THE_LINE)
    };
    Ok(simulate(&experiment, Integration::default())?.position)
}

fn past_the_line(out: &mut impl Write, folder: &Path) -> Result<(), CommandError> {
    writeln!(out, "beyond the limit: the same wall, two samples late instead of one")?;
    match certify(&PAST_THE_LINE) {
        Ok(_) => writeln!(out, "  certified")?,
        Err(rejection) => writeln!(out, "  {rejection}")?,
    }
    let device = Chain::rigid(PAST_THE_LINE.device.inertia, PAST_THE_LINE.device.damping)
        .expect("the device of a scene that is written here");
    let found = worst_hand::search(&PAST_THE_LINE, &device)?;
    if found.oscillates {
        let held = found.worst;
        writeln!(
            out,
            "  without the check: in a passive hand of {} kg m^2, {} N m s/rad and {} N m/rad a \
             touch grows by {} % a tick,\n  a thousandfold in {} ms",
            significant(held.hand.inertia, 3),
            significant(held.hand.damping, 3),
            significant(held.hand.stiffness, 3),
            significant(100.0 * (held.spectral_radius - 1.0), 3),
            significant(1e3 * PAST_THE_LINE.timing.period * ticks_to(1e3, &held), 3)
        )?;
        let picture = growth(
            "Beyond the limit: the rejected wall in a passive hand",
            PAST_THE_LINE.timing.period,
            &touched(&device, &held)?,
        )?;
        picture.write(&folder.join("past_the_line.svg"))?;
    } else {
        writeln!(out, "  no hand was found in which it oscillates")?;
    }
    writeln!(out)?;
    Ok(())
}
