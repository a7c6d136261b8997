//! The response of the device at one frequency, by least squares over one stretch of sine.

use haptic_servo::current::TorqueSource;
use nalgebra::{Complex, DMatrix, DVector};

use super::left_out::Reason;
use super::record::Record;
use super::step::Step;
use super::torque_source;

/// Data of the measurement besides the record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Angle in rad of one count.
    pub count_angle: f64,
    /// Time in s from a row's time until its torque is applied.
    pub torque_delay: f64,
    /// Time in s by which the counts of a row are older than its time.
    pub count_delay: f64,
    /// Part of each stretch that is left out at its beginning, until the transient has died out.
    pub settle: f64,
    /// Longest lag in s that the amplifier may have; half a period if `None`.
    pub longest_lag: Option<f64>,
    /// The current loop of the board's own bridge that made the torque; `None` where an amplifier made it.
    pub source: Option<TorqueSource>,
}

impl Correction {
    /// An encoder of `counts_per_turn`, no delays, and a quarter of each stretch to settle.
    pub fn of_encoder(counts_per_turn: f64) -> Self {
        let count_angle = std::f64::consts::TAU / counts_per_turn;
        Self {
            count_angle,
            torque_delay: 0.0,
            count_delay: 0.0,
            settle: 0.25,
            longest_lag: None,
            source: None,
        }
    }

    /// Both declared delays together, in s.
    pub fn delay(&self) -> f64 {
        self.torque_delay + self.count_delay
    }
}

/// Torque to velocity at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyPoint {
    /// Angular frequency in rad/s.
    pub omega: f64,
    /// `J(j omega)` in rad/(N m s).
    pub admittance: Complex<f64>,
    /// Standard deviation of the real and of the imaginary part of `1/J`, in N m s/rad.
    pub deviation: f64,
    /// Amplitude of the motion in counts.
    pub counts: f64,
    /// Amplitude of the velocity in rad/s.
    pub speed: f64,
    /// The first of its rows in the record, counted from 0.
    pub row: usize,
}

impl FrequencyPoint {
    /// `1/J` in N m s/rad: damping its real part, `omega` times inertia its imaginary part.
    pub fn impedance(&self) -> Complex<f64> {
        1.0 / self.admittance
    }
}

/// Largest part of a torque, as a root mean square, that may be something else than its sine.
const MOST_ELSE: f64 = 0.1;

/// The response over one stretch, or why it has none.
///
/// The torque is held from tick to tick, which makes the sine that the device feels smaller by
/// `sinc(w T/2)` and late by `T/2`; both are taken out, as are the declared delays. The images of
/// the held sine, which sampling folds back, stay in: see [`Model::images`].
///
/// [`Model::images`]: super::model::Model::images
pub fn single_bin(
    record: &Record,
    step: &Step,
    correction: &Correction,
) -> Result<FrequencyPoint, Reason> {
    let rows = step.settled(correction.settle);
    let angle = step.omega * record.period;
    let of_torque = phasor(&record.torque[rows.clone()], angle).ok_or(Reason::Still)?;
    let of_counts = phasor(&record.counts[rows], angle).ok_or(Reason::Still)?;
    let (torque, counts, deviation) = (of_torque.phasor, of_counts.phasor, of_counts.deviation);
    if of_torque.rest > MOST_ELSE * torque.norm() {
        return Err(Reason::NotOneSine(of_torque.rest / torque.norm()));
    }
    let half = 0.5 * angle;
    let late = half + step.omega * correction.delay();
    let applied = torque * (half.sin() / half) * Complex::from_polar(1.0, -late);
    let velocity = Complex::new(0.0, step.omega * correction.count_angle) * counts;
    let admittance = velocity / applied;
    let impedance = 1.0 / admittance;
    // The deviations of counts and torque, each relative to its amplitude.
    let amplitude = torque.norm();
    let of_torque = correction
        .source
        .map_or(0.0, |source| torque_source::deviation(&source, step.omega, amplitude) / amplitude);
    let deviation = impedance.norm() * (deviation / counts.norm()).hypot(of_torque);
    let usable = impedance.is_finite() && deviation.is_finite() && admittance.is_finite();
    let point = FrequencyPoint {
        omega: step.omega,
        admittance,
        deviation,
        counts: counts.norm(),
        speed: velocity.norm(),
        row: step.rows.start,
    };
    if usable { Ok(point) } else { Err(Reason::Still) }
}

/// `Re(p e^(j angle k))` fitted to the samples.
fn phasor(samples: &[f64], angle: f64) -> Option<FittedSine> {
    let (phasors, residual) = fitted_sines(samples, angle, 1)?;
    let rest = (2.0 * residual.norm_squared() / samples.len() as f64).sqrt();
    let deviation = deviation(residual.as_slice(), angle, phasors[0].norm());
    Some(FittedSine { phasor: phasors[0], deviation, rest })
}

/// The phasors of a sine and its harmonics, as many as `orders`, fitted to samples together with a parabola,
/// which a free device drifts along; and the residual.
pub(super) fn fitted_sines(
    samples: &[f64],
    angle: f64,
    orders: usize,
) -> Option<(Vec<Complex<f64>>, DVector<f64>)> {
    const DRIFT: usize = 3;
    let (n, unknowns) = (samples.len(), DRIFT + 2 * orders);
    if n <= unknowns {
        return None;
    }
    let regressors = DMatrix::from_fn(n, unknowns, |row, column| {
        if column < DRIFT {
            // Between -1 and 1, so that the columns are of one size.
            let time = 2.0 * row as f64 / (n - 1) as f64 - 1.0;
            return time.powi(column as i32);
        }
        let order = (column - DRIFT) / 2 + 1;
        let phase = order as f64 * angle * row as f64;
        if (column - DRIFT).is_multiple_of(2) { phase.cos() } else { -phase.sin() }
    });
    let values = DVector::from_column_slice(samples);
    let normal = (regressors.transpose() * &regressors).cholesky()?;
    let solution = normal.solve(&(regressors.transpose() * &values));
    let residual = values - regressors * &solution;
    let parts = solution.as_slice()[DRIFT..].chunks_exact(2);
    Some((parts.map(|part| Complex::new(part[0], part[1])).collect(), residual))
}

struct FittedSine {
    phasor: Complex<f64>,
    /// Standard deviation of its real and imaginary parts.
    deviation: f64,
    /// Amplitude of a sine with the power of the residual.
    rest: f64,
}

/// Deviation of a phasor, from the residuals at the neighbouring frequencies: the noise of a free device is a
/// random walk, so that its mean over all frequencies does not apply to one of them. Its amplitude falls with the
/// frequency, by which each neighbour's is corrected.
fn deviation(residual: &[f64], angle: f64, amplitude: f64) -> f64 {
    /// In steps of one period over the whole stretch; nearer than the first is the sine itself.
    const NEIGHBOURS: [f64; 8] = [-4.5, -3.5, -2.5, -1.5, 1.5, 2.5, 3.5, 4.5];
    /// Steps from zero below which the fitted parabola has taken most of the noise.
    const DRIFT: f64 = 2.0;
    let n = residual.len() as f64;
    let step = std::f64::consts::TAU / n;
    let neighbours = NEIGHBOURS.iter().map(|offset| angle + offset * step);
    let powers: Vec<f64> = neighbours
        .filter(|&near| near > DRIFT * step && near < std::f64::consts::PI)
        .map(|near| (2.0 / n * near / angle * bin(residual, near)).norm_sqr())
        .collect();
    // Two degrees of freedom a neighbour. A quotient by a variance that was estimated from so few is larger
    // than by the true variance.
    let freedom = 2.0 * powers.len().max(2) as f64;
    let power = 2.0 * powers.iter().sum::<f64>() / (freedom - 2.0);
    // At least the error of whole counts: 1/12 of a count squared. Repetition does not reduce it, since the
    // error is repeated with the phase.
    let distinct = distinct_errors(residual.len(), angle, amplitude);
    (0.5 * power).sqrt().max((1.0 / (6.0 * distinct)).sqrt())
}

/// Number of samples of a sine, of `amplitude` counts, with different rounding errors.
///
/// The phases of successive periods differ until that number of samples is a whole number of periods; of an
/// even number, one half has the errors of the other with the sign changed. A slow sine is rounded to the
/// same counts by neighbouring phases.
fn distinct_errors(samples: usize, angle: f64, amplitude: f64) -> f64 {
    const COUNTS_A_PERIOD: f64 = 4.0;
    let n = samples as f64;
    let turn = angle / std::f64::consts::TAU;
    let is_whole = |&count: &usize| {
        let turns = count as f64 * turn;
        (turns - turns.round()).abs() < 1.0 / n
    };
    let until_repeated = (1..samples).find(is_whole).unwrap_or(samples);
    let different = until_repeated >> usize::from(until_repeated.is_multiple_of(2));
    let in_a_period = n.min(1.0 / turn);
    in_a_period.max((different as f64).min(COUNTS_A_PERIOD * amplitude))
}

/// `sum of x_k e^(-j angle k)`.
fn bin(samples: &[f64], angle: f64) -> Complex<f64> {
    let turn = Complex::from_polar(1.0, -angle);
    let add = |sum: Complex<f64>, &sample: &f64| sum * turn + sample;
    // Horner from the last sample, so that one sine and one cosine serve for all.
    samples.iter().rev().fold(Complex::from(0.0), add)
}
