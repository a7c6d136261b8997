//! Runs [benchmarks](crate::bench_request) on the emulated board.

mod scenes;

pub use scenes::{AllScenes, ProgramScenes};

use core::hint::black_box;
use core::marker::PhantomData;

use haptic_servo::board::qemu::{meter, tick_timer};
use haptic_servo::current::{CurrentController, Duties};
use haptic_servo::encoder::RawCount;
use haptic_servo::number::{InEach, Number};
use haptic_servo::rendering::Rendering;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

pub use super::HostClosed;
use super::{Host, serve};
use crate::bench_request::{BLOCK, BenchRequest, Inputs, Output, Outputs};
use crate::currents::Input;
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
    serve(|host, request| {
        let mut bench = Bench { host, scale };
        match request {
            BenchRequest::Servo { scene, transducers, arithmetic } => {
                let job = BenchJob { bench, scene: &scene, transducers: &transducers };
                arithmetic.choose(ServoBench::<K> { job, scenes: PhantomData })
            }
            BenchRequest::Sine(sine) => bench.run(|turn| {
                let (value, time) = timed(sine, turn);
                Output { value: value.into(), code: 0, instructions: time }
            }),
            BenchRequest::Rotation(rotation) => bench.run(|angle| {
                let (pair, time) = timed_rotation(rotation, angle);
                Output { value: rotations::packed(pair), code: 0, instructions: time }
            }),
            BenchRequest::Current(current) => {
                let (mut controller, mut instant) = (current.started(), 0);
                bench.run(|input| {
                    instant += 1;
                    let ([u, code], time) =
                        timed_instant(black_box(&mut controller), input, instant);
                    if u == 0 {
                        controller = current.started();
                    }
                    Output { value: u.into(), code, instructions: time }
                })
            }
        }
    })
}

/// The host, and the scale of the meter.
struct Bench<'a> {
    host: &'a mut Host,
    scale: meter::Scale,
}

impl Bench<'_> {
    /// Replies that it computes, and computes outputs as long as there are inputs.
    #[inline(always)]
    fn run(&mut self, mut compute: impl FnMut(u32) -> Output) -> Result<(), HostClosed> {
        self.host.reply(&true)?;
        while let Some(inputs) = self.inputs()? {
            let mut outputs = inputs.map(&mut compute);
            // Not earlier: the data of the scale would be loaded within the measured interval.
            for output in &mut outputs {
                output.instructions = self.scale.measured(output.instructions);
            }
            self.outputs(&outputs)?;
        }
        Ok(())
    }

    /// The next inputs; `None` at the end of the benchmark.
    #[inline(never)]
    fn inputs(&mut self) -> Result<Option<Inputs>, HostClosed> {
        let mut more = [0];
        self.host.read(&mut more)?;
        if more == [0] {
            return Ok(None);
        }
        let mut inputs = [[0; 4]; BLOCK];
        self.host.read(inputs.as_flattened_mut())?;
        Ok(Some(inputs.map(u32::from_le_bytes)))
    }

    #[inline(never)]
    fn outputs(&mut self, outputs: &Outputs) -> Result<(), HostClosed> {
        outputs.iter().try_for_each(|output| self.host.write(&output.to_bytes()))
    }

    /// Ticks of a servo of the scene.
    // SAFETY: the section is one of code, in flash that the emulated board has.
    #[unsafe(link_section = ".more")]
    #[inline(never)]
    fn ticks<E: Rendering<N>, N: Number>(
        &mut self,
        scene: Scene<E>,
        transducers: &Transducers,
    ) -> Result<(), HostClosed> {
        let Ok(mut servo) = meter::uncertified_servo::<E, N>(&scene, transducers) else {
            return self.host.reply(&false);
        };
        self.run(|count| {
            let (servo, mut code) = (black_box(&mut servo), 0);
            let time = meter::measure(count, |count| {
                let output = servo.tick(RawCount::from(count));
                code = output.code.get();
                (code.into(), output.limit as u32)
            });
            Output { value: servo.torque_nm(), code, instructions: time }
        })
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
    bench: Bench<'a>,
    scene: &'a Scene,
    transducers: &'a Transducers,
}

impl BenchJob<'_> {
    /// Runs its ticks with a servo of its scene in this type.
    fn run<E: Rendering<N>, N: Number>(mut self, scene: Scene<E>) -> Result<(), HostClosed> {
        self.bench.ticks::<E, N>(scene, self.transducers)
    }

    fn refuse(self) -> Result<(), HostClosed> {
        self.bench.host.reply(&false)
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
