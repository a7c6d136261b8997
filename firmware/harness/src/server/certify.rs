//! Certifies scenes that come by their bits.

use haptic_servo::board::qemu::{meter, tick_timer};

use super::{HostClosed, serve};
use crate::scene_codec::{CertifyRequest, certify};

/// Answers until the host closes its end.
pub fn run() -> ! {
    tick_timer::start_clock();
    let scale = meter::Scale::calibrate();
    serve(|host, CertifyRequest(scene)| {
        let reply = certify(&scene, |judge| {
            let start = meter::now();
            judge();
            u64::from(scale.instructions(meter::now().wrapping_sub(start)))
        });
        host.reply(&reply.ok_or(HostClosed)?)
    })
}
