//! The last seconds of a board.

use std::collections::VecDeque;

use haptic_servo::torque::LimitReason;

use super::sample::Sample;

/// The last seconds of a board.
#[derive(Clone, Debug)]
pub struct History {
    samples: VecDeque<Sample>,
    window: f64,
}

impl History {
    /// Keeps the samples of the last `window` seconds.
    pub fn new(window: f64) -> Self {
        Self { samples: VecDeque::new(), window }
    }

    /// Length in s.
    pub fn window(&self) -> f64 {
        self.window
    }

    /// Adds a sample and drops samples that are too old. A tick below the last one shows that the board was
    /// restarted: all earlier samples are dropped.
    pub fn push(&mut self, sample: Sample) {
        if self.samples.back().is_some_and(|last| sample.tick < last.tick) {
            self.samples.clear();
        }
        self.samples.push_back(sample);
        let oldest = sample.time - self.window;
        while self.samples.front().is_some_and(|first| first.time < oldest) {
            self.samples.pop_front();
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// The last sample.
    pub fn last(&self) -> Option<&Sample> {
        self.samples.back()
    }

    /// Points of a curve, at most two for each of `columns`: the smallest and the largest value of each, so
    /// that no peak is lost. Times are in s relative to the last sample: 0 or negative.
    pub fn curve(&self, columns: usize, value: impl Fn(&Sample) -> f64) -> Vec<(f64, f64)> {
        let Some(last) = self.last() else { return Vec::new() };
        let width = self.window / columns.max(1) as f64;
        let mut points: Vec<(f64, f64)> = Vec::with_capacity(2 * columns);
        let mut column = None;
        for sample in &self.samples {
            let (time, value) = (sample.time - last.time, value(sample));
            let of = Some((-time / width) as i64);
            if column == of
                && let [.., low, high] = points.as_mut_slice()
            {
                if value < low.1 {
                    *low = (time, value);
                } else if value > high.1 {
                    *high = (time, value);
                }
                continue;
            }
            column = of;
            points.extend([(time, value); 2]);
        }
        points
    }

    /// Smallest and largest value.
    pub fn range(&self, value: impl Fn(&Sample) -> f64) -> Option<(f64, f64)> {
        self.samples.iter().map(value).fold(None, |range, value| match range {
            None => Some((value, value)),
            Some((low, high)) => Some((value.min(low), value.max(high))),
        })
    }

    /// The reasons for limited torques, each with its share of the samples, the most frequent first.
    pub fn limits(&self) -> Vec<(LimitReason, f64)> {
        let mut counts: Vec<(LimitReason, usize)> = Vec::new();
        for sample in &self.samples {
            match counts.iter_mut().find(|(reason, _)| *reason == sample.limit) {
                Some((_, count)) => *count += 1,
                None => counts.push((sample.limit, 1)),
            }
        }
        counts.retain(|(reason, _)| *reason != LimitReason::None);
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let all = self.samples.len() as f64;
        counts.into_iter().map(|(reason, count)| (reason, count as f64 / all)).collect()
    }
}
