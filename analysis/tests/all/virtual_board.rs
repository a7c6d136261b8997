//! What is flashed, on a virtual board, as a person runs it.

use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};

use analysis::toolchain::Board;
use serde_json::Value;
use tempfile::TempDir;

use crate::common::{answer, haptic, program};

#[test]
fn what_is_flashed_gives_the_codes_of_the_host() {
    for board in Board::ALL {
        for scene in ["delayed_spring", "damper_wall", "free_mode"] {
            let target = format!("board:{board}");
            let run = haptic(&["run", "--target", &target, scene, "--json", "--ticks", "3000"]);
            assert_eq!(run.status.code(), Some(0), "{run:?}");
            let run = answer(&run);
            assert_eq!(run["target"], target);
            assert_eq!((&run["codes_equal"], &run["difference"]), (&3000.into(), &Value::Null));
            // The whole interrupt has what is around the servo, too.
            let instructions = |which| run["instructions"][which].as_f64().unwrap();
            assert!(instructions("interrupt_mean") > instructions("compute_max"), "{run}");
        }
    }
}

#[test]
fn only_a_program_runs_on_a_virtual_board_and_only_on_one_that_there_is() {
    for (arguments, parts) in [
        (
            &["run", "--target", "board:arduino", "damper_wall"][..],
            ["no board arduino", "nucleo-g474re, b-g431b-esc1, stm32f405"],
        ),
        (&["run", "--target", "board", "damper_wall"], ["no target board", "board:NAME"]),
        (
            &["run", "--target", "board:stm32f405", "--full-scale", "3.5", "damper_wall"],
            ["is built for", "run it on the host"],
        ),
        (
            &["twin", "damper_wall", "--board", "arduino", "--port", "unix:x"],
            ["no board arduino", "nucleo-g474re, b-g431b-esc1, stm32f405"],
        ),
    ] {
        let output = haptic(arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
}

/// A virtual board behind a socket; ends with this.
struct SimulatedBoard {
    process: Child,
    port: String,
    _folder: TempDir,
}

impl SimulatedBoard {
    fn of(board: Board, scene: &str) -> Self {
        let folder = TempDir::new().unwrap();
        let port = format!("unix:{}", folder.path().join("board").display());
        let mut process = program(&["twin", scene, "--board", board.name(), "--port", &port])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(process.stdout.take().unwrap()).lines();
        assert_eq!(said.next().unwrap().unwrap(), format!("{scene} listens on {port}"));
        Self { process, port, _folder: folder }
    }

    fn tune(&self, arguments: &[&str]) -> (Option<i32>, Value) {
        let output = haptic(&[&["tune", "--json", "--port", &self.port], arguments].concat());
        (output.status.code(), answer(&output))
    }
}

impl Drop for SimulatedBoard {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Over the serial port that the drivers have set up, judged by the certificate in the flash.
#[test]
fn the_parameters_of_what_is_flashed_are_tuned_over_its_serial_port() {
    for board in Board::ALL {
        let board = SimulatedBoard::of(board, "damper_wall");
        let (status, running) = board.tune(&[]);
        assert_eq!((status, &running["refused"]), (Some(0), &Value::Null), "{running}");
        assert_eq!(running["parameters"]["stiffness"], 22.0);
        let (state, reset) = (&running["state"], &running["reset"]);
        assert_eq!((state, reset), (&"disarmed".into(), &"power-on".into()), "{running}");
        let (status, running) = board.tune(&["--arm"]);
        assert_eq!((status, &running["refused"]), (Some(0), &Value::Null), "{running}");
        let (status, running) = board.tune(&["stiffness=20"]);
        assert_eq!((status, &running["refused"]), (Some(0), &Value::Null), "{running}");
        assert_eq!(running["parameters"]["stiffness"], 20.0);
        // Past the line: the board itself says no, says what would pass, and goes on.
        let (status, refused) = board.tune(&["damping=0.02"]);
        assert_eq!(status, Some(1), "{refused}");
        assert!(refused["refused"].to_string().contains("would pass"), "{refused}");
        let (_, running) = board.tune(&[]);
        assert_eq!(running["parameters"]["damping"], 0.01);
        assert_eq!(running["missed"], 0, "{running}");
    }
}
