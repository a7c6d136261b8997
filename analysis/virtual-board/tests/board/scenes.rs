//! The board's codes against the host's, tick by tick.

use std::f64::consts::TAU;

use analysis::hand::{HandTrajectory, TYPICAL_HAND};
use analysis::lockstep::SimulatedDevice;
use analysis::program::{Program, damper_wall, delayed_spring, free_mode, knob, undelayed_wall};
use analysis::toolchain::NumberFormat;
use haptic_servo::boot;
use haptic_servo::encoder::CounterWidth;
use haptic_servo::scene::Scene;
use haptic_servo::servo::{Latched, OutputMode, RenderingOptions, SupportsTiming, Transducers};
use haptic_servo::servo_loop::Options;
use haptic_servo::tuning::Tunable;
use tests::replica::Replica;
use virtual_board::chip::Chip;

use crate::bench::{Bench, on_both};
use crate::device::{HandHeldDevice, Sample};

/// Samples of a hand's whole script.
const SAMPLES: u64 = 5000;
/// Samples within which the clamp is open.
const OPEN: usize = 110;

/// A program's whole script on a board, against the servo on the host with the same counts.
macro_rules! compare {
    ($($test:ident: $program:ident, $output:ty;)*) => {$(
        #[test]
        fn $test() {
            on_both(|chip| {
                let program = Program::find(stringify!($program)).unwrap();
                let (scene, transducers) = ($program::SCENE, &$program::TRANSDUCERS);
                let device = HandHeldDevice::of(program);
                compare_held::<_, $output>(chip, program, scene, transducers, device);
            });
        }
    )*};
}

compare! {
    the_wall_gives_the_host_s_codes: damper_wall, Latched;
    the_spring_gives_the_host_s_codes: delayed_spring, Latched;
    free_mode_gives_the_host_s_codes: free_mode, Latched;
    the_wall_without_delay_gives_the_host_s_codes: undelayed_wall, undelayed_wall::Output;
}

/// From one end stop through all detents to the other one, beyond both.
#[test]
fn the_knob_gives_the_host_s_codes_through_its_detents_and_into_its_stops() {
    on_both(|chip| {
        let program = Program::find("knob").unwrap();
        let path =
            vec![(0.25, 0.0), (1.5, -2.9), (1.75, -2.9), (4.0, 2.9), (4.25, 2.9), (4.75, 2.3)];
        let description = "a hand turns it from stop to stop";
        let turn = HandTrajectory { description, hand: TYPICAL_HAND, path, release: 4.75 };
        let device = SimulatedDevice::new(&program.scene, turn, &program.transducers).unwrap();
        let device = HandHeldDevice::with(device);
        let (scene, transducers) = (knob::SCENE, &knob::TRANSDUCERS);
        let samples = compare_held::<_, Latched>(chip, program, scene, transducers, device);
        let angle = |sample: &Sample| f64::from(sample.count) * TAU / transducers.counts_per_turn;
        let furthest = samples
            .iter()
            .map(angle)
            .fold((0.0, 0.0), |(least, most): (f64, f64), at| (least.min(at), most.max(at)));
        let ends = scene.environment.profile().unwrap().ends.unwrap();
        assert!(furthest.0 < ends.from && furthest.1 > ends.to, "{furthest:?}");
    });
}

/// A program around a device on a board, against the servo on the host with the same counts; gives what was
/// at the pins from the tick on in which it was armed.
fn compare_held<E, M>(
    chip: &'static Chip,
    program: &'static Program,
    scene: Scene<E>,
    transducers: &Transducers,
    device: HandHeldDevice,
) -> Vec<Sample>
where
    E: Tunable<f32> + SupportsTiming<M>,
    M: OutputMode,
{
    let name = program.name;
    let mut bench = Bench::boot(chip, name, device);
    let armed = bench.armed();
    // What a tick computes is put out in the sample that it begins, or in the one behind.
    let late = if M::TIMING.is_at_phase() { 1 } else { 2 };
    bench.run(SAMPLES + 2);
    let samples = &bench.pins().samples[armed..];
    let transducers = &Transducers { counter: width(chip), ..*transducers };
    let ticks = &samples[..SAMPLES as usize];
    let codes = with_the_same_cycle::<E, M>(scene, transducers, ticks);
    let at = |tick: usize| (samples[tick].count, samples[tick + late].code.unwrap());
    for (tick, &code) in codes.iter().enumerate() {
        assert_eq!(at(tick).1, code, "{name}, tick {tick}: {:?}", at(tick));
    }
    let moved = samples.iter().filter(|sample| sample.code != samples[late].code).count();
    assert!(moved > 1000, "{name}: no torque but in {moved} samples");
    // And the DAC's latch is the sample by which the scene is late; at a phase, it is not.
    let mut controller = program.controller(NumberFormat::F32, transducers).unwrap();
    for (tick, sample) in samples[..SAMPLES as usize].iter().enumerate() {
        let code = controller.tick(sample.count).code;
        let opened = tick > OPEN;
        assert!(!opened || samples[tick + 1].code == Some(code), "{name}: {tick}");
    }
    samples.to_vec()
}

/// The codes of the same cycle on the host, from the tick on in which it is armed.
pub fn with_the_same_cycle<E, M>(
    scene: Scene<E>,
    transducers: &Transducers,
    samples: &[Sample],
) -> Vec<u16>
where
    E: Tunable<f32> + SupportsTiming<M>,
    M: OutputMode,
{
    on_the_host::<E, M>(program(scene, transducers), samples)
}

/// A program of a scene with no other options.
pub fn program<E>(scene: Scene<E>, transducers: &Transducers) -> boot::Program<E> {
    let (transducers, rendering) = (*transducers, RenderingOptions::DEFAULT);
    boot::Program { scene, transducers, rendering, options: Options::DEFAULT }
}

/// The codes of a program's cycle on the host with the same counts, from the tick on in which it is armed.
pub fn on_the_host<E, M>(program: boot::Program<E>, samples: &[Sample]) -> Vec<u16>
where
    E: Tunable<f32> + SupportsTiming<M>,
    M: OutputMode,
{
    let mut host = Replica::<E, M>::boot(program);
    host.arm();
    samples.iter().map(|sample| host.tick(sample.count).0).collect()
}

/// Of the counter of a chip's encoder.
pub fn width(chip: &Chip) -> CounterWidth {
    if chip.counter == 16 { CounterWidth::Bits16 } else { CounterWidth::Bits32 }
}
