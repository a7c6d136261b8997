//! Bytes to a board and back, with a limit on every wait.

use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::os::unix::net::UnixStream;
use std::thread;
use std::time::{Duration, Instant};

use serialport::SerialPort;

use super::Address;

/// Longest wait for a connection, and for the wire to take bytes.
const TIMEOUT: Duration = Duration::from_secs(2);

/// A system rounds the timeout of a socket's read up to its own ticks, of up to 10 ms.
const COARSE: Duration = Duration::from_millis(10);

/// Time between two looks at a socket in a shorter wait.
const LOOK: Duration = Duration::from_micros(100);

/// A two-way stream of bytes whose reads end after a while, with or without bytes.
pub trait Transport: Read + Write + Send {
    /// Sets the longest wait of a read.
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<()>;
    /// Whether its reads and writes wait, if it is a socket; false for others, whose waits are as long as is said.
    fn set_waiting(&self, _: bool) -> io::Result<bool> {
        Ok(false)
    }
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

    fn set_waiting(&self, waits: bool) -> io::Result<bool> {
        self.set_nonblocking(!waits)?;
        Ok(true)
    }
}

impl Transport for UnixStream {
    fn wait_at_most(&mut self, limit: Duration) -> io::Result<()> {
        self.set_read_timeout(Some(limit))
    }

    fn set_waiting(&self, waits: bool) -> io::Result<bool> {
        self.set_nonblocking(!waits)?;
        Ok(true)
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
    let read = if limit < COARSE && transport.set_waiting(false)? {
        let read = look_within(transport, bytes, limit);
        transport.set_waiting(true)?;
        read
    } else {
        // No operating system takes a timeout of zero.
        transport.wait_at_most(limit.max(Duration::from_millis(1)))?;
        transport.read(bytes)
    };
    match read {
        Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
        Err(error) if is_timeout(&error) => Ok(0),
        read => read,
    }
}

/// A read of a socket that does not wait, again and again until it has something.
fn look_within(
    transport: &mut dyn Transport,
    bytes: &mut [u8],
    limit: Duration,
) -> io::Result<usize> {
    let end = Instant::now() + limit;
    loop {
        let read = transport.read(bytes);
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() || !read.as_ref().is_err_and(is_timeout) {
            return read;
        }
        thread::sleep(left.min(LOOK));
    }
}

/// Whether a read has only timed out.
pub fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}
