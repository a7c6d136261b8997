//! A servo without its type parameters, so that programs can hold a servo of any scene and format.

use haptic_servo::certificate::Certified;
use haptic_servo::encoder::RawCount;
use haptic_servo::number::{Number, OutOfRange};
use haptic_servo::rendering::Rendering;
use haptic_servo::scene::Scene;
use haptic_servo::servo::{BuildError, Servo, Transducers};
use haptic_servo::torque::LimitReason;
use haptic_servo::tuning::Tunable;

/// The result of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Position in counts, extended over the counter's wraps.
    pub count: i64,
    /// Angle of the device in rad.
    pub angle: f64,
    /// Coupling torque `F` in N m; the motor applies `-F`.
    pub torque: f64,
    /// Code of the DAC.
    pub code: u16,
    /// The reason if the torque is limited.
    pub limit: LimitReason,
    /// Whether the tick was left out, so that all is as before.
    pub is_left_out: bool,
}

/// A servo of some certified scene in some number format.
pub trait Controller {
    /// One tick with the counter's content.
    fn tick(&mut self, raw: i32) -> Tick;

    /// One tick at an angle in rad without an encoder's rounding: the torque in N m.
    ///
    /// # Errors
    /// If the number format does not hold the angle.
    fn tick_at(&mut self, angle: f64) -> Result<f64, OutOfRange>;
}

impl<E: Rendering<N>, N: Number> Controller for Servo<E, N> {
    fn tick(&mut self, raw: i32) -> Tick {
        let output = Servo::tick(self, RawCount::from(raw));
        Tick {
            count: self.count(),
            angle: self.angle_rad(),
            torque: self.torque_nm(),
            code: output.code.get(),
            limit: output.limit,
            is_left_out: false,
        }
    }

    fn tick_at(&mut self, angle: f64) -> Result<f64, OutOfRange> {
        Servo::tick_at(self, angle)
    }
}

impl<C: Controller + ?Sized> Controller for &mut C {
    fn tick(&mut self, raw: i32) -> Tick {
        (**self).tick(raw)
    }

    fn tick_at(&mut self, angle: f64) -> Result<f64, OutOfRange> {
        (**self).tick_at(angle)
    }
}

/// Builds the servo of a certified scene in the format `N`.
pub fn controller<E, N>(
    scene: &Certified<Scene<E>>,
    transducers: &Transducers,
) -> Result<Box<dyn Controller>, BuildError>
where
    E: Tunable<N>,
    N: Number + 'static,
{
    Ok(Box::new(Servo::<E, N>::new(scene, transducers)?))
}
