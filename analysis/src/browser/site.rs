//! Serves one page on an address of this machine, so that the page's clocks have a fine resolution.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::BrowserError;

/// Timeout of a browser's request for the page.
const PATIENCE: Duration = Duration::from_secs(10);
/// Longest head of a request, in bytes.
const LONGEST_HEAD: u64 = 1 << 14;

/// Without these headers a page's clock has steps of 100 us, with them steps of 5 us: no other site is then
/// in the page's process, whose data the page could learn from measured times.
const ALONE: &str =
    "Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Embedder-Policy: require-corp\r\n";

/// A page that is served; ends when dropped.
pub struct Site {
    address: SocketAddr,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Site {
    /// Serves a page, to any client.
    pub fn of(page: String) -> Result<Self, BrowserError> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).map_err(BrowserError::Site)?;
        let address = listener.local_addr().map_err(BrowserError::Site)?;
        let over = Arc::new(AtomicBool::new(false));
        let is_over = Arc::clone(&over);
        let page: Arc<str> = page.into();
        let thread = thread::spawn(move || {
            for connection in listener.incoming() {
                if is_over.load(Ordering::Acquire) {
                    return;
                }
                let Ok(connection) = connection else { continue };
                let page = Arc::clone(&page);
                // Browsers open connections in advance on which they never send a request.
                thread::spawn(move || answer(connection, &page));
            }
        });
        Ok(Self { address, over, thread: Some(thread) })
    }

    /// The page's address.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }
}

impl Drop for Site {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        // This last connection ends the thread's wait for connections. If it fails, the thread ends with the
        // program.
        if TcpStream::connect(self.address).is_ok()
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
    }
}

/// Sends the page as the answer to any request.
fn answer(mut connection: TcpStream, page: &str) -> io::Result<()> {
    connection.set_read_timeout(Some(PATIENCE))?;
    // A head ends with an empty line.
    for line in BufReader::new((&connection).take(LONGEST_HEAD)).lines() {
        if line?.is_empty() {
            break;
        }
    }
    let length = page.len();
    write!(
        connection,
        "HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {length}\r\n\
         Cache-Control: no-store\r\nConnection: close\r\n{ALONE}\r\n"
    )?;
    connection.write_all(page.as_bytes())
}
