//! The torque that a host wants, tick by tick: from one command to the next, and to zero after the last.

use super::HostTorque;
use super::tank::STEP_BITS;

/// Longest ramp in ticks: half of the longest timeout.
pub(super) const LONGEST_RAMP: u32 = 10_000;

/// What a ramp does at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Then {
    /// Keeps the torque for so many ticks.
    Hold(u32),
    /// Ramps to zero.
    Fade,
    /// Stays at zero.
    Rest,
}

/// The wanted torque in codes of the DAC. A command is reached along a line, held, and faded to zero if none
/// follows it: after half of the timeout, over the other half.
#[derive(Clone, Debug)]
pub(super) struct Stream {
    /// In steps, [`STEP_BITS`] below a code, as are the others.
    wanted: i32,
    step: i32,
    /// The last tick of the present hold, or of the present ramp before its target.
    end: u32,
    target: i32,
    then: Then,
    /// Half of the timeout in ticks, at least one.
    half: u32,
}

impl Stream {
    /// At rest. `period` in s.
    pub fn new(host: &HostTorque, period: f64) -> Self {
        // The cast rounds down and saturates.
        let half = ((0.5 * host.timeout / period) as u32).clamp(1, LONGEST_RAMP);
        Self { wanted: 0, step: 0, end: 0, target: 0, then: Then::Rest, half }
    }

    /// Goes on to the next tick. Ramps and holds end between two ticks, in [`Self::next`], so that this is all
    /// of a usual tick.
    #[inline(always)]
    pub const fn advance(&mut self) {
        self.wanted = self.wanted.wrapping_add(self.step);
    }

    /// The wanted torque of the tick.
    #[inline(always)]
    pub const fn wanted(&self) -> i32 {
        self.wanted >> STEP_BITS
    }

    /// Ends what ends with this tick. Returns the tick after which this has to be called again, at the latest
    /// that.
    pub fn next(&mut self, tick: u32, latest: u32) -> u32 {
        while !self.is_over() {
            if tick.wrapping_sub(self.end).cast_signed() < 0 {
                let is_first = self.end.wrapping_sub(latest).cast_signed() < 0;
                return if is_first { self.end } else { latest };
            }
            self.wanted = self.target;
            self.step = 0;
            match self.then {
                Then::Hold(ticks) => {
                    self.end = self.end.wrapping_add(ticks + 1);
                    self.then = Then::Fade;
                }
                Then::Fade => self.ramp(0, self.half, Then::Rest, self.end),
                Then::Rest => {}
            }
        }
        latest
    }

    /// Whether the torque stays as it is until the next command.
    fn is_over(&self) -> bool {
        self.then == Then::Rest && self.wanted == self.target
    }

    /// Takes a command: a torque within the host's largest. It is not reached before the scene's torque limit is
    /// open, in `opening` ticks. It begins after this tick, as the others do.
    pub fn take(&mut self, torque: i32, ramp: u16, opening: u32, tick: u32) {
        let ticks = u32::from(ramp).max(opening).clamp(1, self.half);
        let torque = torque << STEP_BITS;
        let target = if opening > ticks {
            let way = i64::from(torque - self.wanted) * i64::from(ticks);
            self.wanted + (way / i64::from(opening)) as i32
        } else {
            torque
        };
        self.ramp(target, ticks, Then::Hold((self.half - ticks).max(1)), tick);
    }

    /// A line to zero in so many ticks.
    pub fn fade(&mut self, ticks: u32, tick: u32) {
        self.ramp(0, ticks.clamp(1, LONGEST_RAMP), Then::Rest, tick);
    }

    /// The larger of the present torque and of that to come, in steps without the sign; the largest with the same
    /// codes, so that a limit that falls by parts of a code each tick keeps them.
    pub fn largest(&self) -> i32 {
        self.wanted.abs().max(self.target.abs()) | ((1 << STEP_BITS) - 1)
    }

    /// Keeps to this torque in steps from this tick on.
    pub fn limit(&mut self, most: i32, tick: u32) {
        (self.wanted, self.target) =
            (self.wanted.clamp(-most, most), self.target.clamp(-most, most));
        let left = self.end.wrapping_sub(tick).wrapping_add(1).clamp(1, LONGEST_RAMP);
        self.step = (self.target - self.wanted) / left as i32;
    }

    /// Whether nothing is wanted until the next command.
    pub fn is_at_rest(&self) -> bool {
        self.then == Then::Rest && self.wanted == 0 && self.step == 0
    }

    /// A line that stays short of its target until its last tick.
    fn ramp(&mut self, target: i32, ticks: u32, then: Then, tick: u32) {
        self.target = target;
        self.step = (target - self.wanted) / ticks as i32;
        (self.end, self.then) = (tick.wrapping_add(ticks - 1), then);
    }

    /// Wants nothing until the next command.
    pub fn rest(&mut self) {
        (self.wanted, self.step) = (0, 0);
        (self.target, self.then) = (0, Then::Rest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A timeout of 20 ticks.
    fn stream() -> Stream {
        let host =
            HostTorque { energy: 1.0, power: 0.0, damping: 0.01, torque: 1.0, timeout: 0.0201 };
        Stream::new(&host, 1e-3)
    }

    /// The wanted codes of this tick; the next call is in the tick after which it is due.
    fn next(stream: &mut Stream, due: &mut u32, tick: u32) -> i32 {
        stream.advance();
        let wanted = stream.wanted();
        if tick.wrapping_sub(*due).cast_signed() >= 0 {
            *due = stream.next(tick, tick.wrapping_add(1 << 20));
        }
        wanted
    }

    #[test]
    fn a_stale_torque_is_zero_after_the_timeout() {
        for ramp in [0, 1, 4, 10, u16::MAX] {
            let mut stream = stream();
            // The number of a tick wraps.
            let start = 30_u32.wrapping_neg();
            stream.take(1000, ramp, 0, start);
            let mut due = stream.next(start, start);
            let tick = |after| start.wrapping_add(after);
            let torques: std::vec::Vec<_> =
                (1..41).map(|after| next(&mut stream, &mut due, tick(after))).collect();
            let reached = torques.iter().position(|torque| *torque == 1000).unwrap();
            assert_eq!(reached, usize::from(ramp.clamp(1, 10)) - 1, "{ramp}");
            assert!(
                torques[..reached].is_sorted() && torques[reached..].is_sorted_by(|a, b| a >= b)
            );
            assert!(torques[21..].iter().all(|torque| *torque == 0), "{ramp}: {torques:?}");
        }
    }

    #[test]
    fn the_last_command_wins() {
        let mut stream = stream();
        stream.take(1000, 4, 0, 0);
        let mut due = stream.next(0, 100);
        next(&mut stream, &mut due, 1);
        stream.take(-500, 0, 0, 1);
        due = stream.next(1, 100);
        assert_eq!(next(&mut stream, &mut due, 2), -500);
        stream.rest();
        assert!((3..100).all(|tick| next(&mut stream, &mut due, tick) == 0));
    }
}
