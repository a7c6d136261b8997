//! A chain at one frequency, as motor and hand feel it.

use nalgebra::{Complex, DMatrix, DVector};

use super::Chain;

/// Admittances at one angular frequency: velocity in rad/s for torque in N m, all counted in the
/// direction of the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoPort {
    /// Of the motor's mass by the motor.
    pub motor: Complex<f64>,
    /// Of the hand's mass by the hand.
    pub hand: Complex<f64>,
    /// Of the hand's mass by the motor, which is that of the motor's mass by the hand: a chain is
    /// reciprocal.
    pub hand_by_motor: Complex<f64>,
}

impl TwoPort {
    /// Admittances of the masses and links at `omega` rad/s, greater than 0, without the lag of
    /// the amplifier. Not finite where the chain resonates without any damping.
    pub fn of(chain: &Chain, omega: f64) -> Self {
        let last = chain.masses().len() - 1;
        let factored = impedance(chain, omega).lu();
        let nan = Complex::new(f64::NAN, f64::NAN);
        let driven = |at: usize| {
            let mut torque = DVector::zeros(last + 1);
            torque[at] = Complex::new(1.0, 0.0);
            factored.solve(&torque).unwrap_or_else(|| DVector::from_element(last + 1, nan))
        };
        let (by_motor, by_hand) = (driven(0), driven(last));
        Self { motor: by_motor[0], hand: by_hand[last], hand_by_motor: by_motor[last] }
    }
}

/// The impedance matrix: torque on each mass for the velocity of each mass.
fn impedance(chain: &Chain, omega: f64) -> DMatrix<Complex<f64>> {
    let mut z = DMatrix::zeros(chain.masses().len(), chain.masses().len());
    for (i, mass) in chain.masses().iter().enumerate() {
        z[(i, i)] = Complex::new(mass.damping, mass.inertia * omega);
    }
    for (i, link) in chain.links().iter().enumerate() {
        let between = Complex::new(link.damping, -link.stiffness / omega);
        z[(i, i)] += between;
        z[(i + 1, i + 1)] += between;
        z[(i, i + 1)] -= between;
        z[(i + 1, i)] -= between;
    }
    z
}
