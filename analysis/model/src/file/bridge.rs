//! The motor of a scene file on a board's own bridge: its current loop, and what the scene states of it.

use std::f64::consts::TAU;

use haptic_servo::certificate::Resolution;
use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, EncoderIndex, Regeneration, Supply};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::TimeRange;
use haptic_servo::servo::Transducers;
use haptic_servo::text::RoundUp3;

use super::key::{self, Presence};
use super::motor::FileMotor;
use super::scene::SceneFile;
use super::supply::FileSupply;
use crate::quantity::rounded_down;

/// A motor on a board's bridge.
#[derive(Clone, Copy, Debug)]
pub struct MotorOnBridge {
    /// Its current loop.
    pub current_loop: CurrentLoop,
    /// When the torque of a count is put out.
    pub output: OutputTiming,
}

/// Relative tolerance of times that should be equal.
const SAME: f64 = 1e-9;

impl SceneFile {
    /// The file's resolution, for the certificate's assumptions: that of a motor without a current loop is not
    /// known.
    pub fn steps(&self) -> Resolution {
        self.steps_on(&self.own_bridge())
    }

    /// The same with its [bridge](Self::own_bridge), which takes a design of its current loop.
    pub fn steps_on(&self, bridge: &Result<Option<MotorOnBridge>, String>) -> Resolution {
        let Self { encoder_step: encoder, full_scale, friction, .. } = *self;
        let steps = Resolution { encoder, full_scale, friction, ..Resolution::default() };
        match bridge {
            Ok(None) => steps,
            Ok(Some(bridge)) => steps.with_current_loop(&bridge.current_loop.resolution()),
            Err(_) => Resolution { current: Some(f64::INFINITY), ..steps },
        }
    }

    /// Its motor on the bridge of the board that has one, with the encoder and the full scale of the file; `None`
    /// without a motor.
    ///
    /// # Errors
    /// As [`Self::on_bridge`], and a sentence about an encoder and a full scale that are missing.
    pub fn own_bridge(&self) -> Result<Option<MotorOnBridge>, String> {
        match self.motor {
            Some(_) => self.on_bridge(&self.board_transducers(None, None)?),
            None => Ok(None),
        }
    }

    /// Its motor on the bridge of the board that has one, with the times and the passivity that the scene states;
    /// `None` without a motor.
    ///
    /// # Errors
    /// A sentence about the keys that are missing, or that the current loop does not have.
    pub fn on_bridge(&self, transducers: &Transducers) -> Result<Option<MotorOnBridge>, String> {
        let Self { scene, motor, supply, .. } = self;
        let Some(FileMotor { motor, lowest_supply, highest_supply, index_offset }) = *motor else {
            return Ok(None);
        };
        let regeneration = match supply {
            Some(FileSupply::Sinks { .. }) => Regeneration::Sinks,
            Some(FileSupply::Stores { bus, .. }) => {
                Regeneration::Stores { voltage: bus.voltage, capacitance: bus.capacitance }
            }
            None => return Err(format!("a board's own bridge needs [{}]", key::SUPPLY.path)),
        };
        let (latency, period) = (&scene.latency, scene.timing.period);
        let TimeRange { least: lag, most } = latency.actuator_lag;
        if lag == 0.0 || lag != most {
            let key = key::ACTUATOR_LAG.path;
            return Err(format!(
                "a board's own bridge needs `{key}` as one number, 1/(2 pi bandwidth in Hz)"
            ));
        }
        let drive = Drive {
            motor,
            supply: Supply { lowest: lowest_supply, highest: highest_supply, regeneration },
            bandwidth: 1.0 / (TAU * lag),
            largest_temperature: B_G431B_ESC1.largest_temperature,
        };
        // TIM4, or a chip.
        let counter = self.chip.map_or(CounterWidth::Bits16, |chip| chip.width);
        let transducers = Transducers { counter, ..*transducers };
        let speed = transducers.largest_speed;
        let refused = |error: &dyn ToString| match key::LARGEST_SPEED.presence {
            Presence::Default(default) if speed == default => format!(
                "{}; `{}` is {default} rad/s, as it is where the key is missing: state it",
                error.to_string(),
                key::LARGEST_SPEED.path
            ),
            _ => error.to_string(),
        };
        let mut current_loop = CurrentLoop::design(&drive, &B_G431B_ESC1, &transducers, period)
            .map_err(|error| refused(&error))?;
        if index_offset.is_some() {
            let indexed = current_loop.indexed(EncoderIndex { offset: index_offset });
            current_loop = indexed.map_err(|error| error.to_string())?;
        }
        current_loop.check_age(latency, period, speed).map_err(|error| refused(&error))?;
        let response = current_loop.response();
        let phase = latency.stated_delay() - response.delay;
        let is_latched = phase.abs() <= SAME * response.delay;
        let output = OutputTiming::of_delay(if is_latched { 0.0 } else { phase });
        // The reader has refused a delay that is not a whole number of updates.
        let is_too_early = phase < -SAME * response.delay;
        if latency.actuator_updates != response.updates || is_too_early {
            return Err(format!(
                "the current loop of this motor has `{}` = {} and `{}` = {:?} or a multiple",
                key::ACTUATOR_UPDATES.path,
                response.updates,
                key::OUTPUT_DELAY.path,
                response.delay
            ));
        }
        let (passivity, loss) = (scene.device.passivity(), current_loop.motion_loss());
        if passivity + loss > scene.device.damping {
            return Err(format!(
                "through this motor's current loop motion takes {} N m s/rad of the damping: set `{}` to at most {}",
                RoundUp3(loss),
                key::PASSIVITY.path,
                rounded_down((scene.device.damping - loss).max(0.0), 3)
            ));
        }
        Ok(Some(MotorOnBridge { current_loop, output }))
    }
}
