//! A hand that varies with the servo's period destabilises a loop that is stable in every constant hand
//! (theory, section 13.6).
//!
//! The device is a damper with almost no inertia. The hand reflects the incoming wave: from the incident
//! torque `e = F_hand + delta v` it returns `r = delta v - F_hand`, so that its energy is the integral of
//! `(e^2 - r^2)/(4 delta)`. It takes the two coefficients of `e` over a period in the plane of 1 and
//! `exp(-t/tau)`, filters each by an all-pass with a delay of a period, and returns their weighted sum,
//! constant over a period: never more energy than it received. Weights and all-passes are chosen so that at
//! one angle the whole lagging torque returns in the part that a sample sees.

use std::f64::consts::PI;

use haptic_servo::certificate::assess;
use haptic_servo::environment::Environment;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::passivity::lagged::LagIntervals;
use haptic_servo::scene::{Device, Latency};
use nalgebra::{Complex, DMatrix, DVector};

use super::setting::*;
use crate::chain::Chain;
use crate::line_search::minimizing_angle;
use crate::response::Response;
use crate::stability::{eigenvalues, radius};
use crate::worst_hand::{needed, search};

/// Time constant of the amplifier in s.
pub const LAG: f64 = 0.4 * PERIOD;
/// The paddle with a thousandth of its inertia.
pub const LIGHT: Device = Device { inertia: 1e-3 * PADDLE.inertia, ..PADDLE };
/// Denominator of the controller, descending: a resonance near the half of the sample rate.
pub const RESONANCE: [f64; 3] = [1.0, 1.5, 0.625];

/// `gain z / (z^2 + 1.5 z + 0.625)` behind the amplifier.
fn resonant(gain: f64) -> Scene {
    let resonance = Environment::Rational(rational(&[gain, 0.0], &RESONANCE));
    Scene { latency: Latency::NONE.with_actuator_lag(LAG), ..rigid(LIGHT, resonance) }
}

/// The resonance at `times` the certified limit: its index is `times` the damping.
pub fn at(times: f64) -> Scene {
    let index = assess(&resonant(1.0)).alpha_port.map_or(f64::NAN, Interval::midpoint);
    resonant(times * LIGHT.damping / index)
}

/// At 1.005 of the limit, stable in every constant hand and unstable in a varying hand.
pub fn varying_hand() -> Result<CaseReport, StudyError> {
    let scene = at(1.005);
    let device = Chain::rigid(LIGHT.inertia, LIGHT.damping)?;
    let linear = needed(&scene, &device).unwrap_or(f64::NAN);
    let reason = "hands that do not vary ask for {} N m s/rad";
    let searched = search(&scene, &device)?;
    let allows = MethodVerdict::of(linear < LIGHT.damping);
    let (tried, worst) = (searched.tried, searched.worst.spectral_radius);
    let still = MethodVerdict::of(!searched.oscillates);
    let largest = "the largest eigenvalue in the worst of them is {}";
    let methods = vec![
        MethodResult::new("Nyquist, for all linear hands", allows, linear, reason),
        MethodResult::new(format!("{tried} hands that do not vary"), still, worst, largest),
    ];
    let multiplier = VaryingHand::against(&scene)?.multiplier(&scene)?;
    let varying = "a hand that varies with the period";
    let truth = MethodResult::modulus(varying, "largest multiplier", multiplier);
    let still = loop_run("1.005 of the limit, in no hand", &scene, PADDLES, Outcome::Converges)
        .with_claimed_passivity(1.5)
        .pushed(1.0, 2000);
    let below = loop_run("0.995 of it", &at(0.995), PADDLES, Outcome::Converges).pushed(1.0, 2000);
    CaseReport::of(&scene, methods, truth, &[still, below])
}

/// The path of a coefficient through the hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllPass {
    /// Weight; those of both are the sides of a triangle with a right angle and the hypotenuse 1.
    pub weight: f64,
    /// `p` of `(1 - p z)/(z (z - p))`, between -1 and 1.
    pub pole: f64,
}

/// The hand: the filters of the coefficients in the plane. Units are those of the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VaryingHand {
    /// `tau` in periods.
    lag: f64,
    /// `exp(-1/tau)`
    left: f64,
    /// The paths of the constant, and of the part perpendicular to it.
    pub ways: [AllPass; 2],
}

/// The plane of 1 and `exp(-t/tau)` over a period: integral of the second, and its norm without its mean.
fn plane(lag: f64) -> (f64, f64) {
    let left = (-1.0 / lag).exp();
    let mean = lag * (1.0 - left);
    (mean, (0.5 * lag * (1.0 - left * left) - mean * mean).sqrt())
}

impl VaryingHand {
    /// The worst hand for a scene behind an amplifier, at the angle with the largest shortage of its
    /// certificate.
    pub fn against(scene: &Scene) -> Result<Self, StudyError> {
        let controller = controller(scene)?;
        let (period, damping) = (scene.timing.period, scene.device.damping);
        let lag = scene.latency.actuator_lag.middle() / period;
        let lags = [Interval::exact(lag), Interval::ZERO];
        let lagging = LagIntervals { delay: Interval::ZERO, lags, updates: 0, between: false };
        let response = lagging.response(0).expect("one lag has a response");
        let g = Response::new(response.transfer(Interval::exact(period)));
        let index = |theta: f64| {
            let (g, h) = (g.at_angle(theta), controller.at_angle(theta));
            let ripple = response.ripple_at(theta.cos()).midpoint() * period * period;
            let real = (g * h).re;
            0.5 * ((real * real + ripple * h.norm_sqr()).sqrt() - real)
        };
        let theta = minimizing_angle(|theta| -index(theta), 0.0, PI).unwrap_or(0.5 * PI);
        let z = Complex::from_polar(1.0, theta);
        let one = Complex::new(1.0, 0.0);
        // From the centre of the visible subspace towards -1/H, as a velocity.
        let aim = (-one / controller.at(z) - g.at(z) / (2.0 * damping)) * (z - one);
        // The torque over a period: 1 + rest exp(-t/tau), for a command that turns by theta a period.
        let left = (-1.0 / lag).exp();
        let rest = (one - left) / (z - left) - one;
        let (mean, norm) = plane(lag);
        let coefficients = [one + rest * mean, rest * norm];
        let size = coefficients.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
        let ways = coefficients.map(|coefficient| {
            let turn = aim.arg() - coefficient.arg();
            AllPass::turning(theta, turn, coefficient.norm() / size)
        });
        Ok(Self { lag, left, ways })
    }

    /// Growth per period of the loop of a scene in this hand: the largest eigenvalue of the monodromy matrix.
    pub fn multiplier(&self, scene: &Scene) -> Result<f64, StudyError> {
        let found = eigenvalues(&self.monodromy(scene)?)?;
        Ok(radius(&found))
    }

    /// Over a period: position, velocity and amplifier, the two of each way, the controller's.
    fn monodromy(&self, scene: &Scene) -> Result<DMatrix<f64>, StudyError> {
        let filter = controller(scene)?.filter().expect("a low degree");
        let (numerator, denominator) = (filter.numerator(), filter.denominator());
        let order = denominator.len() - 1;
        let device = &scene.device;
        let inertia = device.inertia / (device.damping * scene.timing.period);
        let gain = scene.timing.period / device.damping;
        let over = self.over_a_period(inertia);
        let size = 3 + 4 + order;
        let columns: Vec<DVector<f64>> = (0..size)
            .map(|column| {
                let mut state = vec![0.0; size];
                state[column] = 1.0;
                let (body, rest) = state.split_at(3);
                let (ways, controller) = rest.split_at(4);
                let torque = gain * numerator[0] * body[0] + controller.first().unwrap_or(&0.0);
                let returned: f64 = self
                    .ways
                    .iter()
                    .zip([ways[0], ways[2]])
                    .map(|(way, out)| way.weight * out)
                    .sum();
                let start = DVector::from_row_slice(&[
                    body[0], body[1], body[2], 0.0, 0.0, -torque, returned,
                ]);
                let end = &over * start;
                let mut next = vec![end[0], end[1], end[2]];
                let (mean, norm) = plane(self.lag);
                let shaped = self.left * end[4];
                for (i, incident) in
                    [end[3], (shaped - mean * end[3]) / norm].into_iter().enumerate()
                {
                    let (pole, out) = (self.ways[i].pole, ways[2 * i]);
                    next.extend([ways[2 * i + 1] + pole * out - pole * incident, incident]);
                }
                for k in 1..=order {
                    let later = controller.get(k).copied().unwrap_or(0.0);
                    next.push(gain * numerator[k] * body[0] - denominator[k] * torque + later);
                }
                DVector::from_vec(next)
            })
            .collect();
        Ok(DMatrix::from_columns(&columns))
    }

    /// Position, velocity, amplifier, the integrals of `e` and of `e exp((1 - t)/tau)`, and the held values:
    /// command and returned torque.
    fn over_a_period(&self, inertia: f64) -> DMatrix<f64> {
        let mut rates = DMatrix::zeros(7, 7);
        let [position, velocity, amplifier, plain, shaped, command, returned] =
            [0, 1, 2, 3, 4, 5, 6];
        rates[(position, velocity)] = 1.0;
        rates[(velocity, amplifier)] = 1.0 / inertia;
        rates[(velocity, velocity)] = -2.0 / inertia;
        rates[(velocity, returned)] = 1.0 / inertia;
        rates[(amplifier, command)] = 1.0 / self.lag;
        rates[(amplifier, amplifier)] = -1.0 / self.lag;
        for integral in [plain, shaped] {
            rates[(integral, velocity)] = 2.0;
            rates[(integral, returned)] = -1.0;
        }
        rates[(shaped, shaped)] = 1.0 / self.lag;
        rates.exp()
    }
}

impl AllPass {
    /// With a phase of `turn` at the angle `theta`, both in rad; a weight below 0 turns by half.
    fn turning(theta: f64, turn: f64, weight: f64) -> Self {
        // Of (1 - p z)/(z - p) alone: from -2 pi to 0, of which a sign does the lower half.
        let turn = (turn + theta).rem_euclid(2.0 * PI) - 2.0 * PI;
        let (turn, sign) = if turn < -PI { (turn + PI, -1.0) } else { (turn, 1.0) };
        // arg(z - p) is half of theta - turn.
        let pole = theta.cos() - theta.sin() / (0.5 * (theta - turn)).tan();
        Self { weight: sign * weight, pole }
    }
}
