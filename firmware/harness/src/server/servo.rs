//! Runs the servo of scenes that the host sends: a request and counts in by the pipe `counts`, codes
//! out by `codes`.

use fixed::types::I16F16;
use haptic_servo::board::qemu::{EXIT_DONE, EXIT_REFUSED, lockstep};
use haptic_servo::encoder::RawCount;
use haptic_servo::number::{Arithmetic, Number};
use haptic_servo::servo::Servo;
use semihosting::fs::File;
use semihosting::io::{Error, Read, Write};

use crate::loop_request::{LoopRequest, StartReply};

/// Serves until the host closes its end.
pub fn run() -> ! {
    let Ok((counts, codes)) = lockstep::pipes() else {
        semihosting::process::exit(EXIT_REFUSED);
    };
    let mut pipes = Pipes { counts, codes };
    while let Ok(request) = pipes.next() {
        let served = request.map(|request| match request.arithmetic {
            Arithmetic::F32 => pipes.run_servo::<f32>(&request),
            Arithmetic::I16F16 => pipes.run_servo::<I16F16>(&request),
            _ => pipes.reply(StartReply::BuildFailed),
        });
        // A malformed request, or a host that closes its end before the last tick.
        if !matches!(served, Some(Ok(()))) {
            semihosting::process::exit(EXIT_REFUSED);
        }
    }
    semihosting::process::exit(EXIT_DONE)
}

/// The two pipes.
struct Pipes {
    counts: File,
    codes: File,
}

impl Pipes {
    /// The next request; `None` if it is malformed.
    fn next(&mut self) -> Result<Option<LoopRequest>, Error> {
        Ok(LoopRequest::decode(&lockstep::words(&mut self.counts)?))
    }

    /// Certifies a scene and, if that passes, runs its servo.
    fn run_servo<N: Number>(&mut self, request: &LoopRequest) -> Result<(), Error> {
        let Ok(certified) = request.scene.certify_in(N::FORMAT) else {
            return self.reply(StartReply::Rejected);
        };
        let Ok(mut servo) = Servo::<_, N>::new(&certified, &request.transducers) else {
            return self.reply(StartReply::BuildFailed);
        };
        self.reply(StartReply::Ready)?;
        for _ in 0..request.ticks {
            let mut count = [0; 4];
            self.counts.read_exact(&mut count)?;
            let output = servo.tick(RawCount::from(u32::from_le_bytes(count)));
            self.codes.write_all(&output.code.get().to_le_bytes())?;
        }
        Ok(())
    }

    fn reply(&mut self, reply: StartReply) -> Result<(), Error> {
        self.codes.write_all(&reply.to_bytes())
    }
}
