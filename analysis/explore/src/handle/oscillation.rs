//! Detects an oscillation of the torque while the hand rests, with its amplitude and frequency.

use std::collections::VecDeque;

use serde::Serialize;

/// The window of the torque in s.
const WINDOW: f64 = 0.25;
/// The smallest and the largest number of ticks of the window.
const TICKS: [f64; 2] = [32.0, 16_384.0];
/// The smallest amplitude in steps of the DAC; smaller ones are steps of encoder and DAC.
const LEAST_STEPS: f64 = 3.0;
/// Smallest ratio of the amplitudes in the second half and in the whole window: a faster decay is the end of
/// a motion.
const LASTING: f64 = 0.8;
/// Fraction of the amplitude that the torque must exceed on both sides of its mean to count as a period.
const SIDE: f64 = 0.25;
/// Largest drift of the device between the halves of the window, relative to the range of its angles.
const DRIFT: f64 = 0.5;
/// Smallest number of periods in the window.
const LEAST_PERIODS: usize = 4;

/// An oscillation of the torque.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Oscillation {
    /// Half of the distance between its extremes, in N m.
    pub amplitude: f64,
    /// In Hz.
    pub frequency: f64,
    /// Encoder counts of the device's motion, peak to peak: if they are few, the loop hunts between steps of
    /// the encoder.
    pub counts: f64,
}

/// The last ticks since the hand moved.
#[derive(Clone, Debug)]
pub struct Watch {
    /// Torques in N m.
    torques: VecDeque<f64>,
    /// Angles of the device in rad.
    angles: VecDeque<f64>,
    ticks: usize,
    period: f64,
    least: f64,
    /// Angle of a count in rad.
    count: f64,
}

impl Watch {
    /// For a period in s, with the steps of the DAC in N m and of the encoder in rad.
    pub fn new(period: f64, step: f64, count: f64) -> Self {
        let ticks = (WINDOW / period).clamp(TICKS[0], TICKS[1]) as usize;
        Self {
            torques: VecDeque::new(),
            angles: VecDeque::new(),
            ticks,
            period,
            least: LEAST_STEPS * step,
            count,
        }
    }

    /// Adds torque in N m and angle in rad of a tick; earlier ticks are discarded unless the hand rests.
    pub fn add(&mut self, torque: f64, angle: f64, rests: bool) {
        for (values, value) in [(&mut self.torques, torque), (&mut self.angles, angle)] {
            if !rests {
                values.clear();
            } else {
                if values.len() == self.ticks {
                    values.pop_front();
                }
                values.push_back(value);
            }
        }
    }

    /// The oscillation of these torques, if it lasts.
    pub fn oscillation(&self) -> Option<Oscillation> {
        if self.torques.len() < self.ticks {
            return None;
        }
        let half = self.ticks / 2;
        if turns_on(&self.angles, half) {
            return None;
        }
        let (before, after) =
            (extremes(self.torques.range(..half)), extremes(self.torques.range(half..)));
        let amplitude = 0.5 * (after[1] - after[0]);
        if amplitude < self.least || amplitude < LASTING * 0.5 * (before[1] - before[0]) {
            return None;
        }
        let frequency = self.frequency(mean(self.torques.iter()), SIDE * amplitude)?;
        let [least, most] = extremes(self.angles.iter());
        Some(Oscillation { amplitude, frequency, counts: (most - least) / self.count })
    }

    /// By the times between the first and the last rise through the mean.
    fn frequency(&self, mean: f64, side: f64) -> Option<f64> {
        let (mut is_below, mut rises) = (false, Vec::new());
        for (tick, torque) in self.torques.iter().enumerate() {
            if *torque < mean - side {
                is_below = true;
            } else if is_below && *torque > mean + side {
                is_below = false;
                rises.push(tick);
            }
        }
        let (first, last) = (*rises.first()?, *rises.last()?);
        let periods = rises.len() - 1;
        (periods >= LEAST_PERIODS).then(|| periods as f64 / ((last - first) as f64 * self.period))
    }
}

/// Whether a device keeps turning, like a released knob from detent to detent.
fn turns_on(angles: &VecDeque<f64>, half: usize) -> bool {
    let [least, most] = extremes(angles.range(half..));
    (mean(angles.range(half..)) - mean(angles.range(..half))).abs() > DRIFT * (most - least)
}

fn mean<'a>(values: impl ExactSizeIterator<Item = &'a f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

fn extremes<'a>(torques: impl Iterator<Item = &'a f64>) -> [f64; 2] {
    torques.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], &torque| {
        [least.min(torque), most.max(torque)]
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn seen_turning(turning: f64, torque: impl Fn(f64) -> f64) -> Option<Oscillation> {
        let mut watch = Watch::new(1e-3, 1e-3, 1e-4);
        for tick in 0..400 {
            let time = f64::from(tick) * 1e-3;
            watch.add(torque(time), 0.01 * (TAU * 50.0 * time).sin() + turning * time, true);
        }
        watch.oscillation()
    }

    fn seen(torque: impl Fn(f64) -> f64) -> Option<Oscillation> {
        seen_turning(0.0, torque)
    }

    #[test]
    fn a_sine_is_seen_with_its_amplitude_and_frequency() {
        for frequency in [25.0, 73.0, 212.0] {
            let seen = seen(|time| 0.4 + 0.21 * (TAU * frequency * time).sin()).unwrap();
            assert!((seen.frequency / frequency - 1.0).abs() < 0.02, "{seen:?}");
            assert!((seen.counts - 200.0).abs() < 5.0, "{seen:?}");
            assert!((seen.amplitude / 0.21 - 1.0).abs() < 0.05, "{seen:?}");
        }
    }

    #[test]
    fn what_decays_or_drifts_or_is_a_step_of_the_converter_is_none() {
        assert_eq!(seen(|time| (-20.0 * time).exp() * (TAU * 100.0 * time).sin()), None);
        assert_eq!(seen(|time| time), None);
        assert_eq!(seen(|time| 2e-3 * (TAU * 100.0 * time).sin().signum()), None);
        assert_eq!(seen_turning(1.0, |time| (TAU * 100.0 * time).sin()), None);
        let mut watch = Watch::new(1e-3, 1e-3, 1e-4);
        for tick in 0..400 {
            // The hand moves in the middle.
            watch.add(f64::from(tick % 4), 0.0, tick != 200);
        }
        assert_eq!(watch.oscillation(), None);
    }
}
