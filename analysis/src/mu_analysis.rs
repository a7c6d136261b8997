//! The structured singular value of a device, as the paper builds it (equations 5 to 16; theory,
//! section 3.1).
//!
//! The hand is `H = (1 - D)/(1 + D)` with `|D| <= 1`, the requirement of `delta`-output strict passivity is
//! `|2 delta J - 1| <= 1`; the star product of `M`, which holds the first, with the device, which is scaled
//! to hold the second, is the generalised plant `G_p`. A second block, `|D'| <= 1`, closes it, and the device
//! is `delta`-output strictly passive exactly if `mu(G_p) <= 1` at all frequencies.
//!
//! **This is a check, not a way to find `delta`.** For a rigid device `mu` is 1 for *every* `delta <= b`: a
//! search for the largest `delta` with `mu <= 1` walks on its own boundary, where the square root in `mu`
//! turns an error of the last bit into 1e-8. [`crate::chain::Chain::excess_passivity`] is the
//! answer.

use nalgebra::{Complex, Matrix2};
use serde::Serialize;

use crate::chain::two_port::TwoPort;
use crate::chain::{Chain, ExcessPassivity};

/// A complex 2x2 matrix: of two ports, the first towards the hand.
pub type Matrix = Matrix2<Complex<f64>>;

/// `G_p` at one frequency: from the outputs of the two contractions to their inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralizedPlant {
    matrix: Matrix,
}

impl GeneralizedPlant {
    /// Of a device at `omega` rad/s, greater than 0, and the required `delta` in N m s/rad. The encoder
    /// counts as being on the motor's mass, and the amplifier as without lag.
    pub fn at(chain: &Chain, delta: f64, omega: f64) -> Self {
        Self { matrix: star(&hand(), &scaled(&device(chain, omega), delta)) }
    }

    /// `mu` in closed form: `mu^2 = (f + sqrt(f^2 - 4 D0^2))/2`, `f = |G11|^2 + |G22|^2 +
    /// 2 |G12 G21|`, `D0 = |det G_p|`.
    pub fn mu(&self) -> f64 {
        let (f, determinant) = self.invariants();
        // f >= 2 D0; factored, so that equality is not lost twice.
        let root = ((f - 2.0 * determinant).max(0.0) * (f + 2.0 * determinant)).sqrt();
        (0.5 * (f + root)).sqrt()
    }

    /// `f` and `D0`.
    fn invariants(&self) -> (f64, f64) {
        let g = &self.matrix;
        let across = g[(0, 1)] * g[(1, 0)];
        let f = g[(0, 0)].norm_sqr() + g[(1, 1)].norm_sqr() + 2.0 * across.norm();
        (f, (g[(0, 0)] * g[(1, 1)] - across).norm())
    }
}

/// `mu` compared with a `delta` from another method: 1 there, except for the rounding error that the square
/// root enlarges, and greater above. Both are the largest over frequencies from far below the device's rates
/// to far above, including the frequency at which `delta` is reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Largest `mu` with `delta`.
    pub at_delta: f64,
    /// Largest `mu` with a `delta` that is greater by the part `by`.
    pub above: f64,
    /// The part.
    pub by: f64,
    /// Angular frequency in rad/s of `above`.
    pub omega: f64,
}

impl Check {
    /// Of a device whose `delta` was found; `None` where it is 0, and where no `mu` is a number.
    pub fn of(chain: &Chain, found: &ExcessPassivity) -> Option<Self> {
        /// Far more than the noise of `mu`, however light the damping.
        const BY: f64 = 0.1;
        if found.value <= 0.0 {
            return None;
        }
        let reached = found.reached.omega().filter(|&omega| omega > 0.0);
        let largest = |delta: f64| {
            let mu = |omega: f64| (GeneralizedPlant::at(chain, delta, omega).mu(), omega);
            let all = frequencies(chain).chain(reached).map(mu).filter(|(mu, _)| mu.is_finite());
            all.max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let (at_delta, _) = largest(found.value)?;
        let (above, omega) = largest((1.0 + BY) * found.value)?;
        Some(Self { at_delta, above, by: BY, omega })
    }
}

/// Angular frequencies in rad/s around the rates of a chain, evenly spaced on a logarithmic axis.
fn frequencies(chain: &Chain) -> impl Iterator<Item = f64> {
    const POINTS: u32 = 600;
    /// How far beyond the slowest and the fastest rate.
    const BEYOND: f64 = 1e3;
    let rates = |inertia: f64| {
        let grounds = chain.masses().iter().map(move |mass| mass.damping / inertia);
        let springs = chain.links().iter().map(move |link| (link.stiffness / inertia).sqrt());
        let dampers = chain.links().iter().map(move |link| link.damping / inertia);
        grounds.chain(springs).chain(dampers).filter(|rate| *rate > 0.0)
    };
    let lightest = chain.masses().iter().map(|mass| mass.inertia).fold(f64::INFINITY, f64::min);
    let slowest = rates(chain.inertia()).fold(f64::INFINITY, f64::min) / BEYOND;
    let fastest = rates(lightest).fold(0.0, f64::max) * BEYOND;
    let step = (fastest / slowest).ln() / f64::from(POINTS);
    (0..=POINTS).map(move |index| slowest * (step * f64::from(index)).exp())
}

/// `M` of equation 8: closed above by `D` it is the reaction `-H` of the hand.
fn hand() -> Matrix {
    Matrix::new((-1.0).into(), 1.0.into(), 2.0.into(), (-1.0).into())
}

/// `D_dev` of equation 9 for any chain. The hand's velocity and torque are counted outwards,
/// which turns the sign of both off-diagonal entries.
fn device(chain: &Chain, omega: f64) -> Matrix {
    let y = TwoPort::of(chain, omega);
    Matrix::new(y.hand, -y.hand_by_motor, -y.hand_by_motor, y.motor)
}

/// The device with `2 delta J - 1` for `J` at its second port (equation 5).
fn scaled(device: &Matrix, delta: f64) -> Matrix {
    let twice = Complex::from(2.0 * delta);
    let one = Complex::from(1.0);
    let d = device;
    Matrix::new(d[(0, 0)], d[(0, 1)], twice * d[(1, 0)], twice * d[(1, 1)] - one)
}

/// The star product: the second port of `upper` is joined to the first of `lower`.
fn star(upper: &Matrix, lower: &Matrix) -> Matrix {
    let (m, d) = (upper, lower);
    let turn = Complex::from(1.0) / (Complex::from(1.0) - m[(1, 1)] * d[(0, 0)]);
    Matrix::new(
        m[(0, 0)] + m[(0, 1)] * d[(0, 0)] * turn * m[(1, 0)],
        m[(0, 1)] * turn * d[(0, 1)],
        d[(1, 0)] * turn * m[(1, 0)],
        d[(1, 1)] + d[(1, 0)] * turn * m[(1, 1)] * d[(0, 1)],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Link, Mass};

    /// Rounding error of `mu`, enlarged by the square root.
    const NOISE: f64 = 1e-7;

    fn frequencies() -> impl Iterator<Item = f64> {
        (-20..=50).map(|step| 10f64.powf(0.1 * f64::from(step)))
    }

    /// `mu` of equation 16: the largest singular value of the matrix with the scaling `d^` of equation 15, which
    /// balances both off-diagonal entries. For two scalar blocks it is `mu` itself.
    fn largest_singular_value(plant: &GeneralizedPlant) -> f64 {
        let g = &plant.matrix;
        let d = Complex::from((g[(1, 0)].norm() / g[(0, 1)].norm()).sqrt());
        Matrix2::new(g[(0, 0)], d * g[(0, 1)], g[(1, 0)] / d, g[(1, 1)]).singular_values().max()
    }

    /// The condition `mu <= 1` without a square root: `f <= 1 + D0^2` and `D0 <= 1`. Both
    /// differences, left less right; neither is positive exactly if `mu <= 1`.
    fn excess(plant: &GeneralizedPlant) -> [f64; 2] {
        let (f, determinant) = plant.invariants();
        [f - 1.0 - determinant * determinant, determinant - 1.0]
    }

    #[test]
    fn the_plant_of_a_rigid_device_is_the_papers() {
        let (m, b, delta) = (0.05, 0.5, 0.3);
        let chain = Chain::rigid(m, b).unwrap();
        for omega in frequencies() {
            let a = Complex::new(b, m * omega);
            let one = Complex::from(1.0);
            let wanted = Matrix::new(
                one - a,
                -one,
                Complex::from(-4.0 * delta),
                Complex::from(2.0 * delta) - a - one,
            ) / (a + one);
            let found = GeneralizedPlant::at(&chain, delta, omega);
            assert!((found.matrix - wanted).norm() < 1e-14 * wanted.norm());
        }
    }

    #[test]
    fn mu_of_a_rigid_device_is_one_up_to_its_damping_and_greater_beyond() {
        for (m, b) in [(0.05, 0.5), (2.2e-5, 0.022), (1.0, 20.0)] {
            let chain = Chain::rigid(m, b).unwrap();
            for omega in frequencies() {
                for part in [0.01, 0.5, 0.9, 0.999, 1.0] {
                    let plant = GeneralizedPlant::at(&chain, part * b, omega);
                    assert!((plant.mu() - 1.0).abs() < NOISE, "{m} {b} {omega} {part}");
                    assert!(excess(&plant).iter().all(|&excess| excess < 1e-14));
                }
                // Where inertia hides the damping, mu is beyond 1 by less than its own rounding.
                let beyond = GeneralizedPlant::at(&chain, 1.01 * b, omega);
                let hidden = 4.0 * 0.01 * b * (1.0 + b) / ((b + 1.0).powi(2) + (m * omega).powi(2));
                assert!(hidden < 1e-12 || excess(&beyond)[1] > 0.4 * hidden);
                assert!(hidden < 1e-4 || beyond.mu() > 1.0 + 0.1 * hidden, "{m} {b} {omega}");
            }
        }
    }

    #[test]
    fn closed_form_and_singular_value_agree() {
        let mass = |inertia, damping| Mass { inertia, damping };
        let link = |stiffness, damping| Link { stiffness, damping };
        let masses = vec![mass(0.02, 0.05), mass(0.05, 0.05), mass(0.1, 0.5)];
        let chain = Chain::new(masses, vec![link(3000.0, 2.0), link(3000.0, 0.1)]).unwrap();
        let delta = chain.excess_passivity().unwrap().delta.midpoint();
        let peak = |delta: f64| {
            frequencies().fold(0.0, |peak: f64, omega| {
                let plant = GeneralizedPlant::at(&chain, delta, omega);
                assert!((plant.mu() - largest_singular_value(&plant)).abs() < NOISE);
                peak.max(plant.mu())
            })
        };
        assert!((peak(0.5 * delta) - 1.0).abs() < NOISE);
        assert!((peak(0.999 * delta) - 1.0).abs() < NOISE);
        // The frequencies miss the worst one a little.
        assert!(peak(1.1 * delta) > 1.0 + 1e-5, "{}", peak(1.1 * delta) - 1.0);
    }
}
