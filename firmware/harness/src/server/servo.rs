//! Runs the servo of scenes that the host sends: a request and counts in, codes out.

use fixed::types::I16F16;
use haptic_servo::encoder::RawCount;
use haptic_servo::number::{Arithmetic, Number};
use haptic_servo::servo::Servo;

use super::{Host, HostClosed, serve};
use crate::loop_request::{LoopRequest, StartReply};

/// Serves until the host closes its end.
pub fn run() -> ! {
    serve(|host, request: LoopRequest| match request.arithmetic {
        Arithmetic::F32 => run_servo::<f32>(host, &request),
        Arithmetic::I16F16 => run_servo::<I16F16>(host, &request),
        _ => host.reply(&StartReply::BuildFailed),
    })
}

/// Certifies a scene and, if that passes, runs its servo.
fn run_servo<N: Number>(host: &mut Host, request: &LoopRequest) -> Result<(), HostClosed> {
    let Ok(certified) = request.scene.certify_in(N::FORMAT) else {
        return host.reply(&StartReply::Rejected);
    };
    let Ok(mut servo) = Servo::<_, N>::new(&certified, &request.transducers) else {
        return host.reply(&StartReply::BuildFailed);
    };
    host.reply(&StartReply::Ready)?;
    for _ in 0..request.ticks {
        let mut count = [0; 4];
        host.read(&mut count)?;
        let output = servo.tick(RawCount::from(u32::from_le_bytes(count)));
        host.write(&output.code.get().to_le_bytes())?;
    }
    Ok(())
}
