//! A board's wire for a page in a browser: a server that is reachable only from this machine, sends the page,
//! and carries the bytes of the port to it and back, unchanged.
//!
//! Any page of any site can ask a server of this machine, and a name can be made to point at it. So a client
//! must know the token, which only the user who started the server has seen; must address this machine by its
//! own address; and must be the page of this server, or a page from a file.

mod access;
mod client;
mod connections;
mod http;
mod port;
mod refusal;
mod shared;

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use thiserror::Error;

use self::access::{Access, Token};
use self::connections::{CONNECTIONS, Connection, Connections};
use self::http::{HttpResponse, Request};
pub use self::port::{Port, Report};
pub use self::refusal::PageRefusal;
use self::shared::Shared;

/// Time after the end of the server in which a page may read the reason.
const GOODBYE: Duration = Duration::from_secs(2);
/// Longest time between two checks whether the server ends.
const POLL_INTERVAL: Duration = Duration::from_millis(5);

/// The reason why there is no server.
#[derive(Debug, Error)]
pub enum ServeError {
    /// Other machines could reach the motor.
    #[error(
        "--listen {address} can be reached from other machines, and who reaches it can arm a motor: name an \
         address of this machine alone, such as 127.0.0.1:0; for another machine, forward the port with \
         `ssh -L`"
    )]
    NotLoopback {
        /// The address.
        address: SocketAddr,
    },
    /// The address is taken.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The cause.
        source: io::Error,
    },
    /// The token could not be created.
    #[error("the system has no random numbers: {0}")]
    Random(#[from] getrandom::Error),
}

/// A running server; ends when dropped.
pub struct Server {
    address: SocketAddr,
    token: Token,
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    /// Checks that an address is reachable only from this machine.
    pub fn check(listen: SocketAddr) -> Result<(), ServeError> {
        if listen.ip().is_loopback() {
            Ok(())
        } else {
            Err(ServeError::NotLoopback { address: listen })
        }
    }

    /// Listens at an address of this machine, for a page and its wire to this port.
    ///
    /// # Errors
    /// If the address is reachable from other machines, or taken, or if there are no random numbers.
    pub fn start(
        port: Port,
        listen: SocketAddr,
        page: String,
        report: Report,
    ) -> Result<Self, ServeError> {
        Self::check(listen)?;
        let cannot = |source| ServeError::Listen { address: listen, source };
        let listener = TcpListener::bind(listen).map_err(cannot)?;
        listener.set_nonblocking(true).map_err(cannot)?;
        let address = listener.local_addr().map_err(cannot)?;
        let token = Token::random()?;
        let over = Arc::new(AtomicBool::new(false));
        let (seats, wire) = port::seats();
        let shared = Arc::new(Shared {
            access: Access::new(address, token.clone()),
            page,
            seats: seats.clone(),
            over: over.clone(),
            connections: Connections::default(),
            report,
        });
        let (of_port, of_listener) = (shared.clone(), shared);
        let carry = move || port.carry(&seats, &wire, &of_port.over, &of_port.report);
        let threads =
            vec![thread::spawn(carry), thread::spawn(move || listen_at(&listener, &of_listener))];
        Ok(Self { address, token, over, threads })
    }

    /// The address at which it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The address of the page, with the token.
    pub fn url(&self) -> String {
        format!("http://{}/?token={}", self.address, self.token)
    }

    /// The token.
    pub fn token(&self) -> String {
        self.token.to_string()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A panic in a thread has been printed; there is nothing left to do about it.
            let _ = thread.join();
        }
    }
}

/// Accepts connections until the server ends, and waits for the open ones.
fn listen_at(listener: &TcpListener, shared: &Arc<Shared>) {
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    while !shared.over.load(Ordering::Relaxed) {
        threads.retain(|thread| !thread.is_finished());
        match listener.accept() {
            Ok((stream, _)) => threads.extend(connection(stream, shared)),
            Err(_) => thread::sleep(POLL_INTERVAL),
        }
    }
    let end = Instant::now() + GOODBYE;
    while Instant::now() < end && threads.iter().any(|thread| !thread.is_finished()) {
        thread::sleep(POLL_INTERVAL);
    }
    // A client that takes a byte now and then would otherwise keep the server from its end.
    shared.connections.close();
    for thread in threads {
        // As above.
        let _ = thread.join();
    }
}

/// Serves a connection in its own thread, if there is room.
fn connection(stream: TcpStream, shared: &Arc<Shared>) -> Option<JoinHandle<()>> {
    // The server does not wait for a client that does not read.
    let is_ready = stream.set_nonblocking(false).is_ok()
        && stream.set_write_timeout(Some(http::TIMEOUT)).is_ok()
        && stream.set_nodelay(true).is_ok();
    if !is_ready {
        return None;
    }
    match shared.connections.open(stream) {
        Ok(connection) => {
            let shared = shared.clone();
            Some(thread::spawn(move || serve(&connection, &shared)))
        }
        Err(stream) => {
            let busy = format!(
                "there are {CONNECTIONS} connections already: close other pages of this server"
            );
            HttpResponse::refusal("503 Service Unavailable", busy).send(&stream);
            None
        }
    }
}

/// Answers one request, or carries the wire of one page.
fn serve(connection: &Connection, shared: &Shared) {
    let answered = Request::read(&connection.stream, &shared.over).and_then(|mut request| {
        shared.access.check_host(&request)?;
        let origin = shared.access.origin(&request)?.map(ToOwned::to_owned);
        let origin = origin.as_deref();
        let answer = answer(connection, &mut request, origin, shared);
        let readable = |response: HttpResponse| response.readable_by(origin);
        answer.map(|response| response.map(readable)).map_err(readable)
    });
    match answered {
        Ok(None) => {}
        Ok(Some(answer)) | Err(answer) => answer.send(&connection.stream),
    }
}

/// The answer, unless the wire was carried.
fn answer(
    connection: &Connection,
    request: &mut Request<'_>,
    origin: Option<&str>,
    shared: &Shared,
) -> Result<Option<HttpResponse>, HttpResponse> {
    match request.path() {
        "/" => {
            shared.access.check_token(request)?;
            connection.trust();
            Ok(Some(HttpResponse::page(&shared.page)))
        }
        "/wire" => {
            shared.access.check_token(request)?;
            connection.trust();
            match request.query("page").map(ToOwned::to_owned) {
                Some(page) => client::send(request, &page, shared).map(Some),
                None => client::carry(&connection.stream, origin, shared).map(|()| None),
            }
        }
        // Browsers request this icon from every server.
        "/favicon.ico" => Ok(Some(HttpResponse::empty())),
        path => {
            let why = format!("there is no {path} here: / is the page");
            Err(HttpResponse::refusal("404 Not Found", why))
        }
    }
}
