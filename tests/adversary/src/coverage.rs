//! How often a search draws each kind of scene and of run.

use std::collections::BTreeMap;
use std::fmt;

use haptic_servo::environment::Wall;
use haptic_servo::scene::Coupling;

use crate::plan::{Pattern, Plan, Request, Signs, TickTiming};
use crate::scenes::RandomScene;

/// Scenes that boards or servos accept and their runs, by what they have.
#[derive(Clone, Debug, Default)]
pub struct Coverage {
    scenes: BTreeMap<String, u64>,
    runs: BTreeMap<String, u64>,
}

impl Coverage {
    /// How many scenes have this.
    pub fn scenes(&self, what: &str) -> u64 {
        self.scenes.get(what).copied().unwrap_or(0)
    }

    /// How many runs have this.
    pub fn runs(&self, what: &str) -> u64 {
        self.runs.get(what).copied().unwrap_or(0)
    }

    /// Adds those of another search.
    pub fn add(&mut self, other: &Self) {
        for (all, more) in [(&mut self.scenes, &other.scenes), (&mut self.runs, &other.runs)] {
            for (what, count) in more {
                *all.entry(what.clone()).or_default() += count;
            }
        }
    }

    /// Counts a scene.
    pub fn scene(&mut self, drawn: &RandomScene) {
        let mut count = |what: String| *self.scenes.entry(what).or_default() += 1;
        let (scene, latency) = (&drawn.scene, &drawn.scene.latency);
        count(format!("kind: {}", drawn.kind));
        count(format!("numbers: {:?}", drawn.format));
        count(format!("mode: {}", drawn.mode.name()));
        count(format!(
            "coupling: {}",
            match scene.coupling {
                Coupling::Rigid => "rigid",
                Coupling::Spring { .. } => "spring",
                Coupling::Matched => "matched",
            }
        ));
        let ranges = [latency.output_delay, latency.actuator_lag, latency.sensor_lag];
        let (wall, profile) = (scene.environment.wall(), scene.environment.profile());
        let has = [
            ("latency: none", latency.is_none()),
            ("latency: output delay", !latency.output_delay.is_zero()),
            ("latency: jitter", latency.total_jitter() > 0.0),
            ("latency: two jitters", latency.jitters_twice()),
            ("latency: actuator lag", !latency.actuator_lag.is_zero()),
            ("latency: sensor lag", !latency.sensor_lag.is_zero()),
            ("latency: updates within the period", latency.actuator_updates > 0),
            ("latency: step response", !latency.actuator_response.is_zero()),
            ("latency: a range", ranges.iter().any(|range| !range.is_exact())),
            ("profile: with ends", profile.is_some_and(|p| p.ends.is_some())),
            ("profile: without ends", profile.is_some_and(|p| p.ends.is_none())),
            ("profile: snap", profile.is_some_and(|p| p.snap.is_some())),
            ("profile: mode", profile.is_some_and(|p| p.modes.is_some())),
            ("torque limit", scene.torque_limit.is_some()),
            ("worst period", scene.timing.worst_period.is_some()),
            ("one-sided wall", wall.is_some_and(Wall::is_one_sided)),
            ("wall without coupling", wall.is_some() && scene.coupling == Coupling::Rigid),
            ("other set", drawn.other.is_some()),
            ("injected damping", drawn.injected.is_some()),
        ];
        for (what, _) in has.into_iter().filter(|(_, has)| *has) {
            count(what.to_owned());
        }
    }

    /// Counts a run.
    pub fn run(&mut self, plan: &Plan) {
        let mut count = |what: String| *self.runs.entry(what).or_default() += 1;
        let (of, signs) = match (plan.jitter.torques, plan.jitter.counts) {
            (None, None) => ("none", None),
            (Some(signs), None) => ("torques", Some(signs)),
            (None, Some(signs)) => ("counts", Some(signs)),
            (Some(signs), Some(_)) => ("torques and counts", Some(signs)),
        };
        count(match signs {
            None => format!("jitter: {of}"),
            Some(Signs::Random { .. }) => format!("jitter: {of}, random"),
            Some(Signs::Periodic(_, length)) => format!("jitter: {of}, period {length}"),
        });
        let ticks = match &plan.pattern {
            Pattern::AllOnTime => &[][..],
            Pattern::Periodic(ticks, length) => &ticks[..*length],
            Pattern::Random { .. } => {
                count("ticks: random".to_owned());
                &[]
            }
        };
        for kind in [TickTiming::Missed, TickTiming::Late, TickTiming::Delayed] {
            if ticks.contains(&kind) {
                count(format!("ticks: {kind:?}"));
            }
        }
        let asks = |is: &dyn Fn(&Request) -> bool| {
            plan.requests.iter().flatten().any(|(_, request)| is(request))
        };
        if asks(&|request| matches!(request, Request::Submit(_))) {
            count("request: swap".to_owned());
        }
        if plan.heats {
            count("heat".to_owned());
        }
        if asks(&|request| *request == Request::Disarm) {
            count("request: disarm".to_owned());
        }
        count(format!("hand: {} masses", 1 + plan.hand.segments.len()));
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (title, all) in [("scenes", &self.scenes), ("runs", &self.runs)] {
            writeln!(f, "{title}")?;
            for (what, count) in all {
                writeln!(f, "  {what:<40} {count:>9}")?;
            }
        }
        Ok(())
    }
}
