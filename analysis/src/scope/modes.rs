//! The modes of a knob's program.

use haptic_servo::certificate::Parameter;
use haptic_servo::environment::ProfileMode;
use haptic_servo::wire::message::ActiveParameters;

use crate::program::Program;

/// The modes of a board's program by number and name, the selected one marked; `None` where it has none, or
/// where this build of `haptic` does not have the program.
pub fn modes(program: &str, parameters: &ActiveParameters) -> Option<String> {
    let is_mode = |change: &&(Parameter, f64)| change.0 == Parameter::Mode;
    let (_, selected) = parameters.values.iter().find(is_mode)?;
    let modes = Program::find(program)?.scene.environment.profile()?.modes?.modes();
    let line = |(number, mode): (usize, &ProfileMode)| {
        let mark = if number as f64 == *selected { '*' } else { ' ' };
        format!("\n{mark} {number:2}  {}", mode.name())
    };
    let lines: String = modes.iter().enumerate().map(line).collect();
    Some(format!("modes, of which mode=NUMBER selects one:{lines}"))
}
