//! `haptic serve` and its clients: raw requests, sockets, and a board that comes and goes.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use analysis::board_sim::Pacing;
use analysis::link::Address;
use analysis::serve::{Port, ServeError, Server};
use haptic_servo::wire::message::{LONGEST_TO_HOST, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder, PROTOCOL, encode};
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::protocol::CloseFrame;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Error, Message, WebSocket};

use crate::wire::off;

type Socket = WebSocket<MaybeTlsStream<TcpStream>>;

const PAGE: &str = "<!DOCTYPE html><title>the page</title>";
/// Timeout of all operations, on a slow machine.
const TIMEOUT: Duration = Duration::from_secs(60);
/// Close code of a second page.
const IN_USE: u16 = 4000;
/// Close code of a page that does not read.
const TOO_SLOW: u16 = 4001;

fn loopback() -> SocketAddr {
    "127.0.0.1:0".parse().unwrap()
}

fn serve(port: &Address) -> Server {
    Server::start(Port::open(port).unwrap(), loopback(), PAGE.into(), Box::new(|_| {})).unwrap()
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

/// Asks for the wire with an origin and a token.
fn ask(server: &Server, origin: Option<&str>, token: &str) -> Result<Socket, tungstenite::Error> {
    let url = format!("ws://{}/wire?token={token}", server.address());
    let mut request = url.into_client_request().unwrap();
    if let Some(origin) = origin {
        request.headers_mut().insert("Origin", origin.parse().unwrap());
    }
    let (socket, _) = tungstenite::connect(request)?;
    let MaybeTlsStream::Plain(stream) = socket.get_ref() else { unreachable!() };
    stream.set_read_timeout(Some(TIMEOUT)).unwrap();
    Ok(socket)
}

fn connect(server: &Server) -> Socket {
    ask(server, Some("null"), &server.token()).unwrap()
}

/// A board, and a page that has heard that its port is open.
fn connected() -> (FakeBoard, Socket) {
    let board = FakeBoard::new();
    let mut socket = connect(&board.server);
    assert_eq!(text(&mut socket), json!({ "port": "open" }));
    (board, socket)
}

/// The next text, as JSON.
fn text(socket: &mut Socket) -> Value {
    loop {
        match socket.read().unwrap() {
            Message::Text(text) => return serde_json::from_str(&text).unwrap(),
            Message::Binary(_) => {}
            other => panic!("{other:?}"),
        }
    }
}

/// This many bytes of the board.
fn bytes(socket: &mut Socket, count: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    while bytes.len() < count {
        if let Message::Binary(more) = socket.read().unwrap() {
            bytes.extend_from_slice(&more);
        }
    }
    bytes
}

/// Why the server closes.
fn close(socket: &mut Socket) -> CloseFrame {
    loop {
        if let Message::Close(frame) = socket.read().unwrap() {
            return frame.unwrap();
        }
    }
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

/// The status and the whole answer to a request for a page.
fn get(server: &Server, target: &str, host: &str, more: &str) -> (u16, String) {
    let answer =
        raw(server, format!("GET {target} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n").as_bytes());
    (answer.split(' ').nth(1).unwrap().parse().unwrap(), answer)
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
        (&*with, &*own, "", 200, PAGE),
        (&with, &local, &*own_origin, 200, PAGE),
        (&format!("/?scene=1&token={token}"), &own, "", 200, PAGE),
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
        (&format!("/wire?token={token}"), &own, &own_origin, 426, "is a WebSocket"),
    ] {
        let (status, answer) = get(server, target, host, more);
        assert_eq!(status, wanted, "{target} {host} {more}: {answer}");
        assert!(answer.contains(part), "{target} {host} {more}: {answer}");
        assert_eq!(answer.contains(PAGE), wanted == 200, "{target} {host} {more}: {answer}");
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
    let many = format!("GET / HTTP/1.1\r\n{}\r\n", "X: x\r\n".repeat(500));
    for (request, status) in [
        (&b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[..], 400),
        (b"hello\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost", 400),
        (b"", 400),
        (b"GET / HTTP/1.1\r\n\r\n", 403),
        (b"POST / HTTP/1.1\r\nHost: x\r\n\r\n", 405),
        (long.as_bytes(), 431),
        (many.as_bytes(), 431),
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
        ask(server, Some(origin), &token).unwrap().close(None).unwrap();
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
        match ask(server, origin, token) {
            Err(tungstenite::Error::Http(answer)) => assert_eq!(answer.status(), 403, "{origin:?}"),
            other => panic!("{origin:?} {token}: {:?}", other.err()),
        }
    }
}

#[test]
fn bytes_are_unchanged_both_ways() {
    let (mut board, mut socket) = connected();
    let mut random = fastrand::Rng::with_seed(5);
    for length in [1, 2, 255, 256, 4096] {
        let all: Vec<u8> =
            (0..length).map(|i| if length == 256 { i as u8 } else { random.u8(..) }).collect();
        socket.send(Message::binary(all.clone())).unwrap();
        let mut read = vec![0; length];
        board.stream.read_exact(&mut read).unwrap();
        assert_eq!(read, all);
        board.stream.write_all(&all).unwrap();
        assert_eq!(bytes(&mut socket, length), all);
    }
}

#[test]
fn a_simulated_board_answers_through_the_socket() {
    let (_, rig) = off(Pacing::RealTime);
    let server = serve(&rig.port().parse().unwrap());
    let mut socket = connect(&server);
    let mut buffer = [0; 64];
    let hello = encode(&ToBoard::Hello, &mut buffer).unwrap().to_vec();
    socket.send(Message::binary(hello)).unwrap();
    let mut decoder = Decoder::<{ LONGEST_TO_HOST + CHECKSUM }>::new();
    let said = loop {
        let message =
            bytes(&mut socket, 1).into_iter().find_map(|byte| decoder.push::<ToHost<String>>(byte));
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
    let refused = close(&mut connect(&board.server));
    assert_eq!(u16::from(refused.code), IN_USE);
    assert!(refused.reason.contains("another page has the board"), "{refused:?}");
    board.stream.write_all(b"still").unwrap();
    assert_eq!(bytes(&mut first, 5), b"still");
    // A page that leaves makes room, and the port stays open.
    first.close(None).unwrap();
    drop(first);
    let mut next = connect(&board.server);
    assert_eq!(text(&mut next), json!({ "port": "open" }));
    board.stream.write_all(b"next").unwrap();
    assert_eq!(bytes(&mut next, 4), b"next");
}

#[test]
fn a_port_that_is_lost_is_said_and_opened_again() {
    let (mut board, mut socket) = connected();
    drop(board.stream);
    let lost = text(&mut socket);
    assert_eq!(lost["port"], "lost");
    assert!(lost["why"].as_str().unwrap().contains("is lost"), "{lost}");
    board.stream = accept(&board.listener);
    // Earlier attempts may have failed, and each is reported.
    while text(&mut socket) != json!({ "port": "open" }) {}
    board.stream.write_all(b"back").unwrap();
    assert_eq!(bytes(&mut socket, 4), b"back");
    // A page that comes while the port is away gets a message at once.
    socket.close(None).unwrap();
    drop((socket, board.stream, board.listener));
    let start = Instant::now();
    loop {
        let mut socket = connect(&board.server);
        if text(&mut socket)["port"] == "lost" {
            break;
        }
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
    let gets_nine = |socket: &mut Socket| loop {
        match socket.read() {
            Ok(Message::Binary(bytes)) if bytes.last() == Some(&9) => return true,
            Ok(Message::Close(_)) | Err(_) => return false,
            Ok(_) => {}
        }
    };
    loop {
        let mut next = connect(&board.server);
        board.stream.write_all(&[9]).unwrap();
        if gets_nine(&mut next) {
            break;
        }
    }
    let end = loop {
        match slow.read() {
            Ok(Message::Close(frame)) => break frame.map(|frame| u16::from(frame.code)),
            Ok(_) => {}
            // Its message was cut off in the middle.
            Err(_) => break None,
        }
    };
    assert!(end.is_none_or(|code| code == TOO_SLOW), "{end:?}");
}

#[test]
fn a_page_that_says_text_or_too_much_at_once_is_sent_away() {
    let board = FakeBoard::new();
    let mut socket = connect(&board.server);
    socket.send(Message::text("hello")).unwrap();
    assert!(close(&mut socket).reason.contains("binary messages"));
    drop(socket);
    let mut socket = connect(&board.server);
    text(&mut socket);
    // The server may close the socket before all of that is sent.
    let sent = socket.send(Message::binary(vec![0; 1 << 20]));
    let hung_up = [ErrorKind::BrokenPipe, ErrorKind::ConnectionReset];
    let is_sent_away = matches!(&sent, Err(Error::Io(error)) if hung_up.contains(&error.kind()));
    assert!(sent.is_ok() || is_sent_away, "{sent:?}");
    while socket.read().is_ok() {}
    drop(socket);
    connect(&board.server);
}

#[test]
fn a_server_that_ends_says_so() {
    let (mut board, mut socket) = connected();
    let server = std::thread::spawn(move || drop(board.server));
    assert!(close(&mut socket).reason.contains("haptic serve was ended"));
    drop(socket);
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
        let refused = Server::start(port, listen, PAGE.into(), Box::new(|_| {})).err().unwrap();
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
    let (mut board, mut socket) = connected();
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
    assert_eq!(bytes(&mut socket, 5), b"still");
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
    let MaybeTlsStream::Plain(stream) = slow.get_ref() else { unreachable!() };
    let mut stream = stream.try_clone().unwrap();
    std::thread::spawn(move || {
        while matches!(stream.read(&mut [0; 4096]), Ok(1..)) {
            std::thread::sleep(Duration::from_millis(500));
        }
    });
    assert_ends(board.server);
}

#[test]
fn a_page_that_sends_without_pause_still_gets_the_bytes_of_the_board() {
    let (mut board, mut socket) = connected();
    let MaybeTlsStream::Plain(stream) = socket.get_ref() else { unreachable!() };
    let sending = stream.try_clone().unwrap();
    std::thread::spawn(move || {
        let role = tungstenite::protocol::Role::Client;
        let mut socket = WebSocket::from_raw_socket(sending, role, None);
        while socket.send(Message::binary(vec![1; 4096])).is_ok() {}
    });
    // The board takes bytes at the rate of a slow line, and no buffer is ever empty.
    let mut slow = board.stream.try_clone().unwrap();
    std::thread::spawn(move || {
        while slow.read(&mut [0; 4096]).is_ok_and(|read| read > 0) {
            std::thread::sleep(Duration::from_millis(20));
        }
    });
    std::thread::sleep(Duration::from_millis(500));
    board.stream.write_all(b"answer").unwrap();
    assert_eq!(bytes(&mut socket, 6), b"answer");
    assert_ends(board.server);
}
