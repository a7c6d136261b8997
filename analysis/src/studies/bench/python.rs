//! Verdicts and steps by packages of Python, which one process of Python runs.

use haptic_servo::certificate::assess;
use haptic_servo::environment::Environment;
use haptic_servo::scene::Scene;
use serde_json::json;

use super::figure::{Pair, seconds};
use super::judge;
use super::peer::Peer;
use super::steps::{STEPS, numbers, steps_beside};
use crate::studies::error::StudyError;
use crate::toolchain::python::{PythonEnvironment, finished};

const SCRIPT: &str = include_str!("peers.py");

/// The packages of the peers that judge environments, by the names in `peers.py`.
pub const JUDGES: [&str; 3] = ["numpy", "slycot", "python-control"];
/// The package of the peer that simulates.
pub const SIMULATOR: &str = "scipy";
/// The packages from PyPI, each with its own attempt: some have no build for every machine.
const FROM_PYPI: [&[&str]; 3] = [&["numpy", "scipy"], &["slycot"], &["control", "cvxopt"]];

/// The process of Python, or the reason why there is none.
pub struct PythonPeers(Result<Peer, String>);

impl PythonPeers {
    /// Installs the packages where they are missing, and starts Python. `progress` gets the packages that
    /// cannot be installed.
    pub fn start(scenes: &[Scene], progress: impl Fn(&str)) -> Result<Self, StudyError> {
        let environment = PythonEnvironment::kept().map_err(|error| error.to_string());
        let ready = environment.and_then(|python| python.set_up().map(|()| python));
        let python = match ready {
            Ok(python) => python,
            Err(why) => return Ok(Self(Err(why))),
        };
        for packages in FROM_PYPI {
            // Nothing is built from source: that would need compilers of its own.
            let mut pip = python.pip_install();
            if let Err(why) = finished(pip.arg("--only-binary=:all:").args(packages)) {
                progress(&format!("{}: not installed: {why}", packages.join(", ")));
            }
        }
        let mut command = python.program("python");
        Ok(Self(Ok(Peer::start(command.args(["-c", SCRIPT]), &work(scenes))?)))
    }

    fn peer(&mut self) -> Result<&mut Peer, StudyError> {
        self.0.as_mut().map_err(|why| StudyError::NoPeer(why.clone()))
    }

    /// The times of a verdict in us, here and by a package, with the source: the package's version, its
    /// method, and its wrong and undecided verdicts.
    pub fn verdicts(
        &mut self,
        rounds: usize,
        scenes: &[Scene],
        name: &str,
    ) -> Result<(Pair, String), StudyError> {
        let peer = self.peer()?;
        let about = peer.ask(&format!("about {name}"))?;
        let values = peer.numbers(&format!("values {name}"))?;
        let ours: Vec<_> = scenes.iter().map(|scene| assess(scene).outcome.is_ok()).collect();
        let undecided = values.iter().filter(|theirs| theirs.is_nan()).count();
        let decided = values.iter().zip(&ours).filter(|(theirs, _)| !theirs.is_nan());
        let wrong = decided.filter(|(theirs, ours)| (**theirs == 1.0) != **ours).count();
        let each = 1e6 / scenes.len() as f64;
        let timed = format!("seconds {name}");
        // The second run counts, so that the caches are filled.
        let judged = || {
            judge(scenes);
            Ok::<_, StudyError>(seconds(|| judge(scenes)) * each)
        };
        let pair = Pair::in_turns(rounds, judged, || Ok(peer.number(&timed)? * each))?;
        let of = values.len();
        Ok((pair, format!("{about}; of {of}: {wrong} wrong, {undecided} undecided")))
    }

    /// The times of a step in ns, here and by a package.
    pub fn steps(&mut self, rounds: usize) -> Result<(Pair, String), StudyError> {
        let peer = self.peer()?;
        let about = peer.ask(&format!("about {SIMULATOR}"))?;
        let requests = ["values", "seconds"].map(|request| format!("{request} {SIMULATOR}"));
        let requests = [&*requests[0], &requests[1]];
        let pair = steps_beside(rounds, SIMULATOR, peer, requests)?;
        Ok((pair, about))
    }
}

fn work(scenes: &[Scene]) -> String {
    let environments = scenes.iter().filter_map(|scene| match &scene.environment {
        Environment::Rational(of) => {
            Some(json!([of.numerator.as_slice(), of.denominator.as_slice(), of.delay]))
        }
        _ => None,
    });
    let scene = scenes.first();
    json!({
        "period": scene.map(|scene| scene.timing.period),
        "delta": scene.map(|scene| scene.device.damping),
        "environments": environments.collect::<Vec<_>>(),
        "motion": numbers(),
        "steps": STEPS,
    })
    .to_string()
}
