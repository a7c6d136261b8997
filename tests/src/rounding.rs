//! The controller that a servo really computes, in exact numbers: every coefficient rounded to the
//! number format by rational arithmetic, and the transfer function put together from these.

use crate::exact::{Q, q};
use crate::poly::Poly;
use crate::rules::Exact;
use crate::scenes::sum_of;
use haptic_servo::environment::{Canceller, Drag, Parts, Wall};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Scene};
use num_integer::Integer;
use num_traits::{One, Signed, Zero};

fn power_of_two(n: i32) -> Q {
    let two = Q::from_integer(2.into());
    if n < 0 { Q::one() / two.pow(-n) } else { two.pow(n) }
}

/// The step between a format's coefficients around `value`, which is not zero.
fn step(value: &Q, format: Format) -> Q {
    let magnitude = value.abs();
    let mut power = 0;
    while power_of_two(power) > magnitude {
        power -= 1;
    }
    while power_of_two(power + 1) <= magnitude {
        power += 1;
    }
    match format {
        Format::F32 => power_of_two(power - 23),
        // 31 bits, of which no more than 31 stand behind the point.
        Format::Fixed { .. } | Format::Truncated { .. } => power_of_two((power - 30).max(-31)),
        Format::F64 => power_of_two(power - 52),
    }
}

/// The coefficient nearest to a value; between two, the even one.
fn nearest(value: &Q, format: Format) -> Q {
    if value.is_zero() {
        return Q::zero();
    }
    let step = step(value, format);
    let steps = value / &step;
    let below = steps.floor();
    let rest = &steps - &below;
    let half = Q::new(1.into(), 2.into());
    let up = rest > half || rest == half && below.to_integer().is_odd();
    (if up { below + Q::one() } else { below }) * step
}

/// The smallest coefficient that is not below a positive value.
fn not_below(value: &Q, format: Format) -> Q {
    let step = step(value, format);
    (value / &step).ceil() * step
}

/// `g (z - 1) / (z - (1 - rate))` with gain and rate rounded.
fn washout(gain: &Q, rate: &Q, format: Format) -> (Poly, Poly) {
    let (gain, rate) = (nearest(gain, format), nearest(rate, format));
    (Poly::integers(&[-1, 1]).scaled(&gain), Poly::ascending(vec![rate - Q::one(), Q::one()]))
}

fn wall(wall: &Wall, period: &Q, format: Format) -> (Poly, Poly) {
    let spring = (Poly::ascending(vec![nearest(&q(wall.stiffness), format)]), Poly::integers(&[1]));
    let rate = Q::one() - wall.filter().map_or_else(Q::zero, q);
    let damper = washout(&(q(wall.damping()) / period * &rate), &rate, format);
    let sum = if wall.damping() == 0.0 { spring } else { sum_of(&spring, &damper) };
    (sum.0, sum.1.raised(wall.delay))
}

/// The linear scene as it runs in a format; `None` for an environment that is not a spring, a wall
/// or a free mode.
///
/// # Panics
/// If a number of the scene is not finite.
pub fn as_it_runs(scene: &Scene, format: Format) -> Option<Exact> {
    let period = q(scene.timing.period);
    let stiffness = match scene.coupling {
        Coupling::Rigid => None,
        Coupling::Matched => unreachable!("not drawn"),
        Coupling::Spring { stiffness } => Some(q(stiffness)),
    };
    let compliance = stiffness.as_ref().map(|k| not_below(&(Q::one() / k), format));
    let free = |canceller: &Canceller| {
        let be = q(scene.device.damping) - q(canceller.residual);
        let (gain, rate) = match &stiffness {
            None => (&be / &period, Q::one()),
            Some(k) => {
                let leading = k * &period + &be;
                (&be * k / &leading, k * &period / &leading)
            }
        };
        let (numerator, denominator) = washout(&-gain, &rate, format);
        (numerator, denominator.raised(canceller.delay))
    };
    let damper = |drag: &Drag| {
        let (numerator, denominator) = washout(&(q(drag.damping) / &period), &Q::one(), format);
        (numerator, denominator.raised(drag.delay))
    };
    let Parts { canceller, wall: beside, profile: None, drag, anticogging: None } =
        scene.environment.parts()
    else {
        return None;
    };
    let parts = [
        canceller.as_ref().map(free),
        beside.as_ref().map(|beside| wall(beside, &period, format)),
        drag.as_ref().map(damper),
    ];
    let (numerator, denominator) = parts.into_iter().flatten().reduce(|a, b| sum_of(&a, &b))?;
    // The direct feedthrough is solved with the coupling by a gain that is rounded as well.
    let through = if numerator.degree() < denominator.degree() || numerator.is_zero() {
        Q::zero()
    } else {
        numerator.leading() / denominator.leading()
    };
    let fed_back = through * compliance.clone().unwrap_or_else(Q::zero);
    let gain = nearest(&(Q::one() / (Q::one() + &fed_back)), format);
    let solved = &gain / (Q::one() - &fed_back * &gain);
    Some(Exact {
        numerator: numerator.scaled(&solved),
        denominator,
        period,
        delta: q(scene.device.damping),
        coupling: compliance.map(|v| Q::one() / v),
    })
}
