//! `haptic serve` and its clients: raw requests, pages, and a board that comes and goes.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use analysis::board_sim::Pacing;
use analysis::link::Address;
use analysis::serve::{Port, ServeError, Server};
use haptic_servo::wire::message::{LONGEST_TO_HOST, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder, PROTOCOL, encode};
use serde_json::{Value, json};

use crate::wire::off;

const TEXT: &str = "<!DOCTYPE html><title>the page</title>";
/// Timeout of all operations, on a slow machine.
const TIMEOUT: Duration = Duration::from_secs(60);

fn loopback() -> SocketAddr {
    "127.0.0.1:0".parse().unwrap()
}

fn serve(port: &Address) -> Server {
    Server::start(Port::open(port).unwrap(), loopback(), TEXT.into(), Box::new(|_| {})).unwrap()
}

/// A port whose other end the test has.
struct FakeBoard {
    listener: TcpListener,
    stream: TcpStream,
    server: Server,
}

impl FakeBoard {
    fn new() -> Self {
        let listener = TcpListener::bind(loopback()).unwrap();
        let server = serve(&Address::Tcp(listener.local_addr().unwrap().to_string()));
        let stream = accept(&listener);
        Self { listener, stream, server }
    }
}

fn accept(listener: &TcpListener) -> TcpStream {
    let (stream, _) = listener.accept().unwrap();
    stream.set_read_timeout(Some(TIMEOUT)).unwrap();
    stream.set_write_timeout(Some(TIMEOUT)).unwrap();
    stream
}

/// A page that has the wire.
struct Page {
    lines: BufReader<TcpStream>,
    /// Where it sends bytes.
    up: Up,
}

/// The address for the bytes of a page.
#[derive(Clone)]
struct Up {
    server: SocketAddr,
    target: String,
}

impl Up {
    /// Sends bytes; the status of the answer.
    fn send(&self, bytes: &[u8]) -> u16 {
        let more = format!("Origin: null\r\nContent-Length: {}\r\n", bytes.len());
        let head = request("POST", &self.target, &self.server.to_string(), &more);
        let mut stream = TcpStream::connect(self.server).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        // The server may refuse it before all of it is sent.
        let sent = stream.write_all(&[head.as_bytes(), bytes].concat());
        let mut answer = String::new();
        match sent.and_then(|()| stream.read_to_string(&mut answer)) {
            Ok(_) => status(&answer),
            Err(_) => 0,
        }
    }
}

impl Page {
    /// The next line; none at the end.
    fn line(&mut self) -> Option<Value> {
        let mut line = String::new();
        let is_whole = self.lines.read_line(&mut line).is_ok() && line.ends_with('\n');
        is_whole.then(|| serde_json::from_str(&line).unwrap())
    }

    /// The next news of the port.
    fn port(&mut self) -> Value {
        loop {
            let line = self.line().unwrap();
            if !line["port"].is_null() {
                return line;
            }
        }
    }

    /// The next bytes of the board; none at the end.
    fn some_bytes(&mut self) -> Option<Vec<u8>> {
        loop {
            if let Some(bytes) = self.line()?["bytes"].as_str() {
                return Some(data_encoding::HEXLOWER.decode(bytes.as_bytes()).unwrap());
            }
        }
    }

    /// This many bytes of the board.
    fn bytes(&mut self, count: usize) -> Vec<u8> {
        let mut bytes = Vec::new();
        while bytes.len() < count {
            bytes.extend(self.some_bytes().unwrap());
        }
        bytes
    }

    /// Why the server ends it; none if the line with the reason is cut off.
    fn end(&mut self) -> Option<String> {
        loop {
            if let Some(why) = self.line()?["end"].as_str() {
                return Some(why.to_owned());
            }
        }
    }
}

/// Asks for the wire with an origin and a token; the status and the whole answer to a refused request.
fn ask(server: &Server, origin: Option<&str>, token: &str) -> Result<Page, (u16, String)> {
    let more = origin.map_or_else(String::new, |origin| format!("Origin: {origin}\r\n"));
    let (target, host) = (format!("/wire?token={token}"), server.address().to_string());
    let mut stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(TIMEOUT)).unwrap();
    stream.write_all(request("POST", &target, &host, &more).as_bytes()).unwrap();
    let mut lines = BufReader::new(stream);
    let mut head = String::new();
    while !head.ends_with("\r\n\r\n") {
        assert!(lines.read_line(&mut head).unwrap() > 0, "{head}");
    }
    if status(&head) != 200 {
        lines.read_to_string(&mut head).unwrap();
        return Err((status(&head), head));
    }
    assert_eq!(head.contains("access-control-allow-origin: null\r\n"), origin == Some("null"));
    let mut page = Page { lines, up: Up { server: server.address(), target } };
    let first = page.line().unwrap();
    page.up.target += &format!("&page={}", first["page"].as_str().unwrap());
    Ok(page)
}

fn connect(server: &Server) -> Page {
    ask(server, Some("null"), &server.token()).unwrap()
}

/// A board, and a page that has heard that its port is open.
fn connected() -> (FakeBoard, Page) {
    let board = FakeBoard::new();
    let mut page = connect(&board.server);
    assert_eq!(page.port(), json!({ "port": "open" }));
    (board, page)
}

/// The answer to bytes that may be a request.
fn raw(server: &Server, request: &[u8]) -> String {
    let mut stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(TIMEOUT)).unwrap();
    stream.write_all(request).unwrap();
    stream.shutdown(Shutdown::Write).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8(answer).unwrap()
}

fn request(method: &str, target: &str, host: &str, more: &str) -> String {
    format!("{method} {target} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n")
}

fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).unwrap().parse().unwrap()
}

/// The status and the whole answer to a request for a page.
fn get(server: &Server, target: &str, host: &str, more: &str) -> (u16, String) {
    let answer = raw(server, request("GET", target, host, more).as_bytes());
    (status(&answer), answer)
}

#[test]
fn the_page_is_for_those_who_know_the_token_and_the_address() {
    let board = FakeBoard::new();
    let (server, token) = (&board.server, board.server.token());
    let own = server.address().to_string();
    let local = format!("localhost:{}", server.address().port());
    let with = format!("/?token={token}");
    let mut wrong = token.clone().into_bytes();
    wrong[31] ^= 1;
    let wrong = format!("/?token={}", String::from_utf8(wrong).unwrap());
    let longer = format!("{with}0");
    let own_origin = format!("Origin: http://{own}\r\n");
    for (target, host, more, wanted, part) in [
        (&*with, &*own, "", 200, TEXT),
        (&with, &local, &*own_origin, 200, TEXT),
        (&format!("/?scene=1&token={token}"), &own, "", 200, TEXT),
        ("/", &own, "", 403, "the token is missing or wrong"),
        (&wrong, &own, "", 403, "the token is missing or wrong"),
        (&longer, &own, "", 403, "the token is missing or wrong"),
        ("/?token=", &own, "", 403, "the token is missing or wrong"),
        (&with, "evil.example", "", 403, "the host is `evil.example`"),
        (&with, "127.0.0.1", "", 403, "the host is `127.0.0.1`"),
        (&with, &own, "Host: evil.example\r\n", 400, "host is there twice"),
        (
            &with,
            &own,
            "Origin: https://evil.example\r\n",
            403,
            "the origin is `https://evil.example`",
        ),
        ("/other", &own, "", 404, "there is no /other"),
        ("/favicon.ico", &own, "", 204, ""),
        (&format!("/wire?token={token}"), &own, &own_origin, 405, "allow: POST"),
    ] {
        let (status, answer) = get(server, target, host, more);
        assert_eq!(status, wanted, "{target} {host} {more}: {answer}");
        assert!(answer.contains(part), "{target} {host} {more}: {answer}");
        assert_eq!(answer.contains(TEXT), wanted == 200, "{target} {host} {more}: {answer}");
    }
    let (_, page) = get(server, &with, &own, "");
    for header in
        ["cache-control: no-store", "referrer-policy: no-referrer", "frame-ancestors 'none'"]
    {
        assert!(page.contains(header), "{page}");
    }
    assert_eq!(server.url(), format!("http://{own}{with}"));
}

#[test]
fn what_is_no_request_is_answered() {
    let board = FakeBoard::new();
    let long = format!("GET / HTTP/1.1\r\nX: {}\r\n", "x".repeat(100_000));
    for (request, status) in [
        (&b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[..], 400),
        (b"hello\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost", 400),
        (b"", 400),
        (b"GET / HTTP/1.1\r\n\r\n", 403),
        (b"POST / HTTP/1.1\r\nHost: x\r\n\r\n", 405),
        (long.as_bytes(), 431),
        (b"GET /\r\n\r\n", 400),
        (b"GET http://x/ HTTP/1.1\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nX: \xff\r\n\r\n", 400),
    ] {
        let answer = raw(&board.server, request);
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{answer}");
    }
    // The server goes on.
    connect(&board.server);
}

#[test]
fn the_wire_is_for_the_own_page_and_a_file_alone() {
    let board = FakeBoard::new();
    let (server, token) = (&board.server, board.server.token());
    let own = format!("http://{}", server.address());
    let other_port = format!("http://127.0.0.1:{}", server.address().port() ^ 1);
    for origin in [own.as_str(), "null"] {
        drop(ask(server, Some(origin), &token).unwrap());
    }
    let secure = own.replace("http", "https");
    for (origin, token) in [
        (Some(own.as_str()), "0123456789abcdef0123456789abcdef"),
        (Some("null"), ""),
        (Some("https://evil.example"), &token),
        (Some(&other_port), &token),
        (Some(&secure), &token),
        (None, &token),
    ] {
        let answer = ask(server, origin, token).err().map(|(status, _)| status);
        assert_eq!(answer, Some(403), "{origin:?} {token}");
    }
}

#[test]
fn bytes_are_unchanged_both_ways() {
    let (mut board, mut page) = connected();
    let mut random = fastrand::Rng::with_seed(5);
    for length in [1, 2, 255, 256, 4096] {
        let all: Vec<u8> =
            (0..length).map(|i| if length == 256 { i as u8 } else { random.u8(..) }).collect();
        assert_eq!(page.up.send(&all), 204);
        let mut read = vec![0; length];
        board.stream.read_exact(&mut read).unwrap();
        assert_eq!(read, all);
        board.stream.write_all(&all).unwrap();
        assert_eq!(page.bytes(length), all);
    }
}

#[test]
fn a_simulated_board_answers_a_page() {
    let (_, rig) = off(Pacing::RealTime);
    let server = serve(&rig.port().parse().unwrap());
    let mut page = connect(&server);
    let mut buffer = [0; 64];
    page.up.send(encode(&ToBoard::Hello, &mut buffer).unwrap());
    let mut decoder = Decoder::<{ LONGEST_TO_HOST + CHECKSUM }>::new();
    let said = loop {
        let message =
            page.bytes(1).into_iter().find_map(|byte| decoder.push::<ToHost<String>>(byte));
        if let Some(said) = message {
            break said;
        }
    };
    let program = "damper_wall".to_owned();
    assert_eq!(said, ToHost::Welcome { protocol: PROTOCOL, program });
}

#[test]
fn a_second_page_is_refused_and_the_first_goes_on() {
    let (mut board, mut first) = connected();
    let (status, refused) = ask(&board.server, Some("null"), &board.server.token()).err().unwrap();
    assert_eq!(status, 409);
    assert!(refused.contains("another page has the board"), "{refused}");
    board.stream.write_all(b"still").unwrap();
    assert_eq!(first.bytes(5), b"still");
    // A page that leaves makes room, and the port stays open.
    let left = first.up.clone();
    drop(first);
    let mut next = connect(&board.server);
    assert_eq!(next.port(), json!({ "port": "open" }));
    board.stream.write_all(b"next").unwrap();
    assert_eq!(next.bytes(4), b"next");
    // What the page that left sends is not for the board.
    assert_eq!(left.send(b"late"), 409);
    assert_eq!(next.up.send(b"own"), 204);
    let mut read = [0; 3];
    board.stream.read_exact(&mut read).unwrap();
    assert_eq!(&read, b"own");
}

#[test]
fn a_port_that_is_lost_is_said_and_opened_again() {
    let (mut board, mut page) = connected();
    drop(board.stream);
    let lost = page.port();
    assert_eq!(lost["port"], "lost");
    assert!(lost["why"].as_str().unwrap().contains("is lost"), "{lost}");
    board.stream = accept(&board.listener);
    // Earlier attempts may have failed, and each is reported.
    while page.port() != json!({ "port": "open" }) {}
    board.stream.write_all(b"back").unwrap();
    assert_eq!(page.bytes(4), b"back");
    // A page that comes while the port is away gets a message at once.
    drop((page, board.stream, board.listener));
    let start = Instant::now();
    while connect(&board.server).port()["port"] != "lost" {
        assert!(start.elapsed() < TIMEOUT);
    }
}

#[test]
fn a_page_that_does_not_read_does_not_stop_the_port() {
    let (mut board, mut slow) = connected();
    // More than all buffers of the system and of the server together.
    let chunk = vec![7; 1 << 20];
    for _ in 0..64 {
        board.stream.write_all(&chunk).unwrap();
    }
    // The port is free for the next page, which gets the next bytes; a page that comes while the rest of the
    // flood is still read may be too slow for it, too.
    loop {
        let mut next = connect(&board.server);
        board.stream.write_all(&[9]).unwrap();
        if std::iter::from_fn(|| next.some_bytes()).any(|bytes| bytes.last() == Some(&9)) {
            break;
        }
    }
    let end = slow.end();
    assert!(end.as_ref().is_none_or(|why| why.contains("has taken less")), "{end:?}");
}

#[test]
fn bytes_of_no_page_and_too_many_are_refused() {
    let (board, page) = connected();
    assert_eq!(page.up.send(&[0; 4096]), 204);
    // The server may close the connection before all of that is sent.
    assert!([413, 0].contains(&page.up.send(&[0; 1 << 20])));
    let own = format!("http://{}", board.server.address());
    let host = board.server.address().to_string();
    let bare = request("POST", &page.up.target, &host, &format!("Origin: {own}\r\n"));
    assert_eq!(status(&raw(&board.server, bare.as_bytes())), 411);
    let short = bare.replace("\r\n\r\n", "\r\nContent-Length: 9\r\n\r\nshort");
    assert_eq!(status(&raw(&board.server, short.as_bytes())), 400);
    let foreign = short.replace(&own, "https://evil.example");
    assert_eq!(status(&raw(&board.server, foreign.as_bytes())), 403);
    let target = page.up.target.split_once("&page").unwrap().0.to_owned() + "&page=0123";
    assert_eq!(Up { target, ..page.up.clone() }.send(b"x"), 409);
    // The page goes on.
    assert_eq!(page.up.send(b"x"), 204);
}

#[test]
fn a_server_that_ends_says_so() {
    let (mut board, mut page) = connected();
    let server = std::thread::spawn(move || drop(board.server));
    assert_eq!(page.end().unwrap(), "haptic serve was ended");
    drop(page);
    server.join().unwrap();
    // And the port is closed.
    let mut rest = Vec::new();
    match board.stream.read_to_end(&mut rest) {
        Ok(_) => {}
        Err(error) => assert_eq!(error.kind(), ErrorKind::ConnectionReset),
    }
}

#[test]
fn other_machines_are_not_served() {
    let listener = TcpListener::bind(loopback()).unwrap();
    let address = Address::Tcp(listener.local_addr().unwrap().to_string());
    for listen in ["0.0.0.0:0", "[::]:0", "192.0.2.1:80"] {
        let (port, listen) = (Port::open(&address).unwrap(), listen.parse().unwrap());
        let refused = Server::start(port, listen, TEXT.into(), Box::new(|_| {})).err().unwrap();
        assert!(
            matches!(refused, ServeError::NotLoopback { address } if address == listen),
            "{refused}"
        );
    }
}

/// A client that opens a connection and sends only a part of a request.
fn half_open(server: &Server) -> TcpStream {
    let mut stream = TcpStream::connect(server.address()).unwrap();
    stream.write_all(b"GET / HTTP/1.1\r\nHost").unwrap();
    stream
}

#[test]
fn clients_without_the_token_do_not_lock_the_page_out() {
    let (mut board, mut page) = connected();
    let (host, target) =
        (board.server.address().to_string(), format!("/?token={}", board.server.token()));
    // On a machine with other work one try may be slow.
    let was_quick = (0..10).any(|_| {
        let mut idle: Vec<TcpStream> = (0..40).map(|_| half_open(&board.server)).collect();
        let start = Instant::now();
        assert_eq!(get(&board.server, &target, &host, "").0, 200);
        let took = start.elapsed();
        // The oldest one had to go.
        idle[0].set_read_timeout(Some(TIMEOUT)).unwrap();
        assert!(matches!(idle[0].read(&mut [0]), Ok(0) | Err(_)));
        took < Duration::from_secs(1)
    });
    assert!(was_quick);
    // The same of clients that have an answer and do not close.
    let _refused: Vec<TcpStream> = (0..40)
        .map(|_| {
            let mut stream = TcpStream::connect(board.server.address()).unwrap();
            stream.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
            stream
        })
        .collect();
    assert_eq!(get(&board.server, &target, &host, "").0, 200);
    // A page that has sent the token keeps its place.
    board.stream.write_all(b"still").unwrap();
    assert_eq!(page.bytes(5), b"still");
}

/// Waits for the end of a server, on a slow machine.
fn assert_ends(server: Server) {
    let (sender, ended) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        drop(server);
        let _ = sender.send(());
    });
    assert!(ended.recv_timeout(TIMEOUT).is_ok(), "the server does not end");
}

#[test]
fn a_page_that_reads_slowly_does_not_keep_the_server_from_its_end() {
    let (mut board, slow) = connected();
    let chunk = vec![7; 1 << 20];
    for _ in 0..16 {
        board.stream.write_all(&chunk).unwrap();
    }
    let mut stream = slow.lines.into_inner();
    std::thread::spawn(move || {
        while matches!(stream.read(&mut [0; 4096]), Ok(1..)) {
            std::thread::sleep(Duration::from_millis(500));
        }
    });
    assert_ends(board.server);
}

#[test]
fn a_page_that_sends_without_pause_still_gets_the_bytes_of_the_board() {
    let (mut board, mut page) = connected();
    let up = page.up.clone();
    std::thread::spawn(move || while up.send(&[1; 4096]) == 204 {});
    // The board takes bytes at the rate of a slow line, and no buffer is ever empty.
    let mut slow = board.stream.try_clone().unwrap();
    std::thread::spawn(move || {
        while slow.read(&mut [0; 4096]).is_ok_and(|read| read > 0) {
            std::thread::sleep(Duration::from_millis(20));
        }
    });
    std::thread::sleep(Duration::from_millis(500));
    board.stream.write_all(b"answer").unwrap();
    assert_eq!(page.bytes(6), b"answer");
    assert_ends(board.server);
}
