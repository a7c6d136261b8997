//! Interval arithmetic encloses the exact result, over random bits: subnormals, numbers next to
//! overflow, infinities. One rounding in the wrong direction anywhere and these fail.

use haptic_servo::passivity::interval::Interval;
use num_traits::{Signed, Zero};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::exact::{Q, of_f64, q};
use tests::floats::any_finite;

const ROUNDS: u32 = 5_000;

/// An interval and two numbers inside it.
fn draw(rng: &mut ChaCha8Rng) -> (Interval, [f64; 2]) {
    let a = any_finite(rng);
    let b = match rng.random_range(0..3) {
        0 => a,
        1 => any_finite(rng),
        // A few units in the last place away, as the operands of long computations are.
        _ => (0..rng.random_range(1..4)).fold(a, |x, _| x.next_up()).min(f64::MAX),
    };
    let (lo, hi) = if a <= b { (a, b) } else { (b, a) };
    (Interval::new(lo, hi), [lo, hi])
}

fn contains(interval: Interval, value: &Q) -> bool {
    let below = of_f64(interval.lo()).map_or(interval.lo() == f64::NEG_INFINITY, |lo| lo <= *value);
    let above = of_f64(interval.hi()).map_or(interval.hi() == f64::INFINITY, |hi| *value <= hi);
    below && above
}

/// An operation of intervals, and the same of numbers where it is defined.
type Operation = (&'static str, fn(Interval, Interval) -> Interval, fn(&Q, &Q) -> Option<Q>);

const OPERATIONS: [Operation; 6] = [
    ("add", Interval::add, |a, b| Some(a + b)),
    ("sub", Interval::sub, |a, b| Some(a - b)),
    ("mul", Interval::mul, |a, b| Some(a * b)),
    ("div", Interval::div, |a, b| (!b.is_zero()).then(|| a / b)),
    ("max", Interval::max, |a, b| Some(a.max(b).clone())),
    ("min", Interval::min, |a, b| Some(a.min(b).clone())),
];

/// An operation encloses the exact result at all four pairs of ends; where the operands are single numbers it is no
/// wider than two steps of the last place.
#[test]
fn operations_of_two_intervals() {
    for (name, operation, exact) in OPERATIONS {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        for _ in 0..ROUNDS {
            let ((x, xs), (y, ys)) = (draw(&mut rng), draw(&mut rng));
            let result = operation(x, y);
            assert!(result.lo() <= result.hi(), "{name} {x:?} {y:?}: {result:?}");
            for (a, b) in xs.into_iter().flat_map(|a| ys.map(|b| (a, b))) {
                let Some(truth) = exact(&q(a), &q(b)) else { continue };
                assert!(contains(result, &truth), "{name} {a:e} {b:e} of {x:?} {y:?}: {result:?}");
            }
            if x.is_exact() && y.is_exact() && exact(&q(xs[0]), &q(ys[0])).is_some() {
                let wide = result.lo().next_up().next_up() < result.hi();
                assert!(!wide, "{name} {x:?} {y:?}: {result:?} is wider than it has to be");
            }
        }
    }
}

#[test]
fn unary_operations() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let two = Q::from_integer(2.into());
    for _ in 0..ROUNDS {
        let (x, ends) = draw(&mut rng);
        for a in ends {
            assert!(contains(x.neg(), &-q(a)), "neg {x:?}");
            assert!(contains(x.half(), &(q(a) / &two)), "half {x:?}");
            assert!(contains(x.double(), &(q(a) * &two)), "double {x:?}");
            assert!(contains(x.abs(), &q(a).abs()), "abs {x:?}");
            assert!(q(x.magnitude()) >= q(a).abs(), "magnitude {x:?}");
        }
    }
}

#[test]
fn square_roots() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    for _ in 0..ROUNDS {
        let (x, ends) = draw(&mut rng);
        let root = x.sqrt();
        for a in ends.into_iter().filter(|a| *a >= 0.0) {
            // The square of the lower end is not above, that of the upper end not below.
            let below = root.lo() <= 0.0 || of_f64(root.lo()).is_some_and(|r| &r * &r <= q(a));
            let above = of_f64(root.hi()).is_none_or(|r| !r.is_negative() && &r * &r >= q(a));
            assert!(below && above, "sqrt {a:e} of {x:?}: {root:?}");
        }
    }
}

/// A pole at exactly `z = 1` is distinguished from a pole near it only because these stay single numbers.
#[test]
fn exact_results_stay_exact() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for _ in 0..ROUNDS {
        let (a, b) = (any_finite(&mut rng), any_finite(&mut rng));
        if of_f64(a + b).is_some_and(|sum| sum == q(a) + q(b)) {
            let sum = Interval::exact(a).add(Interval::exact(b));
            assert!(sum.is_exact() && sum.lo() == a + b, "{a:e} + {b:e}: {sum:?}");
        }
        let small =
            |rng: &mut ChaCha8Rng| f64::from(rng.random_range(-(1 << 26)..1 << 26)) / 1024.0;
        let (a, b) = (small(&mut rng), small(&mut rng));
        let product = Interval::exact(a).mul(Interval::exact(b));
        assert!(product.is_exact() && product.lo() == a * b, "{a} * {b}: {product:?}");
        if b != 0.0 {
            let quotient = product.div(Interval::exact(b));
            assert!(quotient.is_exact() && quotient.lo() == a, "{a} * {b} / {b}: {quotient:?}");
        }
    }
}

/// Every decimal of up to 17 digits that rounds to a number is in its `decimal` enclosure.
#[test]
fn decimals_are_what_was_written() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for _ in 0..ROUNDS {
        let digits = rng.random_range(0..17);
        let text = format!("{:.digits$e}", any_finite(&mut rng));
        let value: f64 = text.parse().expect("a number was written");
        let truth = tests::exact::of_decimal(&text).expect("a decimal was written");
        if value.is_finite() {
            assert!(contains(Interval::decimal(value), &truth), "{text}");
        }
    }
}

#[test]
fn infinities_and_nan_never_narrow() {
    for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN), (2.0, 1.0), (f64::NAN, f64::NAN)] {
        assert_eq!(Interval::new(a, b), Interval::ENTIRE);
    }
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(Interval::exact(x), Interval::ENTIRE);
        assert_eq!(Interval::decimal(x), Interval::ENTIRE);
    }
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for _ in 0..ROUNDS {
        let (finite, [lo, hi]) = draw(&mut rng);
        let half_open = Interval::new(lo, f64::INFINITY);
        for operation in [Interval::add, Interval::sub, Interval::mul, Interval::div] {
            for (x, y) in [(half_open, finite), (finite, half_open), (half_open, Interval::ENTIRE)]
            {
                let result = operation(x, y);
                assert!(result.lo() <= result.hi(), "{x:?} {y:?}: {result:?}");
            }
        }
        let above = half_open.mul(Interval::exact(2.0));
        assert!(contains(above, &(q(hi) * q(2.0))) && above.hi() == f64::INFINITY);
    }
}
