//! What the gates did, by the record of their changes.

use super::{Gates, is_on};

/// Whether any gate was high in a time, both ends included.
pub fn any_high(changes: &[(u64, Gates)], from: u64, to: u64) -> bool {
    first_high(changes, from).is_some_and(|at| at <= to)
}

/// When the first gate was high from a time on.
pub fn first_high(changes: &[(u64, Gates)], from: u64) -> Option<u64> {
    let has_high = |gates: &Gates| gates.iter().any(|&level| is_on(level));
    let at = changes.iter().rev().find(|(at, _)| *at <= from);
    if at.is_some_and(|(_, gates)| has_high(gates)) {
        return Some(from);
    }
    changes.iter().find(|(at, gates)| *at > from && has_high(gates)).map(|(at, _)| *at)
}

/// Since when no gate has been high any more, up to the end of the record; none where one still is.
pub fn off_since(changes: &[(u64, Gates)]) -> Option<u64> {
    let is_off = |(_, gates): &&(u64, Gates)| !gates.iter().any(|&level| is_on(level));
    changes.iter().rev().take_while(is_off).last().map(|(at, _)| *at)
}

/// The shortest time from one switch of a leg turning off to the other turning on.
pub fn shortest_dead_time(changes: &[(u64, Gates)]) -> Option<u64> {
    (0..3).filter_map(|leg| shortest_of(changes, leg)).min()
}

fn shortest_of(changes: &[(u64, Gates)], leg: usize) -> Option<u64> {
    let (mut shortest, mut was_on) = (None::<u64>, [false; 2]);
    // When each switch went off.
    let mut off = [None; 2];
    for (at, gates) in changes {
        for (switch, gate) in [leg, leg + 3].into_iter().enumerate() {
            let on = is_on(gates[gate]);
            if was_on[switch] && !on {
                off[switch] = Some(*at);
            }
            if on
                && !was_on[switch]
                && let Some(other) = off[1 - switch]
            {
                let dead = at - other;
                shortest = Some(shortest.map_or(dead, |shortest| shortest.min(dead)));
            }
            was_on[switch] = on;
        }
    }
    shortest
}
