//! The trajectory of a hand: its set-point over time, and when it lets go.

use haptic_servo::environment::{Environment, Parts};

use crate::device::{Hand, HandSetpoint};

/// Set-point of a hand over time: it moves smoothly from one angle to the next, and the hand lets go
/// at the end.
#[derive(Clone, Debug, PartialEq)]
pub struct HandTrajectory {
    /// The movement of the hand, in a few words.
    pub description: &'static str,
    /// The hand, as long as it holds the device.
    pub hand: Hand,
    /// Times in s, rising, with the set-point in rad at each.
    pub path: Vec<(f64, f64)>,
    /// Time in s at which it lets go.
    pub release: f64,
}

/// Impedance of a typical hand around a knob: the arm's muscles, with a little of its mass.
pub const TYPICAL_HAND: Hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 6.0 };

impl HandTrajectory {
    /// The trajectory that demonstrates an environment: a wall is pushed into, free motion is swung.
    pub fn for_environment(environment: &Environment) -> Self {
        match environment.parts() {
            Parts { profile: Some(_), .. } => Self::turn_and_let_go(),
            Parts { canceller: Some(_), wall: None, .. } => Self::swing_and_let_go(),
            _ => Self::push_and_let_go(),
        }
    }

    /// Comes from outside, pushes in, holds, eases out, pushes in once more and lets go there.
    pub fn push_and_let_go() -> Self {
        let path =
            vec![(0.25, 0.0), (0.5, -0.05), (1.25, 0.12), (1.75, 0.12), (2.5, -0.05), (3.25, 0.12)];
        Self {
            description: "a hand pushes in and lets go",
            hand: TYPICAL_HAND,
            path,
            release: 3.75,
        }
    }

    /// Swings to and fro and lets go in the middle of a swing, so that the device coasts.
    pub fn swing_and_let_go() -> Self {
        let swing = |n: i32| (0.25 + 0.5 * f64::from(n), if n % 2 == 0 { -0.3 } else { 0.3 });
        let path = std::iter::once((0.0, 0.0)).chain((0..8).map(swing)).collect();
        Self { description: "a hand swings it and lets go", hand: TYPICAL_HAND, path, release: 3.5 }
    }

    /// Turns slowly through three detents of fifteen degrees, back through them, and lets go.
    pub fn turn_and_let_go() -> Self {
        let path = vec![(0.25, 0.0), (1.75, 0.8), (2.0, 0.8), (3.25, 0.1), (3.75, 0.1)];
        Self { description: "a hand turns it and lets go", hand: TYPICAL_HAND, path, release: 3.75 }
    }

    /// The same trajectory repeated for `until` seconds, without letting go.
    pub fn repeated_until(self, until: f64) -> Self {
        /// Time in s from the end of one to the beginning of the next.
        const PAUSE: f64 = 0.5;
        let length = self.path.last().map_or(0.0, |&(end, _)| end) + PAUSE;
        let times = (until / length).ceil() as u32;
        let shifted = |n| {
            let start = f64::from(n) * length;
            self.path.iter().map(move |&(at, position)| (start + at, position))
        };
        let path = (0..times).flat_map(shifted).collect();
        Self { path, release: f64::INFINITY, ..self }
    }

    /// The set-point in rad at a time in s: smoothly from point to point.
    pub fn position(&self, time: f64) -> f64 {
        let next = self.path.partition_point(|&(at, _)| at <= time);
        let (Some(&(begin, from)), Some(&(end, to))) =
            (self.path.get(next.wrapping_sub(1)), self.path.get(next))
        else {
            let end = if next == 0 { self.path.first() } else { self.path.last() };
            return end.map_or(0.0, |&(_, position)| position);
        };
        let s = (time - begin) / (end - begin);
        // The cubic whose speed is zero at both ends.
        from + (to - from) * s * s * (3.0 - 2.0 * s)
    }

    /// The set-point over the tick from `start` to `end` in s.
    pub fn setpoint(&self, start: f64, end: f64) -> HandSetpoint {
        HandSetpoint { from: self.position(start), to: self.position(end) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_goes_through_its_points_and_rests_at_its_ends() {
        let trajectory = HandTrajectory::push_and_let_go();
        for &(time, position) in &trajectory.path {
            assert!((trajectory.position(time) - position).abs() < 1e-15);
        }
        assert_eq!(trajectory.position(0.0), 0.0);
        assert_eq!(trajectory.position(99.0), 0.12);
    }

    #[test]
    fn what_is_done_over_and_over_is_the_same_each_time() {
        let (once, often) = (
            HandTrajectory::push_and_let_go(),
            HandTrajectory::push_and_let_go().repeated_until(60.0),
        );
        for time in [0.3, 1.0, 3.0] {
            for n in 0..10 {
                let again = often.position(time + 3.75 * f64::from(n));
                assert!((again - once.position(time)).abs() < 1e-12, "{time} s, time {n}");
            }
        }
        assert!(often.path.last().unwrap().0 >= 59.0 && often.release > 60.0);
        assert!(often.path.windows(2).all(|two| two[0].0 < two[1].0));
    }
}
