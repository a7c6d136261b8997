use core::f64::consts::TAU;

use super::*;
use crate::certificate::{Certified, certify_in};
use crate::encoder::RawCount;
use crate::environment::{Environment, Wall};
use crate::number::Format;
use crate::number::fixed::types::I8F24 as Fixed;
use crate::scene::{Device, EncoderReading, Latency, Scene};
use crate::scene_type::Typed;
use crate::servo::Servo;
use crate::test_scene::{Random, TRANSDUCERS};
use crate::transducers::Transducers;

/// Eight cycles of unequal halves.
static COGGING: CoggingMap<64> = CoggingMap::of(&{
    let mut torques = [0.0; 64];
    let cycle = [0.0, -2e-3, -3e-3, -1e-3, 0.5e-3, 2.5e-3, 2e-3, 1e-3];
    each!(i in 0..64 => { torques[i] = cycle[i % 8]; });
    torques
});

static RUBS: EncoderReading = EncoderReading { friction: 2e-3, ..EncoderReading::IDEAL };

const KNOB: Transducers = Transducers { counts_per_turn: 4096.0, ..TRANSDUCERS };

const WALL: Scene = Scene {
    latency: Latency::NONE.read_by(&RUBS),
    torque_limit: Some(0.5),
    ..Scene::of(
        Device::damped(3e-5, 2e-3),
        1e-4,
        Wall::spring(2.0, 1).behind(0.5).alone().beside(Anticogging::of(&COGGING, 0.8)),
    )
};
const CERTIFIED: Certified<Scene> = WALL.certified();
crate::scene_type!(WallScene: CERTIFIED);

/// The table's torque by a straight line between its values.
fn by_a_line(angle: f64) -> f64 {
    let torques: Vec<_> = Anticogging::of(&COGGING, 1.0).torques().collect();
    let place = (angle / TAU).rem_euclid(1.0) * 64.0;
    let (cell, part) = (place as usize, place.fract());
    0.8 * (torques[cell % 64] * (1.0 - part) + torques[(cell + 1) % 64] * part)
}

/// At any number of turns, with the wall in front of none of them.
#[test]
fn the_motor_opposes_the_table_in_every_turn() {
    let mut servo = Servo::<Environment, f32>::new(&CERTIFIED, &KNOB).unwrap();
    let mut random = Random(3);
    let mut count = -1_000_000_i32;
    servo.begin_at(RawCount::from(count.cast_unsigned()));
    let mut before = None;
    for _ in 0..20_000 {
        count += (900.0 * random.next() + 50.0) as i32;
        let angle = f64::from(count) * TAU / 4096.0;
        servo.tick(RawCount::from(count.cast_unsigned()));
        if let Some(before) = before.replace(angle)
            && angle < 0.4
            && before < 0.4
        {
            // A sample late.
            let error = servo.torque_nm() - by_a_line(before);
            assert!(error.abs() < 1e-6, "{before}: {error}");
        }
    }
}

/// The program's servo gives the bits of the servo as data, and a tick early the same as in time.
#[test]
fn a_program_gives_the_same_bits() {
    let mut data = Servo::<Environment, f32>::new(&CERTIFIED, &KNOB).unwrap();
    let typed = Typed::<WallScene>::certified();
    let mut program = Servo::<Typed<WallScene>, f32>::new(&typed, &KNOB).unwrap();
    let mut early = program.clone();
    let mut random = Random(5);
    let (mut count, mut next) = (0_i32, 0);
    for tick in 0..20_000 {
        count += (100.0 * random.next()) as i32;
        let raw = RawCount::from(count.cast_unsigned());
        let (one, other) = (data.tick(raw), program.tick(raw));
        assert_eq!(one, other);
        assert_eq!(data.torque_nm().to_bits(), program.torque_nm().to_bits());
        assert!(tick == 0 || next == program.torque_nm().to_bits());
        early.timed_tick::<crate::servo::Latched>(raw, &mut crate::energy::NoAction);
        next = early.torque_nm().to_bits();
    }
    assert!(size_of::<Servo<Typed<WallScene>, f32>>() < size_of::<Servo<Environment, f32>>());
}

/// It opens with the clamp, and never jumps when that closes.
#[test]
fn it_fades_with_the_clamp() {
    let mut servo = Servo::<Environment, f32>::new(&CERTIFIED, &KNOB).unwrap();
    servo = servo.fading(0.5, 500.0).unwrap();
    servo.clamp().shut();
    let raw = RawCount::from((128_u32).wrapping_sub(4096));
    servo.begin_at(raw);
    servo.rest_here();
    let mut last = 0.0;
    for tick in 0..1200 {
        match tick {
            0..500 => _ = servo.clamp().open(),
            700 => servo.clamp_to_held_torque(),
            701.. => _ = servo.clamp().close(),
            _ => {}
        }
        servo.tick(raw);
        let torque = servo.torque_nm();
        assert!((torque - last).abs() <= 1.001e-3, "{tick}: {last} {torque}");
        assert!(tick != 600 || torque.abs() > 1e-3, "{torque}");
        last = torque;
    }
    assert_eq!(last, 0.0);
}

#[test]
fn a_changed_table_is_refused() {
    static OTHER: [i16; 64] = [7; 64];
    let changed = Anticogging { units: &OTHER, ..Anticogging::of(&COGGING, 0.5) };
    let scene = Scene { environment: WALL.environment.beside(changed), ..WALL };
    let refused = Servo::<Environment, f32>::new(&scene.certify().unwrap(), &KNOB).unwrap_err();
    assert!(matches!(refused, BuildError::CoggingMap { .. }), "{refused}");
    let weak = Transducers { full_scale_torque: 0.502, ..KNOB };
    let refused = Servo::<Environment, f32>::new(&CERTIFIED, &weak).unwrap_err();
    assert!(matches!(refused, BuildError::Anticogging { .. }), "{refused}");
}

/// The certified slopes are those of the law in the number format, for a share of 0 as well.
#[test]
fn no_share_is_steeper_than_certified() {
    for share in [0.0, 1e-9, 0.3, 1.0] {
        let environment = WALL.environment.with(Parameter::Anticogging, share).unwrap();
        let scene = Scene { environment, ..WALL };
        for format in [Format::F32, <Fixed as Number>::FORMAT] {
            assert!(certify_in(&scene, format).is_ok(), "{share}");
        }
        let certified = scene.certify_in(<Fixed as Number>::FORMAT).unwrap();
        let mut servo = Servo::<Environment, Fixed>::new(&certified, &KNOB).unwrap();
        let largest = (0..4096_u32).map(|count| {
            servo.tick(RawCount::from(count.wrapping_sub(5000)));
            servo.torque_nm().abs()
        });
        let largest = largest.fold(0.0, f64::max);
        assert!((largest - 3e-3 * share).abs() < 1e-5, "{share}: {largest}");
    }
}

#[test]
fn what_is_no_map_is_refused() {
    let learnt =
        |torques: &[f64]| Anticogging::learnt(torques, vec![0; torques.len()].leak()).map(|_| ());
    let angles = |angles| Err(CoggingError::Angles { angles, least: 8, most: 65536 });
    assert_eq!(learnt(&[]), angles(0));
    assert_eq!(learnt(&[1.0; 4]), angles(4));
    assert_eq!(learnt(&[1.0; 84]), angles(84));
    assert_eq!(learnt(&[0.0; 8]), Err(CoggingError::Flat));
    let mut torques = [1.0; 8];
    torques[3] = f64::NAN;
    assert_eq!(learnt(&torques), Err(CoggingError::NotFinite { angle: 3 }));
    assert_eq!(learnt(&[1.0; 8]), Ok(()));
}

/// The bound on the mean that is left where a level clips, against a sum over fine steps at many levels.
#[test]
fn the_mean_of_the_clipped_table_is_bounded() {
    let mut random = Random(9);
    for case in 0..200 {
        let mut torques: Vec<_> = (0..32).map(|_| random.next()).collect();
        if case % 2 == 0 {
            // Without a mean before it is clipped.
            let mean = torques.iter().sum::<f64>() / 32.0;
            torques.iter_mut().for_each(|torque| *torque -= mean);
        }
        let learnt = Anticogging::learnt(&torques, vec![0; 32].leak()).unwrap();
        let torques: Vec<_> = learnt.torques().collect();
        let mut largest: f64 = 0.0;
        for level in 1..=100 {
            let level = learnt.largest() * f64::from(level) / 100.0;
            let at = |i: usize| {
                let (cell, part) = (i / 64, (i % 64) as f64 / 64.0);
                let value = torques[cell] * (1.0 - part) + torques[(cell + 1) % 32] * part;
                value.clamp(-level, level)
            };
            let mean = (0..32 * 64).map(at).sum::<f64>() / (32.0 * 64.0);
            largest = largest.max(mean.abs());
        }
        let bound = learnt.mean();
        assert!(bound > largest - 1e-5 && bound < largest + 0.06, "{case}: {bound} {largest}");
    }
    // An odd table has none.
    let odd: Vec<_> = (0..64).map(|i| (TAU * f64::from(i) / 16.0).sin()).collect();
    assert_eq!(Anticogging::learnt(&odd, vec![0; 64].leak()).unwrap().mean(), 0.0);
}
