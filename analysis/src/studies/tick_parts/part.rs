//! The parts of a tick, identified by the functions of their instructions.

/// A part of the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Counts to an angle.
    Encoder,
    /// The environment's spring.
    Spring,
    /// A damper on the backward difference.
    Damper,
    /// A damper behind a velocity filter.
    Filter,
    /// The canceller of the device's damping.
    Canceller,
    /// A wall's face, if it is not at zero or only pushes.
    Face,
    /// Samples between position and torque.
    Delay,
    /// The damping that is injected during a deficit of energy: an option of every program, selected at its
    /// start, for which the program contains a second version of the tick.
    Injection,
    /// The virtual coupling.
    Coupling,
    /// The torque limit, and the clamp that fades.
    Limit,
    /// Torque to a code.
    Converter,
    /// The remainder: stores, and code that the optimiser shares.
    Rest,
}

/// The name of the function of a tick: its beginning and its end.
const TICK: (&str, &str) = ("<haptic_servo::servo::prepared_servo::PreparedServo<", "::tick");

/// The names of a part's functions: the beginning, and another part of the name.
const NAMES: [(&str, &str, Part); 18] = [
    ("<haptic_servo::energy::Injector<", "", Part::Injection),
    ("<haptic_servo::environment::velocity::Difference<", "", Part::Damper),
    ("<haptic_servo::environment::canceller::", "", Part::Canceller),
    ("<haptic_servo::environment::velocity::Washout<", "", Part::Filter),
    ("<haptic_servo::environment::wall_law::Face<", "", Part::Face),
    ("<haptic_servo::environment::wall_law::Displaced<", "", Part::Face),
    ("<", "::positive_part", Part::Face),
    ("<haptic_servo::coupling::Solver<", "::pushing", Part::Face),
    ("<haptic_servo::coupling::Solver<", "::wall_or_face", Part::Face),
    ("<haptic_servo::environment::delay_line::", "", Part::Delay),
    ("<haptic_servo::environment::wall_law::WallLaw<", "", Part::Spring),
    ("<haptic_servo::coupling::", "", Part::Coupling),
    ("<haptic_servo::coupling_memory::", "", Part::Coupling),
    ("<haptic_servo::torque::", "", Part::Limit),
    ("<haptic_servo::encoder::", "", Part::Encoder),
    ("<haptic_servo::servo::Servo<", "::angle", Part::Encoder),
    ("<", "::codes_below", Part::Converter),
    ("<haptic_servo::dac::", "", Part::Converter),
];

impl Part {
    /// All parts with their names, in the order of a tick.
    pub const ALL: [(Self, &str); 12] = [
        (Self::Encoder, "encoder"),
        (Self::Spring, "spring"),
        (Self::Damper, "damper"),
        (Self::Filter, "velocity filter"),
        (Self::Canceller, "canceller"),
        (Self::Face, "face"),
        (Self::Delay, "delay"),
        (Self::Injection, "injected damping"),
        (Self::Coupling, "coupling"),
        (Self::Limit, "torque limit"),
        (Self::Converter, "converter"),
        (Self::Rest, "rest"),
    ];

    /// The part of an instruction, by the functions that it was inlined from, the innermost first; `None` if
    /// it is not of a tick.
    pub(super) fn of(functions: &[String]) -> Option<Self> {
        let (begins, ends) = TICK;
        let is_tick = |name: &String| name.starts_with(begins) && name.ends_with(ends);
        let tick = functions.iter().position(is_tick)?;
        let found = functions[..tick].iter().find_map(|name| Self::of_function(name));
        let found = found.unwrap_or(Self::Rest);
        // The canceller uses the same high-pass as a filter.
        let cancels = |name: &String| Self::of_function(name) == Some(Self::Canceller);
        let is_canceller = found == Self::Filter && functions[..tick].iter().any(cancels);
        Some(if is_canceller { Self::Canceller } else { found })
    }

    fn of_function(name: &str) -> Option<Self> {
        let is =
            |(begins, has, _): &&(&str, &str, Self)| name.starts_with(begins) && name.contains(has);
        NAMES.iter().find(is).map(|(.., part)| *part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: &str =
        "<haptic_servo::servo::prepared_servo::PreparedServo<Wall, f32, Latched>>::tick";

    fn of(inner: &[&str]) -> Option<Part> {
        let functions = inner.iter().chain(&[TICK, "interrupt"]);
        Part::of(&functions.map(|name| (*name).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn the_innermost_part_counts() {
        let number = "<f32 as haptic_servo::number::Number>::times";
        let damper = "<haptic_servo::environment::velocity::Difference<f32> as \
                      haptic_servo::environment::velocity::Velocity<f32>>::add_to";
        let filter = "<haptic_servo::environment::velocity::Washout<f32>>::torque";
        let wall = "<haptic_servo::environment::wall_law::WallLaw<f32, V, S, D>>::line";
        let canceller =
            "<haptic_servo::environment::canceller::CancellerLaw<f32, D> as Law>::evaluate";
        for (inner, part) in [
            (&[number, damper, wall][..], Part::Damper),
            (&[number, wall], Part::Spring),
            (&[number, filter, wall], Part::Filter),
            (&[number, filter, canceller], Part::Canceller),
            (&["<f32 as haptic_servo::number::Number>::positive_part", wall], Part::Face),
            (&[], Part::Rest),
        ] {
            assert_eq!(of(inner), Some(part), "{inner:?}");
        }
        assert_eq!(Part::of(&[number.to_owned(), damper.to_owned()]), None);
    }
}
