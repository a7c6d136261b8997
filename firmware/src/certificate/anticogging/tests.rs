use core::f64::consts::TAU;

use crate::certificate::{Parameter, Rejection, certify, certify_in, passivity_for_anticogging};
use crate::environment::{Anticogging, Environment, Wall};
use crate::number::Format;
use crate::rendering::context_beside_anticogging;
use crate::scene::{Coupling, Device, EncoderReading, Latency, Scene, TimeRange, Timing};

/// A motor of this cogging in N m with so many periods in a turn, on the map of its 4096 angles.
fn motor(torque: f64, periods: u32) -> Anticogging {
    let angle = |i: u32| TAU * f64::from(i * periods % 4096) / 4096.0;
    let torques: Vec<_> = (0..4096).map(|i| -torque * angle(i).sin()).collect();
    Anticogging::learnt(&torques, vec![0; 4096].leak()).unwrap()
}

fn free(delay: usize) -> Environment {
    Wall::spring(0.0, delay).alone()
}

/// At this period and latency, with nothing else to feel.
fn knob(damping: f64, period: f64, latency: Latency, anticogging: Anticogging) -> Scene {
    Scene {
        latency,
        torque_limit: Some(0.1),
        ..Scene::of(Device::damped(3e-5, damping), period, free(1).beside(anticogging))
    }
}

/// Theorem A by quadrature: the envelope of ages from `late` samples and an `age`, then a lag, folded over the
/// period (theory, section 16.1).
fn by_quadrature(slope: f64, period: f64, oldest: f64, lag: f64) -> f64 {
    const STEPS: u32 = 20_000;
    let envelope = |time: f64| {
        if time <= oldest {
            1.0
        } else if lag == 0.0 {
            0.0
        } else {
            ((oldest - time) / lag).exp()
        }
    };
    let folds = ((oldest + 40.0 * lag) / period) as u32 + 2;
    let step = period / f64::from(STEPS);
    let (mut mean, mut square) = (0.0, 0.0);
    for i in 0..STEPS {
        let s = (f64::from(i) + 0.5) * step;
        let folded: f64 = (0..folds).map(|fold| envelope(s + f64::from(fold) * period)).sum();
        (mean, square) = (mean + folded * step, square + folded * folded * step);
    }
    let c = slope * (0.5 * period + mean);
    let variance = period * square - mean * mean;
    0.5 * (c + (c * c + slope * slope * variance).sqrt())
}

/// The passivity that full cancellation of bought motors needs, against a quadrature; the map's chords are a few
/// tenths of a percent less steep than the sine.
#[test]
fn full_cancellation_of_bought_motors_needs_what_a_quadrature_says() {
    let lagging = |age: f64| Latency::delayed(age).with_actuator_lag(8e-5);
    let columns = [
        (1e-3, lagging(1e-5), 1e-5, 8e-5, [6.7e-4, 1.3e-3, 2.0e-3, 4.0e-3, 8.0e-3]),
        (1e-4, Latency::NONE, 0.0, 0.0, [0.63e-4, 1.3e-4, 1.9e-4, 3.8e-4, 7.6e-4]),
        (1e-4, lagging(1e-5), 1e-5, 8e-5, [1.0e-4, 2.0e-4, 3.0e-4, 6.1e-4, 1.2e-3]),
        (1e-4, lagging(1.1e-4), 1.1e-4, 8e-5, [1.4e-4, 2.9e-4, 4.3e-4, 8.6e-4, 1.7e-3]),
        (2.5e-5, lagging(1e-5), 1e-5, 8e-5, [0.54e-4, 1.1e-4, 1.6e-4, 3.2e-4, 6.4e-4]),
    ];
    let motors = [(0.005, 84), (0.005, 168), (0.015, 84), (0.03, 84), (0.03, 168)];
    for (period, latency, age, lag, expected) in columns {
        for ((torque, periods), published) in motors.into_iter().zip(expected) {
            let scene = knob(1e-2, period, latency, motor(torque, periods));
            let found = passivity_for_anticogging(&scene, Format::F64).unwrap();
            let slope = torque * f64::from(periods);
            let exact = by_quadrature(slope, period, period + age, lag);
            assert!((0.997..1.0002).contains(&(found / exact)), "{found} {exact}");
            // Of two digits.
            assert!((found / published - 1.0).abs() < 0.035, "{found} {published}");
        }
    }
}

/// What it needs is not the scene's: beside it the scene certifies as on a device with that much less.
#[test]
fn the_scene_has_the_rest_of_the_passivity() {
    let latency = Latency::delayed(1e-5);
    let anticogging = motor(0.015, 84);
    let scene = |damping: f64, passivity, environment: Environment| Scene {
        device: Device { passivity, ..knob(damping, 1e-4, latency, anticogging).device },
        environment,
        ..knob(damping, 1e-4, latency, anticogging)
    };
    let taken =
        passivity_for_anticogging(&scene(1e-3, None, free(1).beside(anticogging)), Format::F64);
    let left = 1e-3 - taken.unwrap();
    let couplings = [
        (Coupling::Rigid, 1),
        (Coupling::Spring { stiffness: 2.0 * left / 1e-4 }, 0),
        (Coupling::Matched, 1),
    ];
    for (coupling, delay) in couplings {
        let mut borders = [0.0_f64; 2];
        for (border, (passivity, beside)) in
            borders.iter_mut().zip([(None, true), (Some(left), false)])
        {
            let passes = |stiffness: f64| {
                let wall = Wall::damped(stiffness, 0.0, delay).behind(0.0).alone();
                let environment = if beside { wall.beside(anticogging) } else { wall };
                let latency = if delay == 0 { Latency::NONE } else { latency };
                certify(&Scene { coupling, latency, ..scene(1e-3, passivity, environment) }).is_ok()
            };
            let (mut low, mut high) = (0.0, 100.0);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if passes(middle) { low = middle } else { high = middle }
            }
            *border = low;
        }
        let [beside, alone] = borders;
        assert!((beside / alone - 1.0).abs() < 1e-9, "{coupling:?}: {beside} {alone}");
    }
    // The servo's coupling is designed for the rest, too.
    let matched =
        Scene { coupling: Coupling::Matched, ..scene(1e-3, None, free(1).beside(anticogging)) };
    let context = context_beside_anticogging::<Environment>(&matched, Format::F32);
    assert!((context.passivity / left - 1.0).abs() < 1e-6, "{}", context.passivity);
}

/// More than certifies is refused with a share that certifies.
#[test]
fn more_than_certifies_is_refused_with_the_bound() {
    let scene = |share| knob(1e-3, 1e-3, Latency::delayed(1e-5), motor(0.015, 84).sharing(share));
    let refused = certify(&scene(1.0)).unwrap_err();
    assert!(matches!(refused, Rejection::Anticogging { needed: Some(_), .. }), "{refused}");
    let remedy = refused.remedies().iter().find(|it| it.parameter == Parameter::Anticogging);
    let most = remedy.unwrap_or_else(|| panic!("{refused}")).highest.unwrap();
    assert!((0.45..0.55).contains(&most), "{refused}");
    for format in [Format::F64, Format::F32] {
        assert!(certify_in(&scene(most), format).is_ok());
        assert!(certify_in(&scene(1.02 * most), format).is_err());
    }
    assert!(certify(&scene(0.0)).is_ok());
    for invalid in [-0.1, 1.0_f64.next_up(), f64::NAN, f64::INFINITY] {
        assert!(matches!(certify(&scene(invalid)), Err(Rejection::Invalid(_))), "{invalid}");
    }
    // Beside a scene that needs the rest.
    let stiff =
        Scene { environment: Wall::spring(0.5, 1).alone().beside(motor(0.005, 84)), ..scene(1.0) };
    let refused = certify(&stiff).unwrap_err();
    assert!(matches!(refused, Rejection::Shortage { .. }), "{refused}");
    let text = refused.to_string();
    assert!(text.contains("anticogging <= 0."), "{text}");
    for remedy in refused.remedies().iter() {
        let value = remedy.highest.or(remedy.lowest).unwrap();
        assert!(certify(&stiff.with(remedy.parameter, value).unwrap()).is_ok(), "{remedy:?}");
    }
}

/// An INL makes it steeper, a dropped reading older, and a longer period both.
#[test]
fn what_the_encoder_does_counts() {
    let needs = |worst_period, encoder: EncoderReading, periods: f64| {
        let encoder = Box::leak(Box::new(encoder));
        let timing = Timing { period: 1e-4, worst_period };
        let scene =
            Scene { timing, ..knob(1.0, 1e-4, Latency::NONE.read_by(encoder), motor(0.015, 84)) };
        let found = passivity_for_anticogging(&scene, Format::F64).unwrap();
        let exact = 0.015 * 84.0 * 1e-4 * periods;
        assert!((0.997..1.0002).contains(&(found / exact)), "{found} {exact}");
    };
    needs(None, EncoderReading::IDEAL, 1.5);
    needs(None, EncoderReading { linearity: 0.04, ..EncoderReading::IDEAL }, 1.04 * 1.5);
    needs(None, EncoderReading { dropped: 2, ..EncoderReading::IDEAL }, 3.5);
    needs(Some(3e-4), EncoderReading::IDEAL, 3.0 * 1.5);
    needs(
        None,
        EncoderReading { age: TimeRange::between(0.0, 1e-4), ..EncoderReading::IDEAL },
        2.5,
    );
}

/// The mean over the angle of the device is up to the learnt mean and what the INL adds: friction has to hold it.
#[test]
fn a_mean_needs_friction() {
    let torques: Vec<_> = (0..64).map(|i| [1e-3, 0.0, -8e-4, 0.0][i % 4]).collect();
    let skew = Anticogging::learnt(&torques, vec![0; 64].leak()).unwrap();
    let with = |friction, linearity, anticogging| {
        let encoder = EncoderReading { friction, linearity, ..EncoderReading::IDEAL };
        let latency = Latency::NONE.read_by(Box::leak(Box::new(encoder)));
        certify(&knob(1e-2, 1e-4, latency, anticogging))
    };
    let Err(Rejection::MotorByInl { mean, anticogs: true, .. }) = with(0.0, 0.0, skew) else {
        panic!("{:?}", with(0.0, 0.0, skew));
    };
    // The mean of triangles of 1 and 0.8 mN m, and clipped at 0.8 they still have one.
    assert!(mean.hi() >= 5e-5 && mean.hi() < 1.2e-4, "{mean:?}");
    assert!(with(mean.hi(), 0.0, skew).is_ok());
    assert!(with(0.0, 0.0, motor(0.005, 84)).is_ok());
    let Err(Rejection::MotorByInl { mean, .. }) = with(0.0, 0.04, motor(0.005, 84)) else {
        panic!()
    };
    assert!((mean.hi() / (0.005 * 0.04 / 0.96) - 1.0).abs() < 1e-6, "{mean:?}");
    assert!(with(3e-3, 0.04, motor(0.005, 84)).is_ok());
}

/// Behind any coupling, and where friction holds no more of a mean: the largest share to three digits.
#[test]
fn a_refusal_names_the_largest_share_that_certifies() {
    let wall = |stiffness| Wall::spring(stiffness, 1).alone().beside(motor(0.03, 84));
    let lagging = Latency::delayed(1e-5).with_actuator_lag(8e-5);
    const EXACT: EncoderReading = EncoderReading { friction: 1e-4, ..EncoderReading::IDEAL };
    const BENT: EncoderReading = EncoderReading { linearity: 0.04, ..EXACT };
    let behind = |coupling, stiffness| Scene {
        coupling,
        environment: wall(stiffness),
        ..knob(1e-3, 1e-3, lagging.read_by(&EXACT), motor(0.03, 84))
    };
    let motored = Scene {
        environment: wall(0.5),
        ..knob(1e-3, 1e-4, lagging.read_by(&BENT), motor(0.03, 84))
    };
    for (scene, least) in [
        (behind(Coupling::Rigid, 0.1), 0.2),
        (behind(Coupling::Matched, 0.1), 0.2),
        (behind(Coupling::Matched, 0.5), 0.18),
        (behind(Coupling::Spring { stiffness: 0.2 }, 0.1), 0.2),
        (motored, 0.05),
    ] {
        let refused = certify(&scene).unwrap_err();
        let remedies = refused.remedies();
        let found = remedies.iter().find(|it| it.parameter == Parameter::Anticogging);
        let most = found.unwrap_or_else(|| panic!("{refused}")).highest.unwrap();
        let passes = |share| certify(&scene.with(Parameter::Anticogging, share).unwrap()).is_ok();
        assert!(most >= least && passes(most) && !passes(1.01 * most), "{most}: {refused}");
    }
    // None passes.
    let refused = certify(&behind(Coupling::Rigid, 50.0)).unwrap_err();
    assert!(refused.remedies().iter().all(|it| it.parameter != Parameter::Anticogging));
}
