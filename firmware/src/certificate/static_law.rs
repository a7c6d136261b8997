//! Static laws at the device's port, without a coupling: springs, walls, torque profiles and sums of them
//! (theory, section 16).
//!
//! Each torque depends on positions of the past, and only their largest age counts. All times in this module
//! are in periods.

use super::linearity::{is_behind_spring, is_static_at_port};
use super::loop_intervals::LoopIntervals;
use super::part::{dampers, switched_damping};
use super::profile::{ExtremeSlopes, damper, is_motor};
use super::window::Moments;
use crate::coupling::Coupling;
use crate::encoder_reading::EncoderReading;
use crate::environment::{Environment, EnvironmentModel, Profile, Wall};
use crate::latency::Latency;
use crate::passivity::interval::Interval;
use crate::passivity::lagged::{Decay, left};
use crate::scene::Scene;

/// The index of a scene without a coupling at the device's port.
#[derive(Clone, Copy)]
pub(super) struct IndexAtPort {
    /// The passivity above which the scene is passive, scaled to the worst period; in N m s/rad.
    pub sufficient: Interval,
    /// Whether less is known to be too little.
    pub is_necessary: bool,
}

/// The index of a scene without a coupling at the port, also with its torque limited at any level. `None` if
/// none is known.
///
/// `reading` is the time in s by which a count may be read late.
#[inline(never)]
pub(super) const fn index_at_port(
    scene: &Scene,
    n: &LoopIntervals,
    reading: f64,
) -> Option<IndexAtPort> {
    let law = some!(Law::in_scene::<Environment>(scene, n));
    let lowest = some!(law.needed::<Environment>(scene, n, reading, End::Lower));
    let highest = some!(law.needed::<Environment>(scene, n, reading, End::Upper));
    Some(IndexAtPort {
        sufficient: Interval::new(lowest, highest),
        is_necessary: law.is_spring_somewhere && is_exact(&scene.latency, n),
    })
}

/// Which end of the enclosure of an index.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Lower,
    Upper,
}

impl End {
    /// The index grows with every time and slope, so that each end of its enclosure is computed from the same
    /// end of every time.
    pub const fn of(self, enclosed: Interval) -> f64 {
        match self {
            Self::Lower => enclosed.lo(),
            Self::Upper => enclosed.hi(),
        }
    }

    /// The same end of a time in s, in periods.
    #[cfg_attr(target_os = "none", inline(never))]
    const fn time(self, time: f64, n: &LoopIntervals) -> f64 {
        if time == 0.0 {
            return 0.0;
        }
        self.of(Interval::decimal(time).div(n.period)).max(0.0)
    }
}

/// One end of [`IndexAtPort::sufficient`] (equation 59; for a delay alone, equation 48).
#[inline(never)]
pub(super) const fn needed_at_port<E: EnvironmentModel>(
    scene: &Scene,
    n: &LoopIntervals,
    reading: f64,
    end: End,
) -> Option<f64> {
    let law = some!(Law::in_scene::<E>(scene, n));
    law.needed::<E>(scene, n, reading, end)
}

/// One end of the index at the port of a torque profile by itself, in N m s/rad, scaled to the worst period.
#[inline(never)]
pub(super) const fn needed_by_profile<E: EnvironmentModel>(
    profile: &Profile,
    scene: &Scene,
    n: &LoopIntervals,
    end: End,
) -> Option<f64> {
    let law = Law::of_slopes(profile, &ExtremeSlopes::of_table::<E>(profile, n));
    let law = if E::MAY_MISREAD { law.steepened(scene.latency.encoder) } else { law };
    law.needed::<E>(scene, n, 0.0, end)
}

/// The passivity that a switched damper takes at most beside a static law, over the damper: the geometric mean
/// of the longest times between two counts and between two torques, in periods (theory, section 16.3). At least
/// one of them is 1, unless torques and counts jitter: the arithmetic mean is then not less.
pub(super) const fn share_of_damper(scene: &Scene, n: &LoopIntervals, reading: f64) -> Interval {
    let jitter = Interval::exact(End::Upper.time(scene.latency.total_jitter(), n));
    let reading = Interval::exact(End::Upper.time(reading, n));
    let apart = Interval::ONE.add(jitter.double()).add(reading);
    if scene.latency.jitters_twice() { Interval::ONE.add(apart).half() } else { apart.sqrt() }
}

/// Whether the index is known to be the least one for a spring.
const fn is_exact(latency: &Latency, n: &LoopIntervals) -> bool {
    let is_in_updates = latency.actuator_updates == 0
        || latency.total_jitter() == 0.0 && !latency.is_filtered_beside_updates();
    let drops = latency.encoder.dropped > 0;
    is_in_updates && !latency.jitters_twice() && !drops && (!n.misses_updates || latency.is_none())
}

/// A torque that depends on positions, limited at any level, plus parts that depend on steps of positions.
///
/// All are in N m/rad.
#[derive(Clone, Copy)]
struct Law {
    /// The steepest rise, `L`.
    rise: Interval,
    /// The largest slope, `M`.
    steepest: Interval,
    /// The sum of the slopes times their whole samples of delay.
    late: Interval,
    /// What dampers and cancellers need, over the period.
    damping: Interval,
    /// Whether it is a spring of the stiffness `M`, with `L = M`, for small motions about some position.
    is_spring_somewhere: bool,
}

impl Law {
    const NONE: Self = Self {
        rise: Interval::ZERO,
        steepest: Interval::ZERO,
        late: Interval::ZERO,
        damping: Interval::ZERO,
        is_spring_somewhere: true,
    };

    /// The law in a scene: that of the environment, or of the coupling where that is all that the device feels
    /// of a static environment ([`is_behind_spring`]). Through a nonlinear encoder all slopes over the
    /// device's angle are up to `1 + eta` times as steep (equation 65).
    const fn in_scene<E: EnvironmentModel>(scene: &Scene, n: &LoopIntervals) -> Option<Self> {
        let law = match scene.coupling {
            Coupling::Rigid => some!(Self::of::<E>(&scene.environment, n)),
            _ if E::MEMORY.may_be_coupled() && is_behind_spring(scene) => {
                // A profile that is not late is solved in front of the coupling.
                match scene.environment.profile() {
                    Some(_) => some!(Self::of::<E>(&scene.environment, n)),
                    None => Self::of_coupling(n),
                }
            }
            _ => return None,
        };
        Some(if E::MAY_MISREAD { law.steepened(scene.latency.encoder) } else { law })
    }

    /// The slope of a static environment behind a coupling spring is below that of the spring.
    const fn of_coupling(n: &LoopIntervals) -> Self {
        let spring = Interval::ONE.div(n.compliance);
        Self { rise: spring, steepest: spring, is_spring_somewhere: false, ..Self::NONE }
    }

    const fn steepened(self, encoder: &EncoderReading) -> Self {
        if encoder.linearity == 0.0 {
            return self;
        }
        let factor = Interval::ONE.add(Interval::decimal(encoder.linearity));
        Self {
            rise: self.rise.mul(factor),
            steepest: self.steepest.mul(factor),
            late: self.late.mul(factor),
            damping: self.damping.mul(factor),
            ..self
        }
    }

    /// `None` if no bound is known: for rational and stated environments, negative springs, motors and snap
    /// points.
    const fn of<E: EnvironmentModel>(environment: &Environment, n: &LoopIntervals) -> Option<Self> {
        let Environment::Parts(parts) = environment else { return None };
        let mut sum = None;
        if let Some(wall) = &parts.wall {
            if wall.stiffness < 0.0 {
                return None;
            }
            sum = Some(Self::of_wall(wall, n));
        }
        if let Some(profile) = &parts.profile {
            if !E::PROFILE.exists || parts.count() > 1 && !E::PROFILE.is_composed {
                return None;
            }
            let law = some!(Self::of_profile::<E>(profile, n));
            sum = Some(match sum {
                Some(wall) => law.plus(wall),
                None => law,
            });
        }
        if parts.canceller.is_none() && parts.others() == 0 {
            return sum;
        }
        let damping = some!(dampers::<E>(parts, n)).div(n.period);
        Some(or!(sum, Self::NONE).plus(Self { damping, ..Self::NONE }))
    }

    /// [`needed_at_port`] of the law in a scene.
    const fn needed<E: EnvironmentModel>(
        &self,
        scene: &Scene,
        n: &LoopIntervals,
        reading: f64,
        end: End,
    ) -> Option<f64> {
        let encoder = match E::MAY_MISREAD {
            true => scene.latency.encoder,
            false => EncoderReading::ideal(),
        };
        // Otherwise a dropped reading is a missed update.
        let dropped = if is_static_at_port(scene) { encoder.dropped } else { 0 };
        let between = E::MAY_MISREAD && scene.latency.is_between_updates();
        let times = Times { latency: &scene.latency, window: encoder.window, dropped, between };
        let age = some!(Age::of(&times, n, end));
        let steepest = self.steepest;
        let moved = self.rise.half().add(self.late).add(steepest.mul(age.mean));
        let spread = steepest.mul(steepest).mul(age.variance);
        let varies = n.misses_updates || reading > 0.0 || scene.latency.total_jitter() > 0.0;
        // A damper whose counts are not a period apart has its own share of the passivity.
        let (within, beside) = if varies {
            (moved, self.damping.mul(share_of_damper(scene, n, reading)))
        } else {
            (moved.add(self.damping), Interval::ZERO)
        };
        let root = within.mul(within).add(spread).sqrt();
        let needed = within.add(root).half().mul(age.tick).add(beside).mul(n.period);
        Some(end.of(needed).max(0.0))
    }

    const fn of_wall(wall: &Wall, n: &LoopIntervals) -> Self {
        let spring = n.coefficient(Interval::decimal(wall.stiffness));
        Self {
            rise: spring,
            steepest: spring,
            late: spring.mul(Interval::exact(wall.delay as f64)),
            damping: switched_damping(wall, n).div(n.period),
            is_spring_somewhere: wall.damping() == 0.0,
        }
    }

    const fn of_profile<E: EnvironmentModel>(profile: &Profile, n: &LoopIntervals) -> Option<Self> {
        if is_motor(profile) || E::PROFILE.snaps && profile.snap.is_some() {
            return None;
        }
        let law = Self::of_slopes(profile, &ExtremeSlopes::of_table::<E>(profile, n));
        let damping = damper::<E>(profile, n).abs();
        let is_spring_somewhere = law.is_spring_somewhere && damping.is_zero();
        Some(Self { damping, is_spring_somewhere, ..law })
    }

    const fn of_slopes(profile: &Profile, slopes: &ExtremeSlopes) -> Self {
        let steepest = slopes.steepest();
        Self {
            rise: slopes.rise,
            steepest,
            late: steepest.mul(Interval::exact(profile.delay as f64)),
            damping: Interval::ZERO,
            is_spring_somewhere: slopes.rise.hi() >= steepest.hi(),
        }
    }

    /// The sum, of which nothing is known to be necessary.
    const fn plus(self, other: Self) -> Self {
        Self {
            rise: self.rise.add(other.rise),
            steepest: self.steepest.add(other.steepest),
            late: self.late.add(other.late),
            damping: self.damping.add(other.damping),
            is_spring_somewhere: false,
        }
    }
}

/// The ages of a torque in addition to the whole samples of its law (equation 60): the mean of the folded
/// envelope of the ages and its variance over a tick (theory, section 16.1), scaled to the longest tick.
#[derive(Clone, Copy)]
struct Age {
    mean: Interval,
    variance: Interval,
    /// The longest tick over the worst period.
    tick: Interval,
}

impl Age {
    const NONE: Self = Self { mean: Interval::ZERO, variance: Interval::ZERO, tick: Interval::ONE };

    /// `None` if no bound is known: for updates that are missed beside two lags, or beside a lag with jitter or
    /// with torques that begin between two updates, and for two jitters beside a lag.
    const fn of(times: &Times<'_>, n: &LoopIntervals, end: End) -> Option<Self> {
        let latency = times.latency;
        if latency.is_none() && times.dropped == 0 {
            return Some(Self::NONE);
        }
        let has_lag = !latency.actuator_lag.is_zero();
        let has_filter = !latency.sensor_lag.is_zero();
        let window = times.shape_counts(n);
        let Some(oldest) = oldest(times, window, n, end) else { return None };
        if latency.jitters_twice() {
            return if has_lag || has_filter {
                None
            } else {
                Self::irregular(oldest, latency, n, end)
            };
        }
        let whole = oldest as u32 as f64;
        // Exact, as a difference of doubles of the same order.
        let part = Interval::exact(oldest - whole);
        if window {
            let length = Interval::exact(end.time(times.window, n));
            let last = end.of(part.add(length)).max(part.lo());
            let Moments { mean, square } = Moments::of_window(part.lo(), last);
            let variance = variance(square, mean);
            return Some(Self {
                mean: Interval::exact(whole).add(mean),
                variance,
                tick: Interval::ONE,
            });
        }
        let between = times.between;
        let lag = Tail::of(latency.actuator_lag.most, latency, between, n, part, end);
        let filter = Tail::of(latency.sensor_lag.most, &Latency::NONE, false, n, part, end);
        let mean = part.add(lag.lag.held).add(filter.lag.held);
        let square = part.add(lag.square(part)).add(filter.square(part));
        let square = match has_lag && has_filter {
            true => square.add(lag.beside(&filter, part).double()),
            false => square,
        };
        let whole = Interval::exact(whole);
        if !n.misses_updates {
            let variance = variance(square, mean);
            return Some(Self { mean: whole.add(mean), variance, tick: Interval::ONE });
        }
        let irregular = latency.total_jitter() > 0.0 || times.between;
        if has_lag && has_filter || (has_lag || has_filter) && irregular {
            return None;
        }
        // The envelope in the rest of a tick that is longer than a period is no larger than at its beginning.
        let later = lag.later.add(filter.later);
        let longer = n.stretch.sub(Interval::ONE);
        let mean = mean.add(longer.mul(later)).div(n.stretch);
        let square = square.add(longer.mul(later).mul(later)).div(n.stretch);
        let variance = variance(square, mean);
        Some(Self { mean: whole.add(mean), variance, tick: Interval::ONE })
    }

    /// The ages where neither torques nor counts come once a period: of the two, the ticks are those that
    /// deviate less, by `h`. Each is between `1 - 2 h` and the worst period plus `2 h` long, and as many ticks
    /// as the samples of the law may take `2 h` less than their periods.
    #[inline(never)]
    const fn irregular(
        oldest: f64,
        latency: &Latency,
        n: &LoopIntervals,
        end: End,
    ) -> Option<Self> {
        let less = latency.output_jitter.min(latency.count_jitter);
        let twice = Interval::exact(end.time(less, n)).double();
        let shortest = Interval::ONE.sub(twice);
        if shortest.lo() <= 0.0 {
            return None;
        }
        let oldest = Interval::exact(oldest).add(twice);
        let whole = Interval::exact(end.of(oldest.div(shortest)) as u32 as f64);
        let longest = n.stretch.add(twice);
        let part = oldest.sub(whole.mul(shortest)).max(Interval::ZERO).div(longest);
        let tick = longest.div(n.stretch);
        Some(Self { mean: whole.add(part), variance: variance(part, part), tick })
    }
}

/// `square - mean^2`, which is not negative.
const fn variance(square: Interval, mean: Interval) -> Interval {
    square.sub(mean.mul(mean)).max(Interval::ZERO)
}

#[derive(Clone, Copy)]
struct Times<'s> {
    latency: &'s Latency,
    /// The encoder's window in s.
    window: f64,
    /// Readings in a row that may be older ones.
    dropped: u16,
    /// Whether a torque begins between two updates of the current loop.
    between: bool,
}

impl Times<'_> {
    /// Whether the ages within the encoder's window count by their shape. Where ticks are not a period long,
    /// the window counts as the delay of its end.
    const fn shape_counts(&self, n: &LoopIntervals) -> bool {
        self.window > 0.0 && !self.latency.jitters_twice() && !n.misses_updates
    }
}

/// The largest time from a count to its torque, without lags, and without a window whose shape counts.
const fn oldest(times: &Times<'_>, window: bool, n: &LoopIntervals, end: End) -> Option<f64> {
    let latency = times.latency;
    let delay = match latency.actuator_updates {
        0 => end.time(latency.output_delay.most, n),
        _ => end.of(some!(latency.delay_in_updates(n.period.midpoint()))),
    };
    let response = if window { 0.0 } else { end.time(latency.actuator_response.most, n) };
    let jitter = end.time(latency.total_jitter(), n);
    let sum = Interval::exact(delay).add(Interval::exact(response)).add(Interval::exact(jitter));
    let sum = sum.add(latency.later_than_lag(n.period.midpoint()));
    if times.dropped == 0 {
        return Some(end.of(sum));
    }
    Some(end.of(sum.add(Interval::exact(times.dropped as f64))))
}

/// What a lag leaves of an age after the delay: `u(t)` with `u(0) = 1`.
#[derive(Clone, Copy)]
struct Tail {
    /// The lag after the delay's tick; the integral of `u` is what it holds.
    lag: Decay,
    /// The integral of `u^2`.
    squared: Interval,
    /// The integral of `u` from the end of the delay's tick on.
    beyond: Interval,
    /// The folded envelope after a period.
    later: Interval,
}

impl Tail {
    const NONE: Self = Self {
        lag: Decay::NONE,
        squared: Interval::ZERO,
        beyond: Interval::ZERO,
        later: Interval::ZERO,
    };

    /// The tail of a time constant in s after `part` of a period. Beside jitter the tick may end between two
    /// updates of a current loop, and `u` is at most that at the update before.
    #[inline(never)]
    const fn of(
        tau: f64,
        latency: &Latency,
        between: bool,
        n: &LoopIntervals,
        part: Interval,
        end: End,
    ) -> Self {
        if tau == 0.0 {
            return Self::NONE;
        }
        let tau = Interval::exact(end.time(tau, n));
        let mut over = Interval::ONE.sub(part);
        let (lag, squared) = match latency.judged_updates() {
            0 => {
                let lag = Decay::of(tau, over);
                (lag, lag.unspread)
            }
            updates => {
                let jitters = latency.total_jitter() > 0.0;
                if jitters {
                    let whole = (over.lo() * updates as f64 * (1.0 - 1e-9)) as u32 as f64;
                    over = Interval::exact(whole).div(Interval::exact(updates as f64));
                }
                let lag = Decay::sampled(tau, over, updates, between && !jitters);
                (lag, lag.held.sub(lag.unspread))
            }
        };
        let later = lag.rest.div(Interval::ONE.sub(lag.tick));
        Self { lag, squared, beyond: lag.held.mul(lag.rest), later }
    }

    /// What it adds to the mean square of the folded envelope, with the `part` before it.
    const fn square(&self, part: Interval) -> Interval {
        if self.lag.held.is_zero() {
            return Interval::ZERO;
        }
        let kept = Interval::ONE.sub(self.lag.tick);
        let own = self.squared.mul(Interval::ONE.add(self.lag.tick));
        let in_part = self.beyond.sub(self.lag.tick.mul(self.lag.held)).max(Interval::ZERO);
        let in_part = if part.is_zero() { Interval::ZERO } else { in_part.double() };
        own.add(in_part).div(kept)
    }

    /// The mean product of the folded envelopes of an amplifier and of a sensor, which are on the two sides of
    /// the delay.
    const fn beside(&self, sensor: &Self, part: Interval) -> Interval {
        let over = Interval::ONE.sub(part);
        let rests = self.lag.rest.mul(sensor.lag.rest);
        let product = self.over(sensor, over).add(rests.mul(self.over(sensor, part)));
        let kept = Interval::ONE.sub(self.lag.tick).mul(Interval::ONE.sub(sensor.lag.tick));
        product.div(kept)
    }

    /// The integral over a `time` of one exponential forwards and the other backwards: in partial fractions,
    /// and for time constants that are too nearly equal at most that of the chord, because it is convex.
    const fn over(&self, other: &Self, time: Interval) -> Interval {
        let (a, b) = (left(time, self.lag.tau), left(time, other.lag.tau));
        let chord = Interval::new(0.0, time.mul(a.add(b)).half().hi().max(0.0));
        let apart = self.lag.tau.sub(other.lag.tau);
        if apart.contains(0.0) {
            return chord;
        }
        let fractions = self.lag.tau.mul(other.lag.tau).mul(a.sub(b)).div(apart);
        if fractions.is_finite() { fractions.and(chord) } else { chord }
    }
}

#[cfg(test)]
mod tests;
