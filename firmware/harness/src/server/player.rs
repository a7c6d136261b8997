//! Plays scenes that the host sends: a play and counts in by the pipe `counts`, codes out by
//! `codes`.

use firmware::board::qemu::{EXIT_DONE, EXIT_REFUSED, lockstep};
use firmware::encoder::RawCount;
use firmware::number::{Arithmetic, Number};
use firmware::servo::Servo;
use fixed::types::I16F16;
use semihosting::fs::File;
use semihosting::io::{Error, Read, Write};

use crate::play::{Curtain, Play};

/// Plays until the host closes its end.
pub fn run() -> ! {
    let Ok((counts, codes)) = lockstep::pipes() else {
        semihosting::process::exit(EXIT_REFUSED);
    };
    let mut stage = Stage { counts, codes };
    while let Ok(play) = stage.next() {
        let played = play.map(|play| match play.arithmetic {
            Arithmetic::F32 => stage.play::<f32>(&play),
            Arithmetic::I16F16 => stage.play::<I16F16>(&play),
            _ => stage.draw(Curtain::Unbuildable),
        });
        // What is no play, and a host that goes away in the middle of one.
        if !matches!(played, Some(Ok(()))) {
            semihosting::process::exit(EXIT_REFUSED);
        }
    }
    semihosting::process::exit(EXIT_DONE)
}

/// The two pipes.
struct Stage {
    counts: File,
    codes: File,
}

impl Stage {
    /// The next play, if the bytes are one.
    fn next(&mut self) -> Result<Option<Play>, Error> {
        Ok(Play::read(&lockstep::words(&mut self.counts)?))
    }

    /// Judges a scene and, if it is certified, is its servo.
    fn play<N: Number>(&mut self, play: &Play) -> Result<(), Error> {
        let Ok(certified) = play.scene.certify_in(N::FORMAT) else {
            return self.draw(Curtain::Refused);
        };
        let Ok(mut servo) = Servo::<_, N>::new(&certified, &play.transducers) else {
            return self.draw(Curtain::Unbuildable);
        };
        self.draw(Curtain::Open)?;
        for _ in 0..play.ticks {
            let mut count = [0; 4];
            self.counts.read_exact(&mut count)?;
            let output = servo.tick(RawCount::from(u32::from_le_bytes(count)));
            self.codes.write_all(&output.code.get().to_le_bytes())?;
        }
        Ok(())
    }

    fn draw(&mut self, curtain: Curtain) -> Result<(), Error> {
        self.codes.write_all(&curtain.to_bytes())
    }
}
