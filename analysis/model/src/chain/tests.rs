//! The enclosure against closed forms, and against theory 3.2 evaluated by eliminating the inner
//! masses: in exact rational arithmetic at single frequencies, which a dense grid in `f64` finds.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Num, ToPrimitive};
use proptest::prelude::*;

use super::*;

type Complex<T> = nalgebra::Complex<T>;

/// `R22 - R12^2 / R11` of theory 3.2 at `w`; [`Chain::excess_passivity`] is its infimum. The formula in its
/// other form, `|Z12 Z21| + Re(Z12 Z21) = 2 R12^2` for a reciprocal device.
fn bound_at<T: Num + Clone + FromDecimal>(chain: &Chain, w: T) -> T {
    let (n, zero) = (chain.masses().len(), T::zero());
    let mut z = vec![vec![Complex::new(zero.clone(), zero); n]; n];
    for (i, mass) in chain.masses().iter().enumerate() {
        z[i][i] =
            Complex::new(T::from_decimal(mass.damping), T::from_decimal(mass.inertia) * w.clone());
    }
    for (i, link) in chain.links().iter().enumerate() {
        let stiffness = T::zero() - T::from_decimal(link.stiffness) / w.clone();
        let between = Complex::new(T::from_decimal(link.damping), stiffness);
        for (row, column, plus) in
            [(i, i, true), (i + 1, i + 1, true), (i, i + 1, false), (i + 1, i, false)]
        {
            let entry = z[row][column].clone();
            z[row][column] = if plus { entry + between.clone() } else { entry - between.clone() };
        }
    }
    // Nothing acts on the inner masses: eliminate them, from the motor's side to the hand's.
    for inner in 1..n - 1 {
        let next = inner + 1;
        let (up, down) = (
            z[0][inner].clone() / z[inner][inner].clone(),
            z[next][inner].clone() / z[inner][inner].clone(),
        );
        let (to_motor, to_next) = (z[inner][0].clone(), z[inner][next].clone());
        z[0][0] = z[0][0].clone() - up.clone() * to_motor.clone();
        z[0][next] = z[0][next].clone() - up * to_next.clone();
        z[next][0] = z[next][0].clone() - down.clone() * to_motor;
        z[next][next] = z[next][next].clone() - down * to_next;
    }
    let across = z[0][n - 1].re.clone();
    z[0][0].re.clone() - across.clone() * across / z[n - 1][n - 1].re.clone()
}

trait FromDecimal {
    fn from_decimal(value: f64) -> Self;
}

impl FromDecimal for f64 {
    fn from_decimal(value: f64) -> Self {
        value
    }
}

impl FromDecimal for BigRational {
    /// The decimal that the double stands for.
    fn from_decimal(value: f64) -> Self {
        let shortest = format!("{value}");
        let (whole, fraction) = shortest.split_once('.').unwrap_or((&shortest, ""));
        let digits: BigInt = format!("{whole}{fraction}").parse().unwrap();
        Self::new(digits, num_traits::pow(BigInt::from(10), fraction.len()))
    }
}

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).unwrap()
}

fn chain(masses: &[(f64, f64)], links: &[(f64, f64)]) -> Chain {
    let masses = masses.iter().map(|&(inertia, damping)| Mass { inertia, damping }).collect();
    let links = links.iter().map(|&(stiffness, damping)| Link { stiffness, damping }).collect();
    Chain::new(masses, links).unwrap()
}

/// Least value on a grid of frequencies around the resonances, refined around its smallest points. What `f64`
/// loses to cancellation, up to 1e-9 at high frequencies, can miss the frequency of the least value, but the value
/// at the frequency that is found is exact.
fn least_on_grid(chain: &Chain) -> BigRational {
    let at = |exponent: f64| bound_at(chain, 10f64.powf(exponent));
    const POINTS: i32 = 3000;
    let exponent = |index: i32| -1.0 + 8.0 * f64::from(index) / f64::from(POINTS);
    let values: Vec<f64> = (0..=POINTS).map(|index| at(exponent(index))).collect();
    let mut least = [exponent(0), exponent(POINTS)].to_vec();
    for index in 1..POINTS {
        let here = values[index as usize];
        if here <= values[index as usize - 1] && here <= values[index as usize + 1] {
            let (mut low, mut high) = (exponent(index - 1), exponent(index + 1));
            for _ in 0..60 {
                let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
                if at(a) < at(b) { high = b } else { low = a }
            }
            least.push(0.5 * (low + high));
        }
    }
    let least = least.into_iter().min_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
    bound_at(chain, exact(10f64.powf(least)))
}

#[test]
fn two_masses_have_their_closed_form() {
    for (motor, hand, link) in [
        ((0.05, 0.5), (0.02, 0.25), (700.0, 0.125)),
        ((2.2e-5, 0.022), (1e-4, 1e-9), (1e5, 3.0)),
        ((1.0, 0.0), (1e-6, 2.0), (0.0, 0.5)),
        ((1.0, 0.5), (1.0, 0.0), (30.0, 1.0)),
        ((1.0, 0.5), (1.0, 1.0), (30.0, 0.0)),
        ((1.0, 0.5), (1.0, 0.0), (30.0, 0.0)),
    ] {
        let (b2, b1, b12): (f64, f64, f64) = (motor.1, hand.1, link.1);
        let parallel = if b1 == 0.0 || b12 == 0.0 { 0.0 } else { b1 * b12 / (b1 + b12) };
        let found = chain(&[motor, hand], &[link]).excess_passivity().unwrap();
        let wanted = b2 + parallel;
        assert!(
            (found.delta.midpoint() - wanted).abs() < 1e-15 * (1.0 + wanted),
            "{found:?} {wanted}"
        );
        assert!(found.delta.hi() - found.delta.lo() < 1e-14 * wanted, "{found:?}");
        assert_eq!(found.reached, Reached::Everywhere);
    }
}

/// Node by node the two-mass rule gives a safe lower bound (theory, section 3.2).
fn rule_node_by_node(chain: &Chain) -> f64 {
    let mut bound = chain.masses().last().unwrap().damping;
    for (mass, link) in chain.masses().iter().zip(chain.links()).rev() {
        let through = if bound * link.damping == 0.0 {
            0.0
        } else {
            bound * link.damping / (bound + link.damping)
        };
        bound = mass.damping + through;
    }
    bound
}

#[test]
fn three_masses_reach_the_rule_inside_and_exceed_it_at_the_ends() {
    let inside = chain(&[(0.02, 0.05), (0.05, 0.05), (0.1, 0.5)], &[(3000.0, 2.0), (3000.0, 0.1)]);
    let found = inside.excess_passivity().unwrap();
    let (rule, grid) = (rule_node_by_node(&inside), least_on_grid(&inside).to_f64().unwrap());
    assert!((rule - 0.175).abs() < 1e-15 && found.delta.contains(0.175), "{rule} {found:?}");
    assert!(found.delta.hi() - found.delta.lo() < 1e-14, "{found:?}");
    assert!((found.delta.midpoint() - grid).abs() < 1e-14, "{grid} {found:?}");
    assert!(matches!(found.reached, Reached::At(omega) if (214.4..214.5).contains(&omega)));
    for (links, end) in [
        ([(900.0, 0.5), (400.0, 0.0625)], Reached::AtRest),
        ([(900.0, 0.0625), (400.0, 0.3)], Reached::AtInfinity),
    ] {
        let device = chain(&[(0.05, 0.25), (0.02, 0.125), (0.03, 0.1)], &links);
        let found = device.excess_passivity().unwrap();
        assert!(rule_node_by_node(&device) + 4e-4 < found.delta.lo());
        let grid = least_on_grid(&device).to_f64().unwrap();
        assert!((found.delta.midpoint() - grid).abs() < 1e-7);
        assert_eq!(found.reached, end);
    }
}

/// Rigid, without a damper behind the motor, and grounded nowhere else.
#[test]
fn the_motor_alone_has_its_damping() {
    let motor = (0.05, 0.5);
    let free = [motor, (0.02, 0.0), (0.01, 0.0)];
    for (device, width) in [
        (chain(&[motor], &[]), 1e-15),
        (chain(&free, &[(300.0, 0.0), (500.0, 0.0)]), 1e-15),
        (chain(&free, &[(300.0, 0.2), (500.0, 0.1)]), 1e-12),
    ] {
        let delta = device.excess_passivity().unwrap().delta;
        assert!(delta.contains(0.5) && delta.hi() - delta.lo() < width, "{delta:?}");
    }
}

/// The passivity of a chain with nearly rigid links is its damping except for the last bits, and the sum of
/// the dampers is rounded either way.
#[test]
fn the_rigid_stand_in_has_no_more_passivity_than_damping() {
    for part in 1..100 {
        let b = [0.001 * f64::from(part), 0.01 * f64::from(part).sqrt(), 0.1, 0.3];
        let device = chain(&b.map(|b| (0.05, b)), &[(3.0, 1e30); 3]);
        let rigid = device.as_rigid().unwrap();
        assert!(rigid.passivity.unwrap() <= rigid.damping, "{rigid:?}");
        assert!(rigid.passivity.unwrap() > (1.0 - 1e-12) * rigid.damping, "{rigid:?}");
    }
}

#[test]
fn a_chain_of_the_greatest_length_is_enclosed() {
    let masses: Vec<_> = (0..MAX_MASSES).map(|i| (1e-5 * (i + 1) as f64, 0.02)).collect();
    let links: Vec<_> = (1..MAX_MASSES).map(|i| (30.0 * i as f64, 0.03)).collect();
    let device = chain(&masses, &links);
    let found = device.excess_passivity().unwrap();
    let grid = least_on_grid(&device).to_f64().unwrap();
    assert!(
        found.delta.contains(grid) || (found.delta.midpoint() - grid).abs() < 1e-9,
        "{found:?} {grid}"
    );
    assert!(found.delta.hi() - found.delta.lo() < 1e-17, "{found:?}");
    let longer = vec![Mass { inertia: 1.0, damping: 0.0 }; MAX_MASSES + 1];
    let bad = Chain::new(longer, vec![Link { stiffness: 1.0, damping: 0.0 }; MAX_MASSES]);
    assert_eq!(bad, Err(ChainError::Masses(MAX_MASSES + 1)));
}

#[test]
fn a_distant_encoder_and_a_lag_leave_none() {
    let device = chain(&[(0.05, 0.5), (0.02, 0.25)], &[(700.0, 0.125)]);
    let apart = device.clone().with_encoder(EncoderPlace::Hand);
    let Err(NoPassivity::EncoderAtHand { omega: Some(omega) }) = apart.excess_passivity() else {
        panic!("{:?}", apart.excess_passivity());
    };
    assert!(two_port::TwoPort::of(&apart, omega).hand_by_motor.re < 0.0);
    let late = device.with_actuator_lag(1e-3).unwrap();
    assert!(matches!(late.excess_passivity(), Err(NoPassivity::ActuatorLag { .. })));
    // On a single mass both places are the same.
    let rigid = Chain::rigid(1.0, 1.0).unwrap().with_encoder(EncoderPlace::Hand);
    assert!(rigid.is_collocated() && rigid.excess_passivity().is_ok());
}

#[test]
fn numbers_that_are_no_chain_are_refused() {
    assert!(Chain::rigid(0.0, 1.0).unwrap_err().to_string().contains("inertia of mass 1 is 0"));
    assert!(Chain::rigid(1.0, f64::NAN).is_err() && Chain::rigid(1.0, -1.0).is_err());
    let mass = Mass { inertia: 1.0, damping: 0.0 };
    assert_eq!(Chain::new(vec![mass; 2], vec![]), Err(ChainError::Links { masses: 2, links: 0 }));
    let open = Link { stiffness: 0.0, damping: 0.0 };
    assert_eq!(Chain::new(vec![mass; 2], vec![open]), Err(ChainError::Open(1)));
}

fn decades(from: f64, to: f64) -> impl Strategy<Value = f64> {
    (from..to).prop_map(|exponent| 10f64.powf(exponent))
}

fn damping() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 5 => decades(-4.0, 0.5)]
}

fn random_chain() -> impl Strategy<Value = Chain> {
    (2usize..=6).prop_flat_map(|n| {
        let masses = prop::collection::vec((decades(-3.0, 0.0), damping()), n);
        let links = prop::collection::vec((decades(1.0, 4.0), damping()), n - 1);
        (masses, links).prop_map(|(masses, links): (Vec<_>, Vec<_>)| chain(&masses, &links))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(80) })]

    #[test]
    fn no_frequency_is_below_the_enclosure_and_one_is_in_it(device in random_chain(), exponents in prop::collection::vec(-1.0..5.0f64, 4)) {
        // With no damper at the hand's end R11 is 0 there, and the formula is 0/0.
        let hand_end = device.masses().last().unwrap().damping + device.links().last().unwrap().damping;
        prop_assume!(hand_end > 0.0);
        let found = device.excess_passivity().unwrap();
        let (lo, hi) = (found.delta.lo(), found.delta.hi());
        prop_assert!(hi - lo <= 1e-15 * hi + 1e-30 * device.damping(), "{found:?}");
        prop_assert!(rule_node_by_node(&device) <= hi * (1.0 + 1e-14));
        for exponent in exponents {
            prop_assert!(bound_at(&device, exact(10f64.powf(exponent))) >= exact(lo));
        }
        let grid = least_on_grid(&device);
        prop_assert!(grid >= exact(lo), "{} {found:?}", grid.to_f64().unwrap());
        if let Reached::At(omega) = found.reached {
            let reached = bound_at(&device, exact(omega));
            prop_assert!((&reached - exact(hi)) <= exact(1e-15 * hi + 1e-30 * device.damping()), "{} {found:?}", reached.to_f64().unwrap());
            prop_assert!(grid <= exact(hi + 1e-9 * (hi + device.damping())), "{} {found:?}", grid.to_f64().unwrap());
        }
    }
}
