//! The start of a board from reset to a servo that may run, in an order in which the motor cannot move
//! unexpectedly: amplifier off, DAC at mid-scale, self-check, encoder zeroed, watchdog. The amplifier stays
//! off until the servo is armed, by default by the host: see [`Arming`].

use core::hint::black_box;

use crate::build_error::BuildError;
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::environment::SupportsTiming;
use crate::fault::{Fault, FaultRecord};
use crate::host::{BesideServo, HostResponse, HostTimes, ServoNumbers};
use crate::number::Number;
use crate::output_timing::{OutputMode, OutputTiming};
use crate::period;
use crate::rendering::Rendering;
use crate::reset::ResetCause;
use crate::scene::Scene;
use crate::servo::{PreparedServo, RenderingOptions};
use crate::servo_loop::{Arming, Hardware, Options, Reason, Requests, ServoLoop};
use crate::step::Step;
use crate::text::or_refuse;
use crate::transducers::Transducers;
use crate::tuning::{self, Prepared, Tunable};

/// The hardware before the servo runs.
pub trait Startup: Hardware {
    /// Sets the encoder's counter to zero: the present position is its zero.
    fn zero_encoder(&mut self);
    /// The reading of an absolute encoder, whose zero is its own; `None` if the encoder counts from where
    /// [`zero_encoder`](Self::zero_encoder) was called.
    fn absolute_count(&mut self) -> Option<RawCount> {
        None
    }
    /// Starts the watchdog. From here on only the servo feeds it.
    fn start_watchdog(&mut self);
    /// The words that survived the reset; see [`FaultRecord`].
    fn stored_fault(&mut self) -> [u32; FaultRecord::WORDS];
    /// The cause of the last reset. Call it once: the chip clears it.
    fn reset_cause(&mut self) -> ResetCause;
    /// Timer counts in the servo's period.
    fn period(&self) -> u32;
}

/// Data of a program.
#[derive(Clone, Copy, Debug)]
pub struct Program<E> {
    /// The scene, certified at compile time.
    pub scene: Scene<E>,
    /// Sensor and motor.
    pub transducers: Transducers,
    /// Options of the rendering.
    pub rendering: RenderingOptions,
    /// Options of the servo loop.
    pub options: Options,
}

impl<E: Copy> Program<E> {
    /// Checks that a board can run with these numbers in some number format. The scene's certificate is not
    /// checked here.
    ///
    /// # Errors
    /// The invalid number and its bound.
    pub const fn check(&self) -> Result<(), BuildError> {
        let Scene { timing, torque_limit, latency, .. } = self.scene;
        ok!(period::check(timing.period));
        ok!(self.transducers.check(timing, latency.encoder, torque_limit));
        ok!(BuildError::unless_positive("time of fading", self.rendering.fade));
        BuildError::unless_positive("link's timeout", self.options.link_timeout)
    }

    /// For constants: the same program, or a compile error that names the invalid number.
    #[track_caller]
    pub const fn checked(self) -> Self {
        match self.check() {
            Ok(()) => self,
            Err(error) => error.refuse(),
        }
    }

    /// For constants: a compile error if the scene's host may not stand beside it, which leaves a margin in
    /// N m s/rad, if one is known, with this output.
    #[track_caller]
    pub const fn check_host<N: Number>(&self, margin: Option<f64>, output: OutputTiming)
    where
        E: Rendering<N>,
    {
        let Some(host) = E::HOST else { return };
        let Self { scene, transducers, rendering, .. } = self;
        let cogging = E::AGAINST_COGGING;
        let times_of_host = HostTimes::of(&scene.latency, scene.timing.period);
        // Transducers that no board can have are another error.
        if let Ok(servo) = ServoNumbers::of(scene, cogging, margin, transducers, rendering, output)
        {
            or_refuse!(HostResponse::beside(&host, &servo, times_of_host));
        }
    }
}

/// A board whose servo may run.
#[derive(Clone, Debug)]
pub struct Booted<E: Rendering<N>, N: Number, M> {
    /// The loop that its interrupt runs.
    pub servo_loop: ServoLoop<E, N, M>,
    /// Damping in N m s/rad that the device may lose while this scene runs.
    pub margin: Option<f64>,
    /// The cause of the reset.
    pub reset: ResetCause,
    /// Fault from before the reset.
    pub previous_fault: Option<FaultRecord>,
    /// The reason if the servo arms itself in its first tick.
    pub arms_because: Option<Reason>,
}

/// Everything up to the first tick. The servo stays off until the host arms it, or this is a power-on and the
/// program arms it then.
///
/// # Errors
/// If the self-check fails: the step that failed; [`tuning::explain`] returns the reason. The amplifier is
/// then off and the DAC at mid-scale.
pub fn boot<E, N, M>(
    program: &Program<E>,
    hardware: &mut impl Startup,
    requests: &Requests<'_, PreparedServo<E, N, M>>,
) -> Result<Booted<E, N, M>, Step>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    hardware.amplifier(false);
    hardware.write(DacCode::MID_SCALE);
    // Hidden from the optimiser, which would otherwise certify a constant scene at compile time.
    let scene = black_box(program.scene);
    let Prepared { mut rendering, margin, .. } =
        tuning::prepare(&scene, &[], &program.transducers, &program.rendering)?;
    hardware.zero_encoder();
    if let Some(raw) = hardware.absolute_count() {
        rendering.servo_mut().begin_at(raw);
    }
    let reset = hardware.reset_cause();
    let previous_fault = read_previous_fault(hardware, reset);
    let fault = previous_fault.map(|previous_fault| previous_fault.fault);
    if reset != ResetCause::PowerOn {
        rendering.host_mut().drain();
    }
    let servo_loop = ServoLoop::new(rendering, &program.options, hardware.period(), fault);
    hardware.start_watchdog();
    let arms_because = reason_to_arm(&program.options, reset, previous_fault);
    if arms_because.is_some() {
        requests.arm();
    }
    Ok(Booted { servo_loop, margin, reset, previous_fault, arms_because })
}

/// The reason if the servo may arm itself: only if its program permits it, and only after power-on. Any other
/// reset may come while a hand is on the device.
fn reason_to_arm(
    options: &Options,
    reset: ResetCause,
    previous_fault: Option<FaultRecord>,
) -> Option<Reason> {
    match options.arming {
        Arming::AtPowerOn(reason) if reset == ResetCause::PowerOn && previous_fault.is_none() => {
            Some(reason)
        }
        Arming::AtPowerOn(_) | Arming::WhenAsked => None,
    }
}

/// Reads the fault from before the reset.
fn read_previous_fault(hardware: &mut impl Startup, reset: ResetCause) -> Option<FaultRecord> {
    let by_watchdog = reset == ResetCause::IndependentWatchdog;
    // A panic or a hard fault ends in a watchdog reset: its record is more specific.
    FaultRecord::decode(&hardware.stored_fault()).or(by_watchdog.then_some(FaultRecord {
        fault: Fault::Watchdog,
        tick: 0,
        count: 0,
    }))
}
