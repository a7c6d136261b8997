//! Verdicts on walls of every stiffness and damping on one device: certified, merely stable, or neither.

pub mod border;
pub mod plane;
pub mod plant;
pub mod schur_cohn;

use std::ops::Range;

use haptic_servo::certificate::{KeptResponses, PassivityProblem, RuleAnswer, assess};
use haptic_servo::environment::{Damper, Wall};
use haptic_servo::parameter::Parameter;
use haptic_servo::passivity::lagged::SampledResponse;
use haptic_servo::scene::{Coupling, Latency, Scene};
use haptic_servo::words;
use rayon::prelude::*;
use thiserror::Error;

use crate::file::SceneFile;
use crate::limits::{Limit, largest_stiffness};
use crate::simulation::plant::Plant;
use crate::simulation::{Experiment, Integration, SimulationError};
use plane::Plane;
use plant::SampledPlant;

words! {
    /// Verdicts on a scene, from the worst to the best.
    #[derive(PartialOrd, Ord, Hash)]
    Region {
    /// Certified, and yet without a hand it does not come to rest: its torque is later than the certificate
    /// assumes.
    Wrong "wrong",
    /// Even without a hand it does not come to rest.
    Unstable "unstable",
    /// Rejected: without a hand it comes to rest; some hand may make it oscillate.
    Rejected "rejected",
    /// Neither certified nor rejected; without a hand it comes to rest.
    Undecided "undecided",
    /// The exact rule certifies it, the paper's does not.
    Exact "certified-exact",
    /// The paper's rule certifies it.
    Paper "certified-paper",
    }
}

impl Region {
    /// In words, for a legend; not every map says whether a scene is stable.
    pub const fn words(self, says_stability: bool) -> &'static str {
        match self {
            Self::Undecided if !says_stability => "undecided",
            Self::Rejected if !says_stability => "rejected",
            Self::Paper => "certified by the paper's rule",
            Self::Exact => "certified by the exact rule only",
            Self::Undecided => "undecided, stable with no hand",
            Self::Rejected => "rejected, stable with no hand",
            Self::Unstable => "unstable with no hand",
            Self::Wrong => "WRONG: certified, unstable",
        }
    }
}

/// Why there is no map.
#[derive(Debug, Error)]
pub enum MapError {
    /// The environment has no wall with a stiffness and a damping.
    #[error(
        "{scene}: a map shows stiffness and damping of a wall, but this environment has no wall; \
         it must be a delayed-spring, a damper-wall or a free-mode-wall"
    )]
    NoWall {
        /// Name of the scene.
        scene: String,
    },
    /// The device is beyond the range of numbers.
    #[error(transparent)]
    Device(#[from] SimulationError),
    /// The scene has no such number.
    #[error("{scene}: a map cannot go along `{}`; it can go along {choice}", parameter.key())]
    NoSuchNumber {
        /// Name of the scene.
        scene: String,
        /// The number.
        parameter: Parameter,
        /// The keys of the valid numbers.
        choice: String,
    },
    /// Both axes are the same.
    #[error("{scene}: both axes of a map are `{}`; they must differ", parameter.key())]
    Twice {
        /// Name of the scene.
        scene: String,
        /// The number.
        parameter: Parameter,
    },
    /// There is nothing to judge between the borders of the map.
    #[error(
        "stiffness from {} to {} N m/rad and damping from {} to {} N m s/rad are beyond the range \
         of a map", stiffness.start, stiffness.end, damping.start, damping.end
    )]
    NoRange {
        /// The stiffness.
        stiffness: Range<f64>,
        /// The damping.
        damping: Range<f64>,
    },
}

/// The walls that differ from a scene's in stiffness and damping only.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    scene: Scene,
    plant: SampledPlant,
    /// Whether the verdict rests on an assumption that does not hold: the torque is later than the
    /// certificate assumes.
    may_be_wrong: bool,
    kept: Option<Kept>,
}

/// The responses that the verdicts on scenes of the same delays and lags share.
type Kept = KeptResponses<Vec<SampledResponse>>;

/// The responses of a scene; `None` where nothing lags.
fn kept(scene: &Scene) -> Option<Kept> {
    PassivityProblem::of(scene).ok()?.kept_responses()
}

impl Family {
    /// The walls of a scene file, on its device in no hand.
    ///
    /// # Errors
    /// Where the environment has no wall, or the device's motion is beyond the range of numbers.
    pub fn of(file: &SceneFile) -> Result<Self, MapError> {
        let alone = Experiment { plant: Plant::of(&file.chain), ..Experiment::at_rest(file) };
        Self::on(&file.name, alone)
    }

    /// The walls of a scene called `name`, on its rigid device in no hand.
    ///
    /// # Errors
    /// Where the environment has no wall, or the device's motion is beyond the range of numbers.
    pub fn rigid(name: &str, scene: &Scene) -> Result<Self, MapError> {
        Self::on(name, Experiment::still(scene))
    }

    fn on(name: &str, alone: Experiment) -> Result<Self, MapError> {
        if alone.scene.environment.wall().is_none() {
            return Err(MapError::NoWall { scene: name.to_owned() });
        }
        let tick = alone.tick(Integration::default())?;
        let (scene, plant) = (alone.scene, SampledPlant::new(&tick));
        let family = Self { scene, plant, may_be_wrong: alone.latency > 0.0, kept: None };
        // With stiffness and damping 0 no wall is too stiff for its coupling.
        let kept = kept(&family.member(0.0, 0.0));
        Ok(Self { kept, ..family })
    }

    /// The scene from which the others differ.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The scene with another stiffness (N m/rad) and damping (N m s/rad) of its wall.
    pub fn member(&self, stiffness: f64, damping: f64) -> Scene {
        let mut scene = self.scene;
        if let Some(wall) = scene.environment.wall_mut() {
            let damper = Some(Damper { damping, filter: wall.filter() });
            *wall = Wall { stiffness, damper, ..*wall };
        }
        scene
    }

    /// The verdict on a wall. Stability comes first, as it is by far the cheapest: no hand at all is
    /// a passive hand too, so a loop that is unstable without one is not certified, as long as the
    /// device meets the certificate's assumptions. If it does not, the verdict is computed all the
    /// same, and may be wrong.
    pub fn region(&self, stiffness: f64, damping: f64) -> Region {
        let scene = self.member(stiffness, damping);
        let is_stable = self.plant.is_stable_under(&self.prompt(scene)).unwrap_or(false);
        judged(&scene, self.kept.as_ref(), is_stable, self.may_be_wrong)
    }

    /// A scene with the same controller, which is computed sooner: only a matched coupling depends on
    /// latencies, and the plant has them in it.
    fn prompt(&self, scene: Scene) -> Scene {
        match (&self.kept, scene.coupling) {
            (None, _) | (_, Coupling::Matched) => scene,
            _ => Scene { latency: Latency::NONE, ..scene },
        }
    }

    /// Ranges of stiffness and damping that show the borders: nearly twice the stiffest certified spring,
    /// and damping of both signs about as far as the device's own goes.
    pub fn usual_ranges(&self) -> (Range<f64>, Range<f64>) {
        let delta = assess(&self.scene).delta.midpoint();
        let stiffest = match largest_stiffness(&self.member(0.0, 0.0)) {
            Limit::AtMost(stiffness) => stiffness,
            Limit::Any | Limit::Nothing => 2.0 * delta / self.scene.timing.period,
        };
        (0.0..1.8 * stiffest, -0.6 * delta..1.25 * delta)
    }
}

/// The region of a scene, from its stability without a hand and its verdict.
fn judged(scene: &Scene, kept: Option<&Kept>, is_stable: bool, may_be_wrong: bool) -> Region {
    if !is_stable && !may_be_wrong {
        return Region::Unstable;
    }
    match (is_stable, verdict(scene, kept)) {
        (false, Region::Exact | Region::Paper) => Region::Wrong,
        (false, _) => Region::Unstable,
        (true, verdict) => verdict,
    }
}

/// The middle of the part `index` of a range, of `parts` equal parts.
pub fn middle(range: &Range<f64>, index: usize, parts: usize) -> f64 {
    range.start + (range.end - range.start) * (index as f64 + 0.5) / parts as f64
}

/// The certificate's verdict on a scene.
fn verdict(scene: &Scene, kept: Option<&Kept>) -> Region {
    let posed = match PassivityProblem::of(scene) {
        Ok(posed) => posed,
        Err(rejection) if rejection.is_undecided() => return Region::Undecided,
        Err(_) => return Region::Rejected,
    };
    // The paper's rule is stricter than the exact one, and cheaper.
    if posed.passes_paper() {
        return Region::Paper;
    }
    match kept.map_or_else(|| posed.answer(), |kept| posed.answer_with(kept)) {
        RuleAnswer::Pass => Region::Exact,
        RuleAnswer::Fail => Region::Rejected,
        RuleAnswer::Undecided => Region::Undecided,
    }
}

/// A grid of scenes, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// From the lowest to the highest number to the right: of walls, the stiffness in N m/rad.
    pub x: Range<f64>,
    /// The same upwards: of walls, the damping in N m s/rad.
    pub y: Range<f64>,
    /// Cells to the right.
    pub columns: usize,
    /// Cells upwards.
    pub rows: usize,
    regions: Vec<Region>,
}

impl Map {
    /// Computes the middle of each of `side` times `side` cells, on all cores. Calls `progress` on
    /// each row.
    pub fn new(
        family: &Family,
        stiffness: Range<f64>,
        damping: Range<f64>,
        side: usize,
        progress: impl Fn() + Sync,
    ) -> Self {
        let of_row = |damping: f64| move |stiffness: f64| family.region(stiffness, damping);
        Self::judged([stiffness, damping], [side, side], progress, of_row)
    }

    /// The same of a plane.
    pub fn of_plane(
        plane: &Plane,
        ranges: [Range<f64>; 2],
        cells: [usize; 2],
        progress: impl Fn() + Sync,
    ) -> Self {
        let of_row = |y: f64| {
            let row = plane.row(y);
            move |x: f64| row.region(x)
        };
        Self::judged(ranges, cells, progress, of_row)
    }

    fn judged<R: Fn(f64) -> Region>(
        [x, y]: [Range<f64>; 2],
        [columns, rows]: [usize; 2],
        progress: impl Fn() + Sync,
        of_row: impl Fn(f64) -> R + Sync,
    ) -> Self {
        let row = |row: usize| {
            let of_row = of_row(middle(&y, row, rows));
            let region = |column| of_row(middle(&x, column, columns));
            let regions: Vec<Region> = (0..columns).map(region).collect();
            progress();
            regions
        };
        let regions = (0..rows).into_par_iter().flat_map_iter(row).collect();
        Self { x, y, columns, rows, regions }
    }

    /// The verdict on a cell.
    pub fn at(&self, column: usize, row: usize) -> Region {
        self.regions[row * self.columns + column]
    }

    /// Each cell, row by row: the two numbers of its middle, and the verdict on it.
    pub fn cells(self) -> impl Iterator<Item = (f64, f64, Region)> {
        let Self { x, y, columns, rows, regions } = self;
        regions.into_iter().enumerate().map(move |(index, region)| {
            let (column, row) = (index % columns, index / columns);
            (middle(&x, column, columns), middle(&y, row, rows), region)
        })
    }

    /// The share of the cells in a region, from 0 to 1.
    pub fn share(&self, region: Region) -> f64 {
        let count = self.regions.iter().filter(|&&found| found == region).count();
        count as f64 / self.regions.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests;
