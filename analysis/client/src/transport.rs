//! Bytes to a board and back, with a limit on every wait.

use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use serialport::SerialPort;

use super::Address;

/// Longest wait for a connection, and for the wire to take bytes.
const TIMEOUT: Duration = Duration::from_secs(2);

/// A two-way stream of bytes whose reads end after a while, with or without bytes.
pub trait Transport: Read + Write + Send {
    /// Sets the longest wait of a read.
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<()>;
}

impl Transport for Box<dyn SerialPort> {
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<()> {
        Ok(self.set_timeout(limit)?)
    }
}

impl Transport for TcpStream {
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<()> {
        self.set_read_timeout(Some(limit))
    }
}

impl Transport for UnixStream {
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<()> {
        self.set_read_timeout(Some(limit))
    }
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
    transport.wait_at_most(limit)?;
    match transport.read(bytes) {
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
