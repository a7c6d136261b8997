//! Plant and controller as one matrix: the whole loop where it is linear, without limit, face,
//! quantisation.

use haptic_servo::certificate::LoopTransfers;
use haptic_servo::passivity::transfer::Unbuildable;
use haptic_servo::scene::{Coupling, Scene};
use nalgebra::{DMatrix, DVector, RowDVector};

use super::discrete_plant::DiscretePlant;
use crate::response::Response;

/// The transfer functions of environment and controller. Only a matched coupling depends on the passivity
/// that the scene declares; with another coupling a scene without passivity is simulated like any other.
///
/// # Errors
/// Where the environment is not causal, the loop of coupling and environment has no solution, or
/// a number is out of range.
pub fn transfers(scene: &Scene) -> Result<LoopTransfers, Unbuildable> {
    /// So large that the standard coupling, behind which the equivalent environment stands, is practically
    /// rigid: every scene with a controller then has an equivalent. Below 0, since no device has more
    /// passivity than damping.
    const ANY: f64 = -1e200;
    let mut scene = *scene;
    // A matched coupling follows from the passivity, and nothing stands behind another coupling there.
    if scene.coupling != Coupling::Matched {
        scene.device.passivity = Some(ANY);
    }
    LoopTransfers::of(&scene)
}

/// `z(k+1) = matrix z(k) + inputs`, with the coupling torque `F = torque z`.
///
/// The state `z` consists of the states of the plant, the motor torques of earlier ticks that have not acted
/// yet, and the states of the controller `C = E / (1 + V E)` (direct form II, transposed).
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoop {
    /// State transition over a tick.
    pub matrix: DMatrix<f64>,
    /// Coupling torque in N m from the state.
    pub torque: RowDVector<f64>,
    /// Number of the plant's states, which come first.
    pub plant: usize,
}

impl ClosedLoop {
    /// Closes the loop of a scene without one-sidedness, face, torque limit and quantisation.
    ///
    /// # Errors
    /// Where the environment is not causal, the loop of coupling and environment has no solution,
    /// or a number is out of range.
    pub fn new(tick: &DiscretePlant, scene: &Scene) -> Result<Self, Unbuildable> {
        let controller = Response::new(transfers(scene)?.controller);
        let filter = controller.filter().ok_or(Unbuildable::OutOfRange)?;
        let (numerator, denominator) = (filter.numerator(), filter.denominator());
        let (transition, motor) = tick.with_pending();
        let (first, degree) = (motor.nrows(), denominator.len() - 1);
        let size = first + degree;
        let mut torque = RowDVector::zeros(size);
        torque[tick.measured] = numerator[0];
        if degree > 0 {
            torque[first] = 1.0;
        }
        let mut matrix = DMatrix::zeros(size, size);
        matrix.view_mut((0, 0), (first, first)).copy_from(&transition);
        matrix.view_mut((0, 0), (first, size)).ger(-1.0, &motor, &torque.transpose(), 1.0);
        for i in 1..=degree {
            let row = first + i - 1;
            matrix.row_mut(row).copy_from(&(&torque * -denominator[i]));
            matrix[(row, tick.measured)] += numerator[i];
            if i < degree {
                matrix[(row, row + 1)] += 1.0;
            }
        }
        Ok(Self { matrix, torque, plant: tick.transition.nrows() })
    }

    /// A vector of the plant's states as one of the whole loop's.
    pub fn extended(&self, plant: &DVector<f64>) -> DVector<f64> {
        plant.clone().resize_vertically(self.matrix.nrows(), 0.0)
    }
}
