//! The tank: the energy that a host's torque may still take, tick by tick, in whole numbers.
//!
//! With `d` the step of the position in a tick, `m` the mean of the host's torque at the motor over it, `rho`
//! its ripple and `delta` the host's share of damping, a tick of any passive hand leaves
//!
//! ```text
//! integral (delta v^2 - F v)  >=  delta d^2/T - m d - rho/(4 delta)
//!                             =   (delta/T) (d - m T/(2 delta))^2 - (1/(4 delta)) integral F^2 .
//! ```
//!
//! The first term is known one tick later and is never negative; the second is known as soon as the torque is.
//! So the tank pays for `integral F^2` of a command when it is given, up to the end of its response with all
//! later commands zero, and takes the first term back after each tick, with the supply's power. A command is
//! allowed if the tank can pay for it. Zero costs nothing, so it is always allowed.
//!
//! # Whole numbers
//!
//! Positions are counts, and commands whole codes of the DAC, so that the booked torque is that of the
//! codes. A torque is a number of *steps*, `2^-14` codes, and an energy has the unit of a squared step over
//! a period, divided by four times the share. With `S` steps for a count, the first term is the square of `y =
//! S d - m`, and a command without memory costs its square: nothing is rounded but `S`, the cap and the power,
//! once and down.
//!
//! A count shows the position to half a count. With `r` between -1/2 and 1/2 where the position is within its
//! count, the square is one of `y + S (r' - r)`, which is at least `y^2 + 2 S y (r' - r)`. Summed by parts, the
//! errors of all ticks are at most the sum of `S |y - y_before|`, and `S |y|` at the end. As `|x|` is twice the
//! positive part of `x` less `x`, and the sum of all `y - y_before` is the last `y`, both are at most the sum of
//! `2 S` times the positive parts of `y - y_before`, which the tank debits, and `2 S |y|` at the end, which the
//! reserve has. For that, `y` may be nearer to zero than it is, since for `c` between zero and `y` the square is
//! at least `c^2 + 2 c (y - c) + 2 S c (r' - r)`. So it is clamped to 2^25 steps, and the reserve is `2 S` times
//! that. A product that wraps only does so above 2^31 - 2^25 steps, whose square is above that of any clamped
//! number with any error of a count.
//!
//! An amplifier with a lag makes torques that are no whole numbers. A coefficient is off by at most 2^-25, a
//! torque is below 2^25 steps, and results are rounded: so the modelled torque is off by 3 steps in each tick,
//! and its mean by 6 more. Together that is a torque of at most `9/(1 - a)` steps beside the modelled one, with
//! the lag's decay `a`. A part of 2^-10 of the share pays for it, and the power is less by what that part costs.
//! The modelled torque is rounded to zero, so that the price of its tail is not less than what was paid, and
//! costs are rounded up.

use core::hint::cold_path;

use super::{HostError, HostResponse, HostTorque, Sampling};
use crate::environment::DelayLine;

/// Binary digits of a code of the DAC in steps of a torque.
pub(super) const STEP_BITS: u32 = 14;
/// The most steps whose square a tick gives back.
const LARGEST: i32 = 1 << 25;
/// The most codes of a torque.
const MOST_CODES: f64 = 2047.0;
/// Steps for a count, at least and at most.
const SPEEDS: [f64; 2] = [16.0, (1 << 27) as f64];
/// The unit of the cap.
const CAP_UNIT: f64 = (1_u64 << 32) as f64;
/// The most that a full tank has in that unit.
const MOST_CAP: f64 = (1 << 29) as f64;
/// Below the roundings of a few sums and products.
const LESS: f64 = 1.0 - 1.0 / (1_u64 << 48) as f64;
/// The part of the share that pays for the rounding of a modelled torque.
const ROUNDED: f64 = 1.0 / 1024.0;

/// The whole numbers of a tank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TankNumbers {
    /// Steps for a count.
    speed: i32,
    /// Level per tick.
    power: i64,
    /// The largest level in units of 2^32.
    cap: i32,
    /// The reserve as a level.
    owed: i64,
    /// Level per squared change of the torque in units of 2^-32, for commands without a memory of the last.
    step_price: i32,
    /// The largest command in codes.
    largest: i32,
    /// N m of a code.
    code: f32,
    /// J for a level of 1.
    joules: f64,
}

/// The coefficients of a torque that is not over with its tick; those of costs are rounded up.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Amplifier {
    price: i32,
    decay: i32,
    pull: [i32; 2],
    tail: [i32; 2],
    first: [i32; 2],
    second: [i32; 2],
    is_late: bool,
    over: [i32; 3],
}

impl Amplifier {
    const NONE: Self = Self {
        price: 0,
        decay: 0,
        pull: [0; 2],
        tail: [0; 2],
        first: [0; 2],
        second: [0; 2],
        is_late: false,
        over: [0; 3],
    };
    /// Binary digits after the point.
    const BITS: u32 = 24;
    const LARGEST: f64 = 127.0;

    const fn of(response: &HostResponse) -> Result<Self, HostError> {
        let HostResponse { price, decay, pull, tail, first, second, unfinished, .. } = *response;
        // Written so that NaN is refused.
        if !(price < Self::LARGEST && tail[0] < Self::LARGEST && tail[1] < Self::LARGEST) {
            return Err(HostError::NotCovered { time: "a lag of more than a hundred periods" });
        }
        Ok(Self {
            price: Self::above(price),
            decay: Self::near(decay),
            pull: [Self::near(pull[0]), Self::near(pull[1])],
            tail: [Self::above(tail[0]), Self::above(tail[1])],
            first: [Self::near(first[0]), Self::near(first[1])],
            second: [Self::near(second[0]), Self::near(second[1])],
            is_late: response.is_late,
            over: [
                Self::above(unfinished[0]),
                Self::near(unfinished[1]),
                Self::above(unfinished[2]),
            ],
        })
    }

    #[cfg_attr(target_os = "none", inline(never))]
    const fn near(value: f64) -> i32 {
        let scaled = value * (1 << Self::BITS) as f64;
        (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i32
    }

    #[cfg_attr(target_os = "none", inline(never))]
    const fn above(value: f64) -> i32 {
        (value * (1 << Self::BITS) as f64) as i32 + 1
    }
}

impl TankNumbers {
    const NOTHING: Self = Self {
        speed: 0,
        power: 0,
        cap: 0,
        owed: 0,
        step_price: 0,
        largest: 0,
        code: 1.0,
        joules: 0.0,
    };

    /// Energy in J of the reserve for counts.
    pub(super) const fn of_counts(sampling: &Sampling) -> f64 {
        sampling.count * sampling.code * (LARGEST >> STEP_BITS) as f64
    }

    /// Of a budget and the response of the motor.
    ///
    /// # Errors
    /// If a number of the budget is too small or too large for a tank.
    pub const fn of(host: &HostTorque, response: &HostResponse) -> Result<Self, HostError> {
        let HostTorque { energy, power, damping, torque, .. } = *host;
        let HostResponse { code, count, reserve, is_plain, .. } = *response;
        let codes = torque / code / LESS;
        if codes < 1.0 {
            return Err(HostError::Torque { torque, least: code });
        }
        ok!(Amplifier::of(response));
        let step = code / (1 << STEP_BITS) as f64;
        let share = if is_plain { LESS } else { LESS - ROUNDED };
        let speed = response.speed * count / step * share;
        let [least, most] = SPEEDS;
        // Written so that NaN is refused.
        if !(speed >= least && speed < most) {
            let [least, most] = [damping * (least / speed), damping * (most / speed)];
            return Err(HostError::Steps { damping, least, most });
        }
        let speed = speed as i32;
        let joules = 0.5 * step * count / speed as f64 / LESS;
        let cap = (energy - reserve) / joules / CAP_UNIT;
        if cap < 1.0 {
            return Err(HostError::Energy { energy, least: reserve + CAP_UNIT * joules });
        }
        let most = MOST_CAP * CAP_UNIT * joules;
        if energy > most {
            return Err(HostError::MostEnergy { energy, most });
        }
        let step_price = response.step_price * CAP_UNIT;
        if step_price > (i32::MAX / 2) as f64 {
            return Err(HostError::NotCovered {
                time: "a jitter of more than an eighth of a period",
            });
        }
        // The casts round down and saturate.
        let power = (power * response.period / joules).min((1_u64 << 62) as f64) as i64;
        Ok(Self {
            speed,
            power: power - if is_plain { 0 } else { rounding(response.decay) },
            cap: cap as i32,
            owed: (reserve / joules / LESS) as i64 + 1,
            // Of a change of whole codes, the product with this is rounded down to no less than the price.
            step_price: if step_price > 0.0 { step_price as i32 + (1 << 18) + 1 } else { 0 },
            largest: codes.min(MOST_CODES) as i32,
            code: code as f32,
            joules,
        })
    }
}

/// The level that a tick takes for the rounding of the torque behind a lag with this decay.
const fn rounding(decay: f64) -> i64 {
    let off = 9.0 / (1.0 - decay);
    (2.0 * off * off / ROUNDED) as i64 + 1
}

/// The tank of a host beside a servo.
///
/// `D` has the length of [`HostResponse::whole`]. `LAGS` is 0 if the [response](HostResponse::is_plain) is plain,
/// so that a tick has no code for a lag, and 1 if it is not.
#[derive(Clone, Debug)]
pub struct Tank<D, const LAGS: usize> {
    numbers: TankNumbers,
    /// The level below the cap.
    missing: i64,
    /// Level per tick and steps for a count in the present tick: zero while motion gives nothing back.
    power: i64,
    speed: i32,
    /// The mean torque of the present tick.
    mean: i32,
    /// The last tick gave the square of this back.
    before: i32,
    means: D,
    lagging: [Lagging<D>; LAGS],
}

/// The torque of an amplifier with a lag.
#[derive(Clone, Debug)]
struct Lagging<D> {
    amplifier: Amplifier,
    /// The torque at the motor where the last command ends.
    torque: i32,
    /// The last command.
    before: i32,
    /// Its mean in the tick in which it ends.
    rest: i32,
    /// The energies of the commands that have not begun.
    energies: D,
    /// The rest of the energy of the command that began in the last tick.
    unfinished: i64,
    /// The energies that commands leave for the tick after the one in which they begin.
    unfinished_later: D,
}

impl<D: DelayLine<i64>, const LAGS: usize> Tank<D, LAGS> {
    /// A full tank at rest.
    ///
    /// # Errors
    /// If a number of the budget is too small or too large.
    pub fn new(host: &HostTorque, response: &HostResponse) -> Result<Self, HostError> {
        let (numbers, amplifier) = (TankNumbers::of(host, response)?, Amplifier::of(response)?);
        let line = D::at_rest(response.whole).map_err(|_| HostError::NotCovered {
            time: "an output delay of more than eight periods",
        })?;
        let TankNumbers { speed, power, .. } = numbers;
        let lagging = core::array::from_fn(|_| Lagging::at_rest(amplifier, &line));
        Ok(Self { numbers, speed, power, missing: 0, before: 0, mean: 0, means: line, lagging })
    }

    /// An empty tank that never has any energy, with this line at rest.
    pub(super) fn empty(line: D) -> Self {
        let lagging = core::array::from_fn(|_| Lagging::at_rest(Amplifier::NONE, &line));
        let numbers = TankNumbers::NOTHING;
        Self { numbers, speed: 0, power: 0, missing: 0, before: 0, mean: 0, means: line, lagging }
    }

    /// Ends a tick in which the position has moved by so many counts.
    #[inline(always)]
    pub fn book(&mut self, moved: i32) {
        self.missing = self.booked(moved);
    }

    /// The same without its level, which is returned.
    #[inline(always)]
    pub(super) fn booked(&mut self, moved: i32) -> i64 {
        let y = self.mean.wrapping_sub(moved.wrapping_mul(self.speed)).clamp(-LARGEST, LARGEST - 1);
        // Both are known to be positive.
        let rise = u64::from(twice_positive(y.wrapping_sub(self.before)));
        let lost = rise.wrapping_mul(u64::from(self.speed.cast_unsigned())).cast_signed();
        let earned = product(y, y).wrapping_add(self.power);
        let missing = self.missing.wrapping_sub(earned).wrapping_add(lost);
        let to_come = self.to_come();
        self.before = y;
        clamped(missing.wrapping_sub(to_come)).wrapping_add(to_come)
    }

    /// [Gives](Self::give) what the level of a [booked](Self::booked) tick pays of a wanted torque in codes, with a
    /// single store of the level. Returns the rest.
    #[inline(always)]
    pub(super) fn refused(&mut self, missing: i64, wanted: i32) -> i32 {
        let cost = self.cost(wanted);
        let paid = missing.wrapping_add(cost);
        if !self.is_in_reach(paid) {
            cold_path();
            return self.refuse(paid, wanted);
        }
        self.give_at(wanted, cost, paid);
        0
    }

    #[cold]
    #[inline(never)]
    fn refuse(&mut self, paid: i64, wanted: i32) -> i32 {
        self.missing = paid.wrapping_sub(self.cost(wanted));
        let (given, cost) = self.affordable(wanted);
        self.give_at(given, cost, self.missing.wrapping_add(cost));
        wanted - given
    }

    /// The energy of the commands given so far that is still to come.
    #[inline(always)]
    fn to_come(&self) -> i64 {
        let squares = || self.means.waiting().iter().map(|&mean| product(mean as i32, mean as i32));
        self.lagging.first().map_or_else(|| squares().sum(), Lagging::to_come)
    }

    /// The torque in codes that the motor gets of a wanted torque in [range](Self::in_range).
    #[inline(always)]
    pub fn allowed(&mut self, wanted: i32) -> i32 {
        if self.pays(self.cost(wanted)) { wanted } else { self.affordable(wanted).0 }
    }

    /// Whether the level pays for a command that costs this much.
    #[inline(always)]
    fn pays(&self, cost: i64) -> bool {
        self.is_in_reach(self.missing.wrapping_add(cost))
    }

    #[inline(always)]
    const fn is_in_reach(&self, missing: i64) -> bool {
        ((missing >> 32) as i32) < self.numbers.cap
    }

    /// What a command in codes costs until the end of its response.
    #[inline(always)]
    fn cost(&self, command: i32) -> i64 {
        let command = command << STEP_BITS;
        let lagging = self.lagging.first();
        lagging.map_or_else(|| product(command, command), |lagging| lagging.cost(command))
    }

    /// The wanted torque in N m as codes within the host's largest; zero if it is no finite number.
    pub fn in_range(&self, wanted: f32) -> i32 {
        self.codes(wanted).map_or(0, |[within, _]| within)
    }

    /// The same, and the whole codes beyond the largest; `None` if it is no finite number. A torque passes here once,
    /// where it arrives, and not in each tick.
    pub(super) fn codes(&self, wanted: f32) -> Option<[i32; 2]> {
        let codes = wanted / self.numbers.code;
        let within = |codes: i32| codes.clamp(-self.numbers.largest, self.numbers.largest);
        // The casts saturate, and the second rounds towards zero.
        let [nearest, whole] = [codes + 0.5_f32.copysign(codes), codes].map(|codes| codes as i32);
        wanted.is_finite().then(|| [within(nearest), whole - within(whole)])
    }

    /// The largest command in codes.
    pub(super) const fn largest(&self) -> i32 {
        self.numbers.largest
    }

    /// The largest command of the same sign that the level pays, for a command that it does not pay, and its cost.
    ///
    /// A command of `x` steps costs `x (p x + 2 b)`, or less by up to `x`, and this has a root where it takes all
    /// of the room. Where there is room, floating point and the rounding of costs move the root by `2^-9` of a code
    /// and `1/p` steps, together less than a code. The level pays the code below the root, or the next: that is
    /// decided in whole numbers. So the command is never more than the level pays, and at most a code less.
    #[cold]
    #[inline(never)]
    fn affordable(&mut self, wanted: i32) -> (i32, i64) {
        const NEAR: f32 = 1.0 / 512.0;
        cold_path();
        // However a hand has moved, it did not get more than the energy, which is two reserves below any level.
        let TankNumbers { owed, .. } = self.numbers;
        self.missing = self.missing.min(self.cap() + 2 * owed);
        let (sign, room) = (wanted.signum(), rounded(self.cap() - 1 - self.missing));
        let lagging = self.lagging.first();
        let [p, b] = lagging.map_or([1.0, 0.0], |lagging| lagging.weights(sign));
        let Some(root) = root(b * b + p * room) else { return (0, 0) };
        let steps = if b > 0.0 { room / (b + root) } else { (root - b) / p };
        // The cast saturates.
        let codes = (steps / (1 << STEP_BITS) as f32 + NEAR) as i32;
        let most = codes.min(wanted.abs() - 1);
        let priced = |codes| (sign * codes, self.cost(sign * codes));
        let mut candidates = [most, most - 1].into_iter().filter(|codes| *codes > 0).map(priced);
        candidates.find(|&(_, cost)| self.pays(cost)).unwrap_or((0, 0))
    }

    /// Gives this command in codes to the motor. It must be [allowed](Self::allowed), or between zero and that,
    /// and the tick is [booked](Self::book).
    #[inline(always)]
    pub fn give(&mut self, command: i32) {
        let cost = self.cost(command);
        self.give_at(command, cost, self.missing.wrapping_add(cost));
    }

    /// The same with its cost and the level after it.
    #[inline(always)]
    fn give_at(&mut self, command: i32, cost: i64, paid: i64) {
        let steps = command << STEP_BITS;
        let lagging = self.lagging.first_mut();
        let mean = lagging.map_or(steps, |lagging| lagging.give(steps, cost));
        let begins = self.means.due().map_or(mean, |mean| mean as i32);
        let mut missing = paid;
        if LAGS == 0 {
            // The reserve covers this, so that the level may become negative.
            let change = begins.wrapping_sub(self.mean);
            // Most torques are held.
            if change != 0 {
                let price = (product(change, self.numbers.step_price) >> 32) as i32;
                missing = missing.wrapping_add(product(change, price));
                self.mean = begins;
            }
        } else {
            self.mean = begins;
        }
        self.missing = missing;
        self.means.push(mean.into());
    }

    /// Whether the motor makes no torque, and no command is under way.
    pub(super) fn is_over(&self) -> bool {
        self.mean == 0 && self.to_come() == 0
    }

    /// Takes the energy of another tank that [is over](Self::is_over), at most that of this one. A torque under
    /// way was paid at the price of the other's share.
    pub(super) fn take_over(&mut self, last: &Self) {
        // The last step of the position is known to the width of a count.
        let unknown = product(2 * magnitude(last.before), last.speed);
        let energy = last.level() + last.numbers.owed - unknown;
        let scaled = energy as f64 * (last.numbers.joules / self.numbers.joules);
        // Above the rounding of these and of the reserves.
        let level = (scaled - scaled.abs() * (1.0 - LESS) - 4.0) as i64 - self.numbers.owed;
        self.missing = (self.cap() - level).clamp(0, self.cap() + 2 * self.numbers.owed);
        self.before = 0;
        self.give_back(true);
    }

    /// Whether the level may rise from now on.
    pub(super) fn give_back(&mut self, may_rise: bool) {
        if may_rise {
            (self.speed, self.power) = (self.numbers.speed, self.numbers.power);
        } else {
            let lost = product(2 * magnitude(self.before), self.speed);
            self.missing = self.missing.wrapping_add(lost);
            (self.speed, self.power, self.before) = (0, 0, 0);
        }
    }

    /// No energy is left, and none for errors of counts.
    pub(super) fn drain(&mut self) {
        self.missing = self.missing.max(self.cap() + self.numbers.owed);
    }

    /// The motor makes no torque from now on. What was paid for torques under way is lost; if they may have
    /// been more than that, so is the level.
    pub(super) fn forget(&mut self, at_rest: D, is_emptied: bool) {
        if is_emptied {
            self.missing = self.missing.max(self.cap());
        }
        for lagging in &mut self.lagging {
            *lagging = Lagging::at_rest(lagging.amplifier, &at_rest);
        }
        (self.mean, self.means) = (0, at_rest);
    }

    /// The largest level.
    const fn cap(&self) -> i64 {
        (self.numbers.cap as i64) << 32
    }

    /// The level above the reserve, with the energies to come.
    fn level(&self) -> i64 {
        self.cap() - self.missing + self.to_come()
    }

    /// The level in J, from zero to the host's energy.
    pub fn energy(&self) -> f64 {
        (self.level() + self.numbers.owed) as f64 * self.numbers.joules
    }

    /// The same, with less arithmetic.
    pub(super) fn rounded_energy(&self) -> f32 {
        (self.level() + self.numbers.owed) as f32 * self.numbers.joules as f32
    }

    /// The last command in codes.
    #[inline(always)]
    pub(super) fn given(&self) -> i32 {
        let last = || self.means.waiting().last().map_or(self.mean, |&mean| mean as i32);
        self.lagging.first().map_or_else(last, |lagging| lagging.before) >> STEP_BITS
    }

    /// N m of a code.
    pub(super) const fn code(&self) -> f32 {
        self.numbers.code
    }

    /// The mean of the host's torque at the motor over the tick that begins, in codes.
    pub fn mean(&self) -> f64 {
        f64::from(self.mean) / f64::from(1 << STEP_BITS)
    }
}

impl<D: DelayLine<i64>> Lagging<D> {
    /// Steps above the error of both coefficients of a cost and its rounding.
    const ABOVE: i32 = 8;

    fn at_rest(amplifier: Amplifier, line: &D) -> Self {
        let (energies, unfinished_later) = (line.clone(), line.clone());
        Self { amplifier, torque: 0, before: 0, rest: 0, energies, unfinished: 0, unfinished_later }
    }

    /// What a command costs.
    fn cost(&self, command: i32) -> i64 {
        let sum = (product(command, self.amplifier.price) + 2 * self.pulled()) >> Amplifier::BITS;
        let above = if command > 0 { Self::ABOVE } else { -Self::ABOVE };
        i64::from(command) * (sum + i64::from(above))
    }

    /// Half of that of a command of one step for the torques before it.
    fn pulled(&self) -> i64 {
        let Amplifier { pull: [of_torque, of_before], .. } = self.amplifier;
        product(self.torque, of_torque) + product(self.before, of_before)
    }

    /// Of a command with this sign: `p` and `b` of its cost `x (p x + 2 b)`.
    fn weights(&self, sign: i32) -> [f32; 2] {
        let one = (1 << Amplifier::BITS) as f32;
        let pulled = sign as f32 * rounded(self.pulled());
        [self.amplifier.price as f32 / one, pulled / one + 0.5 * Self::ABOVE as f32]
    }

    /// Gives a command of this cost; returns the mean torque of the tick in which it begins.
    fn give(&mut self, command: i32, cost: i64) -> i32 {
        let Amplifier { decay, first, second, is_late, .. } = self.amplifier;
        let tail = self.tail();
        let step = self.torque - command;
        let left = if is_late { self.left(command, step) } else { 0 };
        self.unfinished = self.unfinished_later.due().unwrap_or(left);
        self.unfinished_later.push(left);
        let weighted = |[own, of_torque]: [i32; 2]| {
            ((product(command, own) + product(self.torque, of_torque)) >> Amplifier::BITS) as i32
        };
        let mean = self.rest + weighted(first);
        self.rest = weighted(second);
        let one = 1_i64 << Amplifier::BITS;
        self.torque = ((i64::from(command) * one + product(step, decay)) / one) as i32;
        self.before = command;
        self.energies.push(cost + tail - self.tail());
        mean
    }

    /// The energy of a command in the second of the ticks in which it acts, from the torque at its begin less it.
    fn left(&self, command: i32, step: i32) -> i64 {
        let [own, both, squared] = self.amplifier.over;
        // Above the error of the coefficient and the rounding.
        let above = if command > 0 { 4 } else { -4 };
        let of_both = i64::from(command) * ((product(step, both) >> Amplifier::BITS) + above);
        of_square(command, own) + of_both + of_square(step, squared)
    }

    /// The energy that is still to come after the last command has ended.
    fn tail(&self) -> i64 {
        let [of_torque, of_before] = self.amplifier.tail;
        of_square(self.torque, of_torque) + of_square(self.before, of_before)
    }

    /// The energy of the commands given so far that is still to come.
    fn to_come(&self) -> i64 {
        self.tail() + self.unfinished + self.energies.waiting().iter().sum::<i64>()
    }
}

/// The exact product.
#[inline(always)]
const fn product(a: i32, b: i32) -> i64 {
    a as i64 * b as i64
}

/// The number to within 2^-23 and 2^8, without a library's conversion.
fn rounded(value: i64) -> f32 {
    (value >> 32) as i32 as f32 * 4_294_967_296.0 + value as u32 as f32
}

/// The root of a positive number to within 2^-22: that of the half of its digits, and Newton's method.
fn root(square: f32) -> Option<f32> {
    (square > 0.0).then(|| {
        let near = f32::from_bits((square.to_bits() >> 1) + 0x1fbd_1df5);
        (0..3).fold(near, |root, _| 0.5 * (root + square / root))
    })
}

/// The number, or zero if it is negative: a full tank has the same level after any number of ticks.
#[inline(always)]
const fn clamped(value: i64) -> i64 {
    value & !(value >> 63)
}

/// Twice a number of magnitude up to twice [`LARGEST`], or zero if it is negative.
#[inline(always)]
fn twice_positive(value: i32) -> u32 {
    (value << 1).clamp(0, 4 * LARGEST - 1).cast_unsigned()
}

/// The number without its sign.
#[inline(always)]
const fn magnitude(value: i32) -> i32 {
    value.wrapping_abs()
}

/// A coefficient times a square, or a little more; zero for zero.
const fn of_square(value: i32, coefficient: i32) -> i64 {
    let value = value.unsigned_abs() as i64;
    value * (((value * coefficient as i64) >> Amplifier::BITS) + 1)
}
