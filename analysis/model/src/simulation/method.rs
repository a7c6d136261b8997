//! From continuous time to one tick, by the exact exponential or by a common approximate method.
//!
//! Every method is linear, so over a step it is a matrix, and over a tick a power of that matrix. Beside the
//! plant's states the matrix has the held inputs, and the sine torque of the hand with its cosine, whose
//! values within a step are exact in all methods.

use haptic_servo::words;
use nalgebra::{DMatrix, DVector, Matrix2, linalg::balancing};

use super::plant::{INPUTS, Input, Plant};

words! {
    /// A method of integration, in one word for arguments.
    #[derive(Default)]
    #[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
    Method {
        /// Matrix exponential: exact for every step.
        #[default]
        Exact "exact",
        /// Explicit Euler: all states from the derivatives at the start of the step.
        Euler "euler",
        /// Semi-implicit Euler: the positions from the velocities at the end of the step.
        SemiImplicit "semi-implicit",
        /// Fourth-order Runge-Kutta.
        Rk4 "rk4",
        /// Trapezoidal rule.
        Tustin "tustin",
    }
}

impl Method {
    /// Its name in the literature.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact exponential",
            Self::Euler => "explicit Euler",
            Self::SemiImplicit => "semi-implicit Euler",
            Self::Rk4 => "Runge-Kutta of order 4",
            Self::Tustin => "Tustin",
        }
    }
}

/// Row of the sine behind the states and the held inputs; its cosine is the next.
const SINE: usize = INPUTS;
/// Rows behind the states.
const DRIVE: usize = INPUTS + 2;

/// One step of `h` s of states, held inputs, sine and cosine: a square matrix of as many rows as
/// the plant has states, and five. `omega` in rad/s is that of the sine torque of the hand.
pub fn step(plant: &Plant, method: Method, omega: f64, h: f64) -> DMatrix<f64> {
    let n = plant.order();
    let states = match method {
        Method::Exact => return exponential(plant, omega, h),
        Method::Euler => euler(plant, h),
        Method::SemiImplicit => semi_implicit(plant, h),
        Method::Rk4 => runge_kutta(plant, omega, h),
        Method::Tustin => trapezoidal(plant, omega, h),
    };
    let mut step = DMatrix::identity(n + DRIVE, n + DRIVE);
    step.view_mut((0, 0), (n, n + DRIVE)).copy_from(&states);
    step.view_mut((n, n), (DRIVE, DRIVE)).copy_from(&drive(omega, h));
    step
}

/// `count` steps in a row.
pub fn repeated(step: &DMatrix<f64>, count: u32) -> DMatrix<f64> {
    let (mut result, mut square) = (DMatrix::identity(step.nrows(), step.ncols()), step.clone());
    let mut left = count;
    while left > 0 {
        if left & 1 == 1 {
            result = &square * result;
        }
        square = &square * &square;
        left >>= 1;
    }
    result
}

/// The inputs after `h` s: held, and the oscillator turned.
fn drive(omega: f64, h: f64) -> DMatrix<f64> {
    let mut drive = DMatrix::identity(DRIVE, DRIVE);
    drive.fixed_view_mut::<2, 2>(SINE, SINE).copy_from(&rotation(omega * h));
    drive
}

/// Sine and cosine after an angle in rad.
pub(super) fn rotation(angle: f64) -> Matrix2<f64> {
    let (s, c) = angle.sin_cos();
    Matrix2::new(c, s, -s, c)
}

/// `[A | B]` with a column for each of the inputs, the sine, and its cosine.
fn rates(plant: &Plant) -> DMatrix<f64> {
    let n = plant.order();
    let mut rates = DMatrix::zeros(n, n + DRIVE);
    rates.view_mut((0, 0), (n, n)).copy_from(plant.rates());
    rates.view_mut((0, n), (n, INPUTS)).copy_from(plant.inputs());
    rates.column_mut(n + SINE).copy_from(&plant.inputs().column(Input::Hand as usize));
    rates
}

/// The states of the whole, unchanged.
fn kept(plant: &Plant) -> DMatrix<f64> {
    DMatrix::identity(plant.order(), plant.order() + DRIVE)
}

/// `[A | B]` with the inputs as they are `h` s later.
fn rates_after(plant: &Plant, omega: f64, h: f64) -> DMatrix<f64> {
    let n = plant.order();
    let mut rates = rates(plant);
    let inputs = rates.columns(n, DRIVE) * drive(omega, h);
    rates.columns_mut(n, DRIVE).copy_from(&inputs);
    rates
}

fn euler(plant: &Plant, h: f64) -> DMatrix<f64> {
    kept(plant) + rates(plant) * h
}

fn semi_implicit(plant: &Plant, h: f64) -> DMatrix<f64> {
    let mut step = euler(plant, h);
    for mass in 0..plant.masses() {
        let (position, velocity) = (2 * mass, 2 * mass + 1);
        // A mass that friction holds in place has no velocity.
        let moves = plant.rates()[(position, velocity)];
        let row = kept(plant).row(position) + step.row(velocity) * (moves * h);
        step.row_mut(position).copy_from(&row);
    }
    step
}

fn runge_kutta(plant: &Plant, omega: f64, h: f64) -> DMatrix<f64> {
    let (n, a, kept) = (plant.order(), plant.rates(), kept(plant));
    let at = |later: f64, state: DMatrix<f64>| {
        let mut rates = rates_after(plant, omega, later);
        rates.columns_mut(0, n).fill(0.0);
        a * state + rates
    };
    let k1 = at(0.0, kept.clone());
    let k2 = at(0.5 * h, &kept + &k1 * (0.5 * h));
    let k3 = at(0.5 * h, &kept + &k2 * (0.5 * h));
    let k4 = at(h, &kept + &k3 * h);
    kept + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0)
}

fn trapezoidal(plant: &Plant, omega: f64, h: f64) -> DMatrix<f64> {
    let n = plant.order();
    let identity = DMatrix::identity(n, n);
    let implicit = &identity - plant.rates() * (0.5 * h);
    let mut later = rates_after(plant, omega, h);
    later.columns_mut(0, n).fill(0.0);
    let explicit = kept(plant) + (rates(plant) + later) * (0.5 * h);
    // The damped masses and springs have no pole in the right half-plane, so 1 - A h / 2 can be inverted; if
    // overflow prevents it, the result is NaN.
    implicit.lu().solve(&explicit).unwrap_or_else(|| explicit * f64::NAN)
}

/// Balances a matrix in place for its exponential or its eigenvalues; returns the scales of its rows. `None`
/// where the squares of its numbers overflow: their sizes cannot be compared.
pub(crate) fn balance(matrix: &mut DMatrix<f64>) -> Option<DVector<f64>> {
    const LARGEST: f64 = 1e150;
    let in_range = matrix.iter().all(|entry| entry.abs() <= LARGEST);
    in_range.then(|| balancing::balance_parlett_reinsch(matrix))
}

/// Largest product of a rate and the length of the step of which the exponential can be computed: it needs
/// tenth powers.
const FASTEST: f64 = 1e25;

/// The exponential of the whole generator, after it is brought to entries of similar size: a
/// common factor 1/m of the inputs would cost as many digits as it has. It is NaN where the machine
/// is too fast for its numbers.
fn exponential(plant: &Plant, omega: f64, h: f64) -> DMatrix<f64> {
    let n = plant.order();
    let mut states = plant.rates() * h;
    let scales = balance(&mut states);
    let Some(balance) = scales.filter(|_| states.amax() <= FASTEST) else {
        return DMatrix::from_element(n + DRIVE, n + DRIVE, f64::NAN);
    };
    let mut inputs = rates(plant).columns(n, DRIVE) * h;
    for (mut row, scale) in inputs.row_iter_mut().zip(balance.iter()) {
        row.scale_mut(1.0 / scale);
    }
    let size = inputs.amax();
    let scale = if size > 0.0 { 2_f64.powi(size.log2().ceil() as i32) } else { 1.0 };
    inputs.scale_mut(1.0 / scale);
    let mut generator = DMatrix::zeros(n + DRIVE, n + DRIVE);
    generator.view_mut((0, 0), (n, n)).copy_from(&states);
    generator.view_mut((0, n), (n, DRIVE)).copy_from(&inputs);
    generator[(n + SINE, n + SINE + 1)] = omega * h;
    generator[(n + SINE + 1, n + SINE)] = -omega * h;
    let mut step = generator.exp();
    for (i, rows) in balance.iter().enumerate() {
        for (j, columns) in balance.iter().enumerate() {
            step[(i, j)] *= rows / columns;
        }
        for j in n..n + DRIVE {
            step[(i, j)] *= rows * scale;
        }
    }
    // Known without rounding.
    step.view_mut((n, n), (DRIVE, DRIVE)).copy_from(&drive(omega, h));
    step
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Link, Mass};
    use crate::device::Hand;
    use haptic_servo::scene::Device;

    fn machine() -> Plant {
        let masses = [Mass { inertia: 1e-3, damping: 0.02 }, Mass { inertia: 2e-3, damping: 0.01 }];
        let hand = Hand { inertia: 1e-3, damping: 0.05, stiffness: 3.0 };
        let links = [Link { stiffness: 700.0, damping: 0.01 }];
        Plant::chain(&masses, &links).with_hand(hand).with_actuator_lag(2e-3)
    }

    #[test]
    fn every_method_approaches_the_exponential_with_its_order() {
        let (plant, omega, h) = (machine(), 30.0, 1e-3);
        let exact = step(&plant, Method::Exact, omega, h);
        let error = |method, count: u32| {
            let whole = repeated(&step(&plant, method, omega, h / f64::from(count)), count);
            (whole - &exact).view((0, 0), (plant.order(), exact.ncols())).amax()
        };
        for (method, order) in [
            (Method::Euler, 1),
            (Method::SemiImplicit, 1),
            (Method::Rk4, 4),
            (Method::Tustin, 2),
            (Method::Exact, 0),
        ] {
            let (coarse, fine) = (error(method, 64), error(method, 128));
            match order {
                0 => assert!(fine < 1e-11, "{fine}"),
                _ => {
                    let measured = (coarse / fine).log2();
                    assert!((measured - f64::from(order)).abs() < 0.12, "{method:?} {measured}");
                }
            }
        }
    }

    #[test]
    fn the_exponential_of_a_free_mass_is_its_closed_form() {
        for inertia in [1e-9, 2.2e-5, 1.0] {
            let (damping, h) = (0.022, 1e-3);
            let plant = Plant::rigid(Device { inertia, damping, passivity: None });
            let m = step(&plant, Method::Exact, 0.0, h);
            let a = damping / inertia * h;
            let gone = -(-a).exp_m1();
            let should = [
                (m[(0, 1)], gone * inertia / damping),
                (m[(1, 1)], (-a).exp()),
                (m[(1, 2)], gone / damping),
            ];
            for (is, should) in should {
                assert!((is - should).abs() <= 4e-15 * should.abs().max(1e-30), "{is} {should}");
            }
        }
    }
}
