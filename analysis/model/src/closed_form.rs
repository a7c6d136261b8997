//! Indices `alpha` that are known by formula (theory, section 5), as enclosures in N m s/rad.
//!
//! The certificate does not use them: it judges every linear scene by the general test, and these formulas
//! check that test. Arguments: stiffness `k` in N m/rad, damping `b` in N m s/rad, period `t` in s, delay `n`
//! in samples.

use haptic_servo::passivity::interval::Interval;

const TWO: Interval = Interval::exact(2.0);
const EIGHT: Interval = Interval::exact(8.0);

/// Spring `K z^-n`, `K > 0`: `K T (n - 1/2)` (equation 21 for `n = 1`).
pub const fn delayed_spring(k: Interval, t: Interval, n: usize) -> Interval {
    k.mul(t).mul(Interval::exact(n as f64 - 0.5))
}

/// Wall `z^-n (K + B q / T)`, `K > 0`, `n <= 3` (equation 27 for `n = 1`); `B > 0` for `n >= 2`.
/// `None` where no formula is known, or where the operands leave open which branch holds.
pub const fn damper_wall(k: Interval, b: Interval, t: Interval, n: usize) -> Option<Interval> {
    let kt = k.mul(t);
    match n {
        0 => Some(kt.half().add(b).neg()),
        1 => Some(kt.half().add(b.abs())),
        2 if b.is_positive() => wall_by_two(kt, b),
        3 if b.is_positive() => wall_by_three(kt, b),
        _ => None,
    }
}

const fn wall_by_two(kt: Interval, b: Interval) -> Option<Interval> {
    let four_b = b.double().double();
    if kt.hi() <= four_b.lo() {
        Some(kt.half().add(b).add(kt.mul(kt).div(EIGHT.mul(b))))
    } else if four_b.hi() < kt.lo() {
        Some(Interval::exact(1.5).mul(kt).sub(b))
    } else {
        None
    }
}

const fn wall_by_three(kt: Interval, b: Interval) -> Option<Interval> {
    let (five_kt, nine_b) = (Interval::exact(5.0).mul(kt), Interval::exact(9.0).mul(b));
    if five_kt.hi() <= nine_b.lo() {
        let three_b = Interval::exact(3.0).mul(b);
        let root = kt.mul(kt).add(three_b.mul(kt)).add(three_b.mul(three_b)).sqrt();
        let c0 = kt.add(root).div(three_b.double());
        let left = wall_by_three_at(kt, b, Interval::exact(-1.0)).neg();
        Some(left.max(wall_by_three_at(kt, b, c0).neg()))
    } else if nine_b.hi() < five_kt.lo() {
        Some(five_kt.half().sub(b).max(kt.half().add(b)))
    } else {
        None
    }
}

/// `-(K T / 2)(4 c^2 + 2 c - 1) + B (4 c^3 - 3 c)`.
const fn wall_by_three_at(kt: Interval, b: Interval, c: Interval) -> Interval {
    let four_c2 = c.mul(c).double().double();
    let spring = kt.half().mul(four_c2.add(c.double()).sub(Interval::ONE));
    b.mul(four_c2.mul(c).sub(Interval::exact(3.0).mul(c))).sub(spring)
}

/// Wall delayed by one sample whose velocity passes `(1 - a) / (1 - a / z)`, `B >= 0`:
/// `K T / 2 + B (1 - a) / (1 + a)`.
pub const fn filtered_wall(k: Interval, b: Interval, a: Interval, t: Interval) -> Interval {
    let ratio = Interval::ONE.sub(a).div(Interval::ONE.add(a));
    k.mul(t).half().add(b.mul(ratio))
}

/// Free mode behind a coupling spring `k_vc`, with an undelayed wall: `be - K T / 2 - B`.
pub const fn free_mode_undelayed_wall(
    be: Interval,
    k: Interval,
    b: Interval,
    t: Interval,
) -> Interval {
    be.sub(k.mul(t).half()).sub(b)
}

/// Free mode behind a coupling spring `k_vc`, with a wall delayed by one sample, `B >= 0`:
/// the larger of `K T / 2 - B + be` (at `z = 1`) and
/// `K T / 2 + B + be k / (be + k)`, `k = K_vc T / 2` (at `z = -1`).
pub const fn free_mode_delayed_wall(
    be: Interval,
    k_vc: Interval,
    k: Interval,
    b: Interval,
    t: Interval,
) -> Interval {
    let half = k.mul(t).half();
    let kappa = k_vc.mul(t).div(TWO);
    let at_minus_one = kappa.mul(be).div(kappa.add(be));
    half.sub(b).add(be).max(half.add(b).add(at_minus_one))
}

#[cfg(test)]
mod tests {
    use haptic_servo::passivity::discrete::index;
    use haptic_servo::passivity::polynomial::Polynomial;
    use haptic_servo::passivity::transfer::Transfer;
    use proptest::prelude::*;

    use super::*;

    const T: Interval = Interval::exact(0.0009765625);

    /// The general test on `(sum of numerator z^i) / (T sum of denominator z^i)`.
    fn general(numerator: &[Interval], denominator: &[Interval], shift: i32) -> Interval {
        let numerator = Polynomial::ascending(numerator);
        let denominator = Polynomial::ascending(denominator).scaled(T);
        let e = Transfer { shift, ..Transfer::new(numerator, denominator) };
        index(e, T, false).expect("a wall meets the pole conditions").minimum
    }

    fn wall(k: Interval, b: Interval, n: usize) -> Interval {
        general(&[b.neg(), k.mul(T).add(b)], &[Interval::ZERO, Interval::ONE], -(n as i32))
    }

    /// `-be K (z - 1) / ((K T + be) z - be)`.
    fn canceller(be: Interval, k_vc: Interval) -> Transfer {
        let denominator = [be.neg(), k_vc.mul(T).add(be)];
        let numerator = Polynomial::ascending(&[be.mul(k_vc).neg()]);
        Transfer { ones: 1, ..Transfer::new(numerator, Polynomial::ascending(&denominator)) }
    }

    fn agree(formula: Interval, general: Interval) {
        assert!(
            formula.lo() <= general.hi() && general.lo() <= formula.hi(),
            "{formula:?} {general:?}"
        );
        let size = formula.magnitude().max(1e-3);
        assert!(general.hi() - general.lo() <= 1e-9 * size, "{general:?}");
    }

    proptest! {
        #[test]
        fn springs(k in 1.0..2000.0, n in 0usize..=8) {
            let k = Interval::exact(k);
            let denominator = [Interval::ONE];
            let general = general(&[k.mul(T)], &denominator, -(n as i32));
            agree(delayed_spring(k, T, n), general);
        }

        #[test]
        fn walls(k in 1.0..2000.0, b in 0.01..2.0, n in 0usize..=3) {
            let (k, b) = (Interval::exact(k), Interval::exact(b));
            if let Some(formula) = damper_wall(k, b, T, n) {
                agree(formula, wall(k, b, n));
            }
        }

        #[test]
        fn filtered(k in 1.0..2000.0, b in 0.01..2.0, a in 0.0..0.95) {
            let (k, b, a) = (Interval::exact(k), Interval::exact(b), Interval::exact(a));
            let (kt, gain) = (k.mul(T), b.mul(Interval::ONE.sub(a)));
            let numerator = [kt.mul(a).add(gain).neg(), kt.add(gain)];
            agree(filtered_wall(k, b, a, T), general(&numerator, &[a.neg(), Interval::ONE], -1));
        }

        #[test]
        fn free_modes_behind_walls(
            be in 0.01..0.5,
            k_vc in 500.0..4000.0,
            k in 1.0..400.0,
            b in 0.01..0.5,
        ) {
            let [be, k_vc, k, b] = [be, k_vc, k, b].map(Interval::exact);
            let numerator = Polynomial::ascending(&[b.neg(), k.mul(T).add(b)]);
            let denominator = Polynomial::ascending(&[Interval::ZERO, T]);
            let undelayed = Transfer::new(numerator, denominator);
            let delayed = Transfer { shift: -1, ..undelayed };
            let sum = |wall| canceller(be, k_vc).plus(&wall).unwrap();
            let formula = free_mode_delayed_wall(be, k_vc, k, b, T);
            agree(formula, index(sum(delayed), T, false).unwrap().minimum);
            let formula = free_mode_undelayed_wall(be, k, b, T);
            agree(formula, index(sum(undelayed), T, false).unwrap().minimum);
        }
    }
}
