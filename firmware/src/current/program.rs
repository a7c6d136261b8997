//! Checks a current loop against its program.

use core::f64::consts::TAU;

use super::current_loop::CurrentLoop;
use super::design::OVER_CURRENT;
use super::drive::DriveError;
use super::regeneration::{Bus, Push};
use crate::latency::Latency;
use crate::magnetic::{Chip, Transfers};
use crate::output_timing::OutputTiming;
use crate::passivity::interval::Interval;
use crate::scene::{Device, Scene};
use crate::text::{Sentence, or_refuse, push};
use crate::transducers::Transducers;

/// Relative tolerance of times that should be equal.
const SAME: f64 = 1e-9;

/// Largest part of an electrical turn that the phase may turn in the age of a reading: 0.1 rad, which reduces the
/// torque by 0.5 per cent.
const LARGEST_TURN: f64 = 1.0 / 64.0;

/// How far the positions of an encoder are off.
#[derive(Clone, Copy)]
struct PositionError {
    counts: f64,
    /// Instants by which they are late.
    late: f64,
}

impl CurrentLoop {
    /// The latency of a scene with this current loop, for a program's output timing.
    ///
    /// # Panics
    /// If a phase is not a whole number of instants; in a constant this is a compile error.
    #[track_caller]
    pub const fn latency(&self, timing: OutputTiming) -> Latency {
        let response = self.response();
        let period = response.delay * response.updates as f64;
        let phase = self.instants_in(timing) as f64 * response.delay;
        let latency = Latency::sampled(response.updates, response.lag, period);
        let output_delay = crate::latency::TimeRange::exactly(phase + response.delay);
        Latency { output_delay, ..latency }
    }

    /// Instants from the beginning of a period to the instant that takes its code over: zero if a code is put
    /// out at the next count.
    ///
    /// # Panics
    /// If a phase is not a whole number of instants; in a constant this is a compile error.
    #[track_caller]
    pub const fn instants_in(&self, timing: OutputTiming) -> u32 {
        let Some(phase) = timing.phase() else { return 0 };
        let response = self.response();
        let instants = (phase / response.delay + 0.5) as u32;
        // The timing is in whole nanoseconds.
        let off = (phase - instants as f64 * response.delay).abs();
        assert!(
            instants > 0 && instants < response.updates as u32 && off <= 1e-9,
            "a phase is a whole number of instants of the current loop, and less than a period"
        );
        instants
    }

    /// For constants: checks that this loop fits a program with this latency, period in s, transducers,
    /// device and output timing.
    ///
    /// # Panics
    /// If it does not fit; in a constant this is a compile error with the numbers.
    #[track_caller]
    pub const fn check_serves(
        &self,
        latency: &Latency,
        period: f64,
        transducers: &Transducers,
        device: &Device,
        timing: OutputTiming,
    ) {
        let own = self.latency(timing);
        let response = self.response();
        // Of which the certificate has the middle in the output delay.
        let age = latency.encoder.age.middle();
        let pairs = [
            ("period", period, response.delay * response.updates as f64),
            ("output delay", latency.output_delay.least - age, own.output_delay.least),
            ("output delay", latency.output_delay.most - age, own.output_delay.most),
            ("actuator lag", latency.actuator_lag.least, own.actuator_lag.least),
            ("actuator lag", latency.actuator_lag.most, own.actuator_lag.most),
            (
                "number of actuator updates",
                latency.actuator_updates as f64,
                response.updates as f64,
            ),
            (
                "full-scale torque",
                transducers.full_scale_torque,
                self.full_scale_current() * self.torque_per_amp(),
            ),
        ];
        let mut i = 0;
        while i < pairs.len() {
            let (name, stated, own) = pairs[i];
            // NaN equals nothing.
            let is_same = (stated - own).abs() <= SAME * own.abs();
            if !is_same {
                let mut t = Sentence::new();
                push!(t,
                    "the program's " {name} " is " {stated} ", and that of its current loop " {own});
                t.refuse();
            }
            i += 1;
        }
        self.check_device(device);
        let (encoder, speed) = (latency.encoder, transducers.largest_speed);
        // A position whose age is another than that before is off by the way between them.
        let late = 2.0 * encoder.deviation_of_age() + encoder.dropped as f64 * period;
        let moved = late * speed * transducers.counts_per_turn / TAU;
        let off = PositionError { counts: encoder.steps() + moved, late: self.late(latency) };
        self.check_acceleration(device, speed, off);
        or_refuse!(self.check_age(latency, period, speed));
    }

    /// The transfers of a chip on the board of this loop, which are at its updates.
    pub const fn transfers(&self, chip: &Chip) -> Transfers {
        let clock = 2.0 * self.timer_counts() as f64 / self.instant();
        Transfers::before_update(chip, self.instant(), clock)
    }

    /// Checks that the phase of the motor is known well enough from the readings of a scene with this latency, at a
    /// period and a largest speed in s and rad/s. A filter makes them older by its time constant.
    ///
    /// # Errors
    /// If it turns too far in their age.
    pub const fn check_age(
        &self,
        latency: &Latency,
        period: f64,
        speed: f64,
    ) -> Result<(), DriveError> {
        let encoder = latency.encoder;
        let age = encoder.age.most + encoder.dropped as f64 * period + latency.sensor_lag.most;
        let frequency = self.winding().pole_pairs() as f64 * speed / TAU;
        let turned = frequency * age;
        if turned <= LARGEST_TURN {
            return Ok(());
        }
        let largest = LARGEST_TURN / frequency;
        Err(DriveError::Age { age, turned, most: LARGEST_TURN, largest })
    }

    /// For constants: checks that the supply of this loop stays below its fault level after a push into a
    /// scene, with these transducers and this injected damping in N m s/rad (theory, section 17).
    ///
    /// # Panics
    /// If it does not; in a constant this is a compile error with the numbers and the remedies.
    #[track_caller]
    pub const fn check_regeneration(
        &self,
        scene: &Scene,
        transducers: &Transducers,
        injection: Option<f64>,
    ) {
        let Some(bus) = self.bus() else { return };
        if let Err(error) = bus.check(scene, &self.push(scene, transducers, injection)) {
            error.refuse()
        }
    }

    /// The capacitance at the bridge; `None` if its supply takes energy back.
    pub const fn bus(&self) -> Option<&Bus> {
        self.bus.as_ref()
    }

    /// The largest push into a scene.
    pub const fn push(
        &self,
        scene: &Scene,
        transducers: &Transducers,
        injection: Option<f64>,
    ) -> Push {
        Push::of(scene, transducers, injection, self.winding_energy())
    }

    /// Largest energy in J that a push may return besides that of the winding, rounded down; `None` if the
    /// supply takes energy back.
    pub const fn returned(&self) -> Option<f64> {
        match self.bus {
            Some(bus) => {
                let winding = Interval::exact(self.winding_energy());
                Some(Interval::exact(bus.room()).sub(winding).lo())
            }
            None => None,
        }
    }

    /// Energy in J of the winding at the current at which the bridge is switched off, rounded up.
    const fn winding_energy(&self) -> f64 {
        let current = Interval::decimal(self.full_scale_current() * OVER_CURRENT);
        let one = Interval::decimal(self.torque_source().inductance).half();
        // Of three phases the squares of the currents add up to 3/2 of the amplitude's.
        let share = Interval::exact(if self.is_brushless() { 1.5 } else { 1.0 });
        one.mul(share).mul(current).mul(current).hi()
    }

    /// Checks that the device's damping covers its passivity and the loss by motion through this loop.
    #[track_caller]
    const fn check_device(&self, device: &Device) {
        let (passivity, loss) = (device.passivity(), self.motion_loss());
        // Rounded up, and written so that NaN is refused.
        let needed = Interval::exact(passivity).add(Interval::exact(loss)).hi();
        if needed <= device.damping {
            return;
        }
        let mut t = Sentence::new();
        push!(t,
            "the device's passivity of " {passivity} " N m s/rad, and the " {loss} " that motion takes through the \
             current loop, are more than the device's damping of " {device.damping});
        let most = device.damping - loss;
        if most > 0.0 {
            push!(t, ": declare a passivity of at most " {most});
        } else {
            t.push(": take a motor with more inductance, or with a smaller torque constant");
        }
        t.refuse()
    }

    /// The largest acceleration of the handle in rad/s^2 that supervision never takes for a fault (equation 64), with a
    /// quadrature encoder.
    pub const fn largest_acceleration(&self) -> f64 {
        self.largest_acceleration_with(PositionError { counts: 1.0, late: 0.0 })
    }

    /// The instants by which readings are later than the feedback, at most (theory, section 15.10).
    const fn late(&self, latency: &Latency) -> f64 {
        let instant = self.instant();
        (latency.encoder.age.most / instant - 2.0).max(0.0) + latency.sensor_lag.most / instant
    }

    /// The same with an encoder whose positions are so far off.
    const fn largest_acceleration_with(&self, off: PositionError) -> f64 {
        let (limits, source) = (&self.limits, self.torque_source());
        // By each of the two speeds that are compared.
        let amps = 2.0 * limits.smoothing as f64 * limits.amps_of_motion as f64 * off.counts;
        let deviation = source.deviation_by(self.torque_per_amp(), source.instant);
        let delay = 1.0 / source.feedback - 1.0 + off.late;
        (limits.unexplained as f64 - amps) / (2.0 * delay * deviation)
    }

    /// Checks that the device accelerates no more by motor and damping than supervision bears, with the errors of the
    /// encoder's positions.
    #[track_caller]
    const fn check_acceleration(&self, device: &Device, speed: f64, off: PositionError) {
        let torque = OVER_CURRENT * self.full_scale_current() * self.torque_per_amp()
            + device.damping * speed;
        let largest = self.largest_acceleration_with(off);
        let acceleration = torque / device.inertia;
        if acceleration <= largest {
            return;
        }
        let mut t = Sentence::new();
        push!(t,
            "motor and damping accelerate the device by up to " {acceleration} " rad/s^2, and with more than "
            {largest} " its back-EMF looks like a broken wire: ");
        if largest > 0.0 {
            push!(t,
                "take an inertia of at least " {torque / largest} " kg m^2, or less full-scale torque, or a smaller \
                 torque constant");
        } else {
            t.push("take an encoder with more counts per turn");
        }
        t.refuse()
    }
}
