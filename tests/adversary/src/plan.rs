//! The plan of a run: the hand and where it starts, the timing of the ticks, and the requests to the
//! servo.

use std::f64::consts::{PI, TAU};

use rand::Rng;
use tests::hands::{Hand, Segment};
use tests::scenes::log_uniform;

use crate::device::State;
use crate::normalized_scene::NormalizedScene;
use crate::timing::LoopTiming;

/// Timing of the tick of one period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TickTiming {
    /// It is in time.
    OnTime,
    /// The interrupt does not run.
    Missed,
    /// Its code comes after the update that it was for.
    Late,
    /// It begins late in its period, and so reads a later count.
    Delayed,
}

/// The ticks that come, over and over.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// All in time.
    AllOnTime,
    /// These, again and again.
    Periodic(Vec<TickTiming>),
    /// By chance, each with a probability, and never more in a row than so many.
    Random {
        /// Where the numbers begin.
        seed: u64,
        /// Share of missed ticks, in 256ths.
        missed: u8,
        /// Share of late ticks, in 256ths.
        late: u8,
        /// Most in a row.
        most: u32,
    },
}

impl Pattern {
    /// Longest periodic pattern.
    pub const LONGEST: usize = 6;

    /// Whether it has delayed ticks.
    pub fn delays(&self) -> bool {
        matches!(self, Self::Periodic(ticks) if ticks.contains(&TickTiming::Delayed))
    }

    /// A plan that misses at most `most` updates in a row, if that is not zero; with late codes where they
    /// are latched.
    pub fn draw(rng: &mut impl Rng, most: u32, normalized: &NormalizedScene) -> Self {
        let NormalizedScene { latched, unreported, .. } = *normalized;
        let most = if unreported { most.max(1) } else { most };
        let latched = latched || unreported;
        let only_delays = most == 0 && latched && rng.random_bool(0.3);
        if !only_delays && (most == 0 || rng.random_bool(0.15)) {
            return Self::AllOnTime;
        }
        if most > 0 && rng.random_bool(0.3) {
            let missed = rng.random_range(0..=200);
            let late = if latched { rng.random_range(0..=200) } else { 0 };
            return Self::Random { seed: rng.random::<u64>() | 1, missed, late, most };
        }
        let length = rng.random_range(2..=Self::LONGEST);
        let mut ticks = vec![TickTiming::OnTime; length];
        let mut in_a_row = 0;
        let kind = match (only_delays, latched) {
            (true, _) => 3,
            (_, true) => rng.random_range(0..5),
            _ => 0,
        };
        let (late, delayed) = (kind == 1 || kind == 2, kind > 2);
        for tick in ticks.iter_mut().take(length - 1) {
            if in_a_row < most && rng.random_bool(0.6) {
                in_a_row += 1;
                let is_late = late && (kind == 1 || rng.random_bool(0.5));
                *tick = if is_late { TickTiming::Late } else { TickTiming::Missed };
            } else {
                in_a_row = 0;
                *tick = if delayed && rng.random_bool(0.6) {
                    TickTiming::Delayed
                } else {
                    TickTiming::OnTime
                };
            }
        }
        Self::Periodic(ticks)
    }
}

/// How the times of torques and counts deviate from tick to tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Jitter {
    /// Those of the torques.
    pub torques: Option<Signs>,
    /// Those of the counts.
    pub counts: Option<Signs>,
}

/// Deviations in units of the largest one.
#[derive(Clone, Debug, PartialEq)]
pub enum Signs {
    /// These, again and again.
    Periodic(Vec<i8>),
    /// By chance.
    Random {
        /// Where the numbers begin.
        seed: u64,
    },
}

impl Signs {
    fn draw(rng: &mut impl Rng) -> Self {
        if rng.random_bool(0.15) {
            return Self::Random { seed: rng.random::<u64>() | 1 };
        }
        let length = [2, 2, 3, 3, 4][rng.random_range(0..5)];
        let mut signs = vec![1; length];
        loop {
            for sign in &mut signs {
                *sign = if rng.random_bool(0.5) { 1 } else { -1 };
            }
            // A constant deviation is a delay, which is the mildest pattern; now and then it is drawn.
            if signs.iter().any(|sign| *sign != signs[0]) || rng.random_bool(0.1) {
                return Self::Periodic(signs);
            }
        }
    }

    /// Signs of the counts beside these of the torques: often the same, so that ticks are long and short.
    fn beside(&self, rng: &mut impl Rng) -> Self {
        match (self, rng.random_range(0..5)) {
            (signs, 0..=2) => signs.clone(),
            (Self::Periodic(signs), 3) => Self::Periodic(signs.iter().map(|sign| -sign).collect()),
            (Self::Periodic(signs), _) => {
                let others = [0; 4].map(|_| if rng.random_bool(0.5) { 1 } else { -1 });
                Self::Periodic(others[..signs.len()].to_vec())
            }
            _ => Self::draw(rng),
        }
    }
}

/// Jitter of counts, in periods, from which two counts could change places.
const LARGEST_OF_COUNTS: f64 = 0.45;

impl Jitter {
    fn draw(rng: &mut impl Rng, timing: &LoopTiming) -> Self {
        let LoopTiming { jitters: [of_torques, of_counts], both, updates, .. } = *timing;
        if of_torques == 0.0 || rng.random_bool(0.1) {
            return Self::default();
        }
        let signs = Signs::draw(rng);
        // An amplifier that is updated takes a torque over at an update, whatever its jitter.
        let torques = (updates == 0).then(|| signs.clone());
        if both {
            return Self { torques, counts: Some(signs.beside(rng)) };
        }
        let counts = of_counts < LARGEST_OF_COUNTS && (updates > 0 || rng.random_bool(0.35));
        if counts {
            Self { torques: None, counts: Some(signs) }
        } else {
            Self { torques: Some(signs), counts: None }
        }
    }
}

/// The readings of an encoder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// Waves of its error in a turn, and in rad the amplitude and the phase of that.
    pub waves: [f64; 3],
    /// The readings that are dropped: where this is above zero.
    pub dropped: Option<Signs>,
    /// Peak of its noise in rad, and the signs of that.
    pub noise: (f64, Option<Signs>),
}

/// Places of a rule of Gauss in a step, and their weights.
const NODES: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_87, 0.326_072_577_431_273_07],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_07],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];

impl Readings {
    fn draw(rng: &mut impl Rng, normalized: &NormalizedScene) -> Self {
        let mut readings = Self::default();
        if normalized.linearity > 0.0 {
            // A step through a filter is a small part of a wave.
            let counts = if normalized.filters_errors() { 4 } else { 6 };
            let count = f64::from([1, 1, 2, 7, 50, 400][rng.random_range(0..counts)]);
            readings.waves = [count, normalized.linearity / count, rng.random_range(0.0..TAU)];
        }
        if normalized.dropped > 0 && rng.random_bool(0.8) {
            readings.dropped = Some(Signs::draw(rng));
        }
        if normalized.noise > 0.0 && rng.random_bool(0.9) {
            readings.noise = (normalized.noise, Some(Signs::draw(rng)));
        }
        readings
    }

    /// The error of the angle that it reads from an angle, in rad.
    pub fn error(&self, angle: f64) -> f64 {
        let [count, amplitude, phase] = self.waves;
        amplitude * (count * angle + phase).sin()
    }

    /// The error behind a filter of this time constant in periods, which was `error`, after so much of a period from one
    /// position and velocity to another, with a cubic path in between.
    pub fn filtered(&self, error: f64, [from, to]: [[f64; 2]; 2], part: f64, lag: f64) -> f64 {
        let left = (-part / lag).exp();
        let (mut sum, mut weights) = (0.0, 0.0);
        for [at, weight] in NODES {
            let (back, weight) = (1.0 - at, weight * ((at - 1.0) * part / lag).exp());
            let [near, far] = [(from, at, part), (to, back, -part)].map(|([x, v], at, part)| {
                let rest = (1.0 - at) * (1.0 - at);
                x * (1.0 + 2.0 * at) * rest + v * part * at * rest
            });
            sum += weight * self.error(near + far);
            weights += weight;
        }
        // What rests behind an error is that error.
        error * left + sum / weights * (1.0 - left)
    }
}

/// A request to the servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// To be armed.
    Arm,
    /// To be disarmed.
    Disarm,
    /// To swap a set in: the scene's own, or its other one.
    Submit(usize),
}

/// Requests in a run at most.
pub const REQUESTS: usize = 6;

/// A run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The hand, with the device's inertia in it, in the loop's units.
    pub hand: Hand,
    /// Angle of the device in rad when the board boots, whose zero that is.
    pub zero: f64,
    /// Where device and hand start.
    pub start: State,
    /// Whether the servo is armed from its first tick, as one may be at power-on; otherwise a request
    /// does it, some ticks later.
    pub armed_by_boot: bool,
    /// What happens to the ticks.
    pub pattern: Pattern,
    /// The part of a period by which a delayed tick begins late.
    pub delay: f64,
    /// The times that deviate.
    pub jitter: Jitter,
    /// The readings of the encoder.
    pub readings: Readings,
    /// Where in their ranges the delay and the lags are, from 0 to 1.
    pub within: [f64; 2],
    /// The request and its period.
    pub requests: [Option<(u32, Request)>; REQUESTS],
    /// Whether the torque's limit falls by the heat of the board's current.
    pub heats: bool,
    /// Whether the servo is armed again after each fault.
    pub again: bool,
    /// Periods.
    pub periods: u32,
}

/// Numbers of a hand, for the loop's arithmetic: what a simulation follows exactly enough.
const LIGHTEST: f64 = 1e-3;
const HEAVIEST: f64 = 3e3;
const STIFFEST: f64 = 1e2;

/// Least inertia, and largest rates squared and rates in a period, of a hand in which an error is filtered.
const SLOWLY: [f64; 3] = [0.1, 64.0, 10.0];

fn bounded(mut hand: Hand, normalized: &NormalizedScene) -> Hand {
    hand.segments.truncate(normalized.segments);
    if normalized.filters_errors() {
        let [lightest, stiffest, most] = SLOWLY;
        let slow = |inertia: f64, stiffness: &mut f64, damping: &mut f64| {
            *stiffness = stiffness.min(stiffest * inertia);
            *damping = damping.min(most * inertia);
        };
        hand.inertia = hand.inertia.max(lightest);
        slow(hand.inertia, &mut hand.stiffness, &mut hand.damping);
        for segment in &mut hand.segments {
            segment.inertia = segment.inertia.max(lightest);
            let least = segment.inertia.min(hand.inertia);
            slow(segment.inertia, &mut segment.stiffness, &mut segment.damping);
            slow(least, &mut segment.link_stiffness, &mut segment.link_damping);
        }
    }
    hand.inertia = hand.inertia.clamp(LIGHTEST, HEAVIEST);
    hand.stiffness = hand.stiffness.min(STIFFEST);
    for segment in &mut hand.segments {
        segment.inertia = segment.inertia.clamp(LIGHTEST, HEAVIEST);
        segment.stiffness = segment.stiffness.min(STIFFEST);
        segment.link_stiffness = segment.link_stiffness.min(STIFFEST);
    }
    hand
}

impl Plan {
    /// A plan for a subject.
    pub fn draw(rng: &mut impl Rng, normalized: &NormalizedScene, periods: u32) -> Self {
        let mut hand = bounded(Self::hand(rng, normalized), normalized);
        // A limit cycle must deliver power: a damper in the hand absorbs it for ever.
        if hand.damping == 0.0 && rng.random_bool(0.7) {
            hand.damping = log_uniform(rng, 1e-5, 1e-2);
        }
        let mut start = [0.0; 8];
        // Small motions grow although a limit ends large ones.
        let largest = if rng.random_bool(0.5) { normalized.bound } else { f64::INFINITY };
        let size = normalized.size.min(0.3 * largest) * log_uniform(rng, 0.1, 3.0);
        for i in 0..=hand.segments.len() {
            start[2 * i] = size * rng.random_range(-1.0..1.0);
            start[2 * i + 1] = size * rng.random_range(-1.0..1.0);
        }
        let armed_by_boot = normalized.bare || rng.random_bool(0.5);
        let zero = if armed_by_boot { start[0] } else { normalized.place(rng) };
        let most = match rng.random_range(0..10) {
            0 if !normalized.bare => normalized.tolerated + rng.random_range(1..=3),
            _ => normalized.tolerated,
        };
        let mut plan = Self {
            hand,
            zero,
            start,
            armed_by_boot,
            pattern: Pattern::draw(rng, most, normalized),
            delay: Self::delay(rng, normalized),
            jitter: Jitter::draw(rng, &normalized.timing),
            readings: Readings::draw(rng, normalized),
            within: [Self::place_in_range(rng), Self::place_in_range(rng)],
            requests: [None; REQUESTS],
            heats: rng.random_bool(0.3),
            again: rng.random_bool(0.7),
            periods,
        };
        plan.separate(normalized);
        plan.draw_requests(rng, normalized);
        plan
    }

    /// Torques and counts deviate at the same time only where the scene says so: a count that is read late
    /// deviates, too.
    fn separate(&mut self, normalized: &NormalizedScene) {
        if self.pattern.delays() && !normalized.timing.both {
            self.jitter = Jitter::default();
        }
    }

    fn place_in_range(rng: &mut impl Rng) -> f64 {
        match rng.random_range(0..3) {
            0 => 0.0,
            1 => 1.0,
            _ => rng.random_range(0.0..1.0),
        }
    }

    /// The period of the next request from a period on.
    pub fn next_request(&self, from: u32) -> u32 {
        let periods = self.requests.iter().flatten().map(|(period, _)| *period);
        periods.filter(|period| *period >= from).min().unwrap_or(u32::MAX)
    }

    /// Later than what counts as in time, or nearly as late as that is.
    fn delay(rng: &mut impl Rng, normalized: &NormalizedScene) -> f64 {
        let latest = normalized.latest.min(0.55);
        if latest > 0.04 && rng.random_bool(0.5) {
            rng.random_range(0.04..latest)
        } else {
            normalized.in_time * rng.random_range(0.9..1.0)
        }
    }

    fn hand(rng: &mut impl Rng, normalized: &NormalizedScene) -> Hand {
        if normalized.timing.jitters[0] > 0.0 && rng.random_bool(0.25) {
            return Self::light(rng);
        }
        match rng.random_range(0..8) {
            0 => Hand::draw(rng),
            1 => Self::clamp(rng),
            2..=3 => {
                let theta = rng.random_range(0.02..PI);
                Hand::tuned(rng, theta)
            }
            4 => {
                let theta = log_uniform(rng, 5e-3, PI);
                Hand::tuned(rng, theta)
            }
            _ => {
                let theta = normalized.angles[rng.random_range(0..normalized.angles.len())];
                Hand::tuned(rng, theta)
            }
        }
    }

    /// A hand that holds the device fast: coupling and environment may oscillate behind it by themselves, and its
    /// damper takes what they deliver.
    fn clamp(rng: &mut impl Rng) -> Hand {
        Hand {
            inertia: log_uniform(rng, 1e-3, 1.0),
            damping: log_uniform(rng, 1e-3, 1e1),
            stiffness: log_uniform(rng, 0.5, STIFFEST),
            ..Hand::NONE
        }
    }

    /// A light device, with a light absorber tuned to nearly half of the sampling rate or without one: all that is left
    /// of its motion is even within each tick, however long that is.
    fn light(rng: &mut impl Rng) -> Hand {
        let theta = PI * rng.random_range(0.8..1.0);
        let inertia = log_uniform(rng, 1e-3, 2e-2);
        let absorber = Segment {
            link_stiffness: inertia * theta * theta,
            link_damping: 0.0,
            inertia,
            stiffness: 0.0,
            damping: 0.0,
        };
        let segments = if rng.random_bool(0.7) { vec![absorber] } else { Vec::new() };
        Hand { inertia: log_uniform(rng, 1e-3, 1e-2), segments, ..Hand::NONE }
    }

    fn draw_requests(&mut self, rng: &mut impl Rng, normalized: &NormalizedScene) {
        self.requests = [None; REQUESTS];
        let mut next = 0;
        let mut ask = |period: u32, request: Request| {
            if let Some(place) = self.requests.get_mut(next) {
                *place = Some((period, request));
                next += 1;
            }
        };
        if !self.armed_by_boot {
            // A board that finds the device elsewhere in its first tick has to be calm for a while.
            ask(rng.random_range(14..40), Request::Arm);
        }
        let late = self.periods / 2;
        if late < 100 {
            return;
        }
        if normalized.sets > 1 && rng.random_bool(0.6) {
            for set in [1, 0, 1].into_iter().take(rng.random_range(1..=3)) {
                ask(rng.random_range(40..late), Request::Submit(set));
            }
        }
        if rng.random_bool(0.15) {
            let disarm = rng.random_range(40..late);
            ask(disarm, Request::Disarm);
            let wait = log_uniform(rng, 1.0, 200.0) as u32;
            ask(disarm + wait, Request::Arm);
        }
    }

    /// A plan like this one, some of it changed by about `spread`.
    pub fn varied(&self, rng: &mut impl Rng, normalized: &NormalizedScene, spread: f64) -> Self {
        let mut plan = self.clone();
        let all = rng.random_bool(0.3);
        let mut pick = |share: f64| all || rng.random_bool(share);
        let (hand, start, pattern, requests) = (pick(0.7), pick(0.5), pick(0.15), pick(0.15));
        if hand {
            plan.hand = bounded(plan.hand.varied(rng, spread), normalized);
        }
        if start {
            let moved = plan.start[0];
            let size = if rng.random_bool(0.3) { log_uniform(rng, 0.5, 2.0) } else { 1.0 };
            for value in &mut plan.start[..6] {
                let change = 1.0 + spread * rng.random_range(-1.0..1.0);
                *value *= size * change;
                if rng.random_bool(0.05) {
                    *value = -*value;
                }
            }
            if plan.armed_by_boot {
                plan.zero += plan.start[0] - moved;
            }
        }
        if pattern {
            plan.pattern = Pattern::draw(rng, normalized.tolerated, normalized);
            plan.delay = Self::delay(rng, normalized);
            plan.jitter = Jitter::draw(rng, &normalized.timing);
            plan.readings = Readings::draw(rng, normalized);
            plan.within = [Self::place_in_range(rng), Self::place_in_range(rng)];
            plan.separate(normalized);
        }
        if requests {
            plan.draw_requests(rng, normalized);
        }
        plan
    }
}
