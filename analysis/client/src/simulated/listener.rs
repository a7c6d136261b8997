//! The socket of a simulated board.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpListener;
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::Address;

/// Bytes of one read: as many as a serial port collects in a few milliseconds.
const BYTES: usize = 256;

/// The error for an address that is not a socket's.
const NO_SOCKET: &str = "a simulated board listens on a socket, tcp://HOST:PORT or unix:PATH, not \
                         on a serial port";

/// A non-blocking stream of bytes.
trait Stream: Read + Write + Send {}

impl<S: Read + Write + Send> Stream for S {}

/// A socket and its client: one at a time, as on a serial line.
pub struct Listener {
    socket: Socket,
    client: Option<Box<dyn Stream>>,
    next: Option<(Instant, Box<dyn Stream>)>,
}

/// Time after which a second client is rejected. Until then the first may turn out to have left.
const QUEUE_TIMEOUT: Duration = Duration::from_millis(100);

enum Socket {
    Tcp(TcpListener),
    Unix(UnixListener, PathBuf),
}

impl Listener {
    /// Listens at the address; returns it, with the port that the system chose in place of port 0.
    pub(super) fn bind(address: &Address) -> io::Result<(Self, Address)> {
        let (socket, address) = match address {
            Address::Tcp(address) => {
                let listener = TcpListener::bind(address)?;
                listener.set_nonblocking(true)?;
                let address = listener.local_addr()?.to_string();
                (Socket::Tcp(listener), Address::Tcp(address))
            }
            Address::Unix(path) => {
                let listener = bind_unix(path)?;
                listener.set_nonblocking(true)?;
                (Socket::Unix(listener, path.clone()), address.clone())
            }
            _ => return Err(io::Error::new(ErrorKind::Unsupported, NO_SOCKET)),
        };
        Ok((Self { socket, client: None, next: None }, address))
    }

    /// The received bytes.
    pub fn receive(&mut self) -> Vec<u8> {
        self.reject_other_clients();
        if self.client.is_none() {
            self.client = self.accept();
        }
        let mut bytes = [0; BYTES];
        self.carry(|client| received(client, &mut bytes).map(<[u8]>::to_vec)).unwrap_or_default()
    }

    /// Sends as many bytes as the stream takes.
    pub fn send(&mut self, outgoing: &mut Vec<u8>) {
        match self.carry(|client| send(client, outgoing)) {
            Some(sent) => drop(outgoing.drain(..sent)),
            // Without a client bytes are lost, as on a serial line.
            None => outgoing.clear(),
        }
    }

    /// Carries bytes; none without a client, or if it leaves.
    fn carry<T>(&mut self, carry: impl FnOnce(&mut dyn Stream) -> io::Result<T>) -> Option<T> {
        let carried = carry(self.client.as_mut()?.as_mut());
        if carried.is_err() {
            self.client = None;
        }
        carried.ok()
    }

    /// The next client.
    fn accept(&mut self) -> Option<Box<dyn Stream>> {
        self.next.take().map(|(_, next)| next).or_else(|| self.socket.accept())
    }

    /// Closes the connection of a second client: a serial port cannot be opened twice either, and the
    /// client should see that.
    fn reject_other_clients(&mut self) {
        if self.client.is_none() {
            return;
        }
        self.next.take_if(|(since, _)| since.elapsed() > QUEUE_TIMEOUT);
        if self.next.is_none() {
            self.next = self.socket.accept().map(|next| (Instant::now(), next));
        }
    }
}

/// Binds a Unix socket; replaces the socket file that a killed program left behind.
fn bind_unix(path: &Path) -> io::Result<UnixListener> {
    let taken = |why: &str| io::Error::new(ErrorKind::AddrInUse, why);
    match UnixListener::bind(path) {
        Err(error) if error.kind() == ErrorKind::AddrInUse => {}
        bound => return bound,
    }
    if !std::fs::symlink_metadata(path)?.file_type().is_socket() {
        return Err(taken("a file with this name exists, and is not a socket"));
    }
    match UnixStream::connect(path) {
        Err(error) if error.kind() == ErrorKind::ConnectionRefused => {
            std::fs::remove_file(path)?;
            UnixListener::bind(path)
        }
        _ => Err(taken("another program listens there")),
    }
}

/// Received bytes; [`ErrorKind::UnexpectedEof`] once the other end is closed.
fn received<'a>(client: &mut dyn Stream, bytes: &'a mut [u8]) -> io::Result<&'a [u8]> {
    match client.read(bytes) {
        Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
        Ok(read) => Ok(&bytes[..read]),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(&[]),
        Err(error) => Err(error),
    }
}

/// Sends as many bytes as the stream takes. It does not send an empty slice: on a stream that the other end
/// has closed this would be an error, and the bytes received before would be lost.
fn send(client: &mut dyn Stream, bytes: &[u8]) -> io::Result<usize> {
    if bytes.is_empty() {
        return Ok(0);
    }
    match client.write(bytes) {
        Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(0),
        written => written,
    }
}

impl Socket {
    /// The next client, if one waits.
    fn accept(&self) -> Option<Box<dyn Stream>> {
        let accepted: io::Result<Box<dyn Stream>> = match self {
            Self::Tcp(listener) => listener.accept().and_then(|(stream, _)| {
                stream.set_nonblocking(true)?;
                stream.set_nodelay(true)?;
                Ok(Box::new(stream) as _)
            }),
            Self::Unix(listener, _) => listener.accept().and_then(|(stream, _)| {
                stream.set_nonblocking(true)?;
                Ok(Box::new(stream) as _)
            }),
        };
        accepted.ok()
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        if let Self::Unix(_, path) = self {
            // The file may be gone already.
            let _ = std::fs::remove_file(path);
        }
    }
}
