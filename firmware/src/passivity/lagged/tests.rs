use super::*;

fn controller(numerator: &[f64], denominator: &[f64]) -> Transfer {
    Transfer::new(
        Polynomial::descending(numerator, true),
        Polynomial::descending(denominator, true),
    )
}

/// `(Re(H g), D abs(H)^2)` at an angle, summed over the aliases of the model in continuous time: it
/// shares nothing with the closed forms.
fn summed(h: (f64, f64), delay: f64, lags: [f64; 2], theta: f64) -> (f64, f64) {
    type Complex = (f64, f64);
    let mul = |a: Complex, b: Complex| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let over = |a: Complex, b: Complex| {
        let m = b.0 * b.0 + b.1 * b.1;
        mul(a, (b.0 / m, -b.1 / m))
    };
    let (mut g, mut held, mut sensed) = ((0.0, 0.0), 0.0, 0.0);
    const ALIASES: i32 = 200_000;
    for k in -ALIASES..=ALIASES {
        let w = theta + std::f64::consts::TAU * f64::from(k);
        let hold = over((1.0 - theta.cos(), theta.sin()), (0.0, w));
        let late = ((w * delay).cos(), -(w * delay).sin());
        let amplifier = over(mul(hold, late), (1.0, w * lags[0]));
        let sensor = over(over((1.0, 0.0), (0.0, w)), (1.0, w * lags[1]));
        let term = mul(amplifier, sensor);
        g = (g.0 + term.0, g.1 + term.1);
        held += amplifier.0 * amplifier.0 + amplifier.1 * amplifier.1;
        sensed += sensor.0 * sensor.0 + sensor.1 * sensor.1;
    }
    let magnitude = h.0 * h.0 + h.1 * h.1;
    let d = held * sensed - (g.0 * g.0 + g.1 * g.1);
    (mul(h, g).0, d * magnitude)
}

#[test]
fn closed_forms_are_the_sums_over_aliases() {
    let exact = Interval::exact;
    for (delay, lags) in [
        (0.0, [0.0, 0.0]),
        (0.3, [0.0, 0.0]),
        (0.0, [0.7, 0.0]),
        (0.6, [0.2, 0.0]),
        (0.0, [0.0, 1.5]),
        (0.4, [0.3, 0.8]),
        (1.25, [2.0, 0.1]),
        (0.4, [0.5, 0.5]),
        (0.0, [1.3, 1.3]),
    ] {
        let lag = LagIntervals {
            delay: exact(delay),
            lags: [exact(lags[0]), exact(lags[1])],
            updates: 0,
            between: false,
        };
        let response = lag.response(0).unwrap();
        // H = 2 (z - 0.25) / (z + 0.5), period 1.
        let h = controller(&[2.0, -0.5], &[1.0, 0.5]);
        let port = Port::new(&h, &response, Interval::ONE, Interval::ZERO).unwrap();
        for theta in [0.05, 0.8, 1.9, 3.0] {
            let (c, s) = (f64::cos(theta), f64::sin(theta));
            let (n, d) = ((2.0 * c - 0.5, 2.0 * s), (c + 0.5, s));
            let m = d.0 * d.0 + d.1 * d.1;
            let at = ((n.0 * d.0 + n.1 * d.1) / m, (n.1 * d.0 - n.0 * d.1) / m);
            let (real, ripple) = summed(at, delay, lags, theta);
            let c = exact(c);
            let r = port.r.at(c);
            let found = port.real.at(c).mul(port.scale).half().div(r);
            assert!(
                (found.midpoint() - real).abs() < 2e-5 * (1.0 + real.abs()),
                "{delay} {lags:?}"
            );
            let found = port.ripple.at(c).div(r);
            assert!(
                (found.midpoint() - ripple).abs() < 1e-4 * (0.1 + ripple),
                "{delay} {lags:?} {theta}: {found:?} for {ripple}"
            );
        }
    }
}

/// The closed form for springs behind a delay, `K T / delta < (sqrt(e^2 + 4 D) - e) / D`.
#[test]
fn springs_have_their_closed_form() {
    let exact = Interval::exact;
    for (delay, lag) in [(0.5_f64, 0.0_f64), (0.0, 0.3), (0.0, 1.4)] {
        let coth = 1.0 / f64::tanh(0.5 / lag);
        let ripple = match lag {
            0.0 => delay * (1.0 - delay),
            _ => lag * lag * (0.5 / lag * coth - 1.0),
        };
        let e = 1.0 + 2.0 * delay + 2.0 * lag;
        let limit = ((e * e + 4.0 * ripple).sqrt() - e) / ripple;
        let lags = [exact(lag), Interval::ZERO];
        let lag = LagIntervals { delay: exact(delay), lags, updates: 0, between: false };
        let response = lag.response(0).unwrap();
        let spring = controller(&[limit], &[1.0]);
        let port = Port::new(&spring, &response, Interval::ONE, Interval::ZERO).unwrap();
        let first = port.index_for(exact(0.5), &Precision::TIGHT).unwrap();
        let needed = port.needed(0.5, first).unwrap();
        assert!(needed.lo() <= 1.0 + 1e-9 && needed.hi() >= 1.0 - 1e-9, "{needed:?}");
        assert!(needed.hi() - needed.lo() <= 1e-9, "{needed:?}");
        assert!(delay != 0.5 || (limit - 0.9443).abs() < 1e-4);
    }
}

/// The integral of the rest of a step, added up over straight lines.
#[test]
fn what_a_sampled_lag_holds_is_the_integral_of_its_step() {
    let exact = Interval::exact;
    for (updates, tau) in [(1_u16, 0.3_f64), (4, 0.2), (7, 2.0)] {
        let n = f64::from(updates);
        let left = (-1.0 / (n * tau)).exp();
        let rest = |y: f64| {
            let update = (y * n).floor();
            left.powf(update) * (1.0 - (1.0 - left) * (y * n - update))
        };
        let lag = SampledLag::of(updates, exact(tau));
        for from in [0.0, 0.1, 0.25, 0.6, 1.0, 2.37] {
            const PARTS: i32 = 400_000;
            let step = 40.0 / f64::from(PARTS);
            let sum: f64 =
                (0..PARTS).map(|i| step * rest(from + step * (f64::from(i) + 0.5))).sum();
            let found = lag.held_after(exact(from));
            assert!(
                (found.midpoint() - sum).abs() < 1e-8,
                "{updates} {tau} {from}: {found:?} {sum}"
            );
            assert!(found.hi() - found.lo() < 1e-14 * (1.0 + found.hi()), "{found:?}");
        }
    }
}
