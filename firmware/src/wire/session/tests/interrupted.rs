//! Ticks that come between any two accesses of a session to what it shares with the servo's interrupt.
//!
//! A host sends a fixed list of messages, and the interrupt comes at chosen instants of the session's work
//! ([`interruption`]): at each instant alone, at all of them, and by chance. Whatever the instants, every
//! request has one answer, the servo renders one whole set, and the session is not busy afterwards.

use std::cell::RefCell;
use std::rc::Rc;

use super::*;
use crate::servo_loop::interruption;
use crate::test_scene::Random;

/// The servo of the first set, and what the list sets.
const FIRST: f64 = 22.0;
const SETS: [(Id, f64); 4] = [(1, 10.0), (4, 12.0), (8, 14.0), (20, 16.0)];

/// Ticks in which a swap ends, and more.
const SWAP: u32 = 60;

/// The interrupt with what it owns.
struct Interrupt {
    servo_loop: ServoLoop<Environment, f32, Latched>,
    hardware: Board,
    inbox: Inbox<'static, PreparedServo<Environment, f32, Latched>>,
    frames: Frames<'static, FRAMES>,
    /// Ticks in each of the next instants; after the last none.
    plan: Vec<u32>,
    instant: usize,
    /// The last code, and the ticks for which a running servo has had it.
    steady: (u16, u32),
    /// Steady codes of a fully open clamp that belong to no set.
    torn: Vec<u16>,
}

/// Ticks after which a code is steady: after a swap the delayed wall and the coupling settle.
const STEADY: u32 = 8;

impl Interrupt {
    fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.servo_loop.run(&mut self.hardware, &mut self.inbox, &mut self.frames);
            let code = self.hardware.code().get();
            let goes_on = self.servo_loop.state() == State::Running && code == self.steady.0;
            self.steady = (code, if goes_on { self.steady.1 + 1 } else { 0 });
            if self.steady.1 == STEADY && !self.is_whole() {
                self.torn.push(code);
            }
        }
    }

    /// Whether the code is that of one of the sets.
    fn is_whole(&self) -> bool {
        let code = f64::from(self.hardware.code().offset());
        let sets = SETS.iter().map(|(_, stiffness)| *stiffness).chain([FIRST]);
        sets.into_iter().any(|stiffness| (codes(stiffness) - code).abs() <= 1.0)
    }

    fn interrupt(&mut self) {
        let ticks = self.plan.get(self.instant).copied().unwrap_or(0);
        self.instant += 1;
        self.ticks(ticks);
    }
}

/// What became of a list of messages.
#[derive(Debug)]
struct End {
    /// Instants at which an interrupt could have come.
    instants: usize,
    said: Vec<Said>,
    torn: Vec<u16>,
    /// Wrong, if not empty.
    wrong: Vec<String>,
}

/// The list: more than one request of each kind is open at once, and not all of them are read soon.
fn messages() -> Vec<Vec<ToBoard>> {
    let set = |(id, value): (Id, f64)| stiffness(id, value);
    vec![
        vec![ToBoard::Status, set(SETS[0])],
        vec![ToBoard::Disarm { id: 2 }, ToBoard::Status],
        vec![ToBoard::Arm { id: 3 }],
        vec![set(SETS[1]), set(SETS[1]), ToBoard::Status],
        vec![ToBoard::Align { id: 5 }, ToBoard::Disarm { id: 6 }],
        vec![ToBoard::Status, ToBoard::Arm { id: 7 }],
        vec![set(SETS[2])],
    ]
}

fn answers(said: &[Said], asked: Id) -> Vec<Outcome> {
    let answer = |said: &Said| match said {
        ToHost::Answer { id, outcome } if *id == asked => Some(*outcome),
        _ => None,
    };
    said.iter().filter_map(answer).collect()
}

/// Plays the list with so many ticks in each instant.
fn play(plan: Vec<u32>) -> End {
    let Bench { mut session, servo_loop, hardware, inbox, frames, mut ear } = Bench::new(None);
    let interrupt = Interrupt {
        servo_loop,
        hardware,
        inbox,
        frames,
        plan,
        instant: 0,
        steady: (0, 0),
        torn: Vec::new(),
    };
    let interrupt = Rc::new(RefCell::new(interrupt));
    // Armed, as `Bench::new` has requested it.
    interrupt.borrow_mut().ticks(SWAP);
    let shared = Rc::clone(&interrupt);
    interruption::set(move || shared.borrow_mut().interrupt());
    let mut said: Vec<Said> = Vec::new();
    let mut poll = |session: &mut Served| said.extend(serve(session, &mut ear, usize::MAX).1);
    for burst in messages() {
        for message in burst {
            session.receive(&frame(&message));
        }
        for _ in 0..3 {
            poll(&mut session);
        }
    }
    let instants = interrupt.borrow().instant;
    interruption::clear();
    let mut rest = |session: &mut Served| {
        for _ in 0..4 * SWAP {
            interrupt.borrow_mut().ticks(1);
            poll(session);
        }
    };
    rest(&mut session);
    session.receive(&frame(&stiffness(SETS[3].0, SETS[3].1)));
    rest(&mut session);
    session.receive(&frame(&ToBoard::Get));
    rest(&mut session);
    let torn = core::mem::take(&mut interrupt.borrow_mut().torn);
    let mut end = End { instants, said, torn, wrong: Vec::new() };
    end.check();
    end
}

impl End {
    fn check(&mut self) {
        let mut wrong = Vec::new();
        for id in [1, 2, 3, 4, 5, 6, 7, 8, 20] {
            let found = answers(&self.said, id);
            // A host that repeats a request which is refused has as many refusals.
            let repeated = id == SETS[1].0 && found == [Outcome::Refused(Refusal::Busy); 2];
            // A later request to disarm replaces an unfinished one.
            let superseded = id == 2 && found.is_empty();
            if found.len() != 1 && !repeated && !superseded {
                wrong.push(std::format!("request {id} has the answers {found:?}"));
            }
        }
        let last = answers(&self.said, SETS[3].0);
        if last != [Outcome::Done] {
            wrong.push(std::format!("the session is still busy: {last:?}"));
        }
        let is_done = |id: &Id| answers(&self.said, *id) == [Outcome::Done];
        let done = SETS.iter().filter(|(id, _)| is_done(id)).count();
        let active = self.said.iter().rev().find_map(|said| match said {
            ToHost::ActiveParameters(active) => Some(active),
            _ => None,
        });
        match active {
            None => wrong.push("the board does not say what it renders".to_string()),
            Some(active) => {
                let stiffness = active.values.iter().find(|(p, _)| *p == Parameter::Stiffness);
                if stiffness.map(|(_, value)| *value) != Some(SETS[3].1) {
                    wrong.push(std::format!("the active stiffness is {stiffness:?}"));
                }
                if active.sets as usize != done {
                    wrong.push(std::format!("{} sets and {done} answers", active.sets));
                }
            }
        }
        if !self.torn.is_empty() {
            wrong.push(std::format!("codes of no set: {:?}", self.torn));
        }
        self.wrong = wrong;
    }
}

/// The instants of the list without an interrupt.
fn instants() -> usize {
    play(Vec::new()).instants
}

fn judge(plans: impl Iterator<Item = Vec<u32>>) {
    let mut failures = Vec::new();
    let mut count = 0;
    for plan in plans {
        let end = play(plan.clone());
        count += 1;
        if !end.wrong.is_empty() {
            let plan: Vec<_> =
                plan.iter().enumerate().filter(|(_, ticks)| **ticks > 0).take(9).collect();
            failures.push(std::format!("(instant, ticks) {plan:?}: {}", end.wrong.join("; ")));
        }
    }
    let first = failures.first();
    assert!(failures.is_empty(), "{} of {count} orders: {first:?}", failures.len());
}

#[test]
fn an_interrupt_at_any_one_instant_loses_nothing() {
    let all = instants();
    assert!(all > 60, "only {all} instants");
    judge((0..all).flat_map(|at| {
        [1, 2, SWAP].map(|ticks| {
            let mut plan = std::vec![0; at];
            plan.push(ticks);
            plan
        })
    }));
}

#[test]
fn interrupts_at_every_instant_lose_nothing() {
    judge([1, 2, 3, 7, SWAP].into_iter().map(|ticks| std::vec![ticks; 4096]));
}

#[test]
fn interrupts_by_chance_lose_nothing() {
    let mut random = Random(1);
    judge((0..300).map(move |_| {
        let mut next = || (random.bits() >> 29) as u32;
        let share = 1 + next() % 8;
        let often = |ticks: u32| if ticks % 16 < share { ticks / 16 % 4 } else { 0 };
        (0..4096).map(|_| often(next())).collect()
    }));
}
