//! A spring in closed loop with a hand that leans with a steady torque and lets go: its stiffness at rest,
//! and whether it comes to rest.
//!
//! A device behind an encoder and without Coulomb friction never comes to rest on a spring: it moves over an
//! edge or two. With the friction that the certificate requires it stands still.

use std::f64::consts::TAU;
use std::ops::Range;

use haptic_servo::certificate::{QuantizationBound, Resolution};
use haptic_servo::dac::DacCode;
use haptic_servo::number::Format;

use crate::lockstep::run;
use crate::program::Program;
use crate::simulation::Experiment;
use crate::simulation::torque_signal::TorqueSignal;
use crate::studies::failures::loaded::LoadedDevice;
use crate::toolchain::NumberFormat;

/// Torque in N m of the hand: less than the programs' limit.
pub const TORQUE: f64 = 0.9;
/// Ticks until the hand begins, until its torque reaches [`TORQUE`], and until it lets go.
const LEANS: [usize; 3] = [250, 750, 2250];
/// Ticks of a run.
pub const TICKS: usize = 3500;
/// Ticks in which the device should be at rest while the hand leans.
pub const LEANING: Range<usize> = 1750..2250;
/// The same after the hand has let go.
pub const FREE: Range<usize> = 3000..3500;

/// The device of a program with this Coulomb friction in N m, at rest. A hand without mass or damping
/// leans against it and lets go.
pub fn device(program: &Program, friction: f64) -> LoadedDevice {
    let [begins, holds, ends] = LEANS;
    let grown =
        |tick: usize| (tick.saturating_sub(begins) as f64 / (holds - begins) as f64).min(1.0);
    let torque = (0..ends).map(|tick| TORQUE * grown(tick)).collect();
    let experiment = Experiment {
        friction,
        hand_torque: TorqueSignal::Held(torque),
        ..Experiment::still(&program.scene)
    };
    LoadedDevice::new(&experiment, &program.transducers)
        .expect("a device that is written there moves")
}

/// The Coulomb friction in N m with which a device comes to rest, from the certificate of a program in `f32`.
pub fn friction_to_rest(program: &Program) -> f64 {
    let steps = Resolution::of(&program.transducers, None);
    let steps = match program.bridge {
        Some(current_loop) => steps.with_current_loop(&current_loop.resolution()),
        None => steps,
    };
    QuantizationBound::of(&program.scene, Format::F32, &steps).map_or(f64::NAN, |rest| rest.hum())
}

/// A device at rest, or nearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest {
    /// Counts from the encoder's lowest to its highest reading.
    pub counts: i32,
    /// Mean angle of these counts in rad.
    pub angle: f64,
    /// Mean torque of the motor in N m, against the angle.
    pub torque: f64,
}

impl AtRest {
    /// From the counts and codes of some ticks.
    pub fn of(program: &Program, ticks: &[(i32, u16)]) -> Self {
        let transducers = &program.transducers;
        let (radians, newton_metres) = (
            TAU / transducers.counts_per_turn,
            transducers.full_scale_torque / f64::from(DacCode::CODES_TO_FULL_SCALE),
        );
        let counts = || ticks.iter().map(|&(count, _)| count);
        let codes = |code: u16| f64::from(DacCode::MID_SCALE.get()) - f64::from(code);
        let mean = |sum: f64| sum / ticks.len() as f64;
        Self {
            counts: counts().max().unwrap_or(0) - counts().min().unwrap_or(0),
            angle: radians * mean(counts().map(f64::from).sum()),
            torque: newton_metres * mean(ticks.iter().map(|&(_, code)| codes(code)).sum()),
        }
    }

    /// Stiffness of the wall in N m/rad.
    pub fn stiffness(&self) -> f64 {
        self.torque / self.angle
    }
}

/// Counts and codes of a program's servo on the host, in closed loop with its device in the leaning hand.
///
/// # Panics
/// If the program's servo cannot be built.
pub fn run_on_host(program: &Program, friction: f64) -> Vec<(i32, u16)> {
    let mut device = device(program, friction);
    let mut servo = program
        .controller(NumberFormat::F32, &program.transducers)
        .expect("a program's scene has a servo");
    let run = run(&mut device, servo.as_mut(), TICKS);
    run.ticks.iter().map(|tick| (tick.count as i32, tick.code)).collect()
}

/// Stiffness in N m/rad that a program renders at rest, in closed loop with its device.
pub fn rendered_stiffness(program: &Program) -> f64 {
    AtRest::of(program, &run_on_host(program, 0.0)[LEANING]).stiffness()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::STIFFEST;

    /// Spring and coupling in a row, with what counts that are read late make the coupling softer by.
    fn predicted() -> f64 {
        let (delta, period) = (0.022, 1e-3);
        let (delay, lag, jitter) = (5e-6, 53.0517e-6, 1e-6);
        let coupling = (period + delay + lag + 3.0 * jitter) / (2.0 * delta);
        1.0 / (1.0 / 2400.0 + coupling)
    }

    /// The friction is the certificate's: no more is needed, and with none the device moves over an edge
    /// or two of its encoder, around the same angle.
    #[test]
    fn the_stiffest_spring_is_as_stiff_as_certified_and_comes_to_rest() {
        let predicted = predicted();
        assert!((40.7..40.8).contains(&predicted), "{predicted}");
        let friction = friction_to_rest(&STIFFEST);
        assert!((0.002..0.004).contains(&friction), "{friction}");
        let transducers = &STIFFEST.transducers;
        let count = TAU / transducers.counts_per_turn;
        let code = transducers.full_scale_torque / f64::from(DacCode::CODES_TO_FULL_SCALE);
        for friction in [0.0, friction] {
            let run = run_on_host(&STIFFEST, friction);
            let [leaning, free] = [LEANING, FREE].map(|ticks| AtRest::of(&STIFFEST, &run[ticks]));
            let most = if friction > 0.0 { 0 } else { 4 };
            assert!(leaning.counts <= most && free.counts <= most, "{leaning:?} {free:?}");
            assert!(
                (leaning.torque - predicted * leaning.angle).abs() <= 0.5 * code,
                "{leaning:?}"
            );
            // The encoder shows the whole counts below an angle; in motion over edges their mean is that of
            // the times between the edges, which may all be near one end.
            let angle = TORQUE / predicted;
            let off = angle - (leaning.angle + 0.5 * count);
            let moved = 0.5 * f64::from(1 + leaning.counts) * count;
            assert!(off.abs() <= moved + friction / predicted, "{off} {leaning:?}");
            assert!(free.angle.abs() <= count + friction / predicted, "{free:?}");
        }
    }
}
