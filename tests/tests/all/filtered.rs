//! The index of a wall whose velocity is filtered and whose torque is limited (equation 61): its proof once
//! more, with the bound that the certificate uses and in rationals; closed motions of the clipped law, which
//! take no more than that; and the exact rule of the wall without the limit.

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::environment::Wall;
use haptic_servo::scene::Coupling;
use num_traits::{One, Signed};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::exact::{Q, of_f64};
use tests::index::{is_negative_somewhere, real_part};
use tests::poly::Poly;
use tests::scenes::{ExactScene, Frame, log_uniform, short, wall_fraction};

use super::composed::{SETTLED, worst};

const WALLS: u64 = 200;
/// Closed motions that are tried on each wall.
const MOTIONS: usize = 6;

/// The slowest pole of a filter, which settles in [`SETTLED`] ticks.
const SLOWEST: f64 = 0.7;

struct Limited {
    frame: Frame,
    wall: Wall,
    /// Largest torque in N m.
    limit: f64,
}

impl Limited {
    fn draw(rng: &mut ChaCha8Rng, delay: usize) -> Self {
        let frame = Frame::draw(rng);
        let stiffness = short(frame.unit() * log_uniform(rng, 0.01, 2.0), 16);
        let damping = short(frame.delta * log_uniform(rng, 0.01, 4.0), 24);
        let pole = short(rng.random_range(0.0..SLOWEST), 20);
        let limit = frame.unit() * log_uniform(rng, 0.01, 10.0);
        Self { frame, wall: Wall::damped(stiffness, damping, delay).filtered(pole), limit }
    }

    /// The wall without its limit behind the standard coupling, on a device of this passivity in N m s/rad.
    fn unlimited(&self, delta: f64) -> ExactScene {
        let coupling = Coupling::Spring { stiffness: 2.0 * delta / self.frame.period };
        Frame { delta, coupling, ..self.frame }.with_parts(None, Some(self.wall))
    }

    /// What the certificate uses of the limited wall, in N m s/rad.
    fn bound(&self) -> f64 {
        let mut scene = self.unlimited(self.frame.delta).scene;
        scene.torque_limit = Some(self.limit);
        PassivityProblem::of(&scene).unwrap().bound().expect("a wall has a bound").hi()
    }

    /// The index in N m s/rad without which a closed motion, of these angles in turn, takes energy.
    fn needed(&self, motion: &[f64]) -> f64 {
        let (wall, period) = (&self.wall, self.frame.period);
        let pole = wall.filter().expect("a filter is drawn");
        let (mut velocity, mut late) = (0.0, vec![0.0; wall.delay]);
        let (mut work, mut squares, mut before) = (0.0, 0.0, motion[0]);
        for _ in 0..=SETTLED.div_ceil(motion.len()) {
            (work, squares) = (0.0, 0.0);
            for &angle in motion {
                let step = angle - before;
                velocity = pole * velocity + (1.0 - pole) * step / period;
                let torque = wall.stiffness * angle + wall.damping() * velocity;
                late.insert(0, torque.clamp(-self.limit, self.limit));
                work += late.pop().expect("one was put in") * step;
                squares += step * step;
                before = angle;
            }
        }
        // Rounding moves smaller values.
        if squares < (1e-6 * self.size()).powi(2) {
            return f64::MIN;
        }
        -period * work / squares
    }

    /// The angle in rad at which the spring is at the limit.
    fn size(&self) -> f64 {
        self.limit / self.wall.stiffness
    }
}

fn q(x: f64) -> Q {
    of_f64(x).expect("drawn numbers are finite")
}

/// `G` is the transfer function from velocity to the torque before the limit. `1/G` is a multiplier of Zames
/// and Falb for that: it is positive at first, not positive afterwards, and its sum is not negative. It
/// proves the index 0 without delay, and `alpha` at one sample if `4 alpha Re(1/G) >= abs(z - 1)^2`. Each
/// further sample may need the norm of `(1 - 1/z) G` more, where that is not more than without a filter.
#[test]
fn the_bound_is_proved_by_a_multiplier() {
    let mut filtered = 0;
    for seed in 0..WALLS {
        let mut drawn = Limited::draw(&mut ChaCha8Rng::seed_from_u64(seed), 0);
        let period = q(drawn.frame.period);
        // E = numerator / denominator, and G = T z E / (z - 1).
        let (numerator, denominator) = wall_fraction(&drawn.wall, drawn.frame.period);
        let over = denominator.times(&Poly::integers(&[-1, 1]));
        let under = numerator.raised(1).scaled(&period);
        assert_multiplier(&over, &under);
        let real = real_part(&over, &under);
        assert!(!is_negative_somewhere(&real), "seed {seed}");
        assert_eq!(drawn.bound(), 0.0, "seed {seed}");

        drawn.wall.delay = 1;
        let bound = q(drawn.bound());
        let step = Poly::ascending(vec![q(2.0), q(-2.0)]);
        let needed = step.times(&real_part(&under, &under));
        let rest = real.scaled(&(&bound * q(4.0))).plus(&needed.scaled(&-Q::one()));
        assert!(!is_negative_somewhere(&rest), "seed {seed}: {:?} {bound}", drawn.wall);

        let torque = real_part(&numerator, &numerator).scaled(&(&period * &period));
        for delay in 2..5 {
            drawn.wall.delay = delay;
            let longer = drawn.bound();
            if longer >= unfiltered(&drawn) * (1.0 - 1e-12) {
                continue;
            }
            filtered += 1;
            // The bounds are rounded up, so that their difference may be too small by as much.
            let more = (q(longer) - &bound) / q(delay as f64 - 1.0) * q(1.0 + 1e-12);
            let square = real_part(&denominator, &denominator).scaled(&(&more * &more));
            let rest = square.plus(&torque.scaled(&-Q::one()));
            assert!(!is_negative_somewhere(&rest), "seed {seed}: {:?} {longer}", drawn.wall);
        }
    }
    assert!(filtered > 50, "{filtered}");
}

/// What equation 31 bounds the index by, in N m s/rad: a filter has the l1 norm 1.
fn unfiltered(drawn: &Limited) -> f64 {
    let wall = &drawn.wall;
    wall.stiffness * drawn.frame.period * (wall.delay as f64 - 0.5) + wall.damping()
}

/// The signs of the impulse response of `over / under` are those of a multiplier.
fn assert_multiplier(over: &Poly, under: &Poly) {
    // In powers of 1/z.
    let descending = |p: &Poly| p.coefficients().iter().rev().cloned().collect::<Vec<Q>>();
    let (over, under) = (descending(over), descending(under));
    let mut response: Vec<Q> = Vec::new();
    for i in 0..6 {
        let mut left = over.get(i).cloned().unwrap_or_else(|| q(0.0));
        for (j, before) in response.iter().enumerate() {
            left -= before * under.get(i - j).unwrap_or(&q(0.0));
        }
        response.push(left / &under[0]);
    }
    assert!(response[0].is_positive(), "{response:?}");
    assert!(response[1..].iter().all(|taken| !taken.is_positive()), "{response:?}");
    // From then on it is geometric, and its sum is over(1) / under(1) = 0.
    let rate = &response[4] / &response[3];
    assert!(rate == &response[5] / &response[4] && !rate.is_negative() && rate < Q::one());
}

#[test]
fn no_closed_motion_of_the_clipped_law_takes_more_energy_than_the_bound_allows() {
    for delay in 1..5 {
        let mut shares = Vec::new();
        for seed in 0..WALLS / 4 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let drawn = Limited::draw(&mut rng, delay);
            let (bound, size) = (drawn.bound(), drawn.size());
            let needed = |motion: &[f64]| drawn.needed(motion);
            let worst = (0..MOTIONS).map(|_| worst(size, &mut rng, needed));
            // To and fro within the limit is the worst of one sample.
            let most = worst.fold(needed(&[-1e-3 * size, 1e-3 * size]), f64::max);
            assert!(most <= bound * (1.0 + 1e-8), "{most} of {bound}: {:?}", drawn.wall);
            shares.push(most / bound);
        }
        shares.sort_by(f64::total_cmp);
        let (half, all) = (shares[shares.len() / 2], shares[shares.len() - 1]);
        println!("{delay} samples: half takes up to {half:.3} of the bound, all up to {all:.3}");
        assert!(half > if delay == 1 { 1.0 - 1e-6 } else { 0.4 } && all > 0.8, "{half} {all}");
    }
}

/// For small motions the limit is none.
#[test]
fn a_bound_passes_no_wall_that_the_exact_rule_refuses() {
    let mut refused = 0;
    for seed in 0..WALLS {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let delay = rng.random_range(1..5);
        let drawn = Limited::draw(rng, delay);
        let bound = drawn.bound();
        let passes = |delta: f64| drawn.unlimited(delta).exact.passes_exact();
        assert!(passes(bound * (1.0 + 1e-9)), "seed {seed}: {bound} {:?}", drawn.wall);
        if delay == 1 {
            refused += 1;
            assert!(!passes(bound * (1.0 - 1e-9)), "seed {seed}: {bound} {:?}", drawn.wall);
        }
    }
    assert!(refused > 20, "{refused}");
}
