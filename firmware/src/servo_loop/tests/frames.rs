//! Frames: their contents, and that the interrupt never waits for their reader.

use proptest::prelude::*;

use super::*;

#[test]
fn a_frame_says_what_its_tick_did() {
    let mut bench = running(&SPRING, 250);
    let tick = bench.status().tick;
    bench.board.elapsed = 777;
    let frame = bench.tick(260);
    let code = DacCode::new(u16::try_from(*bench.board.codes().last().unwrap()).unwrap()).unwrap();
    let limit = LimitReason::None;
    let expected =
        Frame { tick: tick + 1, count: 260, code, limit, state: State::Running, slack: 223 };
    assert_eq!(frame, expected);
    assert_eq!(bench.status().worst_slack, 223);
    bench.tick(1200);
    assert_eq!(bench.tick(1200).limit, LimitReason::Torque);
}

#[test]
fn a_reader_that_stalls_costs_frames_and_nothing_else() {
    let mut bench = running(&SPRING, 250);
    for _ in 0..50 {
        bench.servo_loop.run(&mut bench.board, &mut bench.inbox, &mut bench.frames);
    }
    let ticks: Vec<u32> = core::iter::from_fn(|| bench.seen.take()).map(|f| f.tick).collect();
    assert_eq!(ticks.len(), 8);
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 1));
    assert_eq!(bench.status().dropped, 42);
    assert_eq!(bench.servo_loop.state(), State::Running);
}

#[test]
fn two_threads_see_every_frame_once_and_in_order() {
    let queue: &'static mut FrameQueue<4> = Box::leak(Box::new(FrameQueue::new()));
    let (mut frames, mut reader) = queue.split();
    const TOTAL: u32 = 100_000;
    let of = |tick: u32| Frame {
        tick,
        count: tick.cast_signed().wrapping_mul(-7),
        code: DacCode::from_low_bits(tick as u16),
        limit: LimitReason::Ramp,
        state: State::Faulted,
        slack: !tick,
    };
    let writer = std::thread::spawn(move || {
        for tick in 0..TOTAL {
            loop {
                let dropped = frames.dropped();
                frames.push(of(tick));
                if frames.dropped() == dropped {
                    break;
                }
                std::thread::yield_now();
            }
        }
    });
    for tick in 0..TOTAL {
        let frame = loop {
            match reader.take() {
                Some(frame) => break frame,
                None => std::thread::yield_now(),
            }
        };
        assert_eq!(frame, of(tick));
    }
    assert_eq!(reader.take(), None);
    writer.join().unwrap();
}

proptest! {
    #[test]
    fn a_frame_survives_its_words(
        tick: u32, count: i32, code in 0_u16..4096, slack: u32,
        limit in 0..LimitReason::ALL.len(), state in 0..State::ALL.len(),
    ) {
        let (limit, state) = (LimitReason::ALL[limit], State::ALL[state]);
        let frame = Frame { tick, count, code: DacCode::new(code).unwrap(), limit, state, slack };
        let mut queue = FrameQueue::<2>::new();
        let (mut frames, mut reader) = queue.split();
        frames.push(frame);
        prop_assert_eq!(reader.take(), Some(frame));
    }
}
