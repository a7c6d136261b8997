//! The closed forms of theory section 5, written out here, against the certificate's general test
//! and against the exact reference, over random parameters.
//!
//! A slip in how an environment is turned into a transfer function (a delay counted twice, the
//! filter on the spring too, the sign of the canceller) moves the index away from its formula.

use haptic_servo::certificate::assess;
use haptic_servo::environment::{Canceller, Environment, Wall};
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::Coupling;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::cmp::Ordering;
use tests::exact::{Q, of_f64, ratio};
use tests::scenes::{ExactScene, Frame, log_uniform, short};

const ROUNDS: usize = 200;

fn q(x: f64) -> Q {
    of_f64(x).expect("drawn numbers are finite")
}

/// Device, period and the standard coupling, with a stiffness and a damping that fit them.
struct Draw {
    rng: ChaCha8Rng,
    frame: Frame,
    stiffness: f64,
    damping: f64,
}

impl Draw {
    fn new(seed: usize) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed as u64);
        let mut frame = Frame::draw(&mut rng);
        frame.coupling = Coupling::Spring { stiffness: 2.0 * frame.delta / frame.period };
        let stiffness = short(frame.unit() * log_uniform(&mut rng, 0.01, 2.0), 16);
        let damping = short(frame.delta * log_uniform(&mut rng, 0.01, 2.0), 24);
        Self { rng, frame, stiffness, damping }
    }

    fn kt(&self) -> Q {
        q(self.stiffness) * q(self.frame.period)
    }

    fn b(&self) -> Q {
        q(self.damping)
    }

    fn wall(&self, damping: f64, delay: usize) -> ExactScene {
        self.frame.with_parts(None, Some(Wall::damped(self.stiffness, damping, delay)))
    }
}

fn enclosure(drawn: &ExactScene) -> Interval {
    assess(&drawn.scene).alpha.unwrap_or_else(|| panic!("no index for {:?}", drawn.scene))
}

/// The closed form is the index: by the reference exactly, by the certificate inside it.
fn agree(drawn: &ExactScene, alpha: &Q) {
    let reference = drawn.exact.alpha().expect("the index exists");
    assert_eq!(reference.compare(alpha), Ordering::Equal, "reference, {:?}", drawn.scene);
    let found = enclosure(drawn);
    let inside = q(found.lo()) <= *alpha && *alpha <= q(found.hi());
    assert!(inside, "{alpha} is not in {found:?} of {:?}", drawn.scene);
}

/// The same for a closed form that was computed in floating point.
fn agree_closely(drawn: &ExactScene, alpha: f64) {
    let found = enclosure(drawn);
    let slack = 1e-12 * alpha.abs();
    let overlap = found.lo() <= alpha + slack && alpha - slack <= found.hi();
    assert!(overlap, "{alpha} is not in {found:?} of {:?}", drawn.scene);
}

#[test]
fn springs() {
    for seed in 0..ROUNDS {
        let draw = Draw::new(seed);
        let delay = seed % 9;
        let drawn = draw.frame.with_parts(None, Some(Wall::spring(draw.stiffness, delay)));
        let samples = 2 * i64::try_from(delay).unwrap() - 1;
        agree(&drawn, &(draw.kt() * ratio(samples, 2)));
    }
}

#[test]
fn undelayed_walls() {
    for seed in 0..ROUNDS {
        let draw = Draw::new(seed);
        agree(&draw.wall(draw.damping, 0), &-(draw.kt() * ratio(1, 2) + draw.b()));
    }
}

#[test]
fn walls_one_sample_late() {
    for seed in 0..ROUNDS {
        let draw = Draw::new(seed);
        let alpha = draw.kt() * ratio(1, 2) + draw.b();
        agree(&draw.wall(draw.damping, 1), &alpha);
        agree(&draw.wall(-draw.damping, 1), &alpha);
    }
}

#[test]
fn walls_two_samples_late() {
    for seed in 0..ROUNDS {
        let draw = Draw::new(seed);
        let (kt, b) = (draw.kt(), draw.b());
        let alpha = if kt <= &b * ratio(4, 1) {
            &kt * ratio(1, 2) + &b + &kt * &kt / (&b * ratio(8, 1))
        } else {
            kt * ratio(3, 2) - b
        };
        agree(&draw.wall(draw.damping, 2), &alpha);
    }
}

#[test]
fn walls_three_samples_late() {
    for seed in 0..ROUNDS {
        let draw = Draw::new(seed);
        let (kt, b) = (draw.stiffness * draw.frame.period, draw.damping);
        let g =
            |c: f64| -(kt / 2.0) * (4.0 * c * c + 2.0 * c - 1.0) + b * (4.0 * c.powi(3) - 3.0 * c);
        let alpha = if 5.0 * kt <= 9.0 * b {
            let c0 = (kt + (kt * kt + 3.0 * b * kt + 9.0 * b * b).sqrt()) / (6.0 * b);
            (-g(-1.0)).max(-g(c0))
        } else {
            (2.5 * kt - b).max(0.5 * kt + b)
        };
        agree_closely(&draw.wall(draw.damping, 3), alpha);
    }
}

/// Minus the least of `-(K T / 2)(U_{n-1} + U_{n-2}) + B T_n`, by Sturm's theorem on that very
/// polynomial: it must be the reference's, and the enclosure must hold it.
#[test]
fn walls_later_than_that() {
    for seed in 0..ROUNDS {
        let draw = Draw::new(seed);
        let drawn = draw.wall(draw.damping, 4 + seed % 5);
        let reference = drawn.exact.alpha().expect("the index exists");
        let found = enclosure(&drawn);
        assert_ne!(reference.compare(&q(found.lo())), Ordering::Less, "{:?}", drawn.scene);
        assert_ne!(reference.compare(&q(found.hi())), Ordering::Greater, "{:?}", drawn.scene);
        let width = tests::agreement::relative_width(found);
        assert!(width <= 1e-9, "{found:?} is {width} wide");
    }
}

#[test]
fn filtered_walls_one_sample_late() {
    for seed in 0..ROUNDS {
        let mut draw = Draw::new(seed);
        let a = short(draw.rng.random_range(0.0..0.99), 20);
        let lag = (Q::from_integer(1.into()) - q(a)) / (Q::from_integer(1.into()) + q(a));
        let alpha = draw.kt() * ratio(1, 2) + draw.b() * lag;
        let wall = Wall::damped(draw.stiffness, draw.damping, 1).filtered(a);
        agree(&draw.frame.with_parts(None, Some(wall)), &alpha);
    }
}

#[test]
fn negative_dampers() {
    for seed in 0..ROUNDS {
        let mut draw = Draw::new(seed);
        draw.stiffness = 0.0;
        agree(&draw.wall(-draw.damping, 0), &draw.b());
        agree(&draw.wall(-draw.damping, 1), &draw.b());
    }
}

/// `2 B (z - 1) / (T (z + 1))`: a pole at -1 that is allowed, and no longer is when it is delayed.
#[test]
fn tustin_dampers() {
    use haptic_servo::environment::{Coefficients, Rational};
    use tests::poly::Poly;
    for seed in 0..ROUNDS {
        let draw = Draw::new(seed);
        let gain = 2.0 * draw.damping / draw.frame.period;
        for delay in [0, 1] {
            let environment = Environment::Rational(Rational {
                numerator: Coefficients::new(&[gain, -gain]).expect("two coefficients"),
                denominator: Coefficients::new(&[1.0, 1.0]).expect("two coefficients"),
                delay,
                unit_zeros: 0,
            });
            let over = Poly::integers(&[-1, 1]).scaled(&q(gain));
            let under = Poly::integers(&[1, 1]).raised(delay);
            let drawn = draw.frame.with(environment, (over, under));
            if delay == 0 {
                agree(&drawn, &-draw.b());
            } else {
                let assessment = assess(&drawn.scene);
                assert!(assessment.alpha.is_none() && assessment.outcome.is_err());
            }
        }
    }
}

/// Behind the standard coupling `2 b / T`, with a residual between zero and the damping.
fn free(draw: &mut Draw) -> (Canceller, Q) {
    let residual = short(draw.frame.delta * draw.rng.random_range(0.01..0.99), 24);
    (Canceller::to(residual), q(draw.frame.delta) - q(residual))
}

#[test]
fn free_modes() {
    for seed in 0..ROUNDS {
        let mut draw = Draw::new(seed);
        let (canceller, be) = free(&mut draw);
        agree(&draw.frame.with_parts(Some(canceller), None), &be);
    }
}

#[test]
fn free_modes_with_a_wall() {
    for seed in 0..ROUNDS {
        let mut draw = Draw::new(seed);
        let (canceller, be) = free(&mut draw);
        let half_kt = draw.kt() * ratio(1, 2);
        for delay in [0, 1] {
            let wall = Wall::damped(draw.stiffness, draw.damping, delay);
            let drawn = draw.frame.with_parts(Some(canceller), Some(wall));
            let b = q(draw.frame.delta);
            let alpha = if delay == 0 {
                &be - &half_kt - draw.b()
            } else {
                let still = &half_kt - draw.b() + &be;
                still.max(&half_kt + draw.b() + &b * &be / (&b + &be))
            };
            agree(&drawn, &alpha);
        }
    }
}
