//! Searches among some scenes only: `hunt name=value ...`.
//!
//! Of the search: `seed`, `scenes`, `enough`, or one scene's `number`. Of the drawn scenes: `kind`,
//! `worst_period`, `limited`, `latched`, `saturates`, `injected`, `overrun`, `latency`,
//! `bare`, or `planted` for a wrong rule. Of the device: `taken`,
//! `bisected`, `weakened`. Of the effort: `drawn`, `climbed`, `periods`, `long`. `full=false` prints two
//! lines each; `coverage=true` prints what was drawn.

use adversary::planted::Planted;
use adversary::scenes::{Choice, Kind};
use adversary::search::{Effort, Search};

fn main() {
    let mut search = Search {
        seed: 1,
        scenes: 1000,
        time: None,
        choice: Choice::ANY,
        enough: 5,
        effort: Effort::USUAL,
    };
    let (mut full, mut number, mut coverage) = (true, None, false);
    for argument in std::env::args().skip(1) {
        let (name, value) = argument.split_once('=').expect("name=value");
        let whole = || value.parse::<u64>().expect("a whole number");
        let yes = || Some(value.parse::<bool>().expect("true or false"));
        match name {
            "seed" => search.seed = whole(),
            "number" => number = Some(whole()),
            "scenes" => search.scenes = whole(),
            "enough" => search.enough = usize::try_from(whole()).expect("a small number"),
            "kind" => {
                let kind = Kind::ALL.into_iter().find(|kind| kind.to_string() == value);
                search.choice.kind = Some(kind.expect("a kind"));
            }
            "worst_period" => search.choice.worst_period = yes(),
            "limited" => search.choice.limited = yes(),
            "latched" => search.choice.latched = yes(),
            "taken" => search.choice.taken = value.parse().expect("a number"),
            "bisected" => search.choice.bisected = value.parse().expect("true or false"),
            "weakened" => search.choice.weakened = Some(value.parse().expect("a number")),
            "drawn" => search.effort.drawn = whole() as u32,
            "climbed" => search.effort.climbed = whole() as u32,
            "periods" => search.effort.periods = whole() as u32,
            "long" => search.effort.long = whole() as u32,
            "injected" => search.choice.injected = yes(),
            "latency" => search.choice.latency = yes(),
            "bare" => search.choice.bare = yes(),
            "planted" => {
                let of = |planted: &Planted| format!("{planted:?}") == value;
                let planted = Planted::ALL.into_iter().find(of).expect("a planted rule");
                search.choice.planted = Some(planted);
            }
            "coverage" => coverage = value.parse().expect("true or false"),
            "overrun" => search.choice.overrun = value.parse().expect("a number"),
            "saturates" => search.choice.saturates = value.parse().expect("true or false"),
            "full" => full = value.parse().expect("true or false"),
            _ => panic!("no such setting: {name}"),
        }
    }
    let began = std::time::Instant::now();
    let found = number.map_or_else(|| search.run(), |number| search.scene(number));
    let seconds = began.elapsed().as_secs_f64();
    println!("{found}");
    println!(
        "{:.1} s, {:.2} million ticks/s, {:.2} ms of a core a scene",
        seconds,
        found.ticks as f64 / seconds / 1e6,
        2e3 * seconds / found.scenes as f64
    );
    if coverage {
        println!("{}", found.coverage);
    }
    for motion in &found.motions {
        println!(
            "scene {}, {}, periodic motion: energy {}",
            motion.number, motion.drawn.kind, motion.energy
        );
    }
    for counterexample in &found.counterexamples {
        let text = counterexample.to_string();
        if full {
            println!("{text}\n");
        } else {
            text.lines().take(2).for_each(|line| println!("{line}"));
        }
    }
}
