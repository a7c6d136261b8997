//! The search finds a fault where there is one.

use adversary::scenes::{Choice, Kind, Mode, Numbers, RandomScene};
use adversary::search::{Effort, Search};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::refuted_scenes::{self, RefutedScene};

/// A device with a twentieth less damping than its scene needs, by the certificate's own account,
/// gives energy away: the certificate does not ask for more than it must.
#[test]
fn a_device_with_less_damping_than_its_scene_needs_gives_energy_away() {
    // Of how many scenes at least it finds that, in a hundred: the hand that takes the least is
    // harder to find the more poles there are.
    let kinds =
        [(Kind::Wall, 20), (Kind::FreeMode, 10), (Kind::FreeModeWall, 15), (Kind::Rational, 2)];
    for (kind, percent) in kinds {
        let search = Search {
            scenes: 400,
            choice: Choice {
                kind: Some(kind),
                worst_period: Some(false),
                latency: Some(false),
                // No board renders a rational environment.
                bare: Some(kind == Kind::Rational),
                weakened: Some(0.95),
                ..Choice::ANY
            },
            enough: usize::MAX,
            ..Search::of(2)
        };
        let found = search.run();
        println!("{kind:?}: {found} counterexamples={}", found.counterexamples.len());
        assert!(found.accepted > 0, "{kind:?}");
        assert!(found.counterexamples.len() as u64 * 100 >= found.accepted * percent, "{kind:?}");
    }
}

/// What becomes of a scene that shook once: refused, or not to be shaken.
fn judge(
    (_, scene, judged_as): RefutedScene,
    format: Numbers,
    mode: Mode,
    effort: Effort,
) -> Result<&'static str, String> {
    let search = Search { effort, ..Search::of(3) };
    // Against the torque of a DAC that saturates rarely, sometimes and nearly always.
    for full_scale in [4.0, 1.0, 20.0] {
        let mut drawn = RandomScene::of(Kind::Wall, scene, format, mode, 0.1);
        drawn.judged_as = judged_as;
        if scene.torque_limit.is_none() {
            drawn.transducers.full_scale_torque *= 0.25 * full_scale;
        }
        let found = search.climb(0, &drawn, ChaCha8Rng::seed_from_u64(search.seed));
        match (found.accepted, found.counterexamples.first()) {
            (0, _) if found.unbounded > 0 => return Err("cannot be judged".to_owned()),
            (0, _) => return Ok("refused"),
            (_, None) => {}
            (_, Some(counterexample)) => return Err(counterexample.to_string()),
        }
    }
    Ok("comes to rest")
}

#[test]
fn scenes_that_shook_once_are_refused_or_come_to_rest() {
    shake_all(Effort::USUAL);
}

#[test]
#[ignore = "searches for minutes"]
fn scenes_that_shook_once_come_to_rest_in_many_hands() {
    shake_all(Effort { drawn: 200, climbed: 200, ..Effort::USUAL });
}

fn shake_all(effort: Effort) {
    let mut shook = Vec::new();
    for refuted in refuted_scenes::all() {
        let name = refuted.0;
        for format in [Numbers::F32, Numbers::F64, Numbers::Q24] {
            for mode in [Mode::Simultaneous, Mode::Latched, Mode::Bare] {
                let judged = judge(refuted, format, mode, effort);
                let text = judged.as_ref().map_or("SHAKES", |text| text);
                println!("{name}, {format:?}, {mode:?}: {text}");
                shook.extend(judged.err().map(|why| format!("{name}: {why}")));
            }
        }
    }
    assert!(shook.is_empty(), "{} of them shake:\n{}", shook.len(), shook.join("\n\n"));
}
