//! Answers scenes by their bits: questions in by the pipe `counts`, replies out by `codes`.

use semihosting::fs::File;
use semihosting::io::{Read, Write};

use super::{EXIT_DONE, EXIT_REFUSED, lockstep, meter};
use crate::board::question::{Question, answer};

/// Answers until the host closes its end.
pub fn run() -> ! {
    super::pace::start_clock();
    let scale = meter::Scale::calibrate();
    let Ok((counts, codes)) = lockstep::pipes() else {
        semihosting::process::exit(EXIT_REFUSED);
    };
    semihosting::process::exit(match serve(counts, codes, scale) {
        Ok(()) => EXIT_DONE,
        Err(Unanswerable) => EXIT_REFUSED,
    })
}

/// A question that is none, or a host that does not take the reply.
struct Unanswerable;

fn serve(mut questions: File, mut replies: File, scale: meter::Scale) -> Result<(), Unanswerable> {
    let mut bytes = [0; size_of::<Question>()];
    while questions.read_exact(&mut bytes).is_ok() {
        let (chunks, _) = bytes.as_chunks();
        let question: Question = core::array::from_fn(|i| u64::from_le_bytes(chunks[i]));
        let words = answer(&question, |judge| {
            let start = meter::now();
            judge();
            u64::from(scale.instructions(meter::now().wrapping_sub(start)))
        })
        .ok_or(Unanswerable)?;
        for word in words {
            replies.write_all(&word.to_le_bytes()).map_err(|_| Unanswerable)?;
        }
    }
    Ok(())
}
