//! Certifies scenes that come by their bits: requests in by the pipe `counts`, replies out by `codes`.

use haptic_servo::board::qemu::{EXIT_DONE, EXIT_REFUSED, lockstep, meter, tick_timer};
use semihosting::fs::File;
use semihosting::io::Write;

use crate::scene_codec::certify;

/// Answers until the host closes its end.
pub fn run() -> ! {
    tick_timer::start_clock();
    let scale = meter::Scale::calibrate();
    let Ok((counts, codes)) = lockstep::pipes() else {
        semihosting::process::exit(EXIT_REFUSED);
    };
    semihosting::process::exit(match serve(counts, codes, scale) {
        Ok(()) => EXIT_DONE,
        Err(RequestError) => EXIT_REFUSED,
    })
}

/// A malformed request, or a host that does not take the reply.
struct RequestError;

fn serve(mut requests: File, mut replies: File, scale: meter::Scale) -> Result<(), RequestError> {
    while let Ok(words) = lockstep::words(&mut requests) {
        let words = certify(&words, |judge| {
            let start = meter::now();
            judge();
            u64::from(scale.instructions(meter::now().wrapping_sub(start)))
        })
        .ok_or(RequestError)?;
        let bytes = words.map(u64::to_le_bytes);
        replies.write_all(bytes.as_flattened()).map_err(|_| RequestError)?;
    }
    Ok(())
}
