//! Indices `alpha` that are known by formula (theory, section 5), as enclosures in N m s/rad.
//!
//! The certificate does not use them: it judges every linear scene by the general test, and these
//! are what that test is checked against. Arguments: stiffness `k` in N m/rad, damping `b` in
//! N m s/rad, period `t` in s, delay `n` in samples.

use super::interval::Interval;

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

/// Tustin damper `B (2 / T)(z - 1)/(z + 1)`, undelayed: `-B`.
pub const fn tustin_damper(b: Interval) -> Interval {
    b.neg()
}

/// Free mode that cancels `be >= 0` (equations 22, 23): `be`, reached at `z = 1`.
pub const fn free_mode(be: Interval) -> Interval {
    be
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
