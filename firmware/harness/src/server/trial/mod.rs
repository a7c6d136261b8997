//! Does [trials](crate::trial) on the emulated board: inputs come by the pipe `counts`,
//! outputs go by `codes`.

mod every;
mod programs;

pub use every::Every;
pub use programs::OfPrograms;

use core::hint::black_box;
use core::marker::PhantomData;

use firmware::board::qemu::{EXIT_DONE, EXIT_REFUSED, lockstep, meter, pace};
use firmware::encoder::RawCount;
use firmware::environment::Renderable;
use firmware::number::{InEach, Number};
use firmware::scene::Scene;
use firmware::servo::Transducers;
use semihosting::fs::File;
use semihosting::io::{Read, Write};

use crate::sines::Sine;
use crate::trial::{BLOCK, Inputs, Output, Outputs, READY, REFUSED, Trial};

/// The types of environments of which a program has servos. A servo of data would have instructions
/// of its own to find out what it is.
pub trait Kinds {
    /// Has a servo of the scene's own type do its ticks, if the program has that.
    ///
    /// # Errors
    /// Where the host is gone.
    fn ticks<N: Number>(job: Job<'_>) -> Result<(), Gone>;
}

/// Does trials of these types until the host closes its end.
pub fn run<K: Kinds>() -> ! {
    pace::start_clock();
    let scale = meter::Scale::calibrate();
    let Ok((counts, codes)) = lockstep::pipes() else {
        semihosting::process::exit(EXIT_REFUSED);
    };
    let mut host = Host { counts, codes, scale };
    semihosting::process::exit(match host.serve::<K>() {
        Ok(()) => EXIT_DONE,
        Err(Gone) => EXIT_REFUSED,
    })
}

/// The host does not take an answer, or asks what is no question.
#[derive(Debug)]
pub struct Gone;

/// The pipes to the host, and what the meter's numbers mean.
struct Host {
    counts: File,
    codes: File,
    scale: meter::Scale,
}

impl Host {
    fn serve<K: Kinds>(&mut self) -> Result<(), Gone> {
        while let Some(trial) = self.question()? {
            match trial {
                Trial::Servo { scene, transducers, arithmetic } => {
                    let job = Job { host: self, scene: &scene, transducers: &transducers };
                    arithmetic.choose(OfServo::<K> { job, kinds: PhantomData })?;
                }
                Trial::Sine(sine) => self.sine(sine)?,
            }
        }
        Ok(())
    }

    /// The next trial, if there is another one.
    fn question(&mut self) -> Result<Option<Trial>, Gone> {
        match lockstep::words(&mut self.counts) {
            Ok(words) => Trial::read(&words).map(Some).ok_or(Gone),
            Err(_) => Ok(None),
        }
    }

    fn answer(&mut self, bytes: &[u8]) -> Result<(), Gone> {
        self.codes.write_all(bytes).map_err(|_| Gone)
    }

    /// The inputs that come next; `None` where the trial is over.
    #[inline(never)]
    fn inputs(&mut self) -> Result<Option<Inputs>, Gone> {
        let mut more = [0];
        self.counts.read_exact(&mut more).map_err(|_| Gone)?;
        if more == [0] {
            return Ok(None);
        }
        let mut inputs = [[0; 4]; BLOCK];
        self.counts.read_exact(inputs.as_flattened_mut()).map_err(|_| Gone)?;
        Ok(Some(inputs.map(u32::from_le_bytes)))
    }

    #[inline(never)]
    fn outputs(&mut self, outputs: &Outputs) -> Result<(), Gone> {
        outputs.iter().try_for_each(|output| self.answer(&output.to_bytes()))
    }

    /// Ticks of a servo of the scene, as long as there are counts.
    // SAFETY: the section is one of code, in flash that the emulated board has.
    #[unsafe(link_section = ".more")]
    #[inline(never)]
    fn ticks<E: Renderable<N>, N: Number>(
        &mut self,
        scene: Scene<E>,
        transducers: &Transducers,
    ) -> Result<(), Gone> {
        let Ok(mut servo) = meter::judged_elsewhere::<E, N>(&scene, transducers) else {
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
                let instructions = self.scale.measured(time);
                *output = Output { value: servo.torque_nm(), code, instructions };
            }
            self.outputs(&outputs)?;
        }
        Ok(())
    }

    /// Sines, as long as there are parts of a turn.
    fn sine(&mut self, sine: Sine) -> Result<(), Gone> {
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

/// The sine of the bits of a part of a turn, and the time that it took. The choice is outside of the
/// measured stretch.
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

/// A servo's trial, whose types are still to be chosen.
pub struct Job<'a> {
    host: &'a mut Host,
    scene: &'a Scene,
    transducers: &'a Transducers,
}

impl Job<'_> {
    /// Its ticks, as a servo of this environment.
    fn of<E: Renderable<N>, N: Number>(self, environment: E) -> Result<(), Gone> {
        let Scene { device, timing, coupling, torque_limit, .. } = *self.scene;
        let scene = Scene { device, timing, coupling, environment, torque_limit };
        self.host.ticks::<E, N>(scene, self.transducers)
    }

    fn refuse(self) -> Result<(), Gone> {
        self.host.answer(&[REFUSED])
    }
}

/// A job whose format is still to be chosen.
struct OfServo<'a, K> {
    job: Job<'a>,
    kinds: PhantomData<K>,
}

impl<K: Kinds> InEach for OfServo<'_, K> {
    type Output = Result<(), Gone>;

    fn with<N: Number>(self) -> Result<(), Gone> {
        K::ticks::<N>(self.job)
    }
}
