use core::ops::Range;

use super::*;
use crate::certificate::{
    Assessment, Certified, Rejection, TimingError, assess, certify, certify_scene, timing_checked,
};
use crate::coupling::Coupling;
use crate::environment::Side;
use crate::number::Format;
use crate::output_timing::OutputTiming;
use crate::scene::{Device, TimeRange};
use crate::scene_type::Typed;
use crate::servo::{AtPhase, Latched};
use crate::test_scene::Random;

const fn scene(period: f64, delta: f64, wall: Wall, latency: Latency) -> Scene {
    Scene { latency, ..Scene::of(Device::damped(1e-4, delta), period, wall.alone()) }
}

const fn one_sided(stiffness: f64, damping: f64, delay: usize) -> Wall {
    Wall::damped(stiffness, damping, delay).behind(0.0)
}

/// A law with these slopes, `delay` samples late, and without dampers.
fn law(rise: f64, steepest: f64, delay: f64) -> Law {
    let [rise, steepest] = [rise, steepest].map(Interval::exact);
    let late = steepest.mul(Interval::exact(delay));
    Law { rise, steepest, late, ..Law::NONE }
}

/// What a law needs of a device at this period, with this latency.
fn needed(law: Law, period: f64, latency: Latency) -> f64 {
    let scene = scene(period, 1.0, one_sided(0.0, 0.0, 0), latency);
    let n = LoopIntervals::of(&scene, Format::F64);
    let [low, high] = [End::Lower, End::Upper]
        .map(|end| law.needed::<Environment>(&scene, &n, 0.0, end).unwrap());
    assert!(low <= high && high - low <= 1e-11 * high, "{low} {high}");
    high
}

/// Slopes at which a law needs exactly `delta`, computed independently with 40 digits.
#[test]
fn the_steepest_laws_are_those_of_an_independent_computation() {
    let aged = |oldest: f64| Latency::delayed(oldest);
    let lagging = |oldest: f64, lag: f64| Latency {
        sensor_lag: TimeRange::exactly(lag),
        ..Latency::delayed(oldest)
    };
    let cases = [
        (1e-3, 0.022, 0.0, aged(5e-6), 1.0, 43.353_941_67),
        (1e-3, 0.022, 1.0, aged(1.1e-4), 1.0, 13.537_953_566_6),
        (1e-4, 0.001, 1.0, aged(1e-4), 1.0, 4.0),
        (1e-4, 0.001, 0.0, aged(2.5e-5), 1.0, 12.376_043_070_3),
        (1e-4, 0.001, 1.0, aged(1.1e-4), 0.25, 4.474_139_180_6),
        (1e-3, 0.01, 1.0, aged(3e-4), 0.0, 7.467_130_972_29),
        (1e-3, 0.022, 1.0, lagging(1e-5, 6.4e-5), 1.0, 13.925_990_389_1),
        (1e-4, 0.001, 0.0, lagging(3.3e-5, 1.6e-4), 1.0, 4.099_300_494_56),
    ];
    for (period, delta, delay, latency, rise, steepest) in cases {
        let found = needed(law(rise * steepest, steepest, delay), period, latency);
        assert!((found / delta - 1.0).abs() < 1e-10, "{steepest}: {found} {delta}");
        // An amplifier costs a static law as much as a filter of the encoder.
        let amplifier =
            Latency { actuator_lag: latency.sensor_lag, sensor_lag: TimeRange::ZERO, ..latency };
        let same = needed(law(rise * steepest, steepest, delay), period, amplifier);
        assert!((same / found - 1.0).abs() < 1e-12, "{same} {found}");
    }
}

/// Readings that are means over a window, dropped, or read through a nonlinear encoder, in the same way.
#[test]
fn the_steepest_laws_through_an_encoder_are_those_of_an_independent_computation() {
    let read = |reading: EncoderReading| Latency::NONE.read_by(Box::leak(Box::new(reading)));
    let window = EncoderReading {
        age: TimeRange::between(1e-5, 2.5e-5),
        window: 9e-5,
        ..EncoderReading::IDEAL
    };
    let found = needed(law(0.6 * 9.947_432_066_25, 9.947_432_066_25, 1.0), 1e-4, read(window));
    assert!((found / 0.002 - 1.0).abs() < 1e-10, "{found}");
    // A drop is an older reading: as many more whole samples.
    let drops = EncoderReading { dropped: 2, ..window };
    let [dropped, late] =
        [(1.0, drops), (3.0, window)].map(|(late, it)| needed(law(3.0, 5.0, late), 1e-4, read(it)));
    assert!((dropped / late - 1.0).abs() < 1e-13, "{dropped} {late}");
    // The steepest slope of a law that is less steep where it rises, two samples late.
    let inl = |slope: f64| {
        law(0.7 * slope, slope, 2.0)
            .steepened(&EncoderReading { linearity: 0.1, ..EncoderReading::IDEAL })
    };
    let found = needed(inl(8.510_638_297_87), 1e-3, Latency::NONE);
    assert!((found / 0.022 - 1.0).abs() < 1e-10, "{found}");
}

/// A profile of `A sin(N x)` that opposes a motor's cogging, and such a profile beside a static law, computed
/// independently with 40 digits.
#[test]
fn a_profile_against_cogging_needs_what_an_independent_computation_needs() {
    let sine = |amplitude: f64, periods: f64, share: f64| {
        let slope = share * amplitude * periods;
        law(slope, slope, 1.0)
    };
    let aged = |oldest: f64| Latency::delayed(oldest);
    for (law, period, latency, expected) in [
        (sine(0.005, 84.0, 1.0), 1e-3, Latency::NONE, 6.3e-4),
        (sine(0.03, 168.0, 1.0), 1e-4, Latency::NONE, 7.56e-4),
        (sine(0.03, 168.0, 0.5), 1e-4, aged(1.1e-4), 6.573_735_586_73e-4),
        (sine(0.02, 84.0, 1.0), 5e-5, aged(7e-6), 1.392_848_293_8e-4),
        (
            sine(0.005, 84.0, 1.0).plus(law(6.246_666_666_67, 6.246_666_666_67, 1.0)),
            1e-4,
            Latency::NONE,
            1e-3,
        ),
        (
            sine(0.02, 84.0, 0.9).plus(law(11.054_279_450_1, 11.054_279_450_1, 1.0)),
            1e-4,
            aged(8e-6),
            2e-3,
        ),
        (
            sine(0.005, 84.0, 1.0).plus(law(0.5 * 3.761_655_119_13, 3.761_655_119_13, 2.0)),
            1e-4,
            aged(2e-5),
            1e-3,
        ),
    ] {
        let found = needed(law, period, latency);
        assert!((found / expected - 1.0).abs() < 1e-10, "{found} {expected}");
    }
}

/// With a damper the linear wall has an exact index, with 40 digits; the one-sided wall's is not below.
#[test]
fn a_wall_with_a_damper_needs_at_least_what_the_linear_wall_needs() {
    for (period, stiffness, damping, delay, oldest, exact) in [
        (1e-3, 10.0, 0.004, 1, 1e-4, 0.012_635_019_557_5),
        (1e-3, 20.0, 0.002, 0, 1.05e-4, 0.011_239_515_594_0),
        (1e-4, 3.0, 0.0002, 1, 8.5e-5, 0.000_529_757_571_059),
    ] {
        let wall = one_sided(stiffness, damping, delay);
        let linear = Wall { side: Side::Centred, ..wall };
        let scene = |wall| scene(period, 0.1, wall, Latency::delayed(oldest));
        let found = assess(&scene(linear)).alpha_port.unwrap();
        assert!((found.midpoint() / exact - 1.0).abs() < 1e-9, "{found:?} {exact}");
        let bound = assess(&scene(wall)).bound.unwrap();
        assert!(bound.lo() > exact && bound.hi() < exact + 2.0 * damping, "{bound:?} {exact}");
    }
}

/// For springs the index is that of equation 39, which a search over all angles encloses.
#[test]
fn a_one_sided_spring_needs_what_the_linear_spring_needs() {
    let both = |delay: f64, amplifier: f64, sensor: f64| Latency {
        sensor_lag: TimeRange::exactly(sensor),
        ..Latency::delayed(delay).with_actuator_lag(amplifier)
    };
    let mut all = vec![Latency::sampled(4, 1.7e-4, 1e-3), Latency::sampled(3, 5.3e-4, 1e-3)];
    for delay in [0.0, 5e-6, 3.7e-4, 1.2e-3] {
        for amplifier in [0.0, 2e-5, 4e-4, 3e-3] {
            for sensor in [0.0, 3e-5, 7e-4] {
                all.push(both(delay, amplifier, sensor));
            }
        }
    }
    for latency in all.iter().copied().filter(|latency| !latency.is_none()) {
        for delay in [0, 1, 2] {
            let wall = one_sided(10.0, 0.0, delay);
            let bound = assess(&scene(1e-3, 0.1, wall, latency)).bound.unwrap();
            let linear = Wall { side: Side::Centred, ..wall };
            let exact = assess(&scene(1e-3, 0.1, linear, latency));
            let exact = exact.alpha_port.or(exact.alpha_coupled).unwrap_or_else(|| {
                panic!("{latency:?}: {:?}", exact.outcome);
            });
            assert!(
                (bound.midpoint() / exact.midpoint() - 1.0).abs() < 1e-8,
                "{latency:?}: {bound:?} {exact:?}"
            );
        }
    }
}

/// A wall that certifies without a coupling, or does not, as for Colgate and Schenkel: `b > K T/2 + B`.
#[test]
fn the_textbook_wall_needs_half_a_period_of_its_stiffness_and_its_damping() {
    let at = |damping, b, delay| {
        certify(&scene(1e-3, b, one_sided(1000.0, damping, delay), Latency::NONE))
    };
    assert!(at(0.0, 0.5001, 0).is_ok() && at(0.0, 0.6, 0).is_ok());
    assert!(matches!(at(0.0, 0.4999, 0), Err(Rejection::Shortage { .. })));
    assert!(at(0.0, 1.5001, 1).is_ok() && at(0.2, 0.7001, 0).is_ok());
    assert!(matches!(at(0.2, 0.6999, 0), Err(Rejection::Shortage { .. })));
    // Late, the damper costs less in contact than the bound allows for it.
    let doubtful = at(0.5, 1.99, 1).unwrap_err();
    assert!(doubtful.is_undecided(), "{doubtful}");
    assert!(doubtful.to_string().contains("it would pass with"), "{doubtful}");
    assert!(matches!(at(0.5, 1.2, 1), Err(Rejection::Shortage { .. })));
}

/// Jitter counts by the largest age alone, and updates that are missed by the longest tick.
#[test]
fn jitter_and_missed_updates_cost_what_their_worst_case_costs() {
    let jittering = Latency { output_jitter: 1e-4, ..Latency::delayed(2e-4) };
    let oldest = Latency::delayed(3e-4);
    for wall in [Wall::damped(10.0, 0.0, 1), one_sided(10.0, 0.0, 1)] {
        let bound = assess(&scene(1e-3, 0.1, wall, jittering)).bound.unwrap();
        let law = law(10.0, 10.0, 1.0);
        assert!((bound.midpoint() / needed(law, 1e-3, oldest) - 1.0).abs() < 1e-12);
        let mut missing = scene(1e-3, 0.1, wall, oldest);
        missing.timing.worst_period = Some(2e-3);
        let found = assess(&missing);
        // c = K (T_max/2 + T_max + e T), V = e T (T_max - e T), compared with delta T/T_max.
        let (within, variance) = (10.0 * (3e-3 + 3e-4), 100.0 * 3e-4 * 1.7e-3);
        let expected = 0.25 * (within + f64::sqrt(within * within + variance));
        let bound = found.bound.unwrap().midpoint();
        assert!((bound / expected - 1.0).abs() < 1e-12, "{bound} {expected}");
        assert!(found.outcome.is_ok());
    }
}

/// Where neither torques nor counts come once a period: only without a lag a bound is known. One jitter is of
/// either kind.
#[test]
fn torques_and_counts_that_deviate_at_once_have_a_bound_without_a_lag() {
    let lagging = |output_jitter: f64, count_jitter: f64, lag: f64| {
        let latency = Latency { output_jitter, count_jitter, ..Latency::delayed(3e-4) };
        let latency = latency.with_actuator_lag(lag);
        assess(&scene(1e-3, 0.1, one_sided(10.0, 0.01, 1), latency))
    };
    let at = |output_jitter, count_jitter| lagging(output_jitter, count_jitter, 0.0);
    let bound = |found: &Assessment| found.bound.unwrap().midpoint();
    let one = at(0.0, 1e-4);
    assert_eq!(one.bound, at(1e-4, 0.0).bound);
    // It begins where one jitter ends, but for the damper, and grows with each of them.
    let damper = 0.01 * (1.1 - f64::sqrt(1.2));
    let both = [at(1e-9, 1e-4), at(1e-4, 1e-9)];
    for both in &both {
        assert!((bound(both) - bound(&one) - damper).abs() < 1e-6, "{both:?} {one:?}");
    }
    let more = [at(1e-4, 1e-5), at(1e-5, 1e-4)];
    assert_eq!(more[0].bound, more[1].bound);
    assert!(bound(&more[0]) > bound(&both[0]) && more[0].outcome.is_ok());
    let lags = lagging(1e-4, 1e-5, 1e-4).outcome.unwrap_err();
    assert!(lags.is_undecided() && lags.to_string().contains("that both jitter"), "{lags}");
    // Linear, it is certified as a window of torques; a board limits its torque, and so does the bound.
    let latency = Latency { output_jitter: 1e-4, count_jitter: 1e-5, ..Latency::NONE };
    let linear = scene(1e-3, 0.1, Wall::spring(10.0, 1), latency);
    let found = assess(&linear);
    assert!(found.outcome.is_ok() && found.bound.is_none());
    assert!(found.renders_at(&linear, OutputTiming::Latched).is_ok());
}

/// The largest quotient of `sum (L d^2/2 + M abs(d) P)` and the integral of the squared velocity over motions,
/// with `d` the step in a tick and `P` the path since the position of its torque: what theorem A bounds, at
/// given times in `CELL` periods. By power iteration from a motion at rest in no cell.
fn worst_motion(rise: f64, steepest: f64, torques: &[usize], counts: &[usize], late: usize) -> f64 {
    let mut motion = vec![1.0; *torques.last().unwrap()];
    let mut quotient = 0.0;
    for _ in 0..400 {
        let mut force = vec![0.0; motion.len()];
        for k in late..torques.len() - 1 {
            let (tick, path) = (torques[k]..torques[k + 1], counts[k - late]..torques[k]);
            let length = |cells: &Range<usize>| motion[cells.clone()].iter().sum::<f64>();
            let (step, passed) = (length(&tick), length(&path));
            force[tick].iter_mut().for_each(|f| *f += 0.5 * (rise * step + steepest * passed));
            force[path].iter_mut().for_each(|f| *f += 0.5 * steepest * step);
        }
        let square: f64 = motion.iter().map(|v| v * v).sum();
        quotient = motion.iter().zip(&force).map(|(v, f)| v * f).sum::<f64>() / square * CELL;
        let size = force.iter().copied().fold(0.0, f64::max);
        motion = force.iter().map(|f| f / size).collect();
    }
    quotient
}

/// A part of a period.
const CELL: f64 = 1.0 / 40.0;

/// Random and extreme patterns of both jitters: no motion needs more than the bound, and without jitter the
/// same computation comes as near to it as it has ticks.
#[test]
fn no_motion_needs_more_than_the_bound_for_two_jitters() {
    let cells = |periods: f64| (periods / CELL).round() as usize;
    let mut random = Random(1);
    for (delay, torque, count, late) in [
        (0.2, 0.0, 0.0, 1),
        (0.2, 0.1, 0.05, 0),
        (0.4, 0.1, 0.2, 1),
        (0.5, 0.2, 0.25, 2),
        (0.3, 0.15, 0.15, 0),
    ] {
        let latency =
            Latency { output_jitter: torque, count_jitter: count, ..Latency::delayed(delay) };
        for (rise, steepest) in [(1.0, 1.0), (0.2, 1.0)] {
            let bound = needed(law(rise, steepest, late as f64), 1.0, latency);
            for pattern in 0..12 {
                let mut jitter = |most: f64, k: usize| match pattern {
                    0 => k % 2 * cells(2.0 * most),
                    1 => (k + 1) % 2 * cells(2.0 * most),
                    2 => k / 2 % 2 * cells(2.0 * most),
                    _ => (random.bits() >> 22) as usize % (cells(2.0 * most) + 1),
                };
                let early = |most: f64| 10 * cells(1.0) - cells(most);
                let counts: Vec<_> =
                    (0..40).map(|k| early(count) + k * cells(1.0) + jitter(count, k)).collect();
                let torques: Vec<_> = (0..40)
                    .map(|k| early(torque) + cells(delay) + k * cells(1.0) + jitter(torque, k))
                    .collect();
                let worst = worst_motion(rise, steepest, &torques, &counts, late);
                assert!(worst <= bound, "{latency:?} {pattern}: {worst} {bound}");
                assert!(torque > 0.0 || worst > 0.97 * bound, "{worst} {bound}");
            }
        }
    }
}

/// The margin ends where the scene does.
#[test]
fn the_margin_is_the_damping_that_may_be_lost() {
    for (damping, latency) in [
        (0.0, Latency::NONE),
        (0.2, Latency::NONE),
        (0.0, Latency::delayed(3e-4).with_actuator_lag(2e-4)),
    ] {
        let scene = scene(1e-3, 3.0, one_sided(1000.0, damping, 0), latency);
        let margin = certify(&scene).unwrap().margin(&scene).unwrap();
        assert!(margin > 1.0, "{margin}");
        let with = |lost: f64| {
            let device = Device { damping: 3.0 - lost, ..scene.device };
            certify(&Scene { device, ..scene })
        };
        assert!(with(margin - 1e-9).is_ok() && with(margin + 1e-9).is_err(), "{margin}");
    }
}

/// A board limits the torque and reads counts late; without a coupling a wall passes there as well.
#[test]
fn a_board_renders_a_wall_without_a_coupling() {
    const fn rigid(stiffness: f64) -> Scene {
        scene(1e-3, 0.022, one_sided(stiffness, 0.004, 1), Latency::NONE)
    }
    let latched = |stiffness| timing_checked::<_, Latched>(rigid(stiffness), Format::F32);
    // 1.5 K T + B, with B in counts up to 1 us late.
    assert!(latched(11.99).is_ok() && latched(12.0).is_err());
    let timed = rigid(11.0).certify_in(Format::F32).unwrap().time::<Latched>().unwrap();
    let judged = latched(11.0).unwrap();
    assert_eq!(
        (timed.margin(), timed.injectable_damping()),
        (judged.margin(), judged.injectable_damping())
    );
    let left = 0.022 - 1.5 * 0.011 - 0.004 * f64::sqrt(1.001);
    let [margin, spent] = [timed.margin(), timed.margin_with(left)].map(Option::unwrap);
    assert!((margin - left).abs() < 1e-9 && spent < 1e-6);
    // A program whose own scene has a coupling has no code for it, and says so.
    const COUPLED: Certified<Scene> =
        Scene { coupling: Coupling::Spring { stiffness: 44.0 }, ..rigid(11.0) }.certified();
    crate::scene_type!(Coupled: COUPLED);
    let coupled = *Typed::<Coupled>::certified().scene();
    let plain = Scene { coupling: Coupling::Rigid, ..coupled };
    let certified = certify_scene(plain, Format::F64).unwrap();
    assert_eq!(certified.time::<Latched>().unwrap_err(), TimingError::Coupled);
    assert!(timing_checked::<_, Latched>(plain, Format::F64).is_err());
    // At a phase an undelayed wall is late by the phase.
    let phase = scene(1e-3, 0.022, one_sided(30.0, 0.0, 0), Latency::delayed(1e-4));
    let timed = phase.certify().unwrap().time::<AtPhase<100_000>>().unwrap();
    let judged = timing_checked::<_, AtPhase<100_000>>(phase, Format::F64).unwrap();
    assert_eq!(timed.margin(), judged.margin());
    assert!(phase.certify().unwrap().time::<AtPhase<50_000>>().is_err());
    assert!(timing_checked::<_, AtPhase<50_000>>(phase, Format::F64).is_err());
}

/// A program contains the code for its encoder, and refuses another one.
#[test]
fn a_board_renders_a_wall_that_a_nonlinear_encoder_reads() {
    const fn read(stiffness: f64, encoder: &'static EncoderReading) -> Scene {
        let wall = Wall::spring(stiffness, 1).behind(0.1);
        scene(1e-3, 0.022, wall, Latency::NONE.read_by(encoder))
    }
    const MAGNETIC: EncoderReading = EncoderReading {
        age: TimeRange::between(0.0, 1e-5),
        linearity: 0.1,
        dropped: 1,
        ..EncoderReading::IDEAL
    };
    const CERTIFIED: Certified<Scene> = read(5.0, &MAGNETIC).certified();
    const PLAIN: Certified<Scene> = read(5.0, EncoderReading::ideal()).certified();
    crate::scene_type!(Magnetic: CERTIFIED);
    crate::scene_type!(Plain: PLAIN);
    let limit = needed(law(1.1, 1.1, 2.0), 1e-3, Latency::delayed(1e-5));
    for (part, passes) in [(0.999, true), (1.001, false)] {
        let stiffness = part * 0.022 / limit;
        let data = read(stiffness, &MAGNETIC);
        let typed = Typed::<Magnetic>::of(&data).unwrap();
        assert_eq!(timing_checked::<_, Latched>(typed, Format::F64).is_ok(), passes);
        assert_eq!(timing_checked::<_, Latched>(data, Format::F64).is_ok(), passes);
        assert_eq!(certify(&data).is_ok(), passes);
        let other = Typed::<Plain>::of(&data).unwrap();
        assert!(timing_checked::<_, Latched>(other, Format::F64).is_err());
    }
}
