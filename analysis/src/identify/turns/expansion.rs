//! A number that is a Fourier series in the angle beside a few others, from rows of whole turns: which
//! harmonics stand out of the noise, their amplitudes, and their uncertainty.
//!
//! Over a whole turn the harmonics are orthogonal to each other and to all that does not depend on the angle,
//! where each row counts by the angle that it stands for. Noise and effects without a model differ from turn to
//! turn, so the uncertainty is that of leaving out one turn at a time (the jackknife), without an assumption
//! about the noise within a turn.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use nalgebra::{Complex, DMatrix, DVector};

use crate::identify::profile::student;

/// Largest number of numbers beside the series.
pub const BASES: usize = 5;

/// Probability that a harmonic is found in a record that has none.
const FALSE_ALARM: f64 = 0.01;
/// Part of the largest amplitude found in a round that a harmonic needs to be taken in it: less may have leaked
/// from the largest, because the rows of a turn are not quite evenly spaced.
const LEAKS: f64 = 0.3;
/// Highest harmonic of the first range in which harmonics are looked for; each further one is an octave.
const FIRST: u32 = 16;
/// Largest number of rounds, each with at least one harmonic more.
const ROUNDS: usize = 24;
/// Largest number of harmonics.
const MOST: usize = 48;
/// Smallest variance of a turn, as a part of that of all: below it a turn does not count more.
const LEAST_VARIANCE: f64 = 0.2;

/// One row: `value` is the sum of the numbers by their `bases`, and of the series at the angle.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The turn that it belongs to, counted from 0.
    pub turn: usize,
    pub value: f64,
    /// Factors of the numbers beside the series.
    pub bases: [f64; BASES],
    /// The same with noise that is independent of that of `value` and `bases`, so that noise does not make a
    /// number smaller (instrumental variables).
    pub instruments: [f64; BASES],
    /// Angle in rad.
    pub angle: f64,
    /// Direction of the motion, 1 or -1.
    pub sign: f64,
    /// Velocity in rad/s.
    pub velocity: f64,
    /// Angle in rad that the row stands for.
    pub weight: f64,
    /// Half of the angle in rad of the two windows of a mean over which the row was taken, one after the other:
    /// it lowers harmonic `n` by `sinc^2(n reach)`. 0: the row is of one angle.
    pub reach: f64,
}

/// The part of a series that a mean over a window leaves.
fn left(order: f64, reach: f64) -> f64 {
    let phase = order * reach;
    if phase.abs() < 1e-6 { 1.0 } else { (phase.sin() / phase).powi(2) }
}

/// The means of cosine and sine of a harmonic over a row's window at a steady speed.
fn steady(row: &Row) -> impl Fn(u32) -> [f64; 2] {
    let &Row { angle, reach, .. } = row;
    move |order| {
        let order = f64::from(order);
        let (sine, cosine) = (order * angle).sin_cos();
        let part = left(order, reach);
        [part * cosine, part * sine]
    }
}

/// Means of cosine and sine of harmonics over the windows of all rows, for the motion in them.
pub type Means = BTreeMap<u32, Vec<[f64; 2]>>;

/// A series and the numbers beside it.
#[derive(Clone, Debug)]
pub struct Expansion {
    bases: usize,
    /// Harmonics of the part that is the same in both directions.
    pub even: Vec<u32>,
    /// Harmonics of the part that changes its sign with the direction. Each is there again in proportion to the
    /// speed: damping over an angle that the encoder does not quite show.
    pub odd: Vec<u32>,
    /// Harmonics in proportion to the square of the speed.
    fast: Vec<u32>,
    /// Ranges of harmonics, by their highest.
    pub floors: Vec<Floor>,
    /// Largest root mean square of all harmonics of the even part together that were not found, up to
    /// [`Self::top`], at the confidence of the intervals; 0 where nobody has [looked](Self::refined).
    pub left_out: f64,
    values: DVector<f64>,
    /// What the values become without each of the turns, less the values.
    without: Vec<DVector<f64>>,
    quantile: f64,
}

/// What would not have stood out of the noise.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Floor {
    /// Highest harmonic of a range that begins behind that of the range before.
    pub highest: u32,
    /// Largest amplitude of a harmonic of the range that would not have been found.
    pub amplitude: f64,
}

/// The quantities of the fit.
#[derive(Clone, Copy, Debug)]
pub struct Sought<'a> {
    /// Number of numbers beside the series.
    pub bases: usize,
    /// Harmonics that are there in any case.
    pub certain: &'a [u32],
    /// The same, in proportion to the square of the speed.
    pub fast: &'a [u32],
    /// Highest harmonic.
    pub highest: u32,
    /// Highest harmonic of the part that changes its sign.
    pub highest_odd: u32,
}

/// Normal equations of one turn, in which instruments stand for the factors on one side.
#[derive(Clone, Debug)]
struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

impl Normal {
    fn zero(unknowns: usize) -> Self {
        let (matrix, right) = (DMatrix::zeros(unknowns, unknowns), DVector::zeros(unknowns));
        Self { matrix, right }
    }
}

/// Amplitudes of the harmonics of residuals in each turn.
struct Spectrum {
    /// Statistic, amplitude and order of each, of the even part and of the odd part.
    even: Vec<Peak>,
    odd: Vec<Peak>,
}

#[derive(Clone, Copy, Debug)]
struct Peak {
    order: u32,
    amplitude: f64,
    /// Amplitude above which it stands out of the noise.
    threshold: f64,
    /// Mean square of the amplitude that noise alone has.
    noise: f64,
}

impl Expansion {
    /// The series of the rows that `rows_for` makes for a highest harmonic. The rows of a lower one may be of
    /// longer windows, with less noise. `None` where the rows do not determine the numbers.
    ///
    /// The strongest harmonics are found first, because they leak into all others.
    pub fn of(rows_for: impl Fn(u32) -> Vec<Row>, sought: &Sought<'_>) -> Option<Self> {
        let &Sought { bases, certain, highest, .. } = sought;
        let nothing = Self {
            bases,
            even: certain.to_vec(),
            odd: vec![],
            fast: sought.fast.to_vec(),
            floors: vec![],
            left_out: 0.0,
            values: DVector::zeros(0),
            without: vec![],
            quantile: 0.0,
        };
        let rows = rows_for(highest);
        let turns = rows.iter().map(|row| row.turn + 1).max()?;
        let begin = nothing.fitted(&rows, None, &vec![1.0; turns])?;
        let (mut found, _) = begin.with_more(&rows, 1..=highest, 0)?;
        let tops = (FIRST.ilog2()..).map(|power| (1 << power).min(highest));
        let mut floors: Vec<Floor> = Vec::new();
        for top in tops {
            let lowest = floors.last().map_or(1, |floor| floor.highest + 1);
            if lowest > top {
                break;
            }
            let (more, spectrum) =
                found.with_more(&rows_for(top), lowest..=top, sought.highest_odd)?;
            found = more;
            floors.push(Floor { highest: top, amplitude: spectrum.floor() });
        }
        found.floors = floors;
        Some(found)
    }

    /// The same with harmonics of a range that stand out of these rows, and the spectrum of the others.
    fn with_more(
        self,
        rows: &[Row],
        range: RangeInclusive<u32>,
        highest_odd: u32,
    ) -> Option<(Self, Spectrum)> {
        let mut found = self.again(rows)?;
        let mut rounds = 0;
        loop {
            let residuals: Vec<f64> = rows.iter().map(|row| row.value - found.at(row)).collect();
            let shares = shares_of(rows, &residuals, found.without.len());
            let spectrum = Spectrum::of(rows, &residuals, &shares, range.clone());
            let (more_even, more_odd) = spectrum.besides(&found, highest_odd);
            let (mut even, mut odd) = (found.even.clone(), found.odd.clone());
            even.extend(&more_even);
            odd.extend(&more_odd);
            let has_more = even.len() + odd.len() > found.even.len() + found.odd.len();
            if !has_more || even.len() + odd.len() > MOST || rounds == ROUNDS {
                return Some((found, spectrum));
            }
            found = Self { even, odd, ..found }.fitted(rows, None, &shares)?;
            rounds += 1;
        }
    }

    /// The same in other rows of the same turns, with further harmonics up to [`Self::top`] that stand out there.
    pub fn refined(self, rows: &[Row], highest_odd: u32) -> Option<Self> {
        let range = 1..=self.top();
        let (found, spectrum) = self.with_more(rows, range, highest_odd)?;
        Some(Self { left_out: spectrum.left_out(&found), ..found })
    }

    /// The end of the range of harmonics in which the highest is that was found.
    pub fn top(&self) -> u32 {
        let steepest = self.steepest();
        let holds = |floor: &&Floor| floor.highest >= steepest;
        self.floors.iter().find(holds).map_or(steepest, |floor| floor.highest)
    }

    /// The highest harmonic that was found, 1 without any.
    pub fn steepest(&self) -> u32 {
        self.even.iter().chain(&self.odd).max().map_or(1, |order| *order)
    }

    /// All harmonics.
    pub fn orders(&self) -> impl Iterator<Item = u32> {
        self.even.iter().chain(&self.odd).chain(&self.fast).copied()
    }

    /// The same harmonics in other rows of the same turns.
    pub fn again(&self, rows: &[Row]) -> Option<Self> {
        self.again_over(rows, None)
    }

    /// The same with the means of all harmonics over the windows of the rows, in place of those at a steady speed.
    pub fn again_over(&self, rows: &[Row], means: Option<&Means>) -> Option<Self> {
        let residuals: Vec<f64> = rows.iter().map(|row| row.value - self.at(row)).collect();
        let shares = shares_of(rows, &residuals, self.without.len());
        self.clone().fitted(rows, means, &shares)
    }

    /// The same harmonics, of these rows; turns count by their shares.
    fn fitted(self, rows: &[Row], means: Option<&Means>, shares: &[f64]) -> Option<Self> {
        let bases = self.bases;
        let unknowns = bases + 2 * (self.even.len() + 2 * self.odd.len() + self.fast.len());
        let freedom = shares.len() as f64 - bases as f64;
        if freedom < 1.0 {
            return None;
        }
        let (values, without) = (DVector::zeros(unknowns), Vec::new());
        let mut found = Self { values, without, quantile: student(freedom), ..self };
        let mut turns = vec![Normal::zero(unknowns); shares.len()];
        let (mut factors, mut instruments) = (vec![0.0; unknowns], vec![0.0; unknowns]);
        for (number, row) in rows.iter().enumerate() {
            match means {
                None => found.factors(row, steady(row), &mut factors),
                Some(means) => found.factors(row, |order| means[&order][number], &mut factors),
            }
            instruments.copy_from_slice(&factors);
            instruments[..bases].copy_from_slice(&row.instruments[..bases]);
            let turn = &mut turns[row.turn];
            let weight = row.weight * shares[row.turn];
            let factors = DVector::from_column_slice(&factors);
            let instruments = DVector::from_column_slice(&instruments);
            turn.matrix.ger(weight, &instruments, &factors, 1.0);
            turn.right.axpy(weight * row.value, &instruments, 1.0);
        }
        let mut all = Normal::zero(unknowns);
        for turn in &turns {
            all.matrix += &turn.matrix;
            all.right += &turn.right;
        }
        // In units in which each factor is near 1.
        let units = all.matrix.diagonal().map(|square| square.abs().sqrt().recip());
        let solved = |sum: &Normal| -> Option<DVector<f64>> {
            let scale = DMatrix::from_diagonal(&units);
            let matrix = &scale * &sum.matrix * &scale;
            let solution = matrix.lu().solve(&(&scale * &sum.right))?;
            let values = &scale * solution;
            values.iter().all(|value| value.is_finite()).then_some(values)
        };
        found.values = solved(&all)?;
        let mut without = Vec::with_capacity(turns.len());
        for turn in &turns {
            let rest =
                Normal { matrix: &all.matrix - &turn.matrix, right: &all.right - &turn.right };
            without.push(solved(&rest)? - &found.values);
        }
        found.without = without;
        Some(found)
    }

    /// Factors of all numbers, those of the series included, by the means of cosine and sine of a harmonic.
    fn factors(&self, row: &Row, mean: impl Fn(u32) -> [f64; 2], factors: &mut [f64]) {
        factors[..self.bases].copy_from_slice(&row.bases[..self.bases]);
        let even = self.even.iter().map(|order| (*order, 1.0));
        let odd = self.odd.iter().map(|order| (*order, row.sign));
        let moving = self.odd.iter().map(|order| (*order, row.velocity));
        let fast = self.fast.iter().map(|order| (*order, row.velocity * row.velocity));
        let all = even.chain(odd).chain(moving).chain(fast);
        for (pair, (order, factor)) in factors[self.bases..].chunks_exact_mut(2).zip(all) {
            let [cosine, sine] = mean(order);
            (pair[0], pair[1]) = (factor * cosine, factor * sine);
        }
    }

    /// The fitted value of a row.
    pub fn at(&self, row: &Row) -> f64 {
        let mut factors = vec![0.0; self.values.len()];
        self.factors(row, steady(row), &mut factors);
        factors.iter().zip(self.values.iter()).map(|(factor, value)| factor * value).sum()
    }

    /// The part of the series in that.
    pub fn series_in(&self, row: &Row) -> f64 {
        let numbers = row.bases[..self.bases].iter().zip(self.values.iter());
        self.at(row) - numbers.map(|(factor, value)| factor * value).sum::<f64>()
    }

    /// A number beside the series, and half of its interval.
    pub fn number(&self, base: usize) -> [f64; 2] {
        let mut factors = vec![0.0; self.values.len()];
        factors[base] = 1.0;
        self.combined(&factors)
    }

    /// Amplitude of a harmonic of the even part, and half of its interval.
    pub fn amplitude(&self, index: usize) -> [f64; 2] {
        let at = self.bases + 2 * index;
        let [cosine, sine] = [self.values[at], self.values[at + 1]];
        let amplitude = cosine.hypot(sine);
        let mut factors = vec![0.0; self.values.len()];
        (factors[at], factors[at + 1]) = (cosine / amplitude, sine / amplitude);
        [amplitude, self.combined(&factors)[1]]
    }

    /// Phase in rad of a harmonic of the even part, as a sine.
    pub fn phase(&self, index: usize) -> f64 {
        let at = self.bases + 2 * index;
        self.values[at].atan2(self.values[at + 1])
    }

    /// A part of the series at an angle in rad, and half of its interval.
    pub fn series(&self, part: Part, angle: f64) -> [f64; 2] {
        let mut factors = vec![0.0; self.values.len()];
        let (base, orders, first, is_slope) = match part {
            Part::Even(base) => (Some(base), &self.even, 0, false),
            Part::Odd(base) => (Some(base), &self.odd, self.even.len(), false),
            Part::Series => (None, &self.even, 0, false),
            Part::Slope => (None, &self.even, 0, true),
        };
        if let Some(base) = base {
            factors[base] = 1.0;
        }
        for (index, order) in orders.iter().enumerate() {
            let at = self.bases + 2 * (first + index);
            let order = f64::from(*order);
            let (sine, cosine) = (order * angle).sin_cos();
            (factors[at], factors[at + 1]) =
                if is_slope { (-order * sine, order * cosine) } else { (cosine, sine) };
        }
        self.combined(&factors)
    }

    fn combined(&self, factors: &[f64]) -> [f64; 2] {
        let sum = |values: &DVector<f64>| -> f64 {
            factors.iter().zip(values.iter()).map(|(factor, value)| factor * value).sum()
        };
        let turns = self.without.len() as f64;
        let squares: f64 = self.without.iter().map(|without| sum(without).powi(2)).sum();
        [sum(&self.values), self.quantile * ((turns - 1.0) / turns * squares).sqrt()]
    }
}

/// A part of a series.
#[derive(Clone, Copy, Debug)]
pub enum Part {
    /// That which is the same in both directions, and this number.
    Even(usize),
    /// That which changes its sign, and this number.
    Odd(usize),
    /// That which is the same in both directions, alone.
    Series,
    /// Its slope over the angle.
    Slope,
}

/// How much the rows of each turn count: by the variance of its residuals.
fn shares_of(rows: &[Row], residuals: &[f64], turns: usize) -> Vec<f64> {
    let (mut squares, mut weights) = (vec![0.0; turns], vec![0.0; turns]);
    for (row, residual) in rows.iter().zip(residuals) {
        squares[row.turn] += row.weight * residual * residual;
        weights[row.turn] += row.weight;
    }
    let mean = squares.iter().sum::<f64>() / weights.iter().sum::<f64>();
    if mean.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
        return vec![1.0; turns];
    }
    let variances = squares.iter().zip(&weights).map(|(squares, weight)| squares / weight);
    variances.map(|variance| mean / variance.max(LEAST_VARIANCE * mean)).collect()
}

impl Spectrum {
    fn of(rows: &[Row], residuals: &[f64], shares: &[f64], range: RangeInclusive<u32>) -> Self {
        let lowest = *range.start();
        let (orders, turns) = (range.clone().count(), shares.len());
        let none = Complex::from(0.0);
        let (mut sums, mut weights) = (vec![none; orders * turns], vec![0.0; orders * turns]);
        let mut signs = vec![1.0; turns];
        for (row, residual) in rows.iter().zip(residuals) {
            signs[row.turn] = row.sign;
            let one = Complex::from_polar(1.0, -row.angle);
            let mean = Complex::from_polar(1.0, row.reach);
            let first = f64::from(lowest);
            let mut at = Complex::from_polar(1.0, -first * row.angle);
            let mut window = Complex::from_polar(1.0, first * row.reach);
            for index in 0..orders {
                let phase = (first + index as f64) * row.reach;
                let part = if phase < 1e-6 { 1.0 } else { (window.im / phase).powi(2) };
                let place = row.turn * orders + index;
                sums[place] += at * (row.weight * part * residual);
                weights[place] += row.weight * part * part;
                at *= one;
                window *= mean;
            }
        }
        let peak = |order: u32, is_odd: bool| {
            let place = |turn: usize| turn * orders + (order - lowest) as usize;
            let sign = |turn: usize| if is_odd { signs[turn] } else { 1.0 };
            let all: f64 = (0..turns).map(|turn| shares[turn] * weights[place(turn)]).sum();
            let of = |turn: usize| sums[place(turn)] * (sign(turn) * shares[turn]);
            let mean = (0..turns).map(of).sum::<Complex<f64>>() / all;
            let off = |turn: usize| of(turn) - mean * (shares[turn] * weights[place(turn)]);
            let squares: f64 = (0..turns).map(|turn| off(turn).norm_sqr()).sum();
            let freedom = 2.0 * (turns as f64 - 1.0);
            let variance = squares / (all * all) * turns as f64 / (turns as f64 - 1.0);
            // Fisher's distribution with two and `freedom` degrees of freedom, for all harmonics of both parts.
            let chance = FALSE_ALARM / (2.0 * orders as f64);
            let quantile = 0.5 * freedom * (chance.powf(-2.0 / freedom) - 1.0);
            // The amplitude of a real series is twice that of its complex part. The variance is that of both
            // components, the quantile for the mean of the two.
            let (amplitude, threshold) = (2.0 * mean.norm(), 2.0 * (variance * quantile).sqrt());
            Peak { order, amplitude, threshold, noise: 4.0 * variance }
        };
        let peaks = |is_odd| range.clone().map(|order| peak(order, is_odd)).collect();
        Self { even: peaks(false), odd: peaks(true) }
    }

    /// The harmonics of a round, besides those found before.
    fn besides(&self, found: &Expansion, highest_odd: u32) -> (Vec<u32>, Vec<u32>) {
        let stands_out = |peak: &&Peak| peak.amplitude > peak.threshold;
        let is_new = |known: &[u32], peak: &Peak| !known.contains(&peak.order);
        let even = self.even.iter().filter(|peak| is_new(&found.even, peak)).filter(stands_out);
        let may_be_odd = |peak: &&Peak| peak.order <= highest_odd && is_new(&found.odd, peak);
        let odd = self.odd.iter().filter(may_be_odd).filter(stands_out);
        let most = even.clone().chain(odd.clone()).map(|peak| peak.amplitude).fold(0.0, f64::max);
        let is_large = |peak: &&Peak| peak.amplitude >= LEAKS * most;
        let orders = |peak: &Peak| peak.order;
        (even.filter(is_large).map(orders).collect(), odd.filter(is_large).map(orders).collect())
    }

    /// Upper end of the interval of the root mean square of all harmonics together that were not found.
    fn left_out(&self, found: &Expansion) -> f64 {
        let left = self.even.iter().filter(|peak| !found.even.contains(&peak.order));
        let (mut power, mut variance) = (0.0, 0.0);
        for Peak { amplitude, noise, .. } in left {
            let own = 0.5 * (amplitude * amplitude - noise);
            power += own;
            // Of the power of noise, and of noise beside a harmonic.
            variance += 0.25 * noise * noise + noise * own;
        }
        // Many harmonics: their sum is nearly normal.
        (power.max(0.0) + student(1e6) * variance.max(0.0).sqrt()).sqrt()
    }

    /// Largest amplitude that would not have stood out.
    fn floor(&self) -> f64 {
        self.even.iter().map(|peak| peak.threshold).fold(0.0, f64::max)
    }
}
