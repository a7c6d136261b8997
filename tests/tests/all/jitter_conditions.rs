//! The conditions for linear scenes whose delay deviates from tick to tick (theory, equations 42, 57 and 58),
//! at angles of the circle and summed over the aliases, compared with the largest wall that is certified.

use std::f64::consts::{PI, SQRT_2, TAU};

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::scene::{Latency, Scene};
use nalgebra::Complex;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::loops::Loop;
use tests::scenes::log_uniform;

const ALIASES: i32 = 300;
const ANGLES: usize = 250;
/// Relative error of a largest factor: the aliases that are left out, the angles between, and the `D` of
/// equation 58, which the program does not make smaller.
const TOLERANCE: f64 = 0.012;

/// A loop whose torques and counts deviate at the same time.
#[derive(Clone, Copy, Debug)]
struct Deviating {
    drawn: Loop,
    jitter: f64,
    /// Jitter of counts.
    counts: f64,
}

/// What does not depend on the wall, at one angle.
struct At {
    z: Complex<f64>,
    g: Complex<f64>,
    d: f64,
    in_window: Complex<f64>,
}

impl Deviating {
    /// Of torques alone.
    fn draw(rng: &mut ChaCha8Rng) -> Self {
        let jitter = [0.002, 0.02, 0.1, 0.3, 0.45][rng.random_range(0..5)];
        let drawn = Loop {
            stiffness: log_uniform(rng, 0.1, 2.0),
            damping: if rng.random_bool(0.5) { 0.0 } else { rng.random_range(0.0..0.8) },
            filter: 0.0,
            coupling: if rng.random_bool(0.5) { None } else { Some(log_uniform(rng, 0.3, 4.0)) },
            output_delay: jitter + [0.0, 0.3, 1.0][rng.random_range(0..3)],
            actuator_lag: if rng.random_bool(0.4) { 0.0 } else { log_uniform(rng, 0.02, 1.5) },
            sensor_lag: 0.0,
            ..Loop::draw(rng)
        };
        Self { drawn, jitter, counts: 0.0 }
    }

    /// The same with counts that deviate at the same time.
    fn draw_both(rng: &mut ChaCha8Rng) -> Self {
        let Self { mut drawn, jitter, .. } = Self::draw(rng);
        let jitter = jitter.min(0.3);
        let counts = f64::min(0.49 - jitter, jitter * log_uniform(rng, 0.2, 5.0));
        drawn.output_delay += counts;
        Self { drawn, jitter, counts }
    }

    fn scene(&self, factor: f64) -> Scene {
        let scene = self.drawn.scaled(factor).scene();
        let latency =
            Latency { output_jitter: self.jitter, count_jitter: self.counts, ..scene.latency };
        Scene { latency, ..scene }
    }

    /// Whether the controller has its poles inside of the circle: `1 + E V` does not turn around 0 on it.
    fn is_stable(&self, factor: f64) -> bool {
        let drawn = self.drawn.scaled(factor);
        let on = |n: i32| drawn.closed_at(Complex::from_polar(1.0, PI * f64::from(n) / 4000.0));
        let turned: f64 = (0..4000).map(|n| (on(n + 1) / on(n)).arg()).sum();
        turned.abs() < 1.0
    }

    /// The integral of the rest of a step, from a time after its beginning on.
    fn left(&self, time: f64) -> f64 {
        if time <= 0.0 {
            self.drawn.actuator_lag - time
        } else if self.drawn.actuator_lag > 0.0 {
            self.drawn.actuator_lag * (-time / self.drawn.actuator_lag).exp()
        } else {
            0.0
        }
    }

    /// The rest of a step, a time after its beginning.
    fn rest(&self, time: f64) -> f64 {
        if time <= 0.0 {
            1.0
        } else if self.drawn.actuator_lag > 0.0 {
            (-time / self.drawn.actuator_lag).exp()
        } else {
            0.0
        }
    }

    /// What the smaller of two jitters adds to the width of the window.
    fn both(&self) -> f64 {
        2.0 * self.jitter.min(self.counts)
    }

    fn width(&self) -> f64 {
        1.0 + 2.0 * (self.jitter + self.counts) + self.both()
    }

    fn at(&self, theta: f64) -> At {
        let z = Complex::from_polar(1.0, theta);
        let (mut g, mut held, mut sampled) = (Complex::new(0.0, 0.0), 0.0, 0.0);
        for k in -ALIASES..=ALIASES {
            let jw = Complex::new(0.0, theta + TAU * f64::from(k));
            let h = (1.0 - 1.0 / z) / jw * (-jw * self.drawn.output_delay).exp()
                / (1.0 + jw * self.drawn.actuator_lag);
            g += h / jw;
            held += h.norm_sqr();
            sampled += 1.0 / jw.norm_sqr();
        }
        let off = self.jitter + self.counts;
        let [early, late] = [self.drawn.output_delay - off, self.drawn.output_delay + off];
        let width = self.width();
        let mut taken = Complex::new(0.0, 0.0);
        for m in 0..200 {
            let place = f64::from(m);
            let held = self.left(place - 1.0 - late) - self.left(place - early);
            let tap = held + self.both() * self.rest(place - late);
            taken += tap / width * z.powi(-m);
        }
        At { z, g, d: held * sampled - g.norm_sqr(), in_window: z / (z - 1.0) - taken }
    }

    /// Whether one of the conditions holds at all angles.
    fn passes(&self, factor: f64, angles: &[At]) -> bool {
        let (h, drawn) = (self.jitter, self.drawn.scaled(factor));
        let all = |condition: &dyn Fn(Complex<f64>, &At) -> bool| {
            angles.iter().all(|at| condition(drawn.controller_at(at.z), at))
        };
        let left = 1.0 / self.width();
        let in_window = all(&|controller, at| {
            let over = 1.0 / (at.z - 1.0).norm_sqr() - at.in_window.norm_sqr();
            left + (controller * at.in_window).re >= over * controller.norm_sqr() / (4.0 * left)
        });
        let ripple = h * (4.0 * SQRT_2 + 1.0);
        let of_means = all(&|controller, at| {
            let needed = (at.d + ripple) * controller.norm_sqr() / 4.0;
            1.0 - h / SQRT_2 + (controller * at.g).re >= needed
        });
        let share = 0.5 * h.sqrt();
        let of_work = all(&|controller, at| {
            let needed = at.d / (4.0 * (1.0 - share)) + h / (4.0 * share);
            1.0 - share + (controller * at.g).re >= needed * controller.norm_sqr()
        });
        let of_one = self.counts == 0.0 && (of_means || of_work);
        self.is_stable(factor) && (in_window || of_one)
    }
}

/// The largest factor of a wall that passes, if all smaller ones do.
fn largest(passes: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (1e-3, 20.0);
    while high / low > 1.001 {
        let middle = f64::sqrt(low * high);
        if passes(middle) { low = middle } else { high = middle }
    }
    low
}

#[test]
fn the_largest_wall_is_that_of_the_best_condition() {
    let mut rng = ChaCha8Rng::seed_from_u64(57);
    compare_largest_walls((0..40).map(|_| Deviating::draw(&mut rng)).filter(|one| {
        // Springs without a coupling are judged by their index at the port, which no jitter changes.
        one.drawn.damping != 0.0 || one.drawn.coupling.is_some()
    }));
}

/// Torques and counts that deviate at once have only the condition of the window, without a coupling too.
#[test]
fn the_largest_wall_with_two_jitters_is_that_of_the_window() {
    let mut rng = ChaCha8Rng::seed_from_u64(58);
    compare_largest_walls((0..20).map(|_| Deviating::draw_both(&mut rng)));
}

fn compare_largest_walls(loops: impl Iterator<Item = Deviating>) {
    for drawn in loops {
        let angles: Vec<_> =
            (1..=ANGLES).map(|n| drawn.at(PI * n as f64 / ANGLES as f64)).collect();
        let wanted = largest(|factor| drawn.passes(factor, &angles));
        let found = largest(|factor| {
            PassivityProblem::of(&drawn.scene(factor)).is_ok_and(|posed| posed.is_certified())
        });
        assert!((found / wanted - 1.0).abs() < TOLERANCE, "{found} for {wanted}: {drawn:?}");
    }
}
