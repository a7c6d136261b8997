//! Bytes to a board and back, with a limit on every wait.

use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use serialport::SerialPort;

use super::Address;

/// Longest wait for a connection, and for the wire to take bytes.
const TIMEOUT: Duration = Duration::from_secs(2);

/// A two-way stream of bytes whose reads end after a while, with or without bytes.
pub trait Transport: Read + Write + Send {
    /// Waits for bytes, at most so long: whether a read is due, which may wait for the rest of that time.
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<bool>;
}

impl Transport for Box<dyn SerialPort> {
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<bool> {
        self.set_timeout(limit.max(Duration::from_millis(1)))?;
        Ok(true)
    }
}

impl Transport for TcpStream {
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<bool> {
        has_bytes(self, limit)
    }
}

impl Transport for UnixStream {
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<bool> {
        has_bytes(self, limit)
    }
}

/// Whether a socket has bytes, or its end, within this time. A system rounds the timeout of a socket's read up to its
/// own ticks, of some ms, and this wait not.
fn has_bytes(socket: &impl AsFd, limit: Duration) -> io::Result<bool> {
    let limit = Timespec::try_from(limit).map_err(io::Error::other)?;
    Ok(poll(&mut [PollFd::new(socket, PollFlags::IN)], Some(&limit))? > 0)
}

/// Opens an address.
pub fn open(address: &Address) -> io::Result<Box<dyn Transport>> {
    Ok(match address {
        Address::Serial { port, baud } => {
            let port = serialport::new(port, *baud).timeout(TIMEOUT).open()?;
            // Discards old bytes that the debug probe has buffered.
            port.clear(serialport::ClearBuffer::All)?;
            Box::new(port)
        }
        Address::Tcp(address) => Box::new(connect(address)?),
        Address::Unix(path) => {
            let stream = UnixStream::connect(path)?;
            stream.set_write_timeout(Some(TIMEOUT))?;
            Box::new(stream)
        }
    })
}

/// Connects to the first of a host's addresses that answers.
fn connect(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::from(io::ErrorKind::AddrNotAvailable);
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, TIMEOUT) {
            Ok(stream) => {
                // Messages are small, and each waits for the answer to the previous one.
                stream.set_nodelay(true)?;
                stream.set_write_timeout(Some(TIMEOUT))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Reads the bytes that come within a time; 0 if none do.
///
/// # Errors
/// Where the other end is gone.
pub fn read_within(
    transport: &mut dyn Transport,
    bytes: &mut [u8],
    limit: Duration,
) -> io::Result<usize> {
    let read = transport.wait_at_most(limit).and_then(|is_due| {
        if is_due { transport.read(bytes) } else { Err(io::ErrorKind::TimedOut.into()) }
    });
    match read {
        Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
        Err(error) if is_timeout(&error) => Ok(0),
        read => read,
    }
}

/// Whether a read has only timed out.
pub fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}
