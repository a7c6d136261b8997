//! The page of `haptic serve` in a browser, with a simulated and a virtual board behind it: watched, tuned,
//! armed, refused, lost and back.

use std::net::TcpListener;
use std::path::Path;

use analysis::board_sim::{Pacing, SimulatedBoard};
use analysis::link::Address;
use analysis::lockstep::PlantIo;
use analysis::program::{Program, damper_wall};
use analysis::serve::{Port, Server};
use haptic_servo::environment::Wall;
use haptic_servo::number::Format;
use haptic_servo::scene::Scene;
use serde_json::Value;

use crate::common::board::{BoardProcess, Running};
use crate::common::{WALL, read};
use crate::devtools::{Page, saved};
use crate::explore::explore;

/// Counts inside of the wall.
const INSIDE: i32 = 300;

/// A device that is held still; or torn away, once the file is there: further than any hand can.
struct Held(std::path::PathBuf);

impl PlantIo for Held {
    fn count(&mut self) -> Option<i32> {
        Some(if self.0.exists() { INSIDE + 20_000 } else { INSIDE })
    }

    fn hold(&mut self, _: u16) {}
}

/// The damper wall on a simulated board.
pub fn board(folder: &Path) -> SimulatedBoard {
    let address = Address::Unix(folder.join("board"));
    let wall = Program::find("damper_wall").unwrap();
    let device = Box::new(Held(folder.join("torn away")));
    wall.listen(device, &address, Pacing::RealTime).unwrap()
}

/// Opens the page of a server, and connects.
fn connected(address: &str) -> Page {
    let mut page = Page::start(1280);
    page.open(address);
    assert_eq!(page.value("document.getElementById('board-address').value"), address);
    page.click("#board-socket button");
    page.wait_for(&format!("{BOARD}.dataset.link === 'on'"));
    page
}

/// The part of the page.
const BOARD: &str = "document.getElementById('board')";

fn text(page: &mut Page, id: &str) -> String {
    let text = page.value(&format!("document.getElementById('board-{id}').textContent"));
    text.as_str().unwrap().to_owned()
}

fn wait_for_text(page: &mut Page, id: &str, part: &str) {
    page.wait_for(&format!("document.getElementById('board-{id}').textContent.includes({part:?})"));
}

fn wait_for_state(page: &mut Page, state: &str) {
    page.wait_for(&format!("{BOARD}.dataset.state === {state:?}"));
}

/// Types a number as a person does.
fn type_number(page: &mut Page, name: &str, value: &str) {
    page.value(&format!(
        "(() => {{ const field = document.getElementById('board-number-{name}'); field.value = {value:?}; \
         field.dispatchEvent(new Event('input', {{ bubbles: true }})); }})()"
    ));
}

/// Arms by both buttons.
fn arm(page: &mut Page) {
    page.click("#board-arm");
    page.wait_for("!document.getElementById('board-explained').hidden");
    assert!(text(page, "explanation").contains("Hold the handle"));
    page.click("#board-go");
    wait_for_state(page, "armed");
}

pub fn a_board_is_watched_tuned_armed_and_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let board = board(folder.path());
    let port = board.address().to_string();
    let (_server, address) = Running::start(&["serve", "--port", &port]);
    let mut page = connected(&address);
    assert!(text(&mut page, "state").starts_with("damper_wall: "), "{}", text(&mut page, "state"));

    // The page has opened the board's scene.
    page.wait_for("JSON.parse(window.haptic.scene()).name === 'damper_wall'");

    // Refused before it is sent, in the words of the certificate.
    let environment = Wall::damped(30.0, 0.01, 1).behind(0.0).alone();
    let wall = Scene { environment, ..damper_wall::SCENE };
    let rejection = wall.certify_in(Format::F32).unwrap_err();
    type_number(&mut page, "stiffness", "30");
    let judged = text(&mut page, "judged");
    assert!(judged.starts_with(rejection.reason_in(Format::F64).as_str()), "{judged}");
    assert!(judged.contains("; it would pass with stiffness <= "), "{judged}");
    assert_eq!(page.value("document.getElementById('board-apply').disabled"), true);
    type_number(&mut page, "stiffness", "soft");
    assert!(text(&mut page, "judged").contains("`soft` is not a finite number"));
    type_number(&mut page, "stiffness", "12.5");
    assert_eq!(text(&mut page, "judged"), "");
    page.click("#board-apply");
    wait_for_text(&mut page, "reply", "stiffness=12.5: done");
    wait_for_text(&mut page, "numbers", "runs: 12.5 N m/rad");

    // One press arms nothing.
    page.click("#board-arm");
    page.click("#board-cancel");
    assert_eq!(page.value(&format!("{BOARD}.dataset.state")), "off");
    page.click("#board-record");
    arm(&mut page);
    // As many as have come while it was being armed, and some of the running servo.
    let ticks = "parseInt(document.getElementById('board-recorded').textContent)";
    let before = page.value(ticks).as_f64().unwrap();
    page.wait_for(&format!("{ticks} > {before} + 300"));
    page.click("#board-record");
    page.key("Escape");
    wait_for_state(&mut page, "off");
    wait_for_text(&mut page, "reply", "disarm: done");
    arm(&mut page);
    page.click("#board-disarm");
    wait_for_state(&mut page, "off");

    // The file has a row for each tick, and the head of `haptic scope --csv`.
    page.save_into(folder.path());
    let recorded = text(&mut page, "recorded");
    page.click("#board-save");
    let table = String::from_utf8(saved(&folder.path().join("damper_wall.csv"))).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("tick,time,count,position,code,torque,state,limit,slack"));
    assert_eq!(recorded, format!("{} ticks", lines.count()));
    assert!(table.contains(",running,"), "{}", &table[..300]);

    // A fault, in the words of the program. A tick later the device is where it was.
    arm(&mut page);
    std::fs::write(folder.path().join("torn away"), "").unwrap();
    wait_for_state(&mut page, "fault");
    assert!(
        text(&mut page, "fault").contains("the encoder jumped by"),
        "{}",
        text(&mut page, "fault")
    );
    page.assert_silent();
}

pub fn a_link_is_lost_and_back_and_a_second_page_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = explore(folder.path(), WALL);
    let first = board(folder.path());
    let port = Port::open(first.address()).unwrap();
    let any = "127.0.0.1:0".parse().unwrap();
    let server = Server::start(port, any, read(&file), Box::new(|_| {})).unwrap();
    let mut page = connected(&server.url());

    // A page from a file is refused, too; the first page goes on.
    let mut second = Page::start(400);
    second.open_file(&file);
    let connect = |page: &mut Page, address: &str| {
        page.value(&format!("document.getElementById('board-address').value = {address:?}; 0"));
        page.click("#board-socket button");
    };
    connect(&mut second, &server.url());
    wait_for_text(&mut second, "link", "another page has the board");
    assert_eq!(second.value(&format!("{BOARD}.dataset.link")), "off");
    let mut wrong = server.url();
    wrong.pop();
    connect(&mut second, &wrong);
    wait_for_text(&mut second, "link", "does not know this token");
    connect(&mut second, "COM3");
    wait_for_text(&mut second, "link", "`COM3` is not an address");
    page.value("1");
    assert_eq!(page.value(&format!("{BOARD}.dataset.link")), "on");

    // The board goes, and comes back as after power-on.
    arm(&mut page);
    first.end().unwrap();
    page.wait_for(&format!("{BOARD}.dataset.link === 'lost'"));
    assert!(text(&mut page, "link").contains("connecting again"), "{}", text(&mut page, "link"));
    assert_eq!(page.value("document.getElementById('board-arm').disabled"), true);
    let again = board(folder.path());
    page.wait_for(&format!("{BOARD}.dataset.link === 'on'"));
    wait_for_state(&mut page, "off");

    // A page that leaves makes room.
    page.click("#board-disconnect");
    connect(&mut second, &server.url());
    second.wait_for(&format!("{BOARD}.dataset.link === 'on'"));
    page.assert_silent();
    drop(again);
}

/// The wire is asked for by the script of another site: that is a page of another server of this machine.
pub fn a_foreign_page_does_not_reach_the_board() {
    let folder = tempfile::tempdir().unwrap();
    let board = board(folder.path());
    let any = "127.0.0.1:0".parse().unwrap();
    // The board of the other server never answers.
    let foreign = TcpListener::bind("127.0.0.1:0").unwrap();
    let served = Port::open(board.address()).unwrap();
    let page =
        "<!DOCTYPE html><html data-verdict=''><link rel=icon href='data:,'><title>x</title></html>";
    let server = Server::start(served, any, page.into(), Box::new(|_| {})).unwrap();
    let port = Port::open(&Address::Tcp(foreign.local_addr().unwrap().to_string())).unwrap();
    let other = Server::start(port, any, page.into(), Box::new(|_| {})).unwrap();
    let outcome = |page: &mut Page| -> Value {
        page.value(&format!(
            "fetch('http://{}/wire?token={}', {{ method: 'POST' }}) \
             .then(({{ ok }}) => ok ? 'open' : 'refused', () => 'refused')",
            server.address(),
            server.token()
        ))
    };
    let mut page = Page::start(800);
    page.open(&other.url());
    assert_eq!(outcome(&mut page), "refused");
    page.open(&server.url());
    assert_eq!(outcome(&mut page), "open");
}

/// The flashed program gives the same answers.
pub fn a_virtual_board_is_watched_and_armed() {
    let board = BoardProcess::start("damper_wall", &["--board", "nucleo-g474re"]);
    let (_server, address) = Running::start(&["serve", "--port", &board.port]);
    let mut page = connected(&address);
    arm(&mut page);
    type_number(&mut page, "stiffness", "12.5");
    page.click("#board-apply");
    wait_for_text(&mut page, "reply", "stiffness=12.5: done");
    page.key("Escape");
    wait_for_state(&mut page, "off");
    page.assert_silent();
}
