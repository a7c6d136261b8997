//! A scene run over counts with the board's own bridge: on a virtual board, and on the host beside it.

use haptic_servo::scene::Scene;

use crate::bridge_board::BridgeBoard;
use crate::compare_run::{BoardMeasurement, RunOutcome};
use crate::controller::Controller;
use crate::lockstep::Run;
use crate::shaft::{HandHeldShaft, RecordedShaft, Shaft};
use crate::virtual_board::VirtualBoardError;

/// The source of the shaft's motion besides the motor.
pub enum ShaftInput<'a> {
    /// A hand that holds the scene's device. It waits until the servo runs.
    Hand(Box<HandHeldShaft>),
    Recording(RecordedShaft<'a>),
}

/// Aligns the board's motor if necessary, and arms it; then runs at most `ticks` ticks. `progress` is called
/// after each.
pub fn run_on_bridge(
    input: ShaftInput<'_>,
    controller: &mut dyn Controller,
    mut board: BridgeBoard,
    scene: &Scene,
    ticks: usize,
    progress: impl FnMut(),
) -> Result<RunOutcome, VirtualBoardError> {
    board.align_and_arm(scene)?;
    let (mut energy, mut final_speed) = (None, None);
    let run = match input {
        ShaftInput::Hand(mut shaft) => {
            let run = run(&mut *shaft, controller, &mut board, ticks, progress)?;
            (energy, final_speed) = (Some(shaft.energy()), Some(shaft.motion().speed.abs()));
            run
        }
        ShaftInput::Recording(mut shaft) => {
            // The board has only just begun the period in which it turns to the first count.
            if shaft.begin() {
                board.period(&mut shaft, &[])?;
            }
            run(&mut shaft, controller, &mut board, ticks, progress)?
        }
    };
    let board = Some(BoardMeasurement::Virtual(board.finish()?));
    Ok(RunOutcome { run, energy, final_speed, board, host: None })
}

/// Runs from the current period on.
fn run(
    shaft: &mut dyn Shaft,
    controller: &mut dyn Controller,
    board: &mut BridgeBoard,
    ticks: usize,
    mut progress: impl FnMut(),
) -> Result<Run, VirtualBoardError> {
    let mut run = Run::from_rest(controller);
    while run.ticks.len() < ticks {
        let count = board.count();
        run.add(count, controller.tick(count), board.code());
        progress();
        if !shaft.begin() {
            break;
        }
        board.period(shaft, &[])?;
    }
    Ok(run)
}
