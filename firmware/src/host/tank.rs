//! The tank: the energy that a host's torque may still take, tick by tick.
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
//! # Rounding
//!
//! The level `x` of this file is never above the exact one. Let `u` be the format's unit roundoff.
//!
//! - `y = d s - m` is off by `2u |d s| + u |y| <= 3u |y| + 2u |m|`, so `y^2` by at most `8u y^2 + 2u m^2`. The
//!   square, the sums and the products between it and the end of the next tick add less than `7u` of each
//!   summand; [`Tank::book`] takes `16u` of the sum away, which is more than that.
//! - The coefficients of all that is given back are rounded down, those of costs up, by more than an ulp.
//! - The modelled torque is off by rounding in each tick, at most `16u/(1 - a)` of the commands in the sum of
//!   their squares, with the lag's decay `a`. That, the `2u m^2` above and the rounding of a cost are paid
//!   with the part `64u/(1 - a)` of the share, and with twice that much of the square of each command.
//! - An allowed command is `64u` below the root, so that its computed cost is not above `x`, and `x` does not
//!   become negative by paying. The root is approached from below ([`TankNumber::reciprocal_root`]). The cost
//!   is compared in any case: without this argument a command could become zero, but never too large.

use core::hint::cold_path;

use super::{HostError, HostResponse, HostTorque};
use crate::environment::DelayLine;
use crate::number::Number;
use crate::passivity::interval::Interval;

/// A floating-point format for a tank. A servo in a fixed-point format has a tank in `f32`.
pub trait TankNumber: Number<Coefficient = Self> {
    /// Half the distance from 1 to the next number.
    const ROUNDOFF: f64;

    /// The nearest number.
    fn nearest(value: f64) -> Self;

    /// The number without its sign, in one instruction.
    fn magnitude(self) -> Self;

    /// One over the root of a positive number, by Newton's method, whose results are never above it except by
    /// rounding.
    fn reciprocal_root(self) -> Self;
}

macro_rules! tank_number {
    ($float:ident, $roundoff:expr, $guess:expr, $steps:literal) => {
        impl TankNumber for $float {
            const ROUNDOFF: f64 = $roundoff;

            fn nearest(value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn magnitude(self) -> Self {
                self.abs()
            }

            fn reciprocal_root(self) -> Self {
                // Half the exponent with the sign changed, and a straight line for the digits: 4 % off at most.
                let mut root = Self::from_bits($guess - (self.to_bits() >> 1));
                for _ in 0..$steps {
                    root *= 1.5 - 0.5 * self * root * root;
                }
                root
            }
        }
    };
}

tank_number!(f32, 1.0 / (1_u64 << 24) as f64, 0x5f37_59df_u32, 3);
tank_number!(f64, 1.0 / (1_u64 << 53) as f64, 0x5fe6_eb50_c7b5_37a9_u64, 5);

/// The tank of a host beside a servo.
///
/// `D` has the length of [`HostResponse::whole`]. If `PLAIN` is true the [response](HostResponse::is_plain) has
/// to be plain, and a tick has no code for a lag.
#[derive(Clone, Debug)]
pub struct Tank<R: TankNumber, D, const PLAIN: bool> {
    /// Torque per step of the position, of what a moving device gives back.
    speed: R,
    /// Level per step of the position, because its ends are known within counts only.
    count_error: R,
    /// Level per change of the mean torque, because of the same.
    count_step: R,
    /// Level per squared change of the mean torque, for commands without a memory of the last.
    step_price: R,
    power: R,
    cap: R,
    /// The cap of the present tick: less while motion gives nothing back.
    held: R,
    leak: R,
    below_root: R,
    torque: R,
    memory: Spread<R>,
    /// The energies that commands leave for the tick after the one in which they begin.
    unfinished: D,
    /// The level above the reserve, in squares of torques.
    level: R,
    /// The mean torque of the present tick.
    mean: R,
    means: D,
    /// The energies of the commands that have not begun.
    energies: D,
    /// J for a level of 1.
    joules: f64,
    reserve: f64,
}

/// The part of a tank for a torque that is not over with its tick.
#[derive(Clone, Copy, Debug)]
struct Spread<R> {
    decay: R,
    pull: [R; 2],
    tail: [R; 2],
    first: [R; 2],
    second: [R; 2],
    is_late: bool,
    over: [R; 3],
    /// The torque at the motor where the last command ends.
    lagging: R,
    /// The last command.
    before: R,
    /// Its mean in the tick in which it ends.
    rest: R,
    /// The rest of the energy of the command that began in the last tick.
    unfinished: R,
}

impl<R: TankNumber, D: DelayLine<R>, const PLAIN: bool> Tank<R, D, PLAIN> {
    /// A full tank at rest, for positions in units of `angle` rad and torques in units of `torque` N m.
    ///
    /// # Errors
    /// If the number format leaves nothing of the energy.
    pub fn new(
        host: &HostTorque,
        response: &HostResponse,
        count: f64,
        [angle, torque]: [f64; 2],
    ) -> Result<Self, HostError> {
        let slack = 64.0 * R::ROUNDOFF / (1.0 - response.decay);
        let price = response.price + 2.0 * slack;
        let scale = 1.0 / Interval::exact(price).sqrt().midpoint();
        let (less, more) = (1.0 - 8.0 * R::ROUNDOFF, 1.0 + 8.0 * R::ROUNDOFF);
        let speed = response.speed * (1.0 - slack) * scale / torque;
        let joules = response.joules / (1.0 - slack) * price * torque * torque;
        // Half a step more of energy for each count's width.
        let count_error = 2.0 * speed * count * speed * angle;
        let weighted =
            |[own, lagging]: [f64; 2]| [R::nearest(own * scale), R::nearest(lagging * scale)];
        let part = |value: f64| R::nearest(value / price);
        let cap = R::nearest((host.energy - response.reserve) / joules * less);
        let memory = Spread {
            decay: R::nearest(response.decay),
            pull: response.pull.map(part),
            tail: response.tail.map(part),
            first: weighted(response.first),
            second: weighted(response.second),
            is_late: response.is_late,
            over: response.unfinished.map(part),
            lagging: R::ZERO,
            before: R::ZERO,
            rest: R::ZERO,
            unfinished: R::ZERO,
        };
        let line = || {
            D::at_rest(response.whole).map_err(|_| HostError::NotCovered {
                time: "an output delay of more than eight periods",
            })
        };
        Ok(Self {
            speed: R::nearest(speed * angle * less),
            count_error: R::nearest(count_error * more),
            count_step: R::nearest(speed * count * more),
            step_price: R::nearest(response.step_price * more),
            power: R::nearest(host.power * response.period / joules * less),
            cap,
            held: cap,
            leak: R::nearest(16.0 * R::ROUNDOFF),
            below_root: R::nearest(1.0 - 64.0 * R::ROUNDOFF),
            torque: R::bound_from_f64(host.torque / torque).unwrap_or(R::ZERO),
            memory,
            unfinished: line()?,
            level: cap,
            mean: R::ZERO,
            means: line()?,
            energies: line()?,
            joules,
            reserve: response.reserve,
        })
    }

    /// Ends a tick in which the position has moved by this much.
    #[inline(always)]
    pub fn book(&mut self, moved: R) {
        let y = moved.times(self.speed).minus(self.mean);
        let earned = y.times(y).plus(self.power);
        let lost = moved.magnitude().times(self.count_error);
        let level = self.level.plus(earned).minus(lost);
        // Of a negative level, too, it takes something away.
        let level = level.minus(level.magnitude().times(self.leak));
        self.level = level.smaller(self.held.minus(self.to_come()));
    }

    /// Whether the energy left in another tank of the same response pays for its torques under way here, too.
    pub(super) fn pays_for(&self, last: &Self) -> bool {
        last.to_come() == R::ZERO || self.level_of(last) >= R::ZERO
    }

    /// Takes the energy and the torques under way of another tank, which differs in its budget alone: torques
    /// have the same unit in both, and levels another. The energy is at most that of this tank.
    pub(super) fn take_over(&mut self, last: &Self) {
        self.level = self.level_of(last).smaller(self.cap.minus(last.to_come()));
        self.held = self.cap;
        (self.mean, self.unfinished) = (last.mean, last.unfinished.clone());
        (self.means, self.energies) = (last.means.clone(), last.energies.clone());
        let Spread { lagging, before, rest, unfinished, .. } = last.memory;
        self.memory = Spread { lagging, before, rest, unfinished, ..self.memory };
    }

    /// The level at which this tank has no more energy than another, with the torques under way at its price.
    fn level_of(&self, last: &Self) -> R {
        let (level, to_come) = (last.level.to_f64(), last.to_come().to_f64());
        // With a torque at the motor the last step of the position is known within that tank's reserve only.
        let is_at_rest = last.mean == R::ZERO && to_come == 0.0;
        let unknown = if is_at_rest { 0.0 } else { last.reserve };
        let energy = (level + to_come) * last.joules + last.reserve - unknown;
        let scaled = (energy - self.reserve) / self.joules;
        // Above the rounding of the sums here and of the number format.
        let rounded = 8.0 * R::ROUNDOFF * (scaled.abs() + to_come + self.reserve / self.joules);
        R::nearest(scaled - to_come - rounded)
    }

    /// An empty tank that never has any energy, with these lines at rest.
    pub(super) fn empty(means: D, energies: D) -> Self {
        let zero = R::ZERO;
        let memory = Spread {
            decay: zero,
            pull: [zero; 2],
            tail: [zero; 2],
            first: [zero; 2],
            second: [zero; 2],
            is_late: false,
            over: [zero; 3],
            lagging: zero,
            before: zero,
            rest: zero,
            unfinished: zero,
        };
        Self {
            speed: zero,
            count_error: zero,
            count_step: zero,
            step_price: zero,
            power: zero,
            cap: zero,
            held: zero,
            leak: zero,
            below_root: zero,
            torque: zero,
            memory,
            unfinished: means.clone(),
            level: zero,
            mean: zero,
            means,
            energies,
            joules: 0.0,
            reserve: 0.0,
        }
    }

    /// Whether the level may rise from now on.
    pub(super) fn give_back(&mut self, may_rise: bool) {
        self.held = if may_rise { self.cap } else { self.level.smaller(self.cap) };
    }

    /// No energy is left, and none for errors of counts.
    pub(super) fn drain(&mut self) {
        let owed = self.reserve / self.joules * (1.0 + 8.0 * R::ROUNDOFF);
        self.level = self.level.smaller(R::nearest(-owed));
        self.held = self.level;
    }

    /// The motor makes no torque from now on. What was paid for torques under way is lost; if they may have
    /// been more than that, so is the level.
    pub(super) fn forget(&mut self, at_rest: D, is_emptied: bool) {
        if is_emptied {
            self.level = self.level.smaller(R::ZERO);
            self.held = self.level;
        }
        let zero = R::ZERO;
        (self.mean, self.means, self.energies) = (zero, at_rest.clone(), at_rest.clone());
        self.unfinished = at_rest;
        let memory = &mut self.memory;
        (memory.lagging, memory.before) = (zero, zero);
        (memory.rest, memory.unfinished) = (zero, zero);
    }

    /// The level above the reserve, with the energies to come.
    pub(super) fn level(&self) -> R {
        self.level.plus(self.to_come())
    }

    /// J for a level of 1, and for a level of zero.
    pub(super) const fn joules(&self) -> [f64; 2] {
        [self.joules, self.reserve]
    }

    /// The energy of the commands given so far that is still to come.
    #[inline(always)]
    fn to_come(&self) -> R {
        let mut energy = self.energies.sum();
        if !PLAIN {
            let memory = &self.memory;
            energy = energy.plus(memory.tail()).plus(memory.unfinished);
        }
        energy
    }

    /// The torque that the motor gets of a wanted torque in [range](Self::in_range).
    #[inline(always)]
    pub fn allowed(&self, wanted: R) -> R {
        if self.pays(self.cost(wanted)) { wanted } else { self.affordable(wanted) }
    }

    /// Whether the level pays for a command that costs this much.
    #[inline(always)]
    pub(super) fn pays(&self, cost: R) -> bool {
        cost <= self.level
    }

    /// What the command costs until the end of its response.
    #[inline(always)]
    pub(super) fn cost(&self, command: R) -> R {
        let pulled = if PLAIN { command } else { command.plus(self.pull()).plus(self.pull()) };
        command.times(pulled)
    }

    #[inline(always)]
    fn pull(&self) -> R {
        let Spread { pull: [lagging, before], .. } = self.memory;
        self.memory.lagging.times(lagging).plus(self.memory.before.times(before))
    }

    /// The wanted torque within the host's largest; zero if it is no finite number. A torque passes here once,
    /// where it arrives, and not in each tick.
    pub fn in_range(&self, wanted: R) -> R {
        if wanted.within(self.torque) {
            wanted
        } else if wanted.times(R::ZERO) != R::ZERO {
            R::ZERO
        } else if wanted > R::ZERO {
            self.torque
        } else {
            self.torque.negated()
        }
    }

    /// The largest command of the same sign that the level can pay.
    #[cold]
    #[inline(never)]
    fn affordable(&self, wanted: R) -> R {
        cold_path();
        // The root below is of a positive number, and the interval between both roots has zero.
        if self.level <= R::ZERO {
            return R::ZERO;
        }
        let pull = if PLAIN { R::ZERO } else { self.pull() };
        let square = self.level.plus(pull.times(pull));
        let root = square.times(square.reciprocal_root()).times(self.below_root);
        let (least, most) = (root.negated().minus(pull), root.minus(pull));
        let command = wanted.smaller(most).larger(least);
        if self.cost(command) <= self.level { command } else { R::ZERO }
    }

    /// Gives this command to the motor. It must be [allowed](Self::allowed), or between zero and that, and the
    /// tick is [booked](Self::book).
    #[inline(always)]
    pub fn give(&mut self, command: R) {
        self.give_at(command, self.cost(command));
    }

    /// The same with its cost.
    #[inline(always)]
    pub(super) fn give_at(&mut self, command: R, cost: R) {
        let paid = self.level.minus(cost);
        let (mean, energy) = if PLAIN {
            (command.times(self.memory.first[0]), cost)
        } else {
            self.spread(command, cost)
        };
        let begins = self.means.due().unwrap_or(mean);
        // The reserve covers this, so that the level may become negative.
        let change = begins.minus(self.mean).magnitude();
        let price = if PLAIN {
            self.count_step.plus(change.times(self.step_price))
        } else {
            self.count_step
        };
        self.level = paid.minus(change.times(price));
        self.mean = begins;
        self.means.push(mean);
        self.energies.push(energy);
    }

    /// The mean torque of the tick in which a command begins, and the energy of the command's period.
    fn spread(&mut self, command: R, cost: R) -> (R, R) {
        let memory = &mut self.memory;
        let energy = cost.plus(memory.tail());
        let step = memory.lagging.minus(command);
        if memory.is_late {
            let [own, both, squared] = memory.over;
            let of_step = command.times(both).plus(step.times(squared));
            let left = command.times(command).times(own).plus(step.times(of_step));
            memory.unfinished = self.unfinished.due().unwrap_or(left);
            self.unfinished.push(left);
        }
        let weighted =
            |[own, lagging]: [R; 2]| command.times(own).plus(memory.lagging.times(lagging));
        let mean = memory.rest.plus(weighted(memory.first));
        let rest = weighted(memory.second);
        let lagging = command.plus(step.times(memory.decay));
        *memory = Spread { rest, lagging, before: command, ..*memory };
        (mean, energy.minus(memory.tail()))
    }

    /// The level in J, from zero to the host's energy.
    pub fn energy(&self) -> f64 {
        self.level.plus(self.to_come()).to_f64() * self.joules + self.reserve
    }

    /// The mean of the host's torque at the motor over the tick that begins, in units of torque.
    pub fn mean(&self) -> f64 {
        self.mean.to_f64() / self.scale()
    }

    fn scale(&self) -> f64 {
        (self.memory.first[0].plus(self.memory.first[1]))
            .plus(self.memory.second[0].plus(self.memory.second[1]))
            .to_f64()
    }
}

impl<R: TankNumber> Spread<R> {
    #[inline(always)]
    fn tail(&self) -> R {
        let [lagging, before] = self.tail;
        let of_lag = self.lagging.times(self.lagging).times(lagging);
        of_lag.plus(self.before.times(self.before).times(before))
    }
}
