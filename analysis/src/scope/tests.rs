use haptic_servo::certificate::Parameter;
use haptic_servo::dac::DacCode;
use haptic_servo::fault::Fault;
use haptic_servo::power_reading::PowerReading;
use haptic_servo::reset::ResetCause;
use haptic_servo::servo_loop::{Frame, State};
use haptic_servo::torque::LimitReason;
use haptic_servo::wire::Discarded;
use haptic_servo::wire::message::{ActiveParameters, BoardUnits, PreviousFault, Status, Values};

use super::history::History;
use super::sample::{Sample, Scale};
use super::{Scope, tui};
use crate::link::{Connected, Event};

const BOARD: BoardUnits = BoardUnits {
    period: 0.001,
    timer_counts: 1000,
    counts_per_turn: 1000.0,
    full_scale_torque: 2.0,
    energy_step: 1e-6,
    longest_gap: 0.036,
};

const STATUS: Status = Status {
    state: State::Running,
    fault: None,
    link_lost: false,
    tick: 5000,
    count: 0,
    sets: 3,
    missed: 2,
    worst_slack: 810,
    energy: -5000,
    worst_deficit: 7000,
    dropped: 4,
    thinned: 6,
    discarded: Discarded { broken: 1, too_long: 2, checksum: 3, unknown: 2 },
    stack_left: None,
    reset: ResetCause::PowerOn,
    low_brown_out: false,
    power: None,
};

fn frame(tick: u32, count: i32, limit: LimitReason) -> Frame {
    let code = DacCode::new(2048).unwrap();
    Frame { tick, count, code, limit, state: State::Running, slack: 900 }
}

fn take(scope: &mut Scope, event: Event) {
    scope.take(event, |_| Ok::<(), std::convert::Infallible>(())).unwrap();
}

fn connected() -> Scope {
    let mut scope = Scope::new("COM3".to_owned(), 5.0);
    let fault = Fault::EncoderJump { counts: 900, largest: 100 }.into();
    let previous_fault = Some(PreviousFault { fault, tick: 77, count: 0 });
    let program = "damper_wall".to_owned();
    let budget = None;
    let connected = Connected { program, units: BOARD, previous_fault, budget };
    take(&mut scope, Event::Connected(connected));
    let values = Values::from_slice(&[(Parameter::Stiffness, 22.0)]).unwrap();
    take(
        &mut scope,
        Event::ActiveParameters(ActiveParameters { sets: 3, margin: Some(0.0015), values }),
    );
    take(&mut scope, Event::Status(STATUS, Discarded::default()));
    let limit = |i| if i % 4 == 0 { LimitReason::Torque } else { LimitReason::None };
    take(&mut scope, Event::Ticks((0..12).map(|i| frame(i, 250, limit(i))).collect()));
    scope
}

/// The content of a terminal of that size, line by line.
fn screen(scope: &Scope, width: usize, height: usize) -> String {
    tui::draw(scope, (width, height)).to_string()
}

#[test]
fn shows_everything_that_is_to_be_watched() {
    let shown = screen(&connected(), 120, 40);
    for part in [
        "damper_wall on COM3",
        "running",
        "before the last reset, in tick 77: the encoder jumped by 900 counts",
        "position, rad: 1.5708",
        "torque, N m: 0",
        "stiffness=22",
        "margin 0.0015 N m s/rad",
        "slack 90.0 %, worst 81.0 %",
        "missed 2",
        "energy into the hand -0.005 J, at most 0.007 J",
        "limited by torque 25 %",
        "ticks dropped 4, thinned 6   bad frames: board 8, host 0",
        "q quits   t tunes   A arms   d disarms",
    ] {
        assert!(shown.contains(part), "{part:?} is not in\n{shown}");
    }
}

#[test]
fn shows_what_a_power_stage_measures() {
    const LINE: &str = "current -0.412 A of -0.400 A asked, supply 24.1 V, 31.5 C";
    let mut scope = connected();
    assert!(!screen(&scope, 120, 40).contains("asked"));
    let power = Some(PowerReading {
        current: -412,
        reference: -400,
        voltage: 24_070,
        temperature: 315,
        index: None,
    });
    take(&mut scope, Event::Status(Status { power, ..STATUS }, Discarded::default()));
    let shown = screen(&scope, 120, 40);
    let lines: Vec<_> = shown.lines().map(str::trim_end).collect();
    let at = lines.iter().position(|line| *line == LINE);
    let at = at.unwrap_or_else(|| panic!("{LINE:?} is not a line of\n{shown}"));
    // Between the facts of every board, of which none gives way.
    assert!(lines[at - 1].starts_with("energy into the hand"), "{shown}");
    assert!(lines[at + 1].starts_with("ticks dropped"), "{shown}");
    assert!(shown.contains("q quits"), "{shown}");
}

#[test]
fn a_narrow_terminal_cuts_the_port_and_not_the_state() {
    let port = "unix:/tmp/some/folder/of/another/board".to_owned();
    let scope = Scope { address: port, ..connected() };
    let shown = screen(&scope, 40, 24);
    let first = shown.lines().next().unwrap();
    assert!(first.contains("damper_wall on unix:") && first.contains("...   running"), "{shown}");
}

#[test]
fn shows_the_worst_trouble() {
    let mut scope = connected();
    let fault = Some(Fault::MissedTick { missed: 3, tolerated: 1 }.into());
    let stopped = Status { state: State::Faulted, fault, ..STATUS };
    take(&mut scope, Event::Status(stopped, Discarded::default()));
    let shown = screen(&scope, 120, 40);
    assert!(shown.contains("faulted") && shown.contains("3 update(s) in a row were missed"));
    take(&mut scope, Event::Lost("the link to COM3 is lost: gone".to_owned()));
    let shown = screen(&scope, 120, 40);
    assert!(shown.contains("the link to COM3 is lost: gone; connecting again"), "{shown}");
}

#[test]
fn shows_the_line_that_is_typed_and_all_of_the_answer() {
    let mut scope = connected();
    scope.control.prompt = Some("stiffness = 2".to_owned());
    let sentence = "rejected: the environment needs alpha = 0.5 N m s/rad of damping, not below the \
                    delta = 0.022 N m s/rad that the device has; it would pass with stiffness <= 16";
    scope.control.message = Some(sentence.to_owned());
    let shown = screen(&scope, 60, 40);
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words(&shown).contains(&words(sentence)), "{shown}");
    assert!(shown.contains("tune: stiffness = 2_") && shown.contains("Enter sends"), "{shown}");
}

#[test]
fn colours_can_be_left_out() {
    let canvas = tui::draw(&connected(), (80, 24));
    // Bold and dim stay.
    let rows = |has_colour| canvas.rows(has_colour).collect::<String>();
    assert!(rows(true).contains("\x1b[3"));
    assert!(!rows(false).contains("\x1b[3") && rows(false).contains("\x1b[1m"));
}

#[test]
fn fits_any_terminal_and_needs_no_board() {
    let mut full = connected();
    full.control.message = Some("a long answer ".repeat(50));
    full.control.prompt = Some("stiffness".repeat(5));
    for width in [0, 1, 2, 3, 10, 13, 14, 40, 300] {
        for height in 0..30 {
            let empty = Scope::new("COM3".to_owned(), 5.0);
            for scope in [&empty, &connected(), &full] {
                screen(scope, width, height);
            }
        }
    }
    // In few rows, the state and the keys stay.
    let shown = screen(&connected(), 30, 3);
    let rows: Vec<_> = shown.lines().collect();
    assert!(rows[0].contains("running") && rows[2].contains("q quits"), "{shown}");
}

fn sample(tick: u64, torque: f64) -> Sample {
    Sample {
        tick,
        time: tick as f64 * 0.001,
        count: 0,
        position: 0.0,
        code: 2048,
        torque,
        state: State::Running,
        limit: LimitReason::None,
        slack: 0.0,
    }
}

#[test]
fn a_curve_keeps_every_peak_and_forgets_what_is_old() {
    let mut history = History::new(2.0);
    for tick in 0..5000 {
        let torque = match tick {
            1000 => 9.0,
            4001 => 3.0,
            4500 => -2.0,
            _ => 0.0,
        };
        history.push(sample(tick, torque));
    }
    let curve = history.curve(10, |sample| sample.torque);
    assert!(curve.len() <= 22, "{}", curve.len());
    let peak = |wanted| curve.iter().find(|(_, torque)| *torque == wanted).map(|(time, _)| *time);
    assert_eq!(peak(9.0), None);
    assert!((peak(3.0).unwrap() + 0.998).abs() < 1e-9);
    assert!((peak(-2.0).unwrap() + 0.499).abs() < 1e-9);
    assert_eq!(history.range(|sample| sample.torque), Some((-2.0, 3.0)));
    // A board that was started again counts from zero.
    history.push(sample(1, 1.0));
    assert_eq!(history.range(|sample| sample.torque), Some((1.0, 1.0)));
}

/// The rows of a record equal those of a CSV library, byte for byte.
#[test]
fn rows_are_those_of_the_library_for_csv() {
    let (timer_counts, counts_per_turn, full_scale_torque) = (170_000, 4000.0, 1.791);
    let mut scale =
        Scale::new(BoardUnits { timer_counts, counts_per_turn, full_scale_torque, ..BOARD });
    let mut library = csv::Writer::from_writer(Vec::new());
    let mut rows = String::new();
    for (i, code) in [0, 2047, 2048, 2049, 4095].into_iter().enumerate() {
        let (tick, count, slack) = (3 * i as u32, 1 - i as i32, 7 * i as u32);
        let code = DacCode::new(code).unwrap();
        let frame = Frame { code, slack, ..frame(tick, count, LimitReason::Torque) };
        let sample = scale.sample(&frame);
        let Sample { tick, time, count, position, code, torque, state, limit, slack } = sample;
        let words = (state.as_str(), limit.as_str());
        library.serialize((tick, time, count, position, code, torque, words, slack)).unwrap();
        rows += &format!("{sample}\n");
    }
    assert_eq!(rows, String::from_utf8(library.into_inner().unwrap()).unwrap());
}
