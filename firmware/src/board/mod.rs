//! The platforms of a scene: the STM32 boards, the board that QEMU emulates, and the host, where a program
//! prints its certificate.
//!
//! A scene's program is its numbers and one call of [`scene_program!`](crate::scene_program); this module
//! selects the expansion of that call by the target of the build.
//!
//! All `unsafe` of the library is in the modules of the boards.

pub mod input_filter;
pub mod lockstep_protocol;
pub mod report;
pub mod sim_hardware;

#[cfg(all(target_os = "none", feature = "board-qemu"))]
#[allow(unsafe_code)]
pub mod qemu;

#[cfg(all(target_os = "none", feature = "b-g431b-esc1"))]
pub mod b_g431b_esc1;
#[cfg(all(target_os = "none", any(feature = "board-qemu", feature = "stm32")))]
#[allow(unsafe_code)]
pub mod critical;
#[cfg(all(target_os = "none", any(feature = "board-qemu", feature = "stm32")))]
#[allow(unsafe_code)]
mod fatal;
// Also for boards of other crates.
#[cfg(target_os = "none")]
#[allow(unsafe_code)]
pub mod fault_memory;
#[cfg(all(target_os = "none", feature = "feather-stm32f405"))]
#[allow(unsafe_code)]
pub mod feather_stm32f405;
#[cfg(all(target_os = "none", any(feature = "board-qemu", feature = "stm32")))]
#[allow(unsafe_code)]
pub mod isr_cell;
#[cfg(all(target_os = "none", feature = "nucleo-g474re"))]
#[allow(unsafe_code)]
pub mod nucleo_g474re;
#[cfg(all(target_os = "none", any(feature = "board-qemu", feature = "stm32")))]
#[allow(unsafe_code)]
pub mod stack;
#[cfg(all(target_os = "none", feature = "stm32"))]
#[allow(unsafe_code)]
pub mod stm32;

/// Bits per second on a board's serial port to the host, 8N1: the fastest usual rate that the clocks of all
/// boards reach within a quarter of a per cent.
pub const BAUD: u32 = 460_800;

/// The output mode of a program, by default latched.
#[cfg(not(all(target_os = "none", feature = "board-qemu")))]
pub type ProgramMode<M = crate::servo::Latched> = M;
#[cfg(all(target_os = "none", feature = "board-qemu"))]
pub use qemu::Mode as ProgramMode;

/// Makes a program of a certified scene.
///
/// Takes the scene, its certificate (a constant, so that an unsafe scene does not compile), for an environment
/// of another crate the environment's type after the scene, `scene: SCENE: MyEnvironment`, the transducers, and the
/// types to compute in: `float`, and `fixed` with the feature `fixed-point`; without them `f32` and a `Fixed` of its
/// own. On a board the program runs the servo; on the host it prints the certificate.
///
/// After the certificate of a scene, `host: HOST` is a constant [`HostTorque`](crate::host::HostTorque):
/// what a host may add to the torque of the scene.
///
/// What may follow, in this order, are a type and constant expressions:
///
/// - `output`: when the board puts a code out, such as `AtPhase<10_000>`, 10 microseconds after the
///   beginning of the period of its count ([`AtPhase`](crate::servo::AtPhase)); by default at the next
///   count ([`Latched`](crate::servo::Latched)), and on the emulated board at once;
/// - `bridge`: the [`CurrentLoop`](crate::current::CurrentLoop) of a motor that the board's own bridge
///   drives. Its response is the scene's latency, or this does not compile, and such a program is for
///   boards with a bridge only;
/// - `friction`: the dry friction of the device in N m, if it is known, by which the certificate says
///   whether it comes to rest;
/// - `rendering`: [`RenderingOptions`](crate::servo::RenderingOptions), such as damping that is
///   injected: `RenderingOptions { injection: Some(0.004), ..RenderingOptions::DEFAULT }`;
/// - `options`: [`Options`](crate::servo_loop::Options), such as what to do when the host falls silent:
///   `Options { link: LinkPolicy::Release, ..Options::DEFAULT }`. A servo stays off until the host arms
///   it, after every reset; with `Options::DEFAULT.armed_at_power_on("reason")` it also arms itself when
///   the supply is switched on, and after no other reset. Without words in the reason, which the board
///   logs, the program does not compile;
/// - `encoder`: the [`Chip`](crate::magnetic::Chip) of a magnetic absolute encoder, which a board with the feature
///   `magnetic` reads in place of its quadrature counter: `haptic_servo::magnetic::MT6701`. The scene's age and lag
///   cover the chip's, or this does not compile.
///
/// All of it together is the program's constant `PROGRAM`. Numbers that no board can run do not compile
/// either.
///
/// A board's program is linked with the map `memory.x` of this package, which fits every board. In a crate of
/// your own copy it beside `Cargo.toml`, and let a build script name the folder and the linker's scripts:
///
/// ```no_run
/// let here = std::env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
/// for argument in [format!("-L{here}"), "--nmagic".into(), "-Tlink.x".into(), "-Tdefmt.x".into()] {
///     println!("cargo:rustc-link-arg-bins={argument}");
/// }
/// ```
#[macro_export]
macro_rules! scene_program {
    (
        scene: $scene:ident,
        certified: $certified:ident,
        host: $host:ident,
        transducers: $transducers:ident
        $($rest:tt)*
    ) => {
        $crate::scene_type! {
            /// The structure of the scene.
            pub ThisScene: $certified, host: $host
        }

        /// The environment that the servo renders: the parts of the scene and no others.
        pub type Rendered = $crate::scene_type::Typed<ThisScene>;

        const RENDERED: $crate::certificate::Certified<$crate::scene::Scene<Rendered>> =
            Rendered::certified();

        $crate::scene_program! {
            scene: $scene: Rendered,
            certified: RENDERED,
            transducers: $transducers
            $($rest)*
        }
    };
    (scene: $scene:ident, certified: $certified:ident, $($rest:tt)*) => {
        $crate::scene_type! {
            /// The structure of the scene.
            pub ThisScene: $certified
        }

        /// The environment that the servo renders: the parts of the scene and no others.
        pub type Rendered = $crate::scene_type::Typed<ThisScene>;

        const RENDERED: $crate::certificate::Certified<$crate::scene::Scene<Rendered>> =
            Rendered::certified();

        $crate::scene_program! { scene: $scene: Rendered, certified: RENDERED, $($rest)* }
    };
    (
        scene: $scene:ident: $environment:ty,
        certified: $certified:ident,
        transducers: $transducers:ident,
        float: $float:ty,
        fixed: $fixed:ty
        $(, output: $mode:ty)?
        $(, bridge: $current_loop:ident)?
        $(, friction: $friction:expr)?
        $(, rendering: $rendering:expr)?
        $(, options: $options:expr)?
        $(, encoder: $encoder:expr)?
        $(,)?
    ) => {
        const GIVEN: $crate::certificate::Certified<$crate::scene::Scene<$environment>> =
            $crate::reported_once!($certified);

        /// The flashed program: scene, transducers and options.
        pub const PROGRAM: $crate::boot::Program<$environment> = $crate::boot::Program {
            scene: *GIVEN.scene(),
            transducers: $transducers,
            rendering: $crate::servo::RenderingOptions {
                $(returned: $current_loop.returned(),)?
                ..$crate::or_default!($crate::servo::RenderingOptions $(, $rendering)?)
            },
            options: $crate::or_default!($crate::servo_loop::Options $(, $options)?),
        };

        // Not in `PROGRAM` itself, which is used elsewhere, so that the error appears once.
        const _: $crate::boot::Program<$environment> = PROGRAM.checked();

        // A board that refuses the scene itself reports more.
        const _: () = match CERTIFIED_AS_IT_RUNS.time::<$crate::servo::Simultaneous>() {
            Ok(timed) => {
                PROGRAM.rendering.checked_beside(timed.injectable_damping());
                let injected = match PROGRAM.rendering.injection {
                    Some(damping) => damping,
                    None => 0.0,
                };
                type Number = $crate::chosen_number!($float, $fixed);
                PROGRAM.check_host::<Number>(
                    timed.margin_with(injected),
                    <$crate::board::ProgramMode<$($mode)?> as $crate::servo::OutputMode>::TIMING,
                );
            }
            Err(_) => (),
        };

        /// The certificate of the rounded coefficients of the program's number format. If the scene does not
        /// certify with them, this does not compile.
        pub const CERTIFIED_AS_IT_RUNS: $crate::certificate::Certified<
            $crate::scene::Scene<$environment>,
        > = GIVEN.certified_in(
            <$crate::chosen_number!($float, $fixed) as $crate::number::Number>::FORMAT,
        );

        // On every target, because a board would refuse the scene as well.
        $(const _: $crate::certificate::TimingChecked<$crate::scene::Scene<$environment>, $mode> =
            CERTIFIED_AS_IT_RUNS.timing_checked::<$mode>();)?

        $crate::bridge_checked!([$($current_loop)?] [$($mode)?] $scene, GIVEN, $transducers);

        $crate::encoder_checked!([$($encoder)?] [$($current_loop)?] $scene, $transducers);

        /// The current loop of the board's bridge; `None` with a DAC and an external amplifier.
        #[cfg(not(target_os = "none"))]
        pub const BRIDGE: Option<$crate::current::CurrentLoop> =
            $crate::current_loop_of!($($current_loop)?);

        // The host judges both formats, because the board's format is unknown here.
        #[cfg(not(target_os = "none"))]
        const _: () = {
            let _ = GIVEN.certified_in(<$float as $crate::number::Number>::FORMAT);
            let _ = GIVEN.certified_in(<$fixed as $crate::number::Number>::FORMAT);
        };

        /// Prints the certificate.
        #[cfg(not(target_os = "none"))]
        pub fn main() {
            #[allow(unused_mut, unused_assignments)]
            let mut friction = None;
            $(friction = Some($friction);)?
            let steps = $crate::certificate::Resolution::of(&PROGRAM.transducers, friction);
            $(let steps = steps.with_current_loop(&$current_loop.resolution());)?
            let injection = PROGRAM.rendering.injection;
            if !CERTIFIED_AS_IT_RUNS.is_what_is_stated() {
                eprintln!("the constant was certified as something else than its environment states");
                ::std::process::exit(1);
            }
            print!(
                "{}",
                $crate::board::report::Report::new(&CERTIFIED_AS_IT_RUNS, &steps, injection)
            );
            if let $crate::servo_loop::Arming::AtPowerOn(reason) = PROGRAM.options.arming {
                println!("armed at power-on: {}", reason.as_str());
            }
        }

        #[cfg(target_os = "none")]
        $crate::board_program!(
            $environment,
            PROGRAM,
            CERTIFIED_AS_IT_RUNS,
            $crate::chosen_number!($float, $fixed),
            [$($mode)?],
            [$($current_loop)?],
            [$($encoder)?]
        );
    };
    (
        scene: $scene:ident: $environment:ty,
        certified: $certified:ident,
        transducers: $transducers:ident,
        float: $($other:tt)*
    ) => {
        compile_error!("after `float` and `fixed` come the options of `scene_program!`, in their order");
    };
    (
        scene: $scene:ident: $environment:ty,
        certified: $certified:ident,
        transducers: $transducers:ident
        $($rest:tt)*
    ) => {
        /// Angles to 128 rad and torques to 128 N m, in steps of 6e-8.
        pub type Fixed = $crate::number::fixed::types::I8F24;

        $crate::scene_program! {
            scene: $scene: $environment,
            certified: $certified,
            transducers: $transducers,
            float: f32,
            fixed: Fixed
            $($rest)*
        }
    };
}

/// The current loop of a program, where it has one, is that of its scene, its transducers and its output, and
/// its supply bears the energy that the scene returns.
#[doc(hidden)]
#[macro_export]
macro_rules! bridge_checked {
    ([] $mode:tt $scene:ident, $certified:ident, $transducers:ident) => {};
    ([$current_loop:ident] [$($mode:ty)?] $scene:ident, $certified:ident, $transducers:ident) => {
        const _: () = $current_loop.check_serves(
            &$scene.latency,
            $scene.timing.period,
            &$transducers,
            &$scene.device,
            <$crate::board::ProgramMode<$($mode)?> as $crate::servo::OutputMode>::TIMING,
        );

        const _: () = $current_loop.check_regeneration(
            $certified.as_data(),
            &$transducers,
            PROGRAM.rendering.injection,
        );
    };
}

/// The readings of a program's chip, where it has one, are those that the certificate covers.
#[doc(hidden)]
#[macro_export]
macro_rules! encoder_checked {
    ([] $bridge:tt $($any:tt)*) => {};
    ([$chip:expr] $bridge:tt $scene:ident, $transducers:ident) => {
        const _: &$crate::magnetic::Chip = $chip.checked(
            &$scene.latency,
            &$crate::transfers_of!($chip, $bridge, $scene.timing.period),
            $transducers.counts_per_turn,
        );
    };
}

/// When a program's board makes the transfers of its chip, with or without a bridge.
#[doc(hidden)]
#[macro_export]
macro_rules! transfers_of {
    ($chip:expr, [], $period:expr) => {
        $crate::magnetic::Transfers::at_count(&$chip, $period)
    };
    ($chip:expr, [$current_loop:ident], $period:expr) => {
        $current_loop.transfers(&$chip)
    };
}

/// The current loop of a program, where it has one.
#[doc(hidden)]
#[macro_export]
macro_rules! current_loop_of {
    () => {
        None
    };
    ($current_loop:ident) => {
        Some($current_loop)
    };
}

/// An optional argument of a macro, or its type's default.
#[doc(hidden)]
#[macro_export]
macro_rules! or_default {
    ($options:ty) => {
        <$options>::DEFAULT
    };
    ($options:ty, $given:expr) => {
        $given
    };
}

/// Makes a program of a sweep, its transducers and the limits of the motion: on a board it plays the sweep
/// within the limits, on the host it prints the plan. With the [`CurrentLoop`](crate::current::CurrentLoop)
/// of a motor it also runs on boards with a bridge, and with the [`Chip`](crate::magnetic::Chip) of a magnetic
/// encoder on a board with the feature `magnetic`.
#[macro_export]
macro_rules! sweep_program {
    (
        $sweep:ident, $transducers:ident, $limits:ident
        $(, bridge: $current_loop:ident)? $(, encoder: $encoder:expr)?
    ) => {
        /// The limits in counts. Limits that would not stop any motion do not compile.
        pub const GUARD: $crate::excitation::Guard =
            $crate::excitation::Guard::planned(&$limits, &$transducers, $sweep.period());

        // On every target, also where a simulated device needs no limits and the host paces.
        const _: () = {
            let _ = GUARD;
            $crate::period::checked($sweep.period());
        };

        /// Prints the plan.
        #[cfg(not(target_os = "none"))]
        pub fn main() {
            print!("{}", $sweep);
        }

        #[cfg(target_os = "none")]
        $crate::board_sweep!($sweep, $transducers, $limits, [$($current_loop)?], [$($encoder)?]);
    };
}

/// The number format of the two that the feature `fixed-point` chooses.
#[cfg(feature = "fixed-point")]
#[doc(hidden)]
#[macro_export]
macro_rules! chosen_number {
    ($float:ty, $fixed:ty) => {
        $fixed
    };
}

/// The number format of the two that the feature `fixed-point` chooses.
#[cfg(not(feature = "fixed-point"))]
#[doc(hidden)]
#[macro_export]
macro_rules! chosen_number {
    ($float:ty, $fixed:ty) => {
        $float
    };
}

/// The program of a scene without a named board.
#[cfg(all(target_os = "none", not(any(feature = "board-qemu", feature = "stm32"))))]
#[doc(hidden)]
#[macro_export]
macro_rules! board_program {
    ($($any:tt)*) => {
        compile_error!(
            "name the board that this program is for: --features nucleo-g474re, b-g431b-esc1 or \
             feather-stm32f405, or board-qemu,log for the emulated one"
        );
    };
}

/// The program of a sweep without a named board.
#[cfg(all(target_os = "none", not(any(feature = "board-qemu", feature = "stm32"))))]
#[doc(hidden)]
#[macro_export]
macro_rules! board_sweep {
    ($($any:tt)*) => {
        $crate::board_program!();
    };
}
