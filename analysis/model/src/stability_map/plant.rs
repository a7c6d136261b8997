//! The device over a tick as a ratio of polynomials, which a controller closes at the cost of two
//! products.

use haptic_servo::passivity::transfer::Unbuildable;
use haptic_servo::scene::Scene;
use nalgebra::{Complex, DMatrix, DVector};

use super::schur_cohn::all_inside;
use crate::response::Response;
use crate::simulation::closed_loop::transfers;
use crate::simulation::discrete_plant::DiscretePlant;

/// Sampled position over motor torque, highest power first.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledPlant {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl SampledPlant {
    /// For a plant over a tick (Faddeev and Le Verrier's recursion). Torques that are late are states of
    /// their own.
    pub fn new(tick: &DiscretePlant) -> Self {
        let (transition, motor) = tick.with_pending();
        Self::of_states(&transition, &motor, tick.measured)
    }

    fn of_states(transition: &DMatrix<f64>, motor: &DVector<f64>, measured: usize) -> Self {
        let n = transition.nrows();
        let (mut numerator, mut denominator) = (vec![0.0], vec![1.0]);
        let mut adjugate = DMatrix::identity(n, n);
        for order in 1..=n {
            numerator.push((adjugate.row(measured) * motor)[0]);
            let product = transition * &adjugate;
            let coefficient = -product.trace() / order as f64;
            denominator.push(coefficient);
            adjugate = product + DMatrix::identity(n, n) * coefficient;
        }
        Self { numerator, denominator }
    }

    /// Value at `z`.
    pub fn at(&self, z: Complex<f64>) -> Complex<f64> {
        let horner = |p: &[f64]| p.iter().fold(Complex::new(0.0, 0.0), |sum, c| sum * z + *c);
        horner(&self.numerator) / horner(&self.denominator)
    }

    /// Whether the loop of this plant and a scene's controller dies away from any start: all roots
    /// of `D_plant D_C + N_plant N_C` inside the unit circle. One-sidedness and limits are left
    /// out.
    ///
    /// # Errors
    /// Where the scene has no controller.
    pub fn is_stable_under(&self, scene: &Scene) -> Result<bool, Unbuildable> {
        Ok(all_inside(&mut self.closed(&controller(scene)?)?))
    }

    /// Whether the motion of that loop dies away: where nothing pulls the device back to an angle, as in free
    /// mode, it may come to rest at any. The plant is a device that nothing holds.
    ///
    /// # Errors
    /// Where the scene has no controller.
    pub fn comes_to_rest_under(&self, scene: &Scene) -> Result<bool, Unbuildable> {
        let controller = controller(scene)?;
        let mut closed = self.closed(&controller)?;
        if controller.transfer().ones > 0 {
            // The device's pole at rest stays where it is: z - 1 is a factor.
            let mut sum = 0.0;
            for coefficient in &mut closed {
                sum += *coefficient;
                *coefficient = sum;
            }
            closed.pop();
        }
        Ok(all_inside(&mut closed))
    }

    /// The characteristic polynomial of the loop, highest power first.
    fn closed(&self, controller: &Response) -> Result<Vec<f64>, Unbuildable> {
        let filter = controller.filter().ok_or(Unbuildable::OutOfRange)?;
        let (numerator, denominator) = (filter.numerator(), filter.denominator());
        let mut closed = vec![0.0; self.denominator.len() + denominator.len() - 1];
        for (i, (own_n, own_d)) in self.numerator.iter().zip(&self.denominator).enumerate() {
            for (j, (c_n, c_d)) in numerator.iter().zip(denominator).enumerate() {
                closed[i + j] += own_d * c_d + own_n * c_n;
            }
        }
        Ok(closed)
    }
}

fn controller(scene: &Scene) -> Result<Response, Unbuildable> {
    Ok(Response::new(transfers(scene)?.controller))
}
