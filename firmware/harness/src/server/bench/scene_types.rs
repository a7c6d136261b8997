//! Scene types for jobs whose numbers come from the host.

use haptic_servo::environment::{Environment, Side, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// Makes `ticks`, which runs a job with the type of the first of these scenes that has the structure of the job's
/// scene; `Err` with the job if none has it.
macro_rules! scene_types {
    ($($name:ident: $scene:expr;)*) => {
        $(mod $name {
            use super::*;

            const CERTIFIED: haptic_servo::certificate::Certified<haptic_servo::scene::Scene> =
                $scene.certified();

            haptic_servo::scene_type!(pub Type: CERTIFIED);
        })*

        pub fn ticks<N: Number>(job: BenchJob<'_>) -> Result<Result<(), HostClosed>, BenchJob<'_>> {
            use haptic_servo::scene_type::Typed;

            $(if let Some(scene) = Typed::<$name::Type>::of(job.scene) {
                return Ok(job.run::<_, N>(scene));
            })*
            Err(job)
        }
    };
}
pub(super) use scene_types;

/// The scene of an environment on the paddle of the programs, with its torque not limited.
pub const fn unlimited(environment: Environment) -> Scene {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 0.001, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment,
        latency: Latency::NONE,
        torque_limit: None,
    }
}

/// A wall that also pulls, at rest elsewhere than at zero.
pub const fn placed(wall: Wall) -> Wall {
    Wall { side: Side::Displaced(0.01), ..wall }
}
