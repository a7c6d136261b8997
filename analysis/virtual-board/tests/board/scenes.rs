//! The board's codes against the host's, tick by tick.

use analysis::program::{Program, damper_wall, delayed_spring, free_mode};
use analysis::toolchain::NumberFormat;
use firmware::boot;
use firmware::encoder::CounterWidth;
use firmware::environment::FreeMode;
use firmware::scene::Scene;
use firmware::servo::{Latched, RenderingOptions, SupportsTiming, Transducers};
use firmware::servo_loop::Options;
use firmware::tuning::Tunable;
use tests::replica::Replica;
use virtual_board::chip::Chip;

use crate::bench::{Bench, on_both};
use crate::device::{HandHeldDevice, Sample};

/// Samples of a hand's whole script.
const SAMPLES: u64 = 5000;
/// Samples within which the clamp is open.
const OPEN: usize = 110;

/// Free mode as the boards run it: as late as their DAC.
const FREE_MODE: Scene<FreeMode<1>> = Scene {
    device: free_mode::SCENE.device,
    timing: free_mode::SCENE.timing,
    coupling: free_mode::SCENE.coupling,
    environment: FreeMode { residual: free_mode::SCENE.environment.residual },
    latency: free_mode::SCENE.latency,
    torque_limit: free_mode::SCENE.torque_limit,
};

#[test]
fn the_wall_gives_the_host_s_codes() {
    on_both(|chip| compare(chip, "damper_wall", damper_wall::SCENE, &damper_wall::TRANSDUCERS));
}

#[test]
fn the_spring_gives_the_host_s_codes() {
    on_both(|chip| {
        compare(chip, "delayed_spring", delayed_spring::SCENE, &delayed_spring::TRANSDUCERS);
    });
}

#[test]
fn free_mode_gives_the_host_s_codes() {
    on_both(|chip| compare(chip, "free_mode", FREE_MODE, &free_mode::TRANSDUCERS));
}

/// A program's whole script on a board, against the servo on the host with the same counts.
fn compare<E>(chip: &'static Chip, name: &'static str, scene: Scene<E>, transducers: &Transducers)
where
    E: Tunable<f32> + SupportsTiming<Latched>,
{
    let program = Program::find(name).unwrap();
    let mut bench = Bench::boot(chip, name, HandHeldDevice::of(program));
    let armed = bench.armed();
    // What a tick computes is put out in the sample behind the next one.
    bench.run(SAMPLES + 2);
    let samples = &bench.pins().samples[armed..];
    let transducers = &Transducers { counter: width(chip), ..*transducers };
    let codes = with_the_same_cycle(scene, transducers, samples);
    let at = |tick: usize| (samples[tick].count, samples[tick + 2].code.unwrap());
    for (tick, &code) in codes.iter().enumerate() {
        assert_eq!(at(tick).1, code, "{}, {name}, tick {tick}: {:?}", chip.name, at(tick));
    }
    let moved = samples.iter().filter(|sample| sample.code != samples[2].code).count();
    assert!(moved > 1000, "{}, {name}: no torque but in {moved} samples", chip.name);
    // And the DAC's latch is the sample by which the scene is late.
    let mut controller = program.controller(NumberFormat::F32, transducers).unwrap();
    for (tick, sample) in samples[..SAMPLES as usize].iter().enumerate() {
        let code = controller.tick(sample.count).code;
        let opened = tick > OPEN;
        assert!(!opened || samples[tick + 1].code == Some(code), "{}, {name}: {tick}", chip.name);
    }
}

/// The codes of the same cycle on the host, from the tick on in which it is armed.
fn with_the_same_cycle<E>(
    scene: Scene<E>,
    transducers: &Transducers,
    samples: &[Sample],
) -> Vec<u16>
where
    E: Tunable<f32> + SupportsTiming<Latched>,
{
    let mut host = Replica::<E, Latched>::boot(boot::Program {
        scene,
        transducers: *transducers,
        rendering: RenderingOptions::DEFAULT,
        options: Options::DEFAULT,
    });
    host.arm();
    samples[..SAMPLES as usize].iter().map(|sample| host.tick(sample.count).0).collect()
}

/// Of the counter of a chip's encoder.
pub fn width(chip: &Chip) -> CounterWidth {
    if chip.counter == 16 { CounterWidth::Bits16 } else { CounterWidth::Bits32 }
}
