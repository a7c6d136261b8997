//! Runs [benchmarks](crate::bench_request) on the emulated board: inputs come by the pipe `counts`,
//! outputs go by `codes`.

mod all_scenes;
mod program_scenes;
mod scene_types;

pub use all_scenes::AllScenes;
pub use program_scenes::ProgramScenes;

use core::hint::black_box;
use core::marker::PhantomData;

use haptic_servo::board::qemu::{EXIT_DONE, EXIT_REFUSED, lockstep, meter, tick_timer};
use haptic_servo::current::{CurrentController, Duties};
use haptic_servo::encoder::RawCount;
use haptic_servo::number::{InEach, Number};
use haptic_servo::rendering::Rendering;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;
use semihosting::fs::File;
use semihosting::io::{Read, Write};

use crate::bench_request::{BLOCK, BenchRequest, Inputs, Output, Outputs, READY, REFUSED};
use crate::currents::{CurrentBench, Input};
use crate::rotations::{self, Rotation};
use crate::sines::Sine;

/// The types of environments whose servos a program contains. A servo of an environment as data would need
/// additional instructions to select its type.
pub trait SceneSet {
    /// Runs the ticks of a servo of the scene's own type, if the program contains it.
    ///
    /// # Errors
    /// If the host is gone.
    fn ticks<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed>;
}

/// Runs benchmarks of these types until the host closes its end.
pub fn run<K: SceneSet>() -> ! {
    tick_timer::start_clock();
    let scale = meter::Scale::calibrate();
    let Ok((counts, codes)) = lockstep::pipes() else {
        semihosting::process::exit(EXIT_REFUSED);
    };
    let mut host = Host { counts, codes, scale };
    semihosting::process::exit(match host.serve::<K>() {
        Ok(()) => EXIT_DONE,
        Err(HostClosed) => EXIT_REFUSED,
    })
}

/// The host does not take a reply, or its request is malformed.
#[derive(Debug)]
pub struct HostClosed;

/// The pipes to the host, and the scale of the meter.
struct Host {
    counts: File,
    codes: File,
    scale: meter::Scale,
}

impl Host {
    fn serve<K: SceneSet>(&mut self) -> Result<(), HostClosed> {
        while let Some(request) = self.next_request()? {
            match request {
                BenchRequest::Servo { scene, transducers, arithmetic } => {
                    let job = BenchJob { host: self, scene: &scene, transducers: &transducers };
                    arithmetic.choose(ServoBench::<K> { job, scenes: PhantomData })?;
                }
                BenchRequest::Sine(sine) => self.sine(sine)?,
                BenchRequest::Rotation(rotation) => self.rotation(rotation)?,
                BenchRequest::Current(bench) => self.current(bench)?,
            }
        }
        Ok(())
    }

    /// The next request, if there is one.
    fn next_request(&mut self) -> Result<Option<BenchRequest>, HostClosed> {
        match lockstep::words(&mut self.counts) {
            Ok(words) => BenchRequest::decode(&words).map(Some).ok_or(HostClosed),
            Err(_) => Ok(None),
        }
    }

    fn answer(&mut self, bytes: &[u8]) -> Result<(), HostClosed> {
        self.codes.write_all(bytes).map_err(|_| HostClosed)
    }

    /// The next inputs; `None` at the end of the benchmark.
    #[inline(never)]
    fn inputs(&mut self) -> Result<Option<Inputs>, HostClosed> {
        let mut more = [0];
        self.counts.read_exact(&mut more).map_err(|_| HostClosed)?;
        if more == [0] {
            return Ok(None);
        }
        let mut inputs = [[0; 4]; BLOCK];
        self.counts.read_exact(inputs.as_flattened_mut()).map_err(|_| HostClosed)?;
        Ok(Some(inputs.map(u32::from_le_bytes)))
    }

    #[inline(never)]
    fn outputs(&mut self, outputs: &Outputs) -> Result<(), HostClosed> {
        outputs.iter().try_for_each(|output| self.answer(&output.to_bytes()))
    }

    /// Ticks of a servo of the scene, as long as there are counts.
    // SAFETY: the section is one of code, in flash that the emulated board has.
    #[unsafe(link_section = ".more")]
    #[inline(never)]
    fn ticks<E: Rendering<N>, N: Number>(
        &mut self,
        scene: Scene<E>,
        transducers: &Transducers,
    ) -> Result<(), HostClosed> {
        let Ok(mut servo) = meter::uncertified_servo::<E, N>(&scene, transducers) else {
            return self.answer(&[REFUSED]);
        };
        self.answer(&[READY])?;
        while let Some(counts) = self.inputs()? {
            let mut outputs = [Output::default(); BLOCK];
            for (count, output) in counts.into_iter().zip(&mut outputs) {
                let (servo, mut code) = (black_box(&mut servo), 0);
                let time = meter::measure(count, |count| {
                    let output = servo.tick(RawCount::from(count));
                    code = output.code.get();
                    (code.into(), output.limit as u32)
                });
                *output = Output { value: servo.torque_nm(), code, instructions: time };
            }
            // Not earlier: the data of the scale would be loaded within the measured interval.
            for output in &mut outputs {
                output.instructions = self.scale.measured(output.instructions);
            }
            self.outputs(&outputs)?;
        }
        Ok(())
    }

    /// Sines and cosines, as long as there are angles.
    #[inline(never)]
    fn rotation(&mut self, rotation: Rotation) -> Result<(), HostClosed> {
        self.answer(&[READY])?;
        while let Some(angles) = self.inputs()? {
            let mut outputs = [Output::default(); BLOCK];
            for (angle, output) in angles.into_iter().zip(&mut outputs) {
                let (pair, time) = timed_rotation(rotation, angle);
                let instructions = self.scale.measured(time);
                *output = Output { value: rotations::packed(pair), code: 0, instructions };
            }
            self.outputs(&outputs)?;
        }
        Ok(())
    }

    /// Instants of a current loop, as long as there are samples.
    #[inline(never)]
    fn current(&mut self, bench: CurrentBench) -> Result<(), HostClosed> {
        let (mut controller, mut instant) = (bench.started(), 0);
        self.answer(&[READY])?;
        while let Some(inputs) = self.inputs()? {
            let mut outputs = [Output::default(); BLOCK];
            for (input, output) in inputs.into_iter().zip(&mut outputs) {
                instant += 1;
                let ([u, code], time) = timed_instant(black_box(&mut controller), input, instant);
                let instructions = self.scale.measured(time);
                *output = Output { value: u.into(), code, instructions };
                if u == 0 {
                    controller = bench.started();
                }
            }
            self.outputs(&outputs)?;
        }
        Ok(())
    }

    /// Sines, as long as there are parts of a turn.
    fn sine(&mut self, sine: Sine) -> Result<(), HostClosed> {
        self.answer(&[READY])?;
        while let Some(turns) = self.inputs()? {
            let mut outputs = [Output::default(); BLOCK];
            for (turn, output) in turns.into_iter().zip(&mut outputs) {
                let (value, time) = timed(sine, turn);
                let instructions = self.scale.measured(time);
                *output = Output { value: value.into(), code: 0, instructions };
            }
            self.outputs(&outputs)?;
        }
        Ok(())
    }
}

/// Sine and cosine of an angle, and the time that they took.
fn timed_rotation(rotation: Rotation, angle: u32) -> ([f32; 2], u32) {
    macro_rules! each {
        ($($kind:ident),*) => {
            match rotation {
                $(Rotation::$kind => {
                    let mut bits = [0; 2];
                    let time = meter::measure(angle, |angle| {
                        bits = Rotation::$kind.of_angle(angle).map(f32::to_bits);
                        (bits[0], bits[1])
                    });
                    (bits.map(f32::from_bits), time)
                })*
            }
        };
    }
    each!(Micromath, Libm, Cubic, Quintic, Septic, Table)
}

/// An instant of a current loop, and the time that it took. A fault has no compare values; the loop restarts
/// after it.
#[inline(never)]
fn timed_instant(controller: &mut CurrentController, input: u32, instant: u32) -> ([u16; 2], u32) {
    let mut compare = [0; 2];
    let time = meter::measure(input, |input| {
        let (sample, code) = Input(input).at(instant);
        if let Ok(Duties([u, v, w])) = controller.step(&sample, code) {
            compare = [u, v];
            (u32::from(u) | u32::from(v) << 16, w.into())
        } else {
            (0, 0)
        }
    });
    (compare, time)
}

/// The sine of the bits of a part of a turn, and the time that it took. The choice is outside the measured
/// interval.
fn timed(sine: Sine, turn: u32) -> (f32, u32) {
    macro_rules! each {
        ($($kind:ident),*) => {
            match sine {
                $(Sine::$kind => {
                    let mut bits = 0;
                    let time = meter::measure(turn, |turn| {
                        bits = Sine::$kind.of_turn(f32::from_bits(turn)).to_bits();
                        (bits, bits)
                    });
                    (f32::from_bits(bits), time)
                })*
            }
        };
    }
    each!(Micromath, Libm, LibmDouble, Cubic, Quintic, Septic, Nonic)
}

/// Benchmark of a servo whose types are still to be chosen.
pub struct BenchJob<'a> {
    host: &'a mut Host,
    scene: &'a Scene,
    transducers: &'a Transducers,
}

impl BenchJob<'_> {
    /// Runs its ticks with a servo of its scene in this type.
    fn run<E: Rendering<N>, N: Number>(self, scene: Scene<E>) -> Result<(), HostClosed> {
        self.host.ticks::<E, N>(scene, self.transducers)
    }

    fn refuse(self) -> Result<(), HostClosed> {
        self.host.answer(&[REFUSED])
    }
}

/// A benchmark whose number format is still to be chosen.
struct ServoBench<'a, K> {
    job: BenchJob<'a>,
    scenes: PhantomData<K>,
}

impl<K: SceneSet> InEach for ServoBench<'_, K> {
    type Output = Result<(), HostClosed>;

    fn with<N: Number>(self) -> Result<(), HostClosed> {
        K::ticks::<N>(self.job)
    }
}
