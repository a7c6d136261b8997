//! Packed ticks: each as the difference from the previous tick, one byte instead of five.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use crate::dac::DacCode;
use crate::servo_loop::{Frame, State};
use crate::torque::LimitReason;

/// Ticks in one message. More would add delay and save little.
pub const BATCH: usize = 12;

/// Ticks in their order, not necessarily consecutive.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Batch {
    ticks: Vec<Packed, BATCH>,
}

/// The difference of a tick from the previous tick; of the first tick, from zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Packed {
    later: u32,
    moved: i32,
    code: DacCode,
    limit: LimitReason,
    state: State,
    slack: u32,
}

impl Batch {
    /// An empty batch.
    pub const fn new() -> Self {
        Self { ticks: Vec::new() }
    }

    /// Whether the batch is empty.
    pub fn is_empty(&self) -> bool {
        self.ticks.is_empty()
    }

    /// Whether the batch is full.
    pub fn is_full(&self) -> bool {
        self.ticks.is_full()
    }

    /// Adds a tick that is later than those in the batch.
    ///
    /// # Errors
    /// Returns the tick if the batch is full.
    pub fn push(&mut self, tick: Frame) -> Result<(), Frame> {
        let (last, count) = self.ticks().last().map_or((0, 0), |last| (last.tick, last.count));
        let packed = Packed {
            later: tick.tick.wrapping_sub(last),
            moved: tick.count.wrapping_sub(count),
            code: tick.code,
            limit: tick.limit,
            state: tick.state,
            slack: tick.slack,
        };
        self.ticks.push(packed).map_err(|_| tick)
    }

    /// The ticks.
    pub fn ticks(&self) -> impl Iterator<Item = Frame> {
        self.ticks.iter().scan((0_u32, 0_i32), |(tick, count), packed| {
            *tick = tick.wrapping_add(packed.later);
            *count = count.wrapping_add(packed.moved);
            let Packed { code, limit, state, slack, .. } = *packed;
            Some(Frame { tick: *tick, count: *count, code, limit, state, slack })
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn frame() -> impl Strategy<Value = Frame> {
        let limit = prop::sample::select(vec![LimitReason::None, LimitReason::Ramp]);
        let state = prop::sample::select(vec![State::Disarmed, State::Running, State::Faulted]);
        let all = (any::<u32>(), any::<i32>(), 0_u16..=4095, limit, state, any::<u32>());
        all.prop_map(|(tick, count, code, limit, state, slack)| Frame {
            tick,
            count,
            code: DacCode::new(code).unwrap(),
            limit,
            state,
            slack,
        })
    }

    proptest! {
        #[test]
        fn gives_back_what_was_put_in(frames in prop::collection::vec(frame(), 0..=BATCH)) {
            let mut batch = Batch::new();
            for frame in &frames {
                prop_assert_eq!(batch.push(*frame), Ok(()));
            }
            prop_assert_eq!(batch.ticks().collect::<std::vec::Vec<_>>(), frames.clone());
            prop_assert_eq!(batch.is_full(), frames.len() == BATCH);
            let mut buffer = [0; 32 * BATCH];
            let bytes = postcard::to_slice(&batch, &mut buffer).unwrap();
            prop_assert_eq!(postcard::from_bytes::<Batch>(bytes), Ok(batch));
        }
    }

    #[test]
    fn takes_eight_bytes_a_tick_that_has_fifteen() {
        let mut batch = Batch::new();
        let code = DacCode::new(2100).unwrap();
        let (limit, state) = (LimitReason::Torque, State::Running);
        let mut frame =
            Frame { tick: 4_000_000_000, count: -70_000, code, limit, state, slack: 79 };
        for _ in 0..BATCH {
            batch.push(frame).unwrap();
            frame.tick += 1;
            frame.count -= 40;
        }
        assert_eq!(batch.push(frame), Err(frame));
        let mut buffer = [0; 200];
        let bytes = postcard::to_slice(&batch, &mut buffer).unwrap().len();
        assert!(bytes <= 8 * BATCH + 8, "{bytes}");
    }

    #[test]
    fn a_code_that_no_converter_has_is_no_tick() {
        let frame = [1, 1, 0, 0x80, 0x20, 0, 0, 0];
        assert!(postcard::from_bytes::<Batch>(&frame).is_err());
    }
}
