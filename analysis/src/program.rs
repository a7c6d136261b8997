//! The scenes that have a program for the board, as that program's own file says them.

#[path = "../../firmware/src/bin/damper_wall.rs"]
pub mod damper_wall;
#[path = "../../firmware/src/bin/delayed_spring.rs"]
pub mod delayed_spring;
// It asks whether it is built for a real board, which is never so here.
#[allow(unexpected_cfgs)]
#[path = "../../firmware/src/bin/free_mode.rs"]
pub mod free_mode;
// No scene, and so not among them: what a device is measured with.
#[path = "../../firmware/src/bin/identify.rs"]
pub mod identify;
#[path = "../../firmware/src/bin/supervised_spring.rs"]
pub mod supervised_spring;

use std::io;

use firmware::environment::Renderable;
use firmware::number::Number;
use firmware::scene::Scene;
use firmware::servo::{BuildError, Latched, Servo, Transducers};
use serde::Serialize;

use crate::controller::{Controller, controller};
use crate::hand::Script;
use crate::link::Address;
use crate::rig::{Plant, SimulatedDevice};
use crate::toolchain::NumberFormat;
use crate::twin::{Clock, Twin};

/// A scene with a program of its own.
#[derive(Debug)]
pub struct Program {
    /// Name of the program.
    pub name: &'static str,
    /// Its scene as data.
    pub scene: Scene,
    /// The encoder and the motor that it is built for.
    pub transducers: Transducers,
    /// What a hand does to show it.
    pub script: fn() -> Script,
    /// What its servo keeps from tick to tick, in a format.
    pub state: fn(NumberFormat) -> State,
    build: Build,
    listen: Listen,
}

/// Bytes that a servo keeps from tick to tick, coefficients included. There is nothing in it whose
/// size depends on the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct State {
    /// All of it.
    pub servo: usize,
    /// What of it is the environment's.
    pub environment: usize,
}

impl State {
    fn of<E: Renderable<N>, N: Number>() -> Self {
        Self { servo: size_of::<Servo<E, N>>(), environment: size_of::<E::Law>() }
    }
}

/// Builds a program's servo on the host.
type Build = fn(NumberFormat, &Transducers) -> Result<Box<dyn Controller>, BuildError>;

/// Starts a program on a board that is a thread.
type Listen = fn(Box<dyn Plant + Send>, &Address, Clock) -> io::Result<Twin>;

impl Program {
    /// Its servo on the host, with other transducers where a recording comes from another encoder.
    ///
    /// # Errors
    /// Where the scene cannot be had with these transducers in this format.
    pub fn controller(
        &self,
        format: NumberFormat,
        transducers: &Transducers,
    ) -> Result<Box<dyn Controller>, BuildError> {
        (self.build)(format, transducers)
    }

    /// Its device at rest, in the hand that shows it.
    pub fn device(&self) -> SimulatedDevice {
        SimulatedDevice::new(
            self.scene.device,
            (self.script)(),
            self.scene.timing.period,
            &self.transducers,
        )
        .expect("a device that is written there moves")
    }

    /// Starts it on a board that is a thread, around this device.
    ///
    /// # Errors
    /// Where the address cannot be listened at.
    pub fn listen(
        &self,
        plant: Box<dyn Plant + Send>,
        address: &Address,
        clock: Clock,
    ) -> io::Result<Twin> {
        (self.listen)(plant, address, clock)
    }

    /// The program of that name, among those whose servo needs nothing but counts.
    pub fn find(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|program| program.name == name)
    }

    /// All programs, also the one that needs a host.
    pub fn every() -> impl Iterator<Item = &'static Self> {
        ALL.iter().chain([&SUPERVISED])
    }
}

macro_rules! program {
    ($module:ident, $script:path) => {
        Program {
            name: stringify!($module),
            scene: $module::SCENE.as_data(),
            transducers: $module::TRANSDUCERS,
            script: $script,
            state: |format| match format {
                NumberFormat::F32 => State::of::<$module::Environment, f32>(),
                NumberFormat::Fixed => State::of::<$module::Environment, $module::Fixed>(),
            },
            build: |format, transducers| match format {
                NumberFormat::F32 => controller::<_, f32>(&$module::CERTIFIED, transducers),
                NumberFormat::Fixed => {
                    controller::<_, $module::Fixed>(&$module::CERTIFIED, transducers)
                }
            },
            listen: |plant, address, clock| {
                let program = $module::PROGRAM;
                Twin::start::<_, f32, Latched>(stringify!($module), program, plant, address, clock)
            },
        }
    };
}

macro_rules! programs {
    ($($module:ident, $script:path;)*) => {
        /// Names of the programs that are shown and measured, in the order in which they are shown.
        pub const NAMES: &[&str] = &[$(stringify!($module)),*];

        /// These programs, in the same order.
        pub const ALL: &[Program] = &[$(program!($module, $script)),*];
    };
}

programs! {
    delayed_spring, Script::push_and_let_go;
    damper_wall, Script::push_and_let_go;
    free_mode, Script::swing_and_let_go;
}

/// What the options do. Not among the others: it lets the device go where no host is heard, as in a
/// simulation there is none.
pub static SUPERVISED: Program = program!(supervised_spring, Script::push_and_let_go);

#[cfg(test)]
mod tests {
    use super::*;

    /// A stiffness and the sample that is late; for the wall a face, a damping and the last position,
    /// too; for free mode the canceller's gain, its rate and its state, and the sample that is late.
    #[test]
    fn a_servo_keeps_what_its_environment_uses() {
        for (name, numbers) in [("delayed_spring", 2), ("damper_wall", 5), ("free_mode", 4)] {
            let state = (Program::find(name).unwrap().state)(NumberFormat::F32);
            assert_eq!(state.environment, numbers * size_of::<f32>(), "{name}");
            assert!(state.servo > state.environment);
        }
    }
}
