//! Requests and replies as frames of one length, with the codec of a scene by the bits of its numbers, and the
//! certificate that a board replies.
//!
//! The compiler, the host and the board compute the same certificate; with this codec a test gets the
//! board's, to compare the three bit for bit. It is not a way to change the scene of a servo.

use haptic_servo::certificate::{Assessment, PassivityProblem, RuleAnswer, assess};
use haptic_servo::environment::{Environment, Parts, Rational};
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::Scene;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::tables;

/// Bytes of a request or a reply: it fits a pipe's buffer, so that sending never waits for the other end.
pub const FRAME: usize = 512;
/// A request or a reply, padded with zeros.
pub type Frame = [u8; FRAME];

/// The frame of a request or a reply.
///
/// # Panics
/// If it is longer than a frame, as no request and no reply is.
pub fn encode<T: Serialize>(message: &T) -> Frame {
    let mut frame = [0; FRAME];
    postcard::to_slice(message, &mut frame).expect("a frame has room for the longest scene");
    frame
}

/// The request or the reply of a frame; `None` if it is malformed.
pub fn decode<T: DeserializeOwned>(frame: &Frame) -> Option<T> {
    postcard::take_from_bytes(frame).ok().map(|(message, _)| message)
}

/// A scene with the parts of an environment that are not on a board's wire: polynomials, and a table of knots by its
/// index among [`tables`].
#[derive(Serialize, Deserialize)]
struct Whole {
    scene: Scene,
    rational: Option<Rational>,
    table: Option<usize>,
}

/// The form of a scene in a request.
pub(crate) fn serialize<S: Serializer>(scene: &Scene, serializer: S) -> Result<S::Ok, S::Error> {
    let (mut scene, rational) = (*scene, scene.environment.rational().copied());
    if rational.is_some() {
        scene.environment = Parts::NONE.sum();
    }
    let table = scene.environment.profile().and_then(tables::index_of);
    Whole { scene, rational, table }.serialize(serializer)
}

/// The scene of a request. A table that the board does not have is left empty: a servo of it cannot be built.
pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Scene, D::Error> {
    let Whole { mut scene, rational, table } = Whole::deserialize(deserializer)?;
    if let Some(rational) = rational {
        scene.environment = Environment::Rational(rational);
    }
    if let Environment::Parts(Parts { profile: Some(profile), .. }) = &mut scene.environment
        && let Some(known) = table.and_then(tables::from_index)
    {
        profile.table = known.table;
    }
    Ok(scene)
}

/// A request to certify a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CertifyRequest(#[serde(with = "self")] pub Scene);

/// An enclosure's ends as bits; `None` if the index does not exist.
pub type IntervalBits = Option<(u64, u64)>;

/// Certificate that the board computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CertifyReply {
    /// Index of the environment alone.
    pub alpha: IntervalBits,
    /// Index behind the coupling.
    pub alpha_coupled: IntervalBits,
    /// Index at the port of a scene with latency.
    pub alpha_port: IntervalBits,
    /// Equations 17 to 19.
    pub paper: RuleAnswer,
    /// Theory, section 4.1.
    pub exact: RuleAnswer,
    /// Instructions for certifying; 0 if they are not counted.
    pub instructions: u64,
    /// Whether the scene is certified, computed without the numbers of the verdict.
    pub is_certified: bool,
    /// Instructions for that verdict.
    pub verdict_instructions: u64,
}

/// Certifies a scene. `count` measures the instructions that this takes.
pub fn certify(scene: &Scene, count: impl Fn(&mut dyn FnMut()) -> u64) -> Option<CertifyReply> {
    let mut found = None;
    let instructions = count(&mut || found = Some(assess(scene)));
    let mut is_certified = false;
    let verdict_instructions = count(&mut || {
        is_certified = PassivityProblem::of(scene).is_ok_and(|posed| posed.is_certified());
    });
    let Assessment { alpha, alpha_coupled, alpha_port, paper, exact, .. } = found?;
    let [alpha, alpha_coupled, alpha_port] = [alpha, alpha_coupled, alpha_port].map(bits);
    Some(CertifyReply {
        alpha,
        alpha_coupled,
        alpha_port,
        paper,
        exact,
        instructions,
        is_certified,
        verdict_instructions,
    })
}

fn bits(index: Option<Interval>) -> IntervalBits {
    index.map(|index| (index.lo().to_bits(), index.hi().to_bits()))
}

#[cfg(test)]
mod tests {
    use haptic_servo::environment::{
        Canceller, Coefficients, Ends, MAX_DEGREE, Profile, Side, Wall,
    };
    use haptic_servo::scene::{Coupling, Device, Latency, Timing};

    use super::*;

    fn scene(environment: Environment) -> Scene {
        Scene {
            device: Device { inertia: 0.1, damping: 0.2, passivity: Some(0.3) },
            timing: Timing { period: 0.4, worst_period: None },
            coupling: Coupling::Spring { stiffness: f64::MIN_POSITIVE },
            environment,
            latency: Latency::sampled(3, 0.25, 1.5),
            torque_limit: Some(f64::INFINITY),
        }
    }

    #[test]
    fn scenes_survive_their_frames() {
        let wall = Wall::damped(-1.5, 2.5, 3);
        let free =
            |wall| Parts { canceller: Some(Canceller::to(0.25)), wall: Some(wall), ..Parts::NONE };
        let rational = Rational {
            numerator: Coefficients::new(&[1.0, -0.0, 5e-324]).unwrap(),
            denominator: Coefficients::new(&[0.1; MAX_DEGREE + 1]).unwrap(),
            delay: 7,
            unit_zeros: 2,
        };
        let ends = Some(Ends { from: -1.0, to: 2.0, stiffness: 3.0 });
        let magnet = Profile { ends, count: 3.0, ..Profile::of(&tables::MAGNET, 2) };
        for environment in [
            Wall::spring(-1.5, 3).alone(),
            Wall { side: Side::Displaced(-0.0), ..wall }.alone(),
            Canceller { residual: 0.25, delay: 1 }.alone(),
            free(wall.filtered(0.75).behind(-0.0)).sum(),
            Environment::Rational(rational),
            Profile::of(&tables::DETENTS, 1).alone(),
            magnet.damped(0.01).alone(),
        ] {
            let asked = CertifyRequest(scene(environment));
            assert_eq!(decode(&encode(&asked)), Some(asked));
        }
    }

    #[test]
    fn a_reply_carries_the_bits_of_the_assessment() {
        let scene = Scene {
            torque_limit: None,
            coupling: Coupling::Rigid,
            ..scene(Wall::spring(1.0, 1).alone())
        };
        let count = |run: &mut dyn FnMut()| {
            run();
            17
        };
        let reply = certify(&scene, count).unwrap();
        let found = assess(&scene);
        assert_eq!(
            (reply.alpha, reply.alpha_coupled),
            (bits(found.alpha), bits(found.alpha_coupled))
        );
        assert_eq!((reply.paper, reply.exact), (found.paper, found.exact));
        assert_eq!((reply.instructions, reply.verdict_instructions), (17, 17));
        assert_eq!((reply.alpha_port, reply.is_certified), (None, found.outcome.is_ok()));
        assert_eq!(decode(&encode(&reply)), Some(reply));
        assert_eq!(decode::<CertifyReply>(&[u8::MAX; FRAME]), None);
    }
}
