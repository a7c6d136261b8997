//! The ages of readings that are means over a window: moments of the folded envelope of equation 59.
//!
//! All times in this module are in periods.

use crate::passivity::interval::Interval;

/// Moments over a tick of the folded envelope `o` of an age below 1 and then a window.
pub(super) struct Moments {
    pub mean: Interval,
    pub square: Interval,
}

impl Moments {
    /// The weight of the positions older than `t` is 1 up to the age `part`, and then falls in a straight line
    /// to 0 at the age `oldest`, so that `o` is a straight line between the two folded ages.
    ///
    /// The ends are exact: a caller rounds them.
    #[inline(never)]
    pub const fn of_window(part: f64, oldest: f64) -> Self {
        let whole = oldest as u32;
        let folded = oldest - whole as f64;
        let window = Window { part, oldest, whole, folded };
        let (first, second) = (part.min(folded), part.max(folded));
        let square = window.square(0.0, first);
        let square = square.add(window.square(first, second)).add(window.square(second, 1.0));
        let mean = Interval::exact(part).add(window.length().half());
        Self { mean, square }
    }
}

/// The window of an age, with its end less the whole periods.
struct Window {
    part: f64,
    oldest: f64,
    whole: u32,
    folded: f64,
}

impl Window {
    const fn length(&self) -> Interval {
        Interval::exact(self.oldest).sub(Interval::exact(self.part))
    }

    /// The integral of `o^2` between two times of a tick within one of the straight lines.
    const fn square(&self, from: f64, to: f64) -> Interval {
        if from >= to {
            return Interval::ZERO;
        }
        let (a, b) = (self.folded_envelope(from, to, from), self.folded_envelope(from, to, to));
        let sum = a.mul(a).add(a.mul(b)).add(b.mul(b)).div(Interval::exact(3.0));
        Interval::exact(to).sub(Interval::exact(from)).mul(sum)
    }

    /// `o` at a time on the straight line between two times.
    const fn folded_envelope(&self, from: f64, to: f64, time: f64) -> Interval {
        let is_full = to <= self.part;
        let first = is_full as u32;
        // The periods whose ages at these times are below the oldest.
        let after = if from < self.folded { self.whole + 1 } else { self.whole };
        let full = if is_full { Interval::ONE } else { Interval::ZERO };
        if after <= first {
            return full;
        }
        let count = (after - first) as f64;
        let starts = Interval::exact(0.5 * count * (first + after - 1) as f64);
        let left =
            Interval::exact(self.oldest).sub(Interval::exact(time)).mul(Interval::exact(count));
        full.add(left.sub(starts).div(self.length()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A window within a tick has the variance `e (1 - e) + b (1/3 - e) - b^2/4`, and any window that of the
    /// folded envelope, summed in small steps.
    #[test]
    fn the_moments_are_those_of_the_folded_envelope() {
        for (part, length) in
            [(0.0, 0.3), (0.25, 0.5), (0.25, 0.75), (0.25, 0.9), (0.7, 0.2), (0.7, 1.0), (0.0, 1.0)]
        {
            let Moments { mean, square } = Moments::of_window(part, part + length);
            assert!(mean.contains(part + 0.5 * length), "{mean:?}");
            let variance = square.sub(mean.mul(mean)).midpoint();
            if part + length <= 1.0 {
                let closed =
                    part * (1.0 - part) + length * (1.0 / 3.0 - part) - 0.25 * length * length;
                assert!((variance - closed).abs() < 1e-14, "{part} {length}: {variance} {closed}");
            }
            let older = |age: f64| ((part + length - age) / length).clamp(0.0, 1.0);
            let steps = 100_000;
            let folded = |step| {
                let age = (f64::from(step) + 0.5) / f64::from(steps);
                (0..3).map(|whole| older(age + f64::from(whole))).sum::<f64>()
            };
            let sum = (0..steps).map(|step| folded(step).powi(2)).sum::<f64>() / f64::from(steps);
            assert!((square.midpoint() - sum).abs() < 1e-8, "{part} {length}: {square:?} {sum}");
        }
    }
}
