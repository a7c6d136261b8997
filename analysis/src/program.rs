//! The scenes with a program for the board, from that program's own file: four, and one more in the
//! build of `haptic` that the package `haptic-scene` makes for it.

#[path = "../../firmware/src/bin/damper_wall.rs"]
pub mod damper_wall;
#[path = "../../firmware/src/bin/delayed_spring.rs"]
pub mod delayed_spring;
// It has a `cfg` for a real board, which is never set here.
#[allow(unexpected_cfgs)]
#[path = "../../firmware/src/bin/free_mode.rs"]
pub mod free_mode;
#[path = "../../firmware/src/bin/hosted_wall.rs"]
pub mod hosted_wall;
// The device of the other examples.
#[path = "../../firmware/src/bin/brushless_shaft/mod.rs"]
mod brushless_shaft;
// Not a scene, and so not among them: the program that measures a device.
#[path = "../../firmware/src/bin/identify.rs"]
pub mod identify;
#[path = "../../firmware/src/bin/knob.rs"]
pub mod knob;
#[path = "../../firmware/src/bin/knob_modes.rs"]
pub mod knob_modes;
// The same by slow turns.
#[path = "../../firmware/src/bin/supervised_spring.rs"]
pub mod supervised_spring;
#[path = "../../firmware/src/bin/turns.rs"]
pub mod turns;
#[path = "../../firmware/src/bin/undelayed_spring.rs"]
pub mod undelayed_spring;
#[path = "../../firmware/src/bin/undelayed_wall.rs"]
pub mod undelayed_wall;

use std::io;
use std::sync::OnceLock;

use haptic_servo::current::CurrentLoop;
use haptic_servo::host::HostTorque;
use haptic_servo::number::Number;
use haptic_servo::rendering::Rendering;
use haptic_servo::scene::{Device, Scene};
use haptic_servo::servo::{BuildError, Servo, Transducers};
use serde::Serialize;

use crate::board_sim::{Pacing, SimulatedBoard};
use crate::controller::Controller;
use crate::file::{self, Format, example};
use crate::hand::HandTrajectory;
use crate::link::Address;
use crate::lockstep::{PlantIo, SimulatedDevice};
use crate::toolchain::NumberFormat;

/// A scene with a program of its own.
#[derive(Debug)]
pub struct Program {
    /// Name of the program.
    pub name: &'static str,
    /// Its scene as data.
    pub scene: Scene,
    /// The encoder and the motor that it is built for.
    pub transducers: Transducers,
    /// The current loop of the board's own bridge that makes its torques; none where a DAC does.
    pub bridge: &'static Option<CurrentLoop>,
    /// What a host may do beside it.
    pub host: Option<HostTorque>,
    /// The hand's trajectory that demonstrates it.
    pub trajectory: fn() -> HandTrajectory,
    /// The size of its servo's state, in a format.
    pub state: fn(NumberFormat) -> State,
    /// Builds its servo on the host.
    pub build: Build,
    /// Starts it on a board that is a thread.
    pub listen: Listen,
}

/// Bytes that a servo keeps from tick to tick, coefficients included. No part of it has a size that depends
/// on the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct State {
    /// The whole servo.
    pub servo: usize,
    /// The part of its environment and of its coupling's memory.
    pub environment: usize,
}

impl State {
    /// The state of the servo of an environment in the format `N`.
    pub fn of<E: Rendering<N>, N: Number>() -> Self {
        Self {
            servo: size_of::<Servo<E, N>>(),
            environment: size_of::<E::Law>() + size_of::<E::Memory>(),
        }
    }
}

/// Builds a program's servo on the host.
pub type Build = fn(NumberFormat, &Transducers) -> Result<Box<dyn Controller>, BuildError>;

/// Starts a program on a board that is a thread.
pub type Listen = fn(Box<dyn PlantIo + Send>, &Address, Pacing) -> io::Result<SimulatedBoard>;

impl Program {
    /// Its servo on the host, with other transducers where a recording comes from another encoder.
    pub fn controller(
        &self,
        format: NumberFormat,
        transducers: &Transducers,
    ) -> Result<Box<dyn Controller>, BuildError> {
        (self.build)(format, transducers)
    }

    /// Its device at rest, in the hand that shows it.
    pub fn device(&self) -> SimulatedDevice {
        SimulatedDevice::new(&self.scene, (self.trajectory)(), &self.transducers)
            .expect("a device that is written there moves")
    }

    /// Starts it on a board that is a thread, around this device.
    pub fn listen(
        &self,
        plant: Box<dyn PlantIo + Send>,
        address: &Address,
        pacing: Pacing,
    ) -> io::Result<SimulatedBoard> {
        (self.listen)(plant, address, pacing)
    }

    /// The program of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        Self::every()
            .chain([&KNOB_MODES, &HOSTED])
            .chain(MORE.get())
            .find(|program| program.name == name)
    }

    /// All programs of this build but [`KNOB_MODES`] and [`HOSTED`], including the program that needs a host and those whose
    /// torques are not latched.
    pub fn every() -> impl Iterator<Item = &'static Self> {
        ALL.iter().chain([&SUPERVISED, &UNDELAYED, &STIFFEST])
    }
}

/// Whether a device is that of an example, a program's or a scene file's: by its inertia and damping, of which
/// no two devices have the same.
pub fn is_example(device: &Device) -> bool {
    let chain = example::toml(example::CHAIN)
        .and_then(|text| file::parse(example::CHAIN, Format::Toml, &text).ok());
    let of_programs = [damper_wall::SCENE.device, brushless_shaft::SCENE.device];
    of_programs
        .into_iter()
        .chain(chain.map(|file| file.scene.device))
        .any(|it| (it.inertia, it.damping) == (device.inertia, device.damping))
}

/// The program that this build has besides [`ALL`].
static MORE: OnceLock<Program> = OnceLock::new();

/// Adds the program that [`Program::find`] finds besides [`ALL`].
pub fn add(program: Program) {
    // `find` does not find a second added program.
    let _ = MORE.set(program);
}

/// The [`Program`] of a module that is a scene's file, whose torques are latched if no other mode is named.
#[macro_export]
macro_rules! program {
    ($module:ident) => {
        $crate::program!($module, ::haptic_servo::servo::Latched)
    };
    ($module:ident, $mode:ty) => {
        $crate::program::Program {
            name: stringify!($module),
            scene: $module::SCENE,
            transducers: $module::TRANSDUCERS,
            bridge: &$module::BRIDGE,
            host: <$module::Rendered as ::haptic_servo::rendering::Rendering<f32>>::HOST,
            trajectory: || {
                $crate::hand::HandTrajectory::for_environment(&$module::SCENE.environment)
            },
            state: |format| match format {
                $crate::toolchain::NumberFormat::F32 => {
                    $crate::program::State::of::<$module::Rendered, f32>()
                }
                $crate::toolchain::NumberFormat::Fixed => {
                    $crate::program::State::of::<$module::Rendered, $module::Fixed>()
                }
            },
            build: |format, transducers| match format {
                $crate::toolchain::NumberFormat::F32 => $crate::controller::controller::<_, f32>(
                    &$module::Rendered::certified(),
                    transducers,
                ),
                $crate::toolchain::NumberFormat::Fixed => {
                    $crate::controller::controller::<_, $module::Fixed>(
                        &$module::Rendered::certified(),
                        transducers,
                    )
                }
            },
            listen: |plant, address, pacing| {
                let program = $module::PROGRAM;
                $crate::board_sim::SimulatedBoard::start::<_, f32, $mode>(
                    stringify!($module),
                    program,
                    plant,
                    address,
                    pacing,
                )
            },
        }
    };
}

macro_rules! programs {
    ($($module:ident),*) => {
        /// Names of all programs, in the order in which they are shown.
        pub const NAMES: &[&str] = &[$(stringify!($module)),*];

        /// All programs, in the same order.
        pub const ALL: &[Program] = &[$($crate::program!($module)),*];
    };
}

programs!(delayed_spring, damper_wall, free_mode, knob);

/// The program whose modes are selected while it runs. Not among the others: with the first of its modes it
/// turns freely.
pub static KNOB_MODES: Program = crate::program!(knob_modes);

/// The program that takes the torques of a host. Not among the others, which run without one.
pub static HOSTED: Program = crate::program!(hosted_wall);

/// The program that shows the effect of the options. Not among the others: it releases the device without a
/// host, and a simulation has no host.
pub static SUPERVISED: Program = crate::program!(supervised_spring);

/// The program whose torques come at a phase of their own. Not among the others, which are compared with the
/// paper's: its wall is not late, and has a coupling with memory in front of it.
pub static UNDELAYED: Program = crate::program!(undelayed_wall, undelayed_wall::Output);

/// The stiffest spring of the paddle at its rate, whose torques come at a phase, too.
pub static STIFFEST: Program = crate::program!(undelayed_spring, undelayed_spring::Output);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_device_of_an_example_is_known_by_its_numbers() {
        let text = example::toml("damper-wall").unwrap();
        let device = file::parse("wall", Format::Toml, &text).unwrap().scene.device;
        assert!(is_example(&device) && is_example(&brushless_shaft::SCENE.device));
        assert!(is_example(&Device { passivity: Some(0.0194), ..device }));
        assert!(!is_example(&Device { damping: device.damping.next_down(), ..device }));
        assert!(!is_example(&Device { inertia: 3e-5, ..device }));
    }

    /// A stiffness and the sample that is late; for the wall a face, a damping and the last position,
    /// too; for free mode the canceller's gain, its rate and its state, and the sample that is late.
    #[test]
    fn a_servo_keeps_what_its_environment_uses() {
        for (name, numbers) in [("delayed_spring", 2), ("damper_wall", 5), ("free_mode", 4)] {
            let state = (Program::find(name).unwrap().state)(NumberFormat::F32);
            // On this machine a law is aligned as the pointer to the table that a profile would have.
            let size = (numbers * size_of::<f32>()).next_multiple_of(align_of::<usize>());
            assert_eq!(state.environment, size, "{name}");
            assert!(state.servo > state.environment);
        }
    }
}
