//! A host that sends more than the wire can answer, and a servo that faults meanwhile.

use std::collections::HashMap;

use super::*;

/// Bytes that a line of 460800 bit/s carries in a tick of 1 ms.
const BYTES_PER_TICK: usize = 46;
/// Ticks in which the line carries these messages, the answer, and what was on its way.
const ROUND: usize = (MESSAGES_AHEAD + 2) * largest_frame(LONGEST_TO_HOST) / BYTES_PER_TICK + 2;

/// A board on a line that is as slow as a serial port, in both directions, with a host that always has more to
/// send.
struct Flooded {
    bench: Bench,
    flood: fn(Id) -> ToBoard,
    next: Id,
    to_board: Vec<u8>,
}

impl Flooded {
    fn new(flood: fn(Id) -> ToBoard) -> Self {
        let mut bench = Bench::new(Some(FaultRecord { fault: Fault::Watchdog, tick: 7, count: 8 }));
        bench.tell(&ToBoard::Stream(core::num::NonZeroU32::new(1)));
        let mut flooded = Self { bench, flood, next: 1000, to_board: Vec::new() };
        flooded.run(500);
        flooded
    }

    fn run(&mut self, ticks: usize) -> Vec<Said> {
        let mut said = Vec::new();
        for _ in 0..ticks {
            while self.to_board.len() < BYTES_PER_TICK {
                self.to_board.extend(frame(&(self.flood)(self.next)));
                self.next = self.next.wrapping_add(1).max(1000);
            }
            let rest = self.to_board.split_off(BYTES_PER_TICK);
            self.bench.session.receive(&core::mem::replace(&mut self.to_board, rest));
            self.bench.tick();
            let mut free = BYTES_PER_TICK;
            loop {
                let (sent, more) = self.bench.serve(free);
                said.extend(more);
                free -= sent;
                if sent == 0 || free == 0 {
                    break;
                }
            }
        }
        said
    }

    /// The answer to a message in the flood, within so many ticks.
    fn ask(&mut self, id: Id, message: &ToBoard, ticks: usize) -> Option<Outcome> {
        self.to_board.extend(frame(message));
        // The bytes in front of it on the line come first.
        let ticks = ticks + self.to_board.len().div_ceil(BYTES_PER_TICK);
        self.run(ticks).iter().find_map(|said| match said {
            ToHost::Answer { id: answered, outcome } if *answered == id => Some(*outcome),
            _ => None,
        })
    }
}

const QUESTIONS: [fn(Id) -> ToBoard; 8] = [
    |_| ToBoard::Hello,
    |_| ToBoard::Get,
    |_| ToBoard::Status,
    |_| ToBoard::Describe,
    |_| ToBoard::Stream(core::num::NonZeroU32::new(1)),
    |id| ToBoard::Align { id },
    // Never certified.
    |id| stiffness(id, 1000.0),
    |id| match id % 6 {
        0 => ToBoard::Hello,
        1 => ToBoard::Get,
        2 => ToBoard::Status,
        3 => ToBoard::Describe,
        4 => ToBoard::Align { id },
        _ => stiffness(id, 1000.0),
    },
];

#[test]
fn a_flood_of_one_kind_of_message_keeps_no_request_from_its_answer() {
    let fade = (program().rendering.fade * 1000.0) as usize + 2;
    let gap = (servo_loop::longest_gap(&program().rendering, 0.001) * 1000.0) as usize;
    for (which, flood) in QUESTIONS.into_iter().enumerate() {
        let mut flooded = Flooded::new(flood);
        assert_eq!(flooded.ask(1, &ToBoard::Disarm { id: 1 }, fade + ROUND), Some(Outcome::Done));
        // A servo of which an alignment is requested is armed at the next try.
        let armed = flooded.ask(2, &ToBoard::Arm { id: 2 }, ROUND);
        assert_eq!(armed, Some(Outcome::Done), "{which}");
        let mut outcome = None;
        // A set between others is refused until it comes first.
        for id in 3..200 {
            outcome = flooded.ask(id, &stiffness(id, 7.0), 2 * ROUND + gap + 2 * fade);
            if outcome == Some(Outcome::Done) {
                break;
            }
        }
        assert_eq!(outcome, Some(Outcome::Done), "{which}");
    }
}

#[test]
fn a_flood_of_requests_to_arm_or_to_disarm_keeps_no_set_from_its_answer() {
    let gap = (servo_loop::longest_gap(&program().rendering, 0.001) * 1000.0) as usize;
    for flood in [
        |id| ToBoard::Arm { id },
        |id| ToBoard::Disarm { id },
        |id| if id % 2 == 0 { ToBoard::Arm { id } } else { ToBoard::Disarm { id } },
    ] {
        let mut flooded = Flooded::new(flood);
        let outcome = flooded.ask(3, &stiffness(3, 7.0), 2 * ROUND + gap + 100);
        assert_eq!(outcome, Some(Outcome::Done));
    }
}

#[test]
fn every_kind_has_its_turn_once_in_a_round() {
    let mut turns = std::vec![Turn::FIRST];
    while turns.last().unwrap().next() != Turn::FIRST {
        turns.push(turns.last().unwrap().next());
    }
    assert_eq!(turns.len(), Turn::COUNT);
}

/// With messages of all other kinds but the answers to `Disarm`, which would overrule arming.
#[test]
fn an_answer_waits_for_no_more_messages_than_the_bound() {
    let mut bench = Bench::new(Some(FaultRecord { fault: Fault::Watchdog, tick: 7, count: 8 }));
    bench.run(500);
    bench.tell(&ToBoard::Stream(core::num::NonZeroU32::new(1)));
    let mut other = 1000;
    let mut next = |bench: &mut Bench| -> Said {
        for message in [
            ToBoard::Hello,
            ToBoard::Get,
            ToBoard::Status,
            ToBoard::Describe,
            ToBoard::Align { id: other },
            stiffness(other, 1000.0),
            stiffness(other + 1, 1000.0),
        ] {
            bench.tell(&message);
        }
        other += 2;
        (0..20).for_each(|_| bench.tick());
        bench.serve(usize::MAX).1.swap_remove(0)
    };
    let mut ahead = |id| {
        bench.tell(&ToBoard::Arm { id });
        bench.tick();
        (0..100).position(|_| next(&mut bench) == done(id)).unwrap()
    };
    // Each but the first comes just after its turn, and waits for the longest.
    assert!(ahead(1) <= MESSAGES_AHEAD);
    assert_eq!([2, 3, 4].map(ahead), [MESSAGES_AHEAD - 1; 3]);
}

/// A host that repeats `Hello` faster than a greeting takes still gets the end of one.
#[test]
fn a_greeting_comes_to_its_end() {
    let mut flooded = Flooded::new(|_| ToBoard::Hello);
    let said = flooded.run(200);
    let parts = |wanted: fn(&Said) -> bool| said.iter().filter(|said| wanted(said)).count();
    let welcomes = parts(|said| matches!(said, ToHost::Welcome { .. }));
    let boards = parts(|said| matches!(said, ToHost::Board(_)));
    assert!(boards > 10 && welcomes.abs_diff(boards) <= 1, "{welcomes} {boards}");
    assert!(parts(|said| matches!(said, ToHost::Telemetry(_))) > 10);
}

#[test]
fn one_request_to_arm_at_a_time_and_every_request_to_disarm() {
    let mut bench = Bench::new(None);
    bench.run(500);
    for message in [
        ToBoard::Disarm { id: 1 },
        ToBoard::Disarm { id: 2 },
        ToBoard::Disarm { id: 1 },
        ToBoard::Arm { id: 3 },
    ] {
        bench.tell(&message);
    }
    let said = bench.run(500);
    assert_eq!(said, [refused(3, Refusal::Disarming), done(1), done(2)]);
    for message in [ToBoard::Arm { id: 4 }, ToBoard::Arm { id: 5 }, ToBoard::Arm { id: 4 }] {
        bench.tell(&message);
    }
    let mut said = bench.run(500);
    said.sort_by_key(|said| matches!(said, ToHost::Answer { id: 5, .. }));
    assert_eq!(said, [done(4), refused(5, Refusal::Busy)]);
}

/// What a flood has sent and received.
#[derive(Default)]
struct Journal {
    /// The stiffness of each set, by its number.
    sets: HashMap<Id, f64>,
    said: Vec<Said>,
    next: Id,
}

impl Journal {
    fn message(&mut self, random: &mut Random) -> Vec<u8> {
        self.next += 1;
        let id = self.next;
        let message = match random.below(12) {
            0..4 => {
                // Every fourth is not certified.
                let value = if random.below(4) == 0 { 1000.0 } else { f64::from(id % 20) + 1.0 };
                self.sets.insert(id, value);
                stiffness(id, value)
            }
            4 | 5 => ToBoard::Arm { id },
            6 => ToBoard::Disarm { id },
            7 => ToBoard::Align { id },
            8 => ToBoard::Status,
            9 => ToBoard::Hello,
            10 => ToBoard::Stream(core::num::NonZeroU32::new(random.below(3) as u32)),
            _ => return (0..random.below(40)).map(|_| random.below(256) as u8).collect(),
        };
        frame(&message)
    }

    fn outcomes(&self) -> impl Iterator<Item = (Id, Outcome)> {
        self.said.iter().filter_map(|said| match said {
            ToHost::Answer { id, outcome } => Some((*id, *outcome)),
            _ => None,
        })
    }
}

/// Marsaglia's xorshift: the same numbers on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % bound
    }
}

/// Requests, faults and ticks in any order, with a wire that is served now and then.
fn flood(bench: &mut Bench, journal: &mut Journal, random: &mut Random) {
    for _ in 0..60 {
        match random.below(8) {
            0..3 => bench.session.receive(&journal.message(random)),
            3 | 4 => (0..random.below(12)).for_each(|_| bench.tick()),
            5 => bench.session.poll(),
            6 => {
                let sent = random.below(40) as usize;
                journal.said.extend(bench.serve(sent).1);
            }
            _ => match random.below(6) {
                0 => bench.hardware.output_event = Some(OutputEvent::Fault(Fault::ClockLost)),
                1 => bench.hardware.alignment = Some(random.below(20) as u32),
                _ => {}
            },
        }
    }
}

#[test]
fn after_a_flood_every_accepted_set_is_answered_and_the_last_one_runs() {
    for seed in 1..=3000 {
        let (mut bench, mut journal) = (Bench::new(None), Journal::default());
        let mut random = Random(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed));
        flood(&mut bench, &mut journal, &mut random);
        bench.tell(&ToBoard::Stream(None));
        bench.hardware.alignment = None;
        journal.said.extend(bench.run(300));
        assert_quiet(&bench, seed);
        let answered: Vec<(Id, Outcome)> = journal.outcomes().collect();
        let swapped: Vec<Id> = answered
            .iter()
            .filter(|(id, outcome)| *outcome == Outcome::Done && journal.sets.contains_key(id))
            .map(|(id, _)| *id)
            .collect();
        let running = bench.running();
        assert_eq!(running.sets as usize, swapped.len(), "{seed}");
        let stiffness = swapped.last().map_or(22.0, |id| journal.sets[id]);
        assert!(running.values.contains(&(Parameter::Stiffness, stiffness)), "{seed}");
        // The motor has the torque of the set that is read back.
        bench.tell(&ToBoard::Arm { id: 60_000 });
        assert!(bench.run(200).contains(&done(60_000)), "{seed}");
        let offset = f64::from(bench.hardware.code().offset());
        assert!((offset - codes(stiffness)).abs() <= 1.0, "{seed}: {offset}, {stiffness}");
        assert_eq!(bench.set(60_001, &[(Parameter::Stiffness, 3.0)]), Outcome::Done, "{seed}");
    }
}

/// Nothing is open: no request waits for an answer.
fn assert_quiet(bench: &Bench, seed: u64) {
    let Session { requested, submitted, replies, .. } = &bench.session;
    assert!(requested.is_none() && submitted.is_none() && replies.is_empty(), "{seed}");
}
