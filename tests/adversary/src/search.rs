//! The search: a scene is drawn and booted, runs are drawn, and the best are climbed.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use fixed::types::{I8F24, I12F20};
use haptic_servo::boot::{Booted, Program, boot};
use haptic_servo::environment::Environment;
use haptic_servo::number::Number;
use haptic_servo::scene::Scene;
use haptic_servo::servo::{
    AtPhase, Latched, OutputMode, PreparedServo, Servo, Simultaneous, SupportsTiming,
};
use haptic_servo::servo_loop::{Mailbox, Options};
use haptic_servo::tuning::Tunable;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::hardware::Board;
use crate::mode::Actual;
use crate::normalized_scene::NormalizedScene;
use crate::periodic_motion::least_energy;
use crate::plan::Plan;
use crate::run::{Control, Machine, Outcome};
use crate::scenes::{self, Choice, Mode, Numbers, RandomScene};

/// How long a search is, and what it draws.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// Where the random numbers begin.
    pub seed: u64,
    /// Scenes to draw.
    pub scenes: u64,
    /// The drawn scenes.
    pub choice: Choice,
    /// After so many counterexamples it ends.
    pub enough: usize,
    /// How thoroughly each scene is searched.
    pub effort: Effort,
}

/// How thoroughly a scene is searched.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Runs that are drawn.
    pub drawn: u32,
    /// Steps of the climb.
    pub climbed: u32,
    /// Periods of a run.
    pub periods: u32,
    /// Periods of what looks like a gain.
    pub long: u32,
}

impl Effort {
    /// Some milliseconds a scene.
    pub const USUAL: Self = Self { drawn: 16, climbed: 16, periods: 512, long: 8192 };
}

/// What a search found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Scenes that were drawn.
    pub scenes: u64,
    /// Those that boards accept.
    pub accepted: u64,
    /// Those of which no bound on the effect of their steps is known, so that nothing was run.
    pub unbounded: u64,
    /// Runs.
    pub runs: u64,
    /// Periods of all of them.
    pub ticks: u64,
    /// The largest height of any run; see [`Outcome::score`].
    pub largest: f64,
    /// The largest rate of any run; see [`Outcome::rate`].
    pub rate: f64,
    /// Runs that refute a certificate.
    pub counterexamples: Vec<Counterexample>,
    /// Certified scenes that give energy away in a periodic motion.
    pub motions: Vec<PeriodicMotion>,
}

/// A linear scene that gives energy away in a periodic motion.
#[derive(Clone, Debug)]
pub struct PeriodicMotion {
    /// The scene's number in the search.
    pub number: u64,
    /// What was drawn.
    pub drawn: RandomScene,
    /// See [`least_energy`].
    pub energy: f64,
}

/// A run in which a certified scene gave energy away, with all that it takes to find it again.
#[derive(Clone, Debug)]
pub struct Counterexample {
    /// The search's seed.
    pub seed: u64,
    /// The scene's number in it.
    pub number: u64,
    /// What was drawn.
    pub drawn: RandomScene,
    /// The same as numbers.
    pub normalized: NormalizedScene,
    /// The run.
    pub plan: Plan,
    /// What became of it.
    pub outcome: Outcome,
}

impl std::fmt::Display for Counterexample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { seed, number, outcome, .. } = self;
        let gain = outcome.gained - outcome.allowed;
        write!(f, "ADVERSARY_SEED={seed}, scene {number}: {gain:.3e} above the allowance: {self:?}")
    }
}

impl Found {
    /// No scene, below any height and rate.
    fn nothing() -> Self {
        Self { largest: -1.0, rate: -1.0, ..Self::default() }
    }

    fn add(&mut self, other: Self) {
        self.scenes += other.scenes;
        self.accepted += other.accepted;
        self.unbounded += other.unbounded;
        self.runs += other.runs;
        self.ticks += other.ticks;
        self.largest = self.largest.max(other.largest);
        self.rate = self.rate.max(other.rate);
        self.counterexamples.extend(other.counterexamples);
        self.motions.extend(other.motions);
    }

    /// The scenes that give energy away.
    pub fn refuted(&self) -> usize {
        self.counterexamples.len() + self.motions.len()
    }
}

impl std::fmt::Display for Found {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { scenes, accepted, unbounded, runs, ticks, largest, rate, .. } = self;
        write!(
            f,
            "scenes={scenes} accepted={accepted} unbounded={unbounded} runs={runs} ticks={ticks} \
             largest_score={largest:.3e} largest_rate={rate:.3e}"
        )
    }
}

/// Why there is nothing to search.
enum Unjudged {
    /// A board refuses the scene.
    Refused,
    /// No bound is known on the torque error of encoder, numbers and DAC.
    Unbounded,
}

/// Boots the drawn scene of a search as a board does, and searches.
fn booted(climb: Climb<'_>) -> Result<Found, Unjudged> {
    match (climb.drawn.format, climb.drawn.mode) {
        (Numbers::F32, Mode::AtPhase(phase)) => at_phase::<f32>(climb, phase),
        (Numbers::Q24, Mode::AtPhase(phase)) => at_phase::<I8F24>(climb, phase),
        (_, Mode::AtPhase(_)) => Err(Unjudged::Refused),
        (Numbers::F32, Mode::Latched) => on_board::<f32, Latched>(climb),
        (Numbers::F32, Mode::Simultaneous) => on_board::<f32, Simultaneous>(climb),
        (Numbers::F64, Mode::Latched) => on_board::<f64, Latched>(climb),
        (Numbers::F64, Mode::Simultaneous) => on_board::<f64, Simultaneous>(climb),
        (Numbers::Q24, Mode::Latched) => on_board::<I8F24, Latched>(climb),
        (Numbers::Q24, Mode::Simultaneous) => on_board::<I8F24, Simultaneous>(climb),
        (Numbers::Q20, Mode::Latched) => on_board::<I12F20, Latched>(climb),
        (Numbers::Q20, Mode::Simultaneous) => on_board::<I12F20, Simultaneous>(climb),
        (Numbers::F32, Mode::Bare) => alone::<f32>(climb),
        (Numbers::F64, Mode::Bare) => alone::<f64>(climb),
        (Numbers::Q24, Mode::Bare) => alone::<I8F24>(climb),
        (Numbers::Q20, Mode::Bare) => alone::<I12F20>(climb),
    }
}

/// A board's type has its phase.
fn at_phase<N: Number>(climb: Climb<'_>, phase: u32) -> Result<Found, Unjudged>
where
    Environment: Tunable<N>,
{
    const PHASES: [u32; 3] = Mode::PHASES;
    match phase {
        phase if phase == PHASES[0] => on_board::<N, AtPhase<{ PHASES[0] }>>(climb),
        phase if phase == PHASES[1] => on_board::<N, AtPhase<{ PHASES[1] }>>(climb),
        phase if phase == PHASES[2] => on_board::<N, AtPhase<{ PHASES[2] }>>(climb),
        _ => Err(Unjudged::Refused),
    }
}

/// The servo alone.
fn alone<N: Number>(climb: Climb<'_>) -> Result<Found, Unjudged>
where
    Environment: Tunable<N>,
{
    let drawn = climb.drawn;
    if !scenes::passes(&drawn.scene, N::FORMAT) {
        return Err(Unjudged::Refused);
    }
    let certified = drawn.scene.certify_in(N::FORMAT).map_err(|_| Unjudged::Refused)?;
    let servo = Servo::<_, N>::new(&certified, &drawn.transducers);
    let servo = servo.map_err(|_| Unjudged::Refused)?;
    let mut drawn = drawn.clone();
    (drawn.other, drawn.rendering.injection) = (None, None);
    let normalized = NormalizedScene::of(&drawn, &[*certified.assessment()], N::FORMAT);
    let normalized = normalized.ok_or(Unjudged::Unbounded)?;
    let machine = Machine::<N, Simultaneous>::new(Control::Bare(servo), Vec::new());
    Ok(climb.through(&machine, normalized))
}

fn on_board<N: Number, M: OutputMode>(climb: Climb<'_>) -> Result<Found, Unjudged>
where
    Environment: Tunable<N> + SupportsTiming<M>,
{
    let mut drawn = climb.drawn.clone();
    // Refused scenes are looked at for remedies, which takes a while.
    if !scenes::passes(&drawn.scene, N::FORMAT) {
        return Err(Unjudged::Refused);
    }
    if let Some(share) = drawn.injected {
        let timed = drawn.scene.certify_in(N::FORMAT).ok().and_then(|scene| scene.time::<M>().ok());
        drawn.rendering.injection = timed.map(|timed| timed.injectable_damping() * share);
    }
    let set = |scene: &Scene| {
        let certified = scene.certify_in(N::FORMAT).ok()?;
        let assessment = *certified.assessment();
        let timed = certified.time::<M>().ok()?;
        let set =
            PreparedServo::<_, N, M>::new(&timed, &drawn.transducers, &drawn.rendering).ok()?;
        Some((set, assessment))
    };
    let own = set(&drawn.scene).ok_or(Unjudged::Refused)?;
    let other = drawn.other.as_ref().and_then(set);
    let (sets, assessments): (Vec<_>, Vec<_>) = std::iter::once(own).chain(other).unzip();
    drawn.other = drawn.other.filter(|_| sets.len() > 1);
    let drawn = &drawn;
    let normalized =
        NormalizedScene::of(drawn, &assessments, N::FORMAT).ok_or(Unjudged::Unbounded)?;
    let program = Program {
        scene: drawn.scene,
        transducers: drawn.transducers,
        rendering: drawn.rendering,
        options: Options::DEFAULT,
    };
    let mut board = Board::new(normalized.counts_per_radian, true);
    let mut mailbox = Mailbox::new();
    let (requests, _inbox) = mailbox.split();
    let Booted { servo_loop, .. } =
        boot::<_, N, M>(&program, &mut board, &requests).map_err(|_| Unjudged::Refused)?;
    let machine = Machine::new(Control::Board(servo_loop), sets);
    Ok(climb.through(&machine, normalized))
}

/// Energy that rounding may leave, over that of the device alone.
const ROUNDING: f64 = 1e-6;

/// A periodic motion of the scene as it is in which it gives energy away.
fn periodic_motion(number: u64, drawn: &RandomScene) -> Option<PeriodicMotion> {
    let Actual { latency, passivity, .. } = drawn.actual;
    let latency = latency.unwrap_or(drawn.scene.latency);
    let passivity = passivity.unwrap_or(drawn.scene.device.passivity());
    let energy = least_energy(&drawn.scene, drawn.format.format(), &latency, passivity)?;
    (energy < -ROUNDING).then(|| PeriodicMotion { number, drawn: drawn.clone(), energy })
}

/// A rate from which a run is worth to be gone on with.
const SURE: f64 = 1e-5;

/// A search through the runs of one scene.
struct Climb<'a> {
    search: &'a Search,
    number: u64,
    drawn: &'a RandomScene,
    rng: ChaCha8Rng,
}

impl Climb<'_> {
    /// Searches through the runs of a servo in whatever number format and mode.
    fn through<N: Number, M: OutputMode>(
        mut self,
        machine: &Machine<N, M>,
        normalized: NormalizedScene,
    ) -> Found
    where
        Environment: Tunable<N> + SupportsTiming<M>,
    {
        let effort = self.search.effort;
        let mut found = Found { accepted: 1, ..Found::nothing() };
        let rng = &mut self.rng;
        let run = |found: &mut Found, plan: &Plan, audited: bool| -> Outcome {
            let outcome = machine.run(&normalized, plan, audited);
            found.runs += 1;
            found.ticks += u64::from(outcome.periods);
            outcome
        };
        let mut best: Option<(Plan, Outcome)> = None;
        let consider = |found: &mut Found, plan: Plan, best: &mut Option<(Plan, Outcome)>| {
            let mut plan = plan;
            let mut outcome = run(found, &plan, false);
            // A gain that does not show yet shows after a while, if it is one and not what the
            // clamp's opening put in.
            for periods in [effort.long, 8 * effort.long] {
                if !outcome.is_violation() && outcome.rate > SURE {
                    plan.periods = periods;
                    outcome = run(found, &plan, false);
                }
            }
            let better = best.as_ref().is_none_or(|(_, b)| outcome.objective() > b.objective());
            if outcome.is_violation() {
                let mut audit = run(found, &plan, true);
                // What the simulation itself makes is no gain.
                let over = audit.gained - audit.allowed - 4.0 * audit.residual;
                if audit.went_on || over > 0.0 {
                    audit.score = audit.score.max(f64::MIN_POSITIVE);
                    *best = Some((plan, audit));
                    return true;
                }
                return false;
            }
            if better {
                *best = Some((plan, outcome));
            }
            false
        };
        let mut is_refuted = false;
        // Patterns of jitter are drawn with the hands.
        let jitters = normalized.timing.jitters[0] > 0.0;
        for _ in 0..effort.drawn * if jitters { 3 } else { 1 } {
            let plan = Plan::draw(rng, &normalized, effort.periods);
            is_refuted = consider(&mut found, plan, &mut best);
            if is_refuted {
                break;
            }
        }
        let mut spread = 0.5;
        for _ in 0..effort.climbed {
            let Some((plan, outcome)) = &best else { break };
            if is_refuted {
                break;
            }
            let before = outcome.objective();
            let mut plan = plan.varied(rng, &normalized, spread);
            plan.periods = effort.periods;
            is_refuted = consider(&mut found, plan, &mut best);
            let after = best.as_ref().map_or(before, |(_, o)| o.objective());
            spread =
                if after > before { (spread * 1.3).min(1.0) } else { (spread * 0.85).max(1e-3) };
        }
        if let Some((plan, outcome)) = best {
            found.largest = outcome.score;
            found.rate = outcome.rate;
            if is_refuted {
                found.counterexamples.push(Counterexample {
                    seed: self.search.seed,
                    number: self.number,
                    drawn: self.drawn.clone(),
                    normalized,
                    plan,
                    outcome,
                });
            }
        }
        found
    }
}

impl Search {
    /// A search of the scenes of a seed until the first counterexample.
    pub fn of(seed: u64) -> Self {
        Self { seed, scenes: 5000, choice: Choice::ANY, enough: 1, effort: Effort::USUAL }
    }

    /// A scene of this search, by number.
    pub fn scene(&self, number: u64) -> Found {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(number);
        let Some(drawn) = scenes::draw(&mut rng, &self.choice) else {
            return Found { scenes: 1, ..Found::nothing() };
        };
        // What a planted rule does not judge is the same scene of the search without it.
        if self.choice.planted.is_some() && drawn.actual == Actual::default() {
            return Found { scenes: 1, ..Found::nothing() };
        }
        let mut found = self.climb(number, &drawn, rng);
        if found.accepted > 0 && drawn.mode == Mode::Bare {
            found.motions.extend(periodic_motion(number, &drawn));
        }
        found
    }

    /// Searches through the runs of a scene.
    pub fn climb(&self, number: u64, drawn: &RandomScene, rng: ChaCha8Rng) -> Found {
        let nothing = Found::nothing();
        match booted(Climb { search: self, number, drawn, rng }) {
            Ok(found) => Found { scenes: 1, ..found },
            Err(Unjudged::Refused) => Found { scenes: 1, ..nothing },
            Err(Unjudged::Unbounded) => Found { scenes: 1, unbounded: 1, ..nothing },
        }
    }

    /// The whole search, on two threads.
    pub fn run(&self) -> Found {
        let next = AtomicU64::new(0);
        let all = Mutex::new(Found::nothing());
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    let mut found = Found::nothing();
                    loop {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= self.scenes || found.refuted() >= self.enough {
                            break;
                        }
                        found.add(self.scene(number));
                        if found.refuted() > 0 {
                            // So that both threads stop when there are enough together.
                            let mut all = all.lock().expect("no thread panics");
                            all.counterexamples.append(&mut found.counterexamples);
                            all.motions.append(&mut found.motions);
                            if all.refuted() >= self.enough {
                                next.store(self.scenes, Ordering::Relaxed);
                            }
                        }
                    }
                    all.lock().expect("no thread panics").add(found);
                });
            }
        });
        all.into_inner().expect("no thread panics")
    }
}
