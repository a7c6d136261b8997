//! Properties of the formats, shared where they are the same.

use fixed::FixedI32;
use fixed::types::extra::{U16, U24, U28, U31};
use proptest::prelude::*;

use super::*;

type Q16 = FixedI32<U16>;
type Cut = Truncated<FixedI32<U24>>;

const CENTRE: u16 = 2048;

fn coefficient<N: Number>(value: f64) -> f64 {
    N::coefficient_to_f64(N::coefficient(value).unwrap())
}

fn code<N: Number>(torque: f64, full_scale: f64) -> u16 {
    let scale = N::code_scale(2047.0 / full_scale).unwrap();
    N::from_f64(torque).unwrap().codes_below(CENTRE, scale)
}

fn middle_and_both_ends<N: Number>() {
    for full_scale in [0.9, 0.1] {
        assert_eq!(code::<N>(0.0, full_scale), 2048);
        assert_eq!(code::<N>(full_scale, full_scale), 1);
        assert_eq!(code::<N>(-full_scale, full_scale), 4095);
        let step = full_scale / 2047.0;
        assert_eq!(code::<N>(0.7 * step, full_scale), 2047);
        assert_eq!(code::<N>(0.3 * step, full_scale), 2048);
        assert_eq!(code::<N>(-0.3 * step, full_scale), 2048);
        assert_eq!(code::<N>(-0.7 * step, full_scale), 2049);
    }
}

#[test]
fn the_code_is_in_the_middle_at_no_torque_and_rounds_to_nearest() {
    middle_and_both_ends::<f32>();
    middle_and_both_ends::<f64>();
    middle_and_both_ends::<Q16>();
    middle_and_both_ends::<FixedI32<U24>>();
    middle_and_both_ends::<FixedI32<U31>>();
    middle_and_both_ends::<Cut>();
}

#[test]
fn fixed_point_saturates_at_its_ends() {
    assert_eq!(Q16::MAX.plus(Q16::DELTA), Q16::MAX);
    assert_eq!(Number::minus(Q16::MIN, Q16::DELTA), Q16::MIN);
    assert_eq!(Q16::MIN.negated(), Q16::MAX);
    assert!(!Q16::MIN.within(Q16::from_num(1)));
    let large = Q16::coefficient(1e6).unwrap();
    assert_eq!(Q16::from_num(1).times(large), Q16::MAX);
    assert_eq!(Q16::from_num(-1).times(large), Q16::MIN);
    assert_eq!(Q16::MIN.times(Q16::coefficient(-1.0).unwrap()), Q16::MAX);
}

#[test]
fn what_only_pushes_is_from_zero_to_its_bound() {
    fn ends<N: Number>() {
        let is = |value: f64, bound: f64| {
            N::from_f64(value).unwrap().is_from_zero_to(N::from_f64(bound).unwrap())
        };
        assert!(is(0.0, 0.0) && is(0.0, 0.5) && is(0.25, 0.5) && is(0.5, 0.5));
        assert!(!is(0.75, 0.5) && !is(-0.25, 0.5) && !is(-0.75, 0.5) && !is(0.25, 0.0));
    }
    ends::<f32>();
    ends::<f64>();
    ends::<Q16>();
    ends::<FixedI32<U31>>();
    ends::<Cut>();
    for nan in [f32::NAN, -f32::NAN] {
        assert!(!nan.is_from_zero_to(f32::MAX));
    }
}

#[test]
fn an_angle_beyond_its_format_stands_still_and_says_so() {
    fn ends<N: Number>(last: i32, beyond: i32) {
        let scale = N::angle_scale(1e-4).unwrap();
        for sign in [1, -1] {
            let (inside, fits) = N::angle(last * sign, scale);
            assert!(fits && (inside.to_f64() - f64::from(last * sign) * 1e-4).abs() < 1e-3);
            let (end, fits) = N::angle(beyond * sign, scale);
            assert!(!fits && end.to_f64().abs() >= inside.to_f64().abs());
        }
    }
    ends::<Q16>(327_670_000, 327_690_000);
    ends::<FixedI32<U28>>(79_999, 80_001);
    ends::<Truncated<FixedI32<U28>>>(79_999, 80_001);
    for count in [i32::MIN, -1, 0, 1, i32::MAX] {
        assert_eq!(f64::angle(count, 1e-4), (f64::from(count) * 1e-4, true));
        assert_eq!(f32::angle(count, 1e-4), (count as f32 * 1e-4, true));
    }
}

#[test]
fn what_does_not_fit_is_named() {
    let error = Truncated::<FixedI32<U28>>::from_f64(-9.0).unwrap_err().to_string();
    assert!(error.starts_with("-9 does not fit Q4.28 truncated: "), "{error}");
    let error = FixedI32::<U28>::from_f64(9.0).unwrap_err();
    assert_eq!(error.to_string(), "9 does not fit Q4.28: its magnitude may be at most 7.999999996");
    for value in [f64::NAN, f64::INFINITY, -1e300, 3e9] {
        assert!(Q16::coefficient(value).is_err());
        assert!(Q16::from_f64(value).is_err());
    }
    for value in [f64::NAN, f64::INFINITY, -1e300] {
        assert!(f32::coefficient(value).is_err() && f64::from_f64(value).is_err());
    }
}

/// Of two values the larger never becomes the smaller coefficient, across powers of two as well.
#[test]
fn rounding_keeps_the_order() {
    for format in [Format::F32, Q16::FORMAT] {
        for power in [2_f64.powi(-3), 1.0, 2.0, 2_f64.powi(20), 2_f64.powi(30)] {
            for rounding in [Rounding::Nearest, Rounding::Inward, Rounding::Outward] {
                let around = (-4000..4000).map(|i| power * (1.0 + f64::from(i) * 2_f64.powi(-40)));
                let rounded: Vec<f64> =
                    around.map(|value| format.coefficient(value, rounding)).collect();
                assert!(rounded.is_sorted(), "{format} {power} {rounding:?}");
            }
        }
    }
}

#[test]
fn the_positive_part() {
    fn of<N: Number>() {
        for (value, positive) in [(-0.25, 0.0), (0.0, 0.0), (0.25, 0.25)] {
            assert_eq!(N::from_f64(value).unwrap().positive_part().to_f64(), positive);
        }
    }
    of::<f32>();
    of::<f64>();
    of::<Q16>();
}

proptest! {
    #[test]
    fn coefficients_keep_their_precision(value in -2e9..2e9_f64, power in 0..20) {
        let value = value / 10_f64.powi(power);
        prop_assert!((coefficient::<f32>(value) - value).abs() <= 6e-8 * value.abs());
        prop_assert_eq!(coefficient::<f64>(value), value);
        let bound = (value.abs() * 2_f64.powi(-31)).max(2_f64.powi(-32));
        prop_assert!((coefficient::<Q16>(value) - value).abs() <= bound);
    }

    /// The certificate's coefficients equal the servo's.
    #[test]
    fn a_coefficient_is_known_without_its_type(value in -2e9..2e9_f64, power in 0..25) {
        fn same<N: Number>(value: f64) -> Result<(), TestCaseError> {
            let [nearest, inward, outward] = [Rounding::Nearest, Rounding::Inward, Rounding::Outward]
                .map(|rounding| N::FORMAT.coefficient(value, rounding));
            prop_assert_eq!(nearest, coefficient::<N>(value));
            prop_assert!(inward.abs() <= value.abs() && value.abs() <= outward.abs());
            prop_assert!(nearest == inward || nearest == outward);
            // No number lies between the two.
            let between = 0.5 * (inward + outward);
            prop_assert!([inward, outward].contains(&coefficient::<N>(between)));
            Ok(())
        }
        let value = value / 10_f64.powi(power);
        same::<f32>(value)?;
        same::<f64>(value)?;
        same::<Q16>(value)?;
        same::<FixedI32<U31>>(value)?;
    }

    #[test]
    fn a_fixed_product_is_the_nearest_or_saturates(bits: i32, value in -1e3..1e3_f64) {
        let number = FixedI32::<U24>::from_bits(bits);
        let factor = FixedI32::<U24>::coefficient(value).unwrap();
        // Exact: 31 bits times 31 bits rounded once to 53, and the bound leaves that much room.
        let exact = number.to_f64() * factor_to_f64(factor);
        let (product, end) = (number.times(factor).to_f64(), FixedI32::<U24>::MAX.to_f64());
        let nearest = exact.clamp(-end - 2_f64.powi(-24), end);
        prop_assert!((product - nearest).abs() <= 0.5000001 * 2_f64.powi(-24));
    }

    #[test]
    fn a_truncated_product_is_the_next_below_or_saturates(bits: i32, value in -1e3..1e3_f64) {
        let step = 2_f64.powi(-24);
        let number = Cut::from_f64(f64::from(bits) * step).unwrap();
        prop_assert_eq!(number.to_f64(), f64::from(bits) * step);
        let factor = Cut::coefficient(value).unwrap();
        // Both have 31 bits: exact in whole numbers.
        let factor = Cut::coefficient_to_f64(factor) * 2_f64.powi(31);
        let exact = i128::from(bits) * factor as i128;
        let end = i128::from(i32::MAX);
        let below = exact.div_euclid(1 << 31).clamp(-end - 1, end);
        let product = number.times(Cut::coefficient(value).unwrap()).to_f64();
        prop_assert_eq!(product, below as f64 * step);
        let count = bits >> 1;
        let (angle, fits) = Cut::angle(count, Cut::angle_scale(1.5 * step).unwrap());
        prop_assert!(fits);
        prop_assert_eq!(angle.to_f64(), (1.5 * f64::from(count)).floor() * step);
    }

    #[test]
    fn fixed_angles_are_right_to_a_step(count in -3_000_000..3_000_000_i32) {
        let scale = Q16::angle_scale(1e-4).unwrap();
        let angle = Q16::angle(count, scale).0.to_f64();
        prop_assert!((angle - f64::from(count) * 1e-4).abs() <= 2_f64.powi(-16));
    }

    #[test]
    fn codes_are_within_half_a_step(torque in -1.0..1.0_f64) {
        let exact = f64::from(CENTRE) - torque * 2047.0;
        prop_assert!((f64::from(code::<f32>(torque, 1.0)) - exact).abs() <= 0.5 + 2e-4);
        prop_assert!((f64::from(code::<f64>(torque, 1.0)) - exact).abs() <= 0.5 + 1e-12);
        prop_assert!((f64::from(code::<Q16>(torque, 1.0)) - exact).abs() <= 0.5 + 0.016);
    }
}

fn factor_to_f64(factor: Scaled) -> f64 {
    <FixedI32<U24> as Number>::coefficient_to_f64(factor)
}
