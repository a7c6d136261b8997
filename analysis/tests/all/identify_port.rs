//! `haptic identify --port`: a board that plays a sweep is a thread behind a socket, which sends the same
//! lines as the program on a board, around a simulated device.

use std::io::{Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::process::Output;
use std::thread;
use std::time::Duration;

use analysis::identify::rig::{MeasuredDevice, Sensing};
use analysis::program::damper_wall;
use analysis::program::identify::{GUARD, LIMITS, PERIOD, SWEEP, TRANSDUCERS};
use analysis::simulation::plant::Plant;
use haptic_servo::dac::DacCode;
use haptic_servo::excitation::{Exciter, SWEEP_PROTOCOL, SweepEnd};
use haptic_servo::wire::sweep::{SweepReceiver, SweepRequest};
use serde_json::Value;
use tempfile::TempDir;

use crate::common::{answer, haptic};

/// The fault of a board, if it has one.
#[derive(Clone, Copy, Default)]
struct Board {
    /// Torque in N m that its amplifier cannot exceed.
    clips_at: Option<f64>,
    /// Where the sweep ends, and why.
    ends: Option<(u64, SweepEnd)>,
    /// Where it falls silent permanently.
    dies_at: Option<u64>,
    /// Rows that it sends after the last one.
    more: usize,
    /// Text that it sends in place of the description.
    says: Option<&'static str>,
}

impl Board {
    /// Serves the only host that comes.
    fn serve(self, listener: &UnixListener) {
        let (mut host, _) = listener.accept().unwrap();
        let (mut bytes, mut receiver) = ([0; 1], SweepReceiver::new());
        while matches!(host.read(&mut bytes), Ok(1)) {
            let said = match (receiver.push(bytes[0]), self.says) {
                (Some(SweepRequest::Describe), None) => {
                    host.write_all(self.description().as_bytes())
                }
                (Some(SweepRequest::Describe), Some(words)) => host.write_all(words.as_bytes()),
                (Some(SweepRequest::Begin { .. }), _) => self.play(&mut host),
                _ => Ok(()),
            };
            if said.is_err() {
                return;
            }
        }
    }

    fn description(&self) -> String {
        let (counts, ticks) = (TRANSDUCERS.counts_per_turn, SWEEP.ticks());
        let (travel, speed) = (LIMITS.travel, LIMITS.speed);
        // A row of a sweep before, cut in two, is on the line still.
        format!("3,\nidentify,{SWEEP_PROTOCOL},{PERIOD},{counts},{ticks},{travel},{speed}\n")
    }

    fn play(&self, host: &mut UnixStream) -> std::io::Result<()> {
        let ideal = Sensing::ideal(PERIOD, TRANSDUCERS.counts_per_turn);
        let sensing = Sensing { torque_noise: 0.002, ..ideal };
        let plant = Plant::rigid(damper_wall::SCENE.device);
        let mut device = MeasuredDevice::new(&plant, &sensing).unwrap();
        let mut exciter = Exciter::new(&SWEEP);
        let step = TRANSDUCERS.full_scale_torque / f64::from(DacCode::CODES_TO_FULL_SCALE);
        let mut text = "time,torque,counts\n".to_owned();
        let (mut end, mut last) = (SweepEnd::Done, 0);
        for tick in 0..SWEEP.ticks() {
            if self.dies_at == Some(tick) {
                host.write_all(text.as_bytes())?;
                thread::sleep(Duration::from_secs(4));
                return Err(std::io::ErrorKind::BrokenPipe.into());
            }
            if let Some((at, why)) = self.ends
                && at == tick
            {
                end = why;
                break;
            }
            let torque = f64::from(exciter.next().code.offset()) * step;
            let most = self.clips_at.unwrap_or(f64::INFINITY);
            let count = device.count();
            // The program's tones keep the device that they are made for within its limits.
            assert_eq!(GUARD.check(count, count - last), None, "tick {tick}");
            last = count;
            text += &format!("{},{torque},{count}\n", tick as f64 * PERIOD);
            device.hold(torque.clamp(-most, most));
            if text.len() > 4000 {
                host.write_all(text.as_bytes())?;
                text.clear();
            }
        }
        text += &"1,0,0\n".repeat(self.more);
        text += &format!("end,{},0\n", end.as_str());
        host.write_all(text.as_bytes())
    }

    /// Runs `haptic identify --port` on it; returns its output, and its record.
    fn identify(self, arguments: &[&str]) -> (Output, Option<String>) {
        let folder = TempDir::new().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        let (socket, record) = (path("board"), path("record.csv"));
        let listener = UnixListener::bind(&socket).unwrap();
        let board = thread::spawn(move || self.serve(&listener));
        let port = format!("unix:{socket}");
        let all = [&["identify", "--port", &port, "--record", &record], arguments].concat();
        let output = haptic(&all);
        board.join().unwrap();
        (output, std::fs::read_to_string(record).ok())
    }

    /// The sentence with which that ends, and the record.
    fn complaint(self) -> (String, Option<String>) {
        let (output, record) = self.identify(&[]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        (String::from_utf8(output.stderr).unwrap(), record)
    }
}

#[test]
fn a_board_is_begun_recorded_and_identified() {
    let (output, record) = Board::default().identify(&["--json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let found: Value = answer(&output);
    let near = |path: &str, wanted: f64| {
        let value = found.pointer(path).and_then(Value::as_f64).unwrap();
        assert!((value / wanted - 1.0).abs() < 0.02, "{path} {value}");
    };
    near("/damping/value", 0.022);
    near("/inertia/value", 2.2e-5);
    assert_eq!(found["responses"].as_array().unwrap().len(), 20);
    assert_eq!(record.unwrap().lines().count() as u64, 1 + SWEEP.ticks());
}

#[test]
fn every_end_before_the_last_is_named_and_what_there_is_is_kept() {
    for end in SweepEnd::ALL.into_iter().filter(|end| *end != SweepEnd::Done) {
        let (sentence, record) = Board { ends: Some((700, end)), ..Board::default() }.complaint();
        let begins = format!("the sweep ended with `{}` after 700 of 58000 rows: ", end.as_str());
        assert!(sentence.contains(&begins), "{sentence}");
        let limit = match end {
            SweepEnd::Travel => Some(format!("by more than {} rad", LIMITS.travel)),
            SweepEnd::Speed => Some(format!("faster than {} rad/s", LIMITS.speed)),
            _ => None,
        };
        assert!(limit.is_none_or(|limit| sentence.contains(&limit)), "{sentence}");
        assert_eq!(record.unwrap().lines().count(), 701);
    }
    // A record that lost rows on the way is incomplete, too.
    let lost = Board { ends: Some((700, SweepEnd::Done)), ..Board::default() };
    assert!(lost.complaint().0.contains("ended with `lost-row` after 700"));
}

#[test]
fn a_record_that_does_not_end_is_refused() {
    let (sentence, record) = Board { more: 1, ..Board::default() }.complaint();
    assert!(sentence.contains("has sent more than the 58000 rows"), "{sentence}");
    assert_eq!(record.unwrap().lines().count(), 58_001);
}

#[test]
fn a_torque_that_is_cut_off_is_refused() {
    let (sentence, record) = Board { clips_at: Some(1.4), ..Board::default() }.complaint();
    for words in ["the sine of 1.6 N m at 64 Hz", "the amplifier clips", "Lower the amplitude"] {
        assert!(sentence.contains(words), "{sentence}");
    }
    assert!(record.is_some());
}

#[test]
fn a_board_that_falls_silent_leaves_the_rows_before() {
    let (sentence, record) = Board { dies_at: Some(5000), ..Board::default() }.complaint();
    let words = "has sent nothing for 2 s after 5000 of 58000";
    assert!(sentence.contains(words), "{sentence}");
    assert_eq!(record.unwrap().lines().count(), 5001);
}

#[test]
fn a_port_without_a_sweep_says_what_to_flash() {
    for (board, words) in [
        (
            Board { says: Some(""), ..Board::default() },
            "cargo haptic flash identify --device FILE.toml",
        ),
        (Board { says: Some("identify,9,1\n"), ..Board::default() }, "flash `identify` again"),
    ] {
        let (sentence, record) = board.complaint();
        assert!(sentence.contains(words), "{sentence}");
        assert_eq!(record, None);
    }
}
