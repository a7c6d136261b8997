//! The sampled loop: device and hand by the exact zero-order hold, the controller as a state space.

use crate::exact::Q;
use crate::hands::Hand;
use crate::rules::Exact;
use nalgebra::{Complex, DMatrix, DVector, RowDVector, Schur};
use num_traits::{One, ToPrimitive, Zero};

/// Device and hand over one period of 1, the torque held: `x+ = a x + b u`; `x[0]` is the position
/// at the encoder, positions and velocities alternate.
#[derive(Clone, Debug)]
pub struct Plant {
    /// State transition over one period.
    pub a: DMatrix<f64>,
    /// Effect of a torque held over the period.
    pub b: DVector<f64>,
    hand: Hand,
}

impl Plant {
    /// The device with damping 1 and this hand.
    pub fn new(hand: &Hand) -> Self {
        let n = 2 * (1 + hand.segments.len());
        let mut rates = DMatrix::zeros(n + 1, n + 1);
        for i in (0..n).step_by(2) {
            rates[(i, i + 1)] = 1.0;
        }
        rates[(1, 0)] = -hand.stiffness / hand.inertia;
        rates[(1, 1)] = -(1.0 + hand.damping) / hand.inertia;
        rates[(1, n)] = 1.0 / hand.inertia;
        let mut before = hand.inertia;
        for (i, s) in hand.segments.iter().enumerate() {
            let (row, up) = (2 * i + 3, 2 * i + 1);
            for (offset, link, ground) in
                [(0, s.link_stiffness, s.stiffness), (1, s.link_damping, s.damping)]
            {
                let (here, there) = (row - 1 + offset, up - 1 + offset);
                rates[(row, here)] -= (link + ground) / s.inertia;
                rates[(row, there)] += link / s.inertia;
                rates[(up, there)] -= link / before;
                rates[(up, here)] += link / before;
            }
            before = s.inertia;
        }
        let over = rates.exp();
        let a = over.view((0, 0), (n, n)).into_owned();
        let b = over.view((0, n), (n, 1)).column(0).into_owned();
        Self { a, b, hand: hand.clone() }
    }

    /// Kinetic and potential energy of a state, in `delta` times angle squared over period.
    pub fn energy(&self, x: &DVector<f64>) -> f64 {
        let half = |k: f64, v: f64| 0.5 * k * v * v;
        let hand = &self.hand;
        let mut total = half(hand.inertia, x[1]) + half(hand.stiffness, x[0]);
        for (i, s) in hand.segments.iter().enumerate() {
            let (position, velocity) = (x[2 * i + 2], x[2 * i + 3]);
            total += half(s.inertia, velocity) + half(s.stiffness, position);
            total += half(s.link_stiffness, position - x[2 * i]);
        }
        total
    }
}

/// A controller `C = E / (1 + V E)` in the loop's units, as `x+ = a x + b y`, `u = c x + d y`.
#[derive(Clone, Debug)]
pub struct Controller {
    a: DMatrix<f64>,
    c: RowDVector<f64>,
    d: f64,
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl Controller {
    /// From a scene; `None` where the algebraic loop has no solution.
    pub fn new(scene: &Exact) -> Option<Self> {
        let compliance = scene.coupling.as_ref().map_or_else(Q::zero, |k| Q::one() / k);
        let denominator = scene.denominator.plus(&scene.numerator.scaled(&compliance));
        let n = scene.denominator.degree();
        if denominator.degree() < n || scene.numerator.degree() > n {
            return None;
        }
        let lead = denominator.leading();
        let unit = &scene.period / &scene.delta / &lead;
        let float = |c: &Q| c.to_f64().unwrap_or(f64::NAN);
        let under: Vec<f64> =
            denominator.coefficients().iter().map(|c| float(&(c / &lead))).collect();
        let mut over: Vec<f64> =
            scene.numerator.coefficients().iter().map(|c| float(&(c * &unit))).collect();
        over.resize(n + 1, 0.0);
        let mut a = DMatrix::zeros(n, n);
        for i in 0..n {
            a[(n - 1, i)] = -under[i];
            if i + 1 < n {
                a[(i, i + 1)] = 1.0;
            }
        }
        let c = RowDVector::from_fn(n, |_, i| over[i] - over[n] * under[i]);
        Some(Self { a, c, d: over[n], numerator: over, denominator: under })
    }

    /// `Re (z / (z - 1)) C'` at an angle, in units of `delta`, where `C' = C / (1 - C / 2)` is the
    /// environment that gives this controller behind the standard coupling: below -1 is unsafe.
    pub fn real_part(&self, theta: f64) -> f64 {
        let z = Complex::from_polar(1.0, theta);
        let at = |p: &[f64]| p.iter().rev().fold(Complex::new(0.0, 0.0), |s, &c| s * z + c);
        let (n, d) = (at(&self.numerator), at(&self.denominator));
        (z / (z - 1.0) * n / (d - n * 0.5)).re
    }

    /// Angle on a grid where that is smallest.
    pub fn worst_angle(&self) -> f64 {
        let grid = (1..=500).map(|i| f64::from(i) * std::f64::consts::PI / 500.0);
        let key = |theta: &f64| self.real_part(*theta);
        grid.min_by(|a, b| key(a).total_cmp(&key(b))).unwrap_or(1.0)
    }

    /// Largest modulus of the closed loop's eigenvalues; `None` if they were not found.
    pub fn spectral_radius(&self, plant: &Plant) -> Option<f64> {
        let (n, k) = (plant.a.nrows(), self.a.nrows());
        let mut m = DMatrix::zeros(n + k, n + k);
        m.view_mut((0, 0), (n, n)).copy_from(&plant.a);
        for i in 0..n {
            m[(i, 0)] -= plant.b[i] * self.d;
            for j in 0..k {
                m[(i, n + j)] = -plant.b[i] * self.c[j];
            }
        }
        if k > 0 {
            m.view_mut((n, n), (k, k)).copy_from(&self.a);
            m[(n + k - 1, 0)] = 1.0;
        }
        nalgebra::linalg::balancing::balance_parlett_reinsch(&mut m);
        let schur = Schur::try_new(m, 1e-15, 10_000)?;
        Some(schur.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max))
    }
}
