//! The cost of a step of the exact method, and the same motion by peers.

use std::hint::black_box;
use std::process::Command;

use haptic_servo::scene::{Coupling, Device, Scene};

use super::figure::{Pair, median, seconds};
use super::peer::Peer;
use crate::device::Motion;
use crate::simulation::{Experiment, Integration, Simulator, Trajectory};
use crate::studies::error::StudyError;
use crate::studies::failures::setting::{PADDLE, PERIOD, rigid, wall_of};
use crate::toolchain::target_folder;

/// Steps of a run; the same number is in `steps.c`.
pub const STEPS: usize = 10_000;
/// Stable without a hand, and so close to its limit there that the motion lasts for all steps.
const STIFFNESS: f64 = 25.0;
const COUPLING: f64 = 88.0;
/// The position in rad from which the device is released.
const START: f64 = 1e-3;
/// Largest difference between a peer's values and ours, as a part of the largest position, velocity or torque:
/// the sums have other orders.
const ROUNDING: f64 = 1e-10;

const C_SOURCE: &str = include_str!("steps.c");
/// The C compiler, which a linker of Rust's programs brings.
const C_COMPILER: &str = "cc";
/// Its optimisation. Without contraction it computes the same operations on every machine.
const C_OPTIONS: [&str; 2] = ["-O2", "-ffp-contract=off"];

/// A wall of degree 1 on the paper's device, released from a millirad.
fn experiment() -> Experiment {
    let scene = Scene {
        coupling: Coupling::Spring { stiffness: COUPLING },
        ..rigid(PADDLE, wall_of(STIFFNESS, 0.0, 1))
    };
    let start = Motion { position: START, velocity: 0.0 };
    Experiment { samples: STEPS, start, ..Experiment::still(&scene) }
}

/// The numbers of that motion for a peer: by hand for a mass and a damper, on an undamped wall one sample late.
pub fn numbers() -> [f64; 7] {
    let Device { inertia: m, damping: b, .. } = PADDLE;
    let decay = f64::exp(-b * PERIOD / m);
    let slide = (1.0 - decay) * m / b;
    let (to_position, to_velocity) = ((PERIOD - slide) / b, (1.0 - decay) / b);
    [slide, decay, to_position, to_velocity, STIFFNESS, 1.0 / COUPLING, START]
}

/// The exact method on that wall, from its start.
fn simulator() -> Simulator {
    Simulator::new(&experiment(), Integration::default()).expect("a wall has a difference equation")
}

/// Time of a step in ns on one core. The second run counts, so that the caches are filled.
fn nanoseconds(out: &mut Trajectory) -> f64 {
    simulator().fill(black_box(out));
    let mut simulator = simulator();
    seconds(|| simulator.fill(black_box(out))) * 1e9 / STEPS as f64
}

/// Median time of a step in ns on one core.
pub fn step_time(rounds: usize) -> f64 {
    let mut out = Trajectory::of_length(STEPS);
    median((0..rounds).map(|_| nanoseconds(&mut out)).collect())
}

/// Times of a step in ns, here and by a peer with these requests for its values and its time; its motion must
/// be the same.
pub fn steps_beside(
    rounds: usize,
    name: &str,
    peer: &mut Peer,
    [values, seconds]: [&str; 2],
) -> Result<Pair, StudyError> {
    let mut out = Trajectory::of_length(STEPS);
    simulator().fill(&mut out);
    same_motion(name, &peer.numbers(values)?, &out)?;
    let theirs = || Ok::<_, StudyError>(peer.number(seconds)? * 1e9 / STEPS as f64);
    Pair::in_turns(rounds, || Ok(nanoseconds(&mut out)), theirs)
}

/// Refuses a motion of a peer that differs by more than rounding.
fn same_motion(peer: &str, theirs: &[f64], ours: &Trajectory) -> Result<(), StudyError> {
    let columns = [&ours.position, &ours.velocity, &ours.torque];
    let (found, all) = (theirs.len(), 3 * STEPS);
    if found != all {
        return Err(StudyError::WrongPeer(format!("{found} of {all} values: {peer}")));
    }
    for (ours, theirs) in columns.into_iter().zip(theirs.chunks(STEPS)) {
        let largest = ours.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        // NaN is not the same.
        let is_same = |(ours, theirs): &(&f64, &f64)| (*ours - *theirs).abs() <= ROUNDING * largest;
        if let Some((ours, theirs)) = ours.iter().zip(theirs).find(|pair| !is_same(pair)) {
            return Err(StudyError::WrongPeer(format!("{theirs} in place of {ours}: {peer}")));
        }
    }
    Ok(())
}

/// Compiles `steps.c` in the folder of builds, starts it, and returns it with its compiler.
pub fn in_c() -> Result<(Peer, String), StudyError> {
    let missing = |why: String| StudyError::NoPeer(format!("{C_COMPILER}: {why}"));
    let run = |command: &mut Command| {
        let output = command.output().map_err(|error| missing(error.to_string()))?;
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        match output.status.success() {
            true => Ok(said),
            false => Err(missing(String::from_utf8_lossy(&output.stderr).into_owned())),
        }
    };
    let version = run(Command::new(C_COMPILER).arg("--version"))?;
    let target = target_folder().map_err(|error| missing(error.to_string()))?;
    // Removed at the end: a running program keeps its file.
    let folder = tempfile::Builder::new().prefix("bench-").tempdir_in(target)?;
    let [source, program] = ["steps.c", "steps"].map(|name| folder.path().join(name));
    std::fs::write(&source, C_SOURCE)?;
    run(Command::new(C_COMPILER).args(C_OPTIONS).arg("-o").arg(&program).arg(&source))?;
    let work = numbers().map(|number| format!("{number:?}")).join(" ");
    let peer = Peer::start(&mut Command::new(&program), &work)?;
    let version = version.lines().next().unwrap_or(C_COMPILER);
    Ok((peer, format!("plain C, {version}, {}", C_OPTIONS[0])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The C has another order of operations, so that both agree to rounding only. A peer with one other value
    /// or fewer values is not measured.
    #[test]
    fn the_c_peer_computes_the_motion_of_the_exact_simulation() {
        let mut ours = Trajectory::of_length(STEPS);
        simulator().fill(&mut ours);
        // It lasts.
        let late =
            ours.torque[STEPS - 100..].iter().fold(0.0, |most: f64, one| most.max(one.abs()));
        assert!(late > 1e-3, "{late}");
        let (mut peer, compiler) = in_c().unwrap();
        assert!(compiler.starts_with("plain C, ") && compiler.len() > 20, "{compiler}");
        let theirs = peer.numbers("values").unwrap();
        same_motion("C", &theirs, &ours).unwrap();
        assert!(peer.number("seconds").unwrap() > 0.0);
        for other in [theirs[25_000] + 1e-9, f64::NAN] {
            let mut others = theirs.clone();
            others[25_000] = other;
            let error = same_motion("C", &others, &ours).unwrap_err().to_string();
            assert!(error.contains(&format!("{other} in place of ")), "{error}");
        }
        let error = same_motion("C", &theirs[1..], &ours).unwrap_err().to_string();
        assert!(error.contains("29999 of 30000 values"), "{error}");
    }
}
