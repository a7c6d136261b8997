//! The scenes, the motors and the random numbers of the tests.

use crate::encoder::{CounterWidth, RawCount};
use crate::number::Number;
use crate::scene::{Coupling, Device, Scene};
use crate::servo::Servo;
use crate::transducers::Transducers;

/// An environment on the paper's paddle at 1 kHz, behind the standard coupling.
pub(crate) const fn scene<E>(environment: E) -> Scene<E> {
    let mut scene = Scene::of(Device::damped(2.2e-5, 0.022), 0.001, environment);
    scene.coupling = Coupling::Spring { stiffness: 44.0 };
    scene
}

/// An encoder whose counter does not overflow, and a small motor.
pub(crate) const TRANSDUCERS: Transducers = Transducers::of(61_440.0, 1.0);

/// The paddle's encoder and motor on a board.
pub(crate) const PADDLE: Transducers =
    Transducers { counter: CounterWidth::Bits16, full_scale_torque: 2.0, ..TRANSDUCERS };

/// The largest difference in N m of the torques of a servo with a coarse encoder and a servo with exact
/// positions, in `f64`, in a slow and a fast motion of these amplitudes in rad.
pub(crate) fn largest_error<N: Number>(
    scene: &Scene,
    counts_per_turn: f64,
    [slow, fast]: [f64; 2],
) -> f64 {
    let transducers =
        |counts_per_turn| Transducers { counts_per_turn, largest_speed: 1e4, ..TRANSDUCERS };
    let certified = scene.certify().unwrap();
    let fine = 1024.0 * counts_per_turn;
    let mut coarse = Servo::<_, N>::new(&certified, &transducers(counts_per_turn)).unwrap();
    let mut exact = Servo::<_, f64>::new(&certified, &transducers(fine)).unwrap();
    let mut largest = 0.0_f64;
    for tick in 0..20_000 {
        let angle = slow * (f64::from(tick) * 7e-4).sin() + fast * (f64::from(tick) * 0.13).sin();
        let count = |counts: f64| (angle * counts / core::f64::consts::TAU).round() as i32;
        coarse.tick(RawCount::from(count(counts_per_turn)));
        exact.tick(RawCount::from(count(fine)));
        largest = largest.max((coarse.torque_nm() - exact.torque_nm()).abs());
    }
    largest
}

/// Random numbers, the same in each run.
pub(crate) struct Random(pub u64);

impl Random {
    /// 53 bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 11
    }

    /// A number from -1 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.bits() as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
