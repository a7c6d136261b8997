//! What the interrupt publishes for the task.

use proptest::prelude::*;

use super::*;
use crate::servo_loop::mailbox::Published;

/// A task that reads late misses nothing: twelve requests and their replies before the first look.
#[test]
fn replies_without_a_reader_are_replaced_by_the_last() {
    let mut bench = running(&SPRING, 500);
    for _ in 0..3 {
        bench.requests.disarm();
        bench.stand(500, 110);
        bench.requests.arm();
        bench.stand(500, 110);
    }
    for _ in 0..3 {
        bench.requests.submit(swap::set(&SPRING, &[])).unwrap();
        bench.stand(500, 250);
    }
    let disarmed = bench.requests.disarm();
    bench.stand(500, 110);
    bench.board.output_event = Some(OutputEvent::Fault(Fault::ClockLost));
    bench.tick(500);
    let armed = bench.requests.arm();
    bench.tick(500);
    let aligned = bench.requests.align();
    bench.tick(500);
    assert_eq!(bench.requests.off(), disarmed);
    assert_eq!(bench.requests.arming(), Some((armed, Reply::Fault(Fault::ClockLost))));
    assert_eq!(bench.requests.alignment(), Some((aligned, Reply::Fault(Fault::ClockLost))));
    assert_eq!(bench.requests.swapped(), 3);
}

#[test]
fn disarming_overrules_what_was_requested_in_the_same_tick() {
    let mut bench = bench(&SPRING);
    let (armed, aligned) = (bench.requests.arm(), bench.requests.align());
    let disarmed = bench.requests.disarm();
    bench.tick(0);
    assert_eq!(bench.requests.arming(), Some((armed, Reply::Disarming)));
    assert_eq!(bench.requests.alignment(), Some((aligned, Reply::Disarming)));
    assert_eq!((bench.requests.off(), bench.board.is_on()), (disarmed, false));
}

/// A set that comes while a motor is aligned does not wait for the end of the alignment.
#[test]
fn a_set_is_swapped_while_a_motor_is_aligned() {
    let board = Board { alignment: Some(1000), ..Board::new() };
    let mut bench = Bench::<Environment, f32, Latched>::boot(&SPRING, board).unwrap();
    bench.requests.align();
    bench.stand(500, 10);
    let number = bench.requests.submit(swap::set(&SPRING, &[])).unwrap();
    bench.stand(500, 2);
    assert_eq!(bench.requests.swapped(), number);
    assert_eq!(bench.servo_loop.state(), State::Aligning);
    assert!(bench.board.codes().iter().all(|code| *code == 2048));
}

/// The writer does not wait, and the reader gets whole words.
#[test]
fn two_threads_see_whole_words_that_never_go_back() {
    const LAST: u32 = 200_000;
    let published = Published::<7>::new();
    std::thread::scope(|scope| {
        scope.spawn(|| (1..=LAST).for_each(|number| published.publish([number; 7])));
        let mut before = 0;
        while before < LAST {
            let Some(words) = published.read() else { continue };
            assert!(words.iter().all(|word| *word == words[0]), "{words:?}");
            assert!(words[0] >= before);
            before = words[0];
        }
    });
}

proptest! {
    #[test]
    fn a_status_survives_its_words(
        numbers: [u32; 5], wide: [i64; 3], state in 0..State::ALL.len(), link_lost: bool, stopped: bool,
    ) {
        let [tick, period, worst_slack, missed, dropped] = numbers;
        let [count, energy, worst_deficit] = wide;
        let fault = stopped.then_some(Fault::LateTick { late: tick, allowed: period });
        let state = State::ALL[state];
        let status = Status {
            state, fault, tick, count, period, worst_slack, missed, dropped, energy, worst_deficit, link_lost,
        };
        prop_assert_eq!(Status::from_words(status.to_words()), status);
    }
}

#[test]
fn a_reply_survives_its_words() {
    let fault = Fault::MissedTick { missed: 7, tolerated: u32::MAX };
    for reply in [Reply::Done, Reply::Fault(fault), Reply::Armed, Reply::Disarming] {
        assert_eq!(Reply::from_words(reply.to_words()), Some(reply));
    }
}
