//! The scene of the stiffest wall at the handle that certifies on a board: over the coupling, the time of the
//! output, the rate, and the damper of the wall.

use haptic_servo::certificate::{QuantizationBound, Resolution};
use haptic_servo::current::{B_G431B_ESC1, PwmTiming};
use haptic_servo::environment::{Damper, Environment};
use haptic_servo::number::Format;
use haptic_servo::output_timing::{READ_WITHIN, SHORTEST_PHASE};
use haptic_servo::parameter::Parameter;
use haptic_servo::period;
use haptic_servo::rendering::context_beside_anticogging;
use haptic_servo::scene::{Coupling, EncoderReading, Latency, Scene, TimeRange};

use super::edge::{Edge, edge, inward};
use super::{Choice, Judge, Terms, at_period, prepared};
use crate::chip_on_board::{ChipOnBoard, reread, with_age};
use crate::felt;
use crate::file::SceneFile;
use crate::quantity::rounded;

/// The coupling and the time of the output of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Structure {
    coupling: Kind,
    is_latched: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    None,
    Spring,
    Matched,
}

impl Structure {
    /// All that a board renders, but for a spring at a phase: a board has that coupling for latched torques
    /// only.
    pub const ALL: [Self; 5] = [
        Self { coupling: Kind::Spring, is_latched: true },
        Self { coupling: Kind::None, is_latched: true },
        Self { coupling: Kind::Matched, is_latched: true },
        Self { coupling: Kind::None, is_latched: false },
        Self { coupling: Kind::Matched, is_latched: false },
    ];

    /// In a few words.
    pub const fn name(self) -> &'static str {
        match (self.coupling, self.is_latched) {
            (Kind::None, true) => "no coupling, latched",
            (Kind::None, false) => "no coupling, at a phase",
            (Kind::Spring, _) => "spring, latched",
            (Kind::Matched, true) => "matched coupling, latched",
            (Kind::Matched, false) => "matched coupling, at a phase",
        }
    }
}

/// The stiffest wall of a structure at a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Its structure.
    pub structure: Structure,
    /// The scene, which certifies on a board.
    pub scene: Scene,
    /// Stiffness in N m/rad at the handle.
    pub felt: f64,
    /// Whether a stiffer environment would certify, too, of which the handle feels the coupling alone.
    pub saturates: bool,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The stiffest wall.
    pub best: Wall,
    /// The stiffest wall of each structure at each tried rate.
    pub walls: Vec<Wall>,
}

/// The device, and the conditions of the search.
#[derive(Clone, Debug)]
pub struct Search {
    /// With a wall, and with its own coupling.
    pub(super) scene: Scene,
    terms: Terms,
    shortest_period: f64,
    /// The steps of the device, with its friction.
    pub(super) steps: Resolution,
    /// The chip of its encoder.
    chip: Option<ChipOnBoard>,
    /// Whether the friction has to prevent a limit cycle at rest, as in the scene of the file.
    rests: bool,
}

/// A change of the device or the board, which cannot be made in the scene.
type Lever = (&'static str, fn(&Search) -> Option<Search>);

const LEVERS: [Lever; 9] = [
    (Search::FASTER_BOARD, |search| {
        let shortest_period = 0.5 * search.shortest_period;
        Some(Search { shortest_period, ..search.clone() })
    }),
    ("half the lag of the amplifier", |search| {
        search.with_latency(|latency| halved(&mut latency.actuator_lag))
    }),
    ("half the lag of the sensor", |search| {
        search.with_latency(|latency| halved(&mut latency.sensor_lag))
    }),
    ("half the age of the encoder's readings", |search| {
        search.with_encoder(|encoder| halved(&mut encoder.age))
    }),
    ("half the noise of the encoder", |search| {
        search.rests.then(|| search.with_encoder(|encoder| halve(&mut encoder.noise)))?
    }),
    ("20 % more damping at the shaft", |search| {
        let mut more = search.clone();
        more.scene.device.damping *= 1.2;
        more.scene.device.passivity = more.scene.device.passivity.map(|passivity| 1.2 * passivity);
        Some(more)
    }),
    ("20 % more friction", |search| {
        let friction = search.steps.friction.filter(|_| search.rests).map(|torque| 1.2 * torque);
        let steps = Resolution { friction: Some(friction?), ..search.steps };
        Some(Search { steps, ..search.clone() })
    }),
    ("an encoder with four times the counts", |search| {
        let encoder = search.steps.encoder.filter(|_| search.rests).map(|step| 0.25 * step)?;
        let steps = Resolution { encoder: Some(encoder), ..search.steps };
        let finer = Search { steps, ..search.clone() };
        // The same noise and hysteresis are four times as many counts.
        Some(finer.with_encoder(quadruple).unwrap_or(finer))
    }),
    ("no missed updates", |search| {
        let mut punctual = search.clone();
        punctual.scene.timing.longer_period()?;
        punctual.scene.timing.worst_period = None;
        Some(punctual)
    }),
];

/// Halves a number; whether that changes it.
fn halve(number: &mut f64) -> bool {
    *number *= 0.5;
    *number > 0.0
}

/// Makes noise and hysteresis four times as many counts; whether that changes them.
fn quadruple(encoder: &mut EncoderReading) -> bool {
    encoder.noise *= 4.0;
    encoder.hysteresis *= 4.0;
    encoder.noise + encoder.hysteresis > 0.0
}

/// Halves a time; whether that changes it.
fn halved(time: &mut TimeRange) -> bool {
    let TimeRange { least, most } = *time;
    *time = TimeRange::between(0.5 * least, 0.5 * most);
    most > 0.0
}

/// Factor between two tried rates, at most.
const RATE_STEP: f64 = 1.6;
/// Factors of nearby periods.
const NEARBY: [f64; 4] = [0.8, 0.9, 1.12, 1.25];
/// Dampings that are tried, as parts of the device's passivity.
const DAMPINGS: [f64; 5] = [0.0, 0.05, 0.15, 0.3, 0.5];
/// Poles of the velocity filter that are tried.
const FILTERS: [Option<f64>; 4] = [None, Some(0.5), Some(0.8), Some(0.95)];
/// Relative gain of stiffness below which the scene's own damper stays.
const GAIN: f64 = 1e-3;
/// Stiffness of a wall behind a coupling that saturates, in couplings: 1 % less is felt.
const SATURATED: f64 = 100.0;
/// Relative precision of a limit before it is rounded to three digits.
const PRECISION: f64 = 1e-5;

impl Search {
    /// The change of the board's rate.
    pub const FASTER_BOARD: &'static str = "twice the rate of the board";

    /// A search on the device of a scene; `None` without a wall.
    pub fn new(file: &SceneFile, terms: &Terms) -> Option<Self> {
        file.scene.environment.wall()?;
        let mut search = Self {
            scene: prepared(&file.scene, &Terms { coupling: Choice::Kept, ..*terms }),
            terms: *terms,
            shortest_period: period::SHORTEST,
            steps: file.steps(),
            chip: file.chip_on_board(),
            rests: false,
        };
        // The updates and the delay of a bridge's current loop are the search's, not the file's.
        let [_, latched, ..] = Structure::ALL;
        if let Some(scene) = search.scene_of(latched, file.scene.timing.period, None) {
            search.steps = SceneFile { scene, ..file.clone() }.steps();
        }
        search.rests = comes_to_rest(&file.scene, &search.steps) == Some(true);
        Some(search)
    }

    /// The same search, whether friction prevents a limit cycle or not.
    pub fn without_rest(&self) -> Self {
        Self { rests: false, ..self.clone() }
    }

    /// The search for the stiffest wall that the stated friction keeps silent at rest; `None` if no friction is
    /// stated, or if this is that search.
    pub fn silent(&self) -> Option<Self> {
        let is_known = !self.rests && comes_to_rest(&self.scene, &self.steps).is_some();
        is_known.then(|| Self { rests: true, ..self.clone() })
    }

    /// Searches; `None` if no wall certifies. `progress` is called for each rate.
    pub fn run(&self, progress: impl Fn()) -> Option<Found> {
        let mut walls = Vec::new();
        for period in self.periods() {
            walls.extend(
                Structure::ALL.iter().filter_map(|&structure| self.wall(structure, period)),
            );
            progress();
        }
        let stiffest = walls.iter().max_by(|a, b| a.felt.total_cmp(&b.felt))?;
        Some(Found { best: self.refined(*stiffest), walls })
    }

    /// The stiffest wall at a period in s.
    pub fn at(&self, period: f64) -> Option<Wall> {
        let walls = Structure::ALL.iter().filter_map(|&structure| self.wall(structure, period));
        walls.max_by(|a, b| a.felt.total_cmp(&b.felt))
    }

    /// The number of rates that are tried.
    pub fn rates(&self) -> usize {
        self.periods().len()
    }

    /// The searches with one change of the device or the board each, by name.
    pub fn levers(&self) -> Vec<(&'static str, Self)> {
        LEVERS.iter().filter_map(|(name, change)| Some((*name, change(self)?))).collect()
    }

    fn with_latency(&self, change: fn(&mut Latency) -> bool) -> Option<Self> {
        let mut changed = self.clone();
        change(&mut changed.scene.latency).then_some(changed)
    }

    fn with_encoder(&self, change: fn(&mut EncoderReading) -> bool) -> Option<Self> {
        let mut encoder = *self.scene.latency.encoder;
        change(&mut encoder).then(|| {
            let mut changed = self.clone();
            changed.scene.latency = reread(&changed.scene.latency, encoder);
            changed
        })
    }

    /// The tried periods in s, in two digits: from the shortest to the scene's own, or to four times the
    /// shortest. Those of a bridge are filled by whole periods of its modulation.
    pub fn periods(&self) -> Vec<f64> {
        let own = self.scene.timing.period.max(4.0 * self.shortest_period);
        let steps = ((own / self.shortest_period).ln() / RATE_STEP.ln()).ceil() as i32;
        let step = (own / self.shortest_period).powf(1.0 / f64::from(steps));
        let period = |index| self.shortest_period * step.powi(index);
        let mut periods: Vec<f64> = match self.scene.latency.actuator_updates {
            0 => (0..=steps).map(|index| rounded(period(index), 2)).collect(),
            _ => (0..=steps).filter_map(|index| filled(period(index))).collect(),
        };
        periods.dedup();
        periods
    }

    /// The stiffest wall of a structure at a rate, with the scene's own damper or without its damping.
    fn wall(&self, structure: Structure, period: f64) -> Option<Wall> {
        let damper = self.scene.environment.wall()?.damper;
        let without = damper.map(|damper| Damper { damping: 0.0, ..damper });
        self.stiffer(self.with_damper(structure, period, damper), structure, period, without)
    }

    /// The wall, or the one with this damper if that is stiffer.
    fn stiffer(
        &self,
        wall: Option<Wall>,
        structure: Structure,
        period: f64,
        damper: Option<Damper>,
    ) -> Option<Wall> {
        let least = wall.map_or(0.0, |wall| wall.felt * (1.0 + GAIN));
        self.with_damper(structure, period, damper).filter(|other| other.felt > least).or(wall)
    }

    /// The wall at the best of some nearby rates, and with the best of some dampers.
    fn refined(&self, wall: Wall) -> Wall {
        let (structure, period) = (wall.structure, wall.scene.timing.period);
        let damper = wall.scene.environment.wall().and_then(|wall| wall.damper);
        let mut best = Some(wall);
        if period > self.shortest_period && self.scene.latency.actuator_updates == 0 {
            for factor in NEARBY {
                best = self.stiffer(best, structure, rounded(factor * period, 2), damper);
            }
        }
        let period = best.map_or(period, |best| best.scene.timing.period);
        // Behind a coupling that saturates, no damper makes the wall stiffer.
        if damper.is_some() && !wall.saturates {
            for part in DAMPINGS {
                let damping = rounded(part * self.scene.device.passivity(), 2);
                for filter in FILTERS {
                    let damper = Some(Damper { damping, filter });
                    best = self.stiffer(best, structure, period, damper);
                }
            }
        }
        best.unwrap_or(wall)
    }

    /// The scene of a structure, with a wall of no stated stiffness.
    pub(super) fn scene_of(
        &self,
        structure: Structure,
        period: f64,
        damper: Option<Damper>,
    ) -> Option<Scene> {
        let Structure { coupling, is_latched } = structure;
        // The age follows from the updates, too, which are set below.
        let mut scene = at_period(&self.scene, None, period);
        let Environment::Parts(parts) = &mut scene.environment else { return None };
        let delay = usize::from(is_latched);
        parts.wall.as_mut()?.damper = damper;
        parts.set_wall_delay(delay);
        if scene.latency.actuator_updates > 0 {
            scene.latency.actuator_updates =
                PwmTiming::of(period, B_G431B_ESC1.clock).ok()?.updates;
        }
        if let Some(chip) = self.chip {
            scene.latency = with_age(&scene.latency, chip.age_in(&self.scene, &scene));
        }
        let transfers = self.chip.map(|chip| chip.transfers(&scene));
        let latency = &mut scene.latency;
        let encoder = latency.encoder;
        if encoder.window > 0.0 {
            latency.actuator_response = TimeRange::ZERO;
        }
        (latency.output_jitter, latency.count_jitter) = (0.0, 0.0);
        if latency.actuator_updates > 0 {
            let update = if is_latched { 1 } else { 2 };
            latency.output_delay = TimeRange::exactly(latency.delay_at_update(update, period));
        } else {
            let phase = transfers.map_or(SHORTEST_PHASE, |transfers| transfers.shortest_phase());
            latency.output_delay = TimeRange::exactly(if is_latched { 0.0 } else { phase });
            if !latency.is_none() || !encoder.age.is_zero() {
                let own = &self.scene.latency;
                let jitter = own.total_jitter() - own.encoder.deviation_of_age();
                // Beside a varying age it is that of the counts, too.
                let of_counts = encoder.deviation_of_age() > 0.0;
                let place = match of_counts {
                    true => &mut latency.count_jitter,
                    false => &mut latency.output_jitter,
                };
                *place = jitter.max(READ_WITHIN);
            }
        }
        *latency = latency.read_by(encoder);
        scene.coupling = match coupling {
            Kind::None => Coupling::Rigid,
            Kind::Matched => Coupling::Matched,
            Kind::Spring => {
                let longest = scene.timing.worst_period.unwrap_or(period);
                let left = context_beside_anticogging::<Environment>(&scene, Format::F64).passivity;
                let standard = 2.0 * left / longest;
                Coupling::Spring { stiffness: inward(standard, 2.0).next()? }
            }
        };
        Some(scene)
    }

    fn with_damper(
        &self,
        structure: Structure,
        period: f64,
        damper: Option<Damper>,
    ) -> Option<Wall> {
        let scene = self.scene_of(structure, period, damper)?;
        let at = |stiffness| scene.with(Parameter::Stiffness, stiffness).unwrap_or(scene);
        let passes = |stiffness: &f64| self.passes(&at(*stiffness));
        let compliance = felt::compliance(&scene).filter(|&compliance| compliance > 0.0);
        let saturated = compliance.and_then(|it| inward(SATURATED / it, 2.0).find(passes));
        let stiffness = saturated.or_else(|| {
            let start = scene.device.passivity() / period;
            let precision = if self.terms.exact { 0.0 } else { PRECISION };
            match edge(|stiffness| passes(&stiffness), start, 2.0, precision) {
                Edge::At(limit) if self.terms.exact => Some(limit),
                Edge::At(limit) => inward(limit, 2.0).find(passes),
                Edge::Always | Edge::Never => None,
            }
        })?;
        let scene = at(stiffness);
        let felt = felt::stiffness(&scene)?;
        Some(Wall { structure, scene, felt, saturates: saturated.is_some() })
    }

    pub(super) fn passes(&self, scene: &Scene) -> bool {
        Judge::Board(self.shortest_period).passes(scene)
            && (!self.rests || comes_to_rest(scene, &self.steps) == Some(true))
    }
}

/// Whether the stated friction prevents a limit cycle; `None` where that is not known.
fn comes_to_rest(scene: &Scene, steps: &Resolution) -> Option<bool> {
    QuantizationBound::of(scene, Format::F64, steps)?.comes_to_rest()
}

/// The period of whole counts that the modulation of a bridge fills; the longest up to `period` in s.
fn filled(period: f64) -> Option<f64> {
    // The shortest period of the modulation.
    const INSTANT: f64 = 25e-6;
    let period = rounded((period / INSTANT).round().max(1.0) * INSTANT, 6);
    PwmTiming::of(period, B_G431B_ESC1.clock).ok().map(|_| period)
}
