//! The response of the motor to a host's torque, and what it costs, as numbers for a [`Tank`](super::Tank).
//!
//! A *command* is the host's torque of one tick. It begins to act some whole ticks and a part of a tick
//! later, and the amplifier follows with a lag. With `f` the motor's torque at the moment at which a command
//! `h` takes over, `a` what the lag leaves of a step over a period, and all later commands zero, the energy
//! `integral F^2` that is still to come changes by
//!
//! ```text
//! T h ( (1 - lambda) h + lambda f ),    lambda = tau (1 - a) / T          (a continuous lag),
//! ```
//!
//! because `integral F^2 = h integral F - tau (f'^2 - f^2) / 2` over a period. A current loop that is updated
//! several times in a period has another `lambda`, with the same derivation. Errors of the model cost in the
//! same form, bilinear in `h` and in `f` or the last command:
//!
//! - a lag known to within `r`: `r^2 / (4 delta2)` times `integral F'^2`, which changes by
//!   `(1 - a) h (h - f) / tau`;
//! - instants that deviate by up to `j`: `j / (4 delta3)` times the squared steps of the commands, whose sum
//!   up to a later zero changes by `2 h (h - before)`.
//!
//! The parts of the share are chosen to make the coefficient of `h^2` least.

use super::stream::LONGEST_RAMP;
use super::{HostError, HostTimes, HostTorque, ServoNumbers, TankNumbers};
use crate::dac::DacCode;
use crate::latency::Latency;
use crate::output_timing::{OutputTiming, READ_WITHIN};
use crate::passivity::interval::Interval;
use crate::passivity::lagged::Decay;
use crate::scene::Timing;

/// How the servo reads positions and puts torques out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Period in s.
    pub period: f64,
    /// Longest time in s between two updates, if updates may be missed.
    pub worst_period: Option<f64>,
    /// Width of a count in rad.
    pub count: f64,
    /// Torque in N m of a code of the DAC; commands have whole codes.
    pub code: f64,
    /// Whole ticks from a count to the output of its torque, in addition to the latency: 1 if it is latched.
    pub ticks: usize,
    /// The most in s by which a count is read late, in addition to the latency's jitter.
    pub reading: f64,
}

impl Sampling {
    /// Each torque is put out at the instant of its count, apart from the latency.
    pub const fn simultaneous(timing: &Timing, count: f64, code: f64) -> Self {
        let Timing { period, worst_period } = *timing;
        Self { period, worst_period, count, code, ticks: 0, reading: 0.0 }
    }
}

/// The numbers of a tank in SI units, before rounding to its whole numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostResponse {
    /// Period in s.
    pub period: f64,
    /// Width of a count in rad.
    pub count: f64,
    /// Torque in N m of a code of the DAC.
    pub code: f64,
    /// Whole ticks from a command to the tick in which it acts.
    pub whole: usize,
    /// Whether a command only acts in one tick, without errors of the model.
    pub is_plain: bool,
    /// Cost of the square of a command, in periods over four times the main share.
    pub price: f64,
    /// Torque in N m at a speed of one rad per period that is worth as much: twice the main share over the
    /// period.
    pub speed: f64,
    /// What the lag leaves of a step over a period.
    pub decay: f64,
    /// Half the coefficients of a command times the torque at its begin, and times the command before.
    pub pull: [f64; 2],
    /// Coefficients of the squares of these two in the energy still to come.
    pub tail: [f64; 2],
    /// Weights of a command and of the torque at its begin in the mean torque of the tick in which it begins.
    pub first: [f64; 2],
    /// The same for the tick after that.
    pub second: [f64; 2],
    /// Whether a command acts in two ticks.
    pub is_late: bool,
    /// The energy of a command in the second of these: the coefficients of its square, of its product with the
    /// torque at its begin less it, and of the square of that.
    pub unfinished: [f64; 3],
    /// Coefficient of the squared steps of the mean torque, in place of a memory of the last command.
    pub step_price: f64,
    /// Energy in J that counts can cost once all later commands are zero.
    pub reserve: f64,
}

/// A part of the lag's range more than stated, which covers the rounding of the modelled torque.
const WIDER: f64 = 1.0 + 1.0 / 1024.0;

/// Largest deviation of counts in periods: from a quarter on nothing is left of the share.
const MOST_DEVIATION: f64 = 0.2;

impl HostResponse {
    /// The response of a motor with this latency.
    ///
    /// # Errors
    /// If a time of the scene is not covered, or the energy is less than counts can cost.
    pub const fn of(
        host: &HostTorque,
        latency: &Latency,
        sampling: &Sampling,
    ) -> Result<Self, HostError> {
        ok!(host.check());
        ok!(covered(latency, sampling));
        let period = sampling.period;
        let (least, most) = (2.0 * period, 2.0 * LONGEST_RAMP as f64 * period);
        if host.timeout < least || host.timeout > most {
            return Err(HostError::Timeout { timeout: host.timeout, least, most });
        }
        let delay = in_periods(latency, period);
        let whole = delay.midpoint() as usize;
        let part = delay.sub(Interval::exact(whole as f64)).midpoint();
        let lag = decay(latency, period, part);
        let [held, unspread] = [lag.held.midpoint(), lag.unspread.midpoint()];
        let (a, rest) = (lag.tick.midpoint(), lag.rest.midpoint());
        let lambda = 2.0 * unspread * (1.0 - a);

        let tau = lag.tau.midpoint();
        let range = latency.actuator_lag.most - latency.actuator_lag.least;
        let spread = 0.5 * WIDER * range / period;
        let of_lag = if spread == 0.0 { 0.0 } else { spread * spread * (1.0 - a) / tau };
        let (deviation, of_counts) = deviations(latency, sampling);
        if of_counts > MOST_DEVIATION {
            return Err(HostError::NotCovered {
                time: "a jitter of more than a fifth of the period",
            });
        }
        // Cauchy-Schwarz: the least sum of costs over shares that add up to one.
        let own = 1.0 - lambda;
        let lag_share = root(of_lag / own);
        let step_share = root(2.0 * deviation / own);
        let of_lag = if of_lag == 0.0 { 0.0 } else { of_lag / lag_share };
        let of_steps = if deviation == 0.0 { 0.0 } else { deviation / step_share };
        // Counts that deviate: a step d is off by e, and d^2 >= (1 - eta) d'^2 - e^2/eta; the second part
        // takes 4 j/(eta T) of the main share.
        let eta = 2.0 * root(of_counts);
        let main = host.damping / ((1.0 + eta) / (1.0 - eta) + lag_share + step_share);

        let squared = if of_lag == 0.0 { 0.0 } else { 0.5 * of_lag / (1.0 - a) };
        let last = if of_lag == 0.0 { 0.0 } else { of_lag };
        let over = 1.0 - part;
        let square = held - unspread;
        let square_left = if MAY_BE_OLD && latency.is_between_updates() {
            lag.square_left(latency.actuator_updates).midpoint()
        } else {
            square * rest * rest
        };
        let first = [over - held * (1.0 - rest), held * (1.0 - rest)];
        let total = [1.0 - held * (1.0 - a), held * (1.0 - a)];
        let response = Self {
            period,
            count: sampling.count,
            code: sampling.code,
            whole: whole + sampling.ticks,
            is_plain: part == 0.0 && tau == 0.0 && deviation == 0.0,
            price: own + last + 2.0 * of_steps,
            speed: 2.0 * main / period,
            decay: a,
            pull: [0.5 * (lambda - last), -of_steps],
            tail: [held - unspread + squared, of_steps],
            first,
            second: [total[0] - first[0], total[1] - first[1]],
            is_late: part > 0.0,
            unfinished: [part, 2.0 * held * (rest - a), square_left - square * a * a],
            step_price: 0.0,
            reserve: TankNumbers::of_counts(sampling),
        };
        ok!(TankNumbers::of(host, &response));
        Ok(response)
    }

    /// The response beside a servo whose commands act at these times.
    ///
    /// # Errors
    /// If a number has no meaning, or there is no proof for it.
    pub const fn beside(
        host: &HostTorque,
        servo: &ServoNumbers<'_>,
        times: HostTimes,
    ) -> Result<Self, HostError> {
        ok!(host.check());
        ok!(host.check_share(servo.margin));
        ok!(host.check_range(servo.torque_limit, servo.full_scale));
        if servo.stores {
            return Err(HostError::Stores);
        }
        let Timing { period, worst_period } = servo.timing;
        let (ticks, reading) = match servo.output {
            OutputTiming::Simultaneous => (0, 0.0),
            OutputTiming::Latched => (1, READ_WITHIN),
            OutputTiming::AtPhase(_) => (0, READ_WITHIN),
        };
        let count = servo.radians_per_count;
        let code = servo.full_scale / DacCode::CODES_TO_FULL_SCALE as f64;
        let sampling = Sampling { period, worst_period, count, code, ticks, reading };
        let mut response = ok!(Self::of(host, servo.latency, &sampling));
        if times.is_plain {
            response = ok!(response.without_memory(host));
        }
        if response.whole != times.ticks || response.is_plain != times.is_plain {
            let time = "an output at another time than that of the program's board";
            return Err(HostError::NotCovered { time });
        }
        Ok(response)
    }

    /// For a motor without a lag: the steps of the torque are debited when they reach the motor, and not
    /// with the command. Their cost cannot be known to be payable then, so the reserve has it: of the steps
    /// under way and of those to zero, each up to twice the largest torque that the energy pays.
    ///
    /// # Errors
    /// If the energy is less than this reserve.
    pub const fn without_memory(self, host: &HostTorque) -> Result<Self, HostError> {
        let of_steps = self.tail[1];
        let has_lag = self.is_late || self.tail[0] != 0.0 || self.pull[0] != 0.0;
        if of_steps == 0.0 || has_lag {
            return Ok(self);
        }
        // Energy in J of 1 N^2 m^2 in a tick.
        let joules = 0.5 / self.speed;
        let square = (host.torque * host.torque).min(host.energy / joules);
        let steps = 4.0 * (self.whole + 1) as f64 + 1.0;
        let reserve = self.reserve + steps * of_steps * square * joules;
        let (pull, tail) = ([0.0; 2], [0.0; 2]);
        let plain = Self { is_plain: true, price: 1.0, pull, tail, step_price: of_steps, ..self };
        let response = Self { reserve, ..plain };
        ok!(TankNumbers::of(host, &response));
        Ok(response)
    }
}

/// Whether an encoder may answer after the instant of its position: a program without a chip has no code for it.
const MAY_BE_OLD: bool = cfg!(any(not(target_os = "none"), feature = "magnetic"));

const fn covered(latency: &Latency, sampling: &Sampling) -> Result<(), HostError> {
    let time = if or!(sampling.worst_period, sampling.period) != sampling.period {
        "updates that may be missed"
    } else if !latency.sensor_lag.is_zero() || latency.encoder.window > 0.0 {
        "a filter of the encoder"
    } else if latency.encoder.linearity > 0.0 || latency.encoder.steps() > 1.0 {
        "an encoder with nonlinearity, noise or hysteresis"
    } else if latency.encoder.dropped > 0 {
        "readings that may be dropped"
    } else if !latency.actuator_response.is_zero() {
        "an amplifier whose step response is only known to rise between two times"
    } else if !MAY_BE_OLD && latency.is_between_updates() {
        "an amplifier that is updated several times in a period beside readings with an age"
    } else if latency.actuator_updates > 0 && latency.delay_in_updates(sampling.period).is_none() {
        "an output delay that is no whole number of the amplifier's updates"
    } else if latency.actuator_updates > 0 && !latency.actuator_lag.is_exact() {
        "an amplifier that is updated several times in a period and whose lag is known in a range only"
    } else {
        return Ok(());
    };
    Err(HostError::NotCovered { time })
}

/// The output delay in periods.
const fn in_periods(latency: &Latency, period: f64) -> Interval {
    match latency.actuator_updates {
        0 => Interval::exact(latency.output_delay.middle() / period),
        _ => or!(latency.delay_in_updates(period), Interval::ZERO),
    }
}

const fn decay(latency: &Latency, period: f64, part: f64) -> Decay {
    let tau = Interval::exact(latency.actuator_lag.middle() / period);
    let over = Interval::exact(1.0 - part);
    match latency.actuator_updates {
        0 => Decay::of(tau, over),
        updates => Decay::sampled(tau, over, updates, MAY_BE_OLD && latency.is_between_updates()),
    }
}

/// The most in periods by which torques deviate from their times, and counts from theirs.
///
/// A count that deviates changes the work of a step of the mean torque as a torque that deviates does, and the
/// steps of the means are no larger than those of the commands in the sum of their squares. If both deviate,
/// the roots of their energies add.
const fn deviations(latency: &Latency, sampling: &Sampling) -> (f64, f64) {
    let range = 0.5 * (latency.output_delay.most - latency.output_delay.least);
    // With one jitter alone it is of the counts or of the torques, not of both. An age that varies is a count's.
    let reading = latency.deviation_of_counts().max(sampling.reading);
    let counts = reading + latency.encoder.deviation_of_age();
    let torques = range + if latency.jitters_twice() { latency.output_jitter } else { 0.0 };
    let sum = torques + counts + 2.0 * root(torques * counts);
    (sum / sampling.period, counts / sampling.period)
}

/// The root of a number that is not negative.
const fn root(square: f64) -> f64 {
    if square > 0.0 { Interval::exact(square).sqrt().midpoint() } else { 0.0 }
}
