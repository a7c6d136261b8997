//! The two pipes of the lockstep.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::time::{Duration, Instant};

use nix::fcntl::OFlag;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

/// This process's ends.
pub struct Pipes {
    counts: File,
    codes: File,
}

impl Pipes {
    /// Makes the pipes `counts` and `codes` in a folder and opens this side of them.
    pub fn make(folder: &Path) -> io::Result<Self> {
        let [counts, codes] = ["counts", "codes"].map(|name| folder.join(name));
        for path in [&counts, &codes] {
            mkfifo(path, Mode::S_IRUSR | Mode::S_IWUSR)?;
        }
        Ok(Self {
            // Opened for both directions, because opening for writing alone waits for a reader.
            counts: OpenOptions::new().read(true).write(true).open(counts)?,
            // Only for reading, so that the end of the guest is an end of file; not blocking, because opening
            // would wait for the guest.
            codes: OpenOptions::new()
                .read(true)
                .custom_flags(OFlag::O_NONBLOCK.bits())
                .open(codes)?,
        })
    }

    /// Writes a request and reads an answer of known length. `ended` returns whether the guest has ended; it
    /// is polled, because a guest that never opened the pipe cannot close it.
    ///
    /// # Errors
    /// `TimedOut` after the timeout, `UnexpectedEof` if the guest has ended.
    pub fn exchange(
        &mut self,
        request: &[u8],
        mut answer: &mut [u8],
        timeout: Duration,
        ended: &mut dyn FnMut() -> io::Result<bool>,
    ) -> io::Result<()> {
        self.counts.write_all(request)?;
        let deadline = Instant::now() + timeout;
        while !answer.is_empty() {
            while !self.has_something()? {
                if ended()? {
                    return Err(io::ErrorKind::UnexpectedEof.into());
                }
                if Instant::now() >= deadline {
                    return Err(io::ErrorKind::TimedOut.into());
                }
            }
            match self.codes.read(answer) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(read) => answer = &mut answer[read..],
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Waits a little for bytes to read, or for the guest to close its end.
    fn has_something(&self) -> io::Result<bool> {
        let mut codes = [PollFd::new(self.codes.as_fd(), PollFlags::POLLIN)];
        match poll(&mut codes, PollTimeout::from(BETWEEN_LOOKS)) {
            Ok(ready) => Ok(ready > 0),
            Err(nix::errno::Errno::EINTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }
}

/// Time in ms between two polls for the end of the guest.
const BETWEEN_LOOKS: u8 = 50;
