//! The servers on the emulated board: requests come by the pipe `counts`, replies go by `codes`.

pub mod bench;
pub mod certify;

use haptic_servo::board::qemu::{EXIT_DONE, EXIT_REFUSED, lockstep};
use semihosting::fs::File;
use semihosting::io::{Read, Write};
use semihosting::process::exit;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::scene_codec::{FRAME, decode, encode};

/// The host does not take a reply, or its request is malformed.
#[derive(Debug)]
pub struct HostClosed;

struct Host {
    counts: File,
    codes: File,
}

impl Host {
    fn read(&mut self, bytes: &mut [u8]) -> Result<(), HostClosed> {
        self.counts.read_exact(bytes).map_err(|_| HostClosed)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), HostClosed> {
        self.codes.write_all(bytes).map_err(|_| HostClosed)
    }

    fn reply<R: Serialize>(&mut self, reply: &R) -> Result<(), HostClosed> {
        self.write(&encode(reply))
    }
}

/// Answers requests until the host closes its end.
fn serve<Q: DeserializeOwned>(mut answer: impl FnMut(&mut Host, Q) -> Result<(), HostClosed>) -> ! {
    let Ok((counts, codes)) = lockstep::pipes() else { exit(EXIT_REFUSED) };
    let (mut host, mut frame) = (Host { counts, codes }, [0; FRAME]);
    while host.read(&mut frame).is_ok() {
        let request = decode(&frame).ok_or(HostClosed);
        if request.and_then(|request| answer(&mut host, request)).is_err() {
            exit(EXIT_REFUSED)
        }
    }
    exit(EXIT_DONE)
}
