//! A tick of a board in physical units.

use std::f64::consts::TAU;
use std::fmt;

use haptic_servo::dac::DacCode;
use haptic_servo::servo_loop::{Frame, State};
use haptic_servo::torque::LimitReason;
use haptic_servo::wire::message::BoardUnits;

use crate::quantity::rounded;

/// Digits of a time: a multiple of a period with few digits has no more, except by rounding.
const DIGITS: usize = 15;

/// A tick of a board in physical units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Periods since the board's servo started; wraps on the board and not here.
    pub tick: u64,
    /// Time in s since the board's servo started.
    pub time: f64,
    /// Position in counts.
    pub count: i64,
    /// Angle in rad.
    pub position: f64,
    /// The DAC's code.
    pub code: u16,
    /// Coupling torque `F` in N m, as in every other trace; the motor applies `-F`.
    pub torque: f64,
    /// The state of the servo.
    pub state: State,
    /// The reason if the torque is limited.
    pub limit: LimitReason,
    /// Time in s that was left of the period when the tick was done.
    pub slack: f64,
}

/// Converts a board's ticks to samples.
#[derive(Clone, Debug)]
pub struct Scale {
    board: BoardUnits,
    tick: u64,
    count: i64,
}

impl Scale {
    /// For this board.
    pub fn new(board: BoardUnits) -> Self {
        Self { board, tick: 0, count: 0 }
    }

    /// Converts the next tick; the ticks come in order. Numbers that wrap on the wire do not wrap here.
    pub fn sample(&mut self, frame: &Frame) -> Sample {
        let board = &self.board;
        self.tick += u64::from(frame.tick.wrapping_sub(self.tick as u32));
        self.count += i64::from(frame.count.wrapping_sub(self.count as i32));
        let torque_per_code = board.full_scale_torque / f64::from(DacCode::CODES_TO_FULL_SCALE);
        Sample {
            tick: self.tick,
            time: rounded(self.tick as f64 * board.period, DIGITS),
            count: self.count,
            position: self.count as f64 * TAU / board.counts_per_turn,
            code: frame.code.get(),
            // Zero torque is 0 and not -0.
            torque: 0.0 - f64::from(frame.code.offset()) * torque_per_code,
            state: frame.state,
            limit: frame.limit,
            slack: f64::from(frame.slack) / f64::from(board.timer_counts) * board.period,
        }
    }
}

/// The names of a row's columns.
pub const COLUMNS: &str = "tick,time,count,position,code,torque,state,limit,slack";

/// As a row of a table in CSV; the shortest decimals that are the numbers.
impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, count, code, .. } = self;
        let (state, limit) = (self.state.as_str(), self.limit.as_str());
        let [time, position, torque, slack] =
            [self.time, self.position, self.torque, self.slack].map(decimal);
        write!(f, "{tick},{time},{count},{position},{code},{torque},{state},{limit},{slack}")
    }
}

/// A number in the notation of JSON, so that all tables of this workspace write it alike.
fn decimal(number: f64) -> String {
    serde_json::Number::from_f64(number).map_or(number.to_string(), |number| number.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOARD: BoardUnits = BoardUnits {
        period: 0.001,
        timer_counts: 8000,
        counts_per_turn: 4000.0,
        full_scale_torque: 1.791,
        energy_step: 1e-6,
        longest_gap: 0.036,
    };

    fn frame(tick: u32, count: i32) -> Frame {
        let code = DacCode::new(2048 - 500).unwrap();
        let (limit, state) = (LimitReason::Torque, State::Running);
        Frame { tick, count, code, limit, state, slack: 6000 }
    }

    #[test]
    fn is_in_the_units_of_the_world() {
        let sample = Scale::new(BOARD).sample(&frame(250, -1000));
        assert_eq!((sample.tick, sample.count), (250, -1000));
        for (value, wanted) in [
            (sample.time, 0.25),
            (sample.position, -TAU / 4.0),
            (sample.torque, 0.5),
            (sample.slack, 0.00075),
        ] {
            assert!((value - wanted).abs() < 1e-12, "{value} is not {wanted}");
        }
    }

    #[test]
    fn goes_on_where_the_boards_numbers_wrap() {
        let mut scale = Scale::new(BOARD);
        scale.sample(&frame(u32::MAX, i32::MAX));
        let sample = scale.sample(&frame(4, i32::MIN + 6));
        assert_eq!(sample.tick, (1 << 32) + 4);
        assert_eq!(sample.count, (1 << 31) + 6);
    }
}
