//! A scene file as a program for boards, as in `firmware/src/bin`.

use haptic_servo::current::{Drive, IndexOffset, Motor, Supply};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::magnetic::Chip;
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::Device;
use haptic_servo::servo::Transducers;

use super::bridge::MotorOnBridge;
use super::constant::{self, Constants, Written, imports, layout};
use super::{SceneFile, excerpt};

/// The program of a scene with these transducers, for a DAC or for a board's own bridge; `source` is the name of
/// its file.
///
/// # Errors
/// Where its environment has no constant.
pub fn program(
    file: &SceneFile,
    transducers: &Transducers,
    bridge: Option<&MotorOnBridge>,
    source: &str,
) -> Written {
    let Constants { environment, scene, items } = constant::of(file)?;
    let of_dac = || OutputTiming::of_delay(file.scene.latency.stated_delay());
    let output = bridge.map_or_else(of_dac, |bridge| bridge.output);
    let (current, driven, current_loop) = bridge.map_or_else(Default::default, |bridge| {
        let mut names = vec![
            "B_G431B_ESC1",
            "CurrentLoop",
            "Drive",
            "Motor",
            "Regeneration",
            "Supply",
            "Winding",
        ];
        let offset = bridge.current_loop.index_offset();
        if offset.is_some() {
            names.splice(3..3, ["EncoderIndex", "IndexOffset"]);
        }
        let driven = current_loop_of(bridge.current_loop.drive(), offset, file.scene.timing.period);
        let current = imports("haptic_servo::current", &names) + "\n";
        (current, driven, "    bridge: CURRENT_LOOP,\n")
    });
    let (mode, option, servo) = match output {
        OutputTiming::AtPhase(nanoseconds) => (
            format!(
                "/// When the torque of a count is put out, in nanoseconds after it.\n\
                 pub type Output = AtPhase<{nanoseconds}>;\n\n"
            ),
            "    output: Output,\n",
            ["AtPhase", "Transducers"].as_slice(),
        ),
        _ => (String::new(), "", ["Transducers"].as_slice()),
    };
    let encoder = file.chip.map_or_else(String::new, |chip| format!("    {},\n", option_of(chip)));
    let host = file.host.map_or("", |_| "    host: HOST,\n");
    let friction = file.friction.map_or_else(String::new, |it| format!("    friction: {it:?},\n"));
    Ok(format!(
        "//! {}, of {}.\n\
         #![cfg_attr(target_os = \"none\", no_std, no_main)]\n\n\
         use haptic_servo::certificate::Certified;\n\
         {current}use haptic_servo::encoder::CounterWidth;\n\
         {environment}\n{scene}\n{}\n\n\
         {}\n\
         {driven}{mode}{items}\n\
         haptic_servo::scene_program! {{\n    \
         scene: SCENE,\n    certified: CERTIFIED,\n{host}    transducers: TRANSDUCERS,\n{option}{current_loop}{friction}{encoder}}}\n",
        excerpt(&file.name),
        excerpt(source),
        imports("haptic_servo::servo", servo),
        constant_of(transducers, file.chip),
    ))
}

/// The option of a program that reads a chip.
pub fn option_of(chip: &Chip) -> String {
    format!("encoder: haptic_servo::magnetic::{}", chip.name.to_uppercase())
}

/// The constant of encoder and motor.
fn constant_of(transducers: &Transducers, chip: Option<&Chip>) -> String {
    let Transducers { counts_per_turn, full_scale_torque, largest_speed, .. } = transducers;
    let counter = chip.map_or(CounterWidth::Bits16, |chip| chip.width);
    let constant = format!(
        "Transducers {{ counts_per_turn: {counts_per_turn:?}, counter: CounterWidth::{counter:?}, \
         full_scale_torque: {full_scale_torque:?}, largest_speed: {largest_speed:?} }}"
    );
    format!(
        "/// The encoder, and the motor with its amplifier, at the handle: torque in N m, speed in rad/s.\n\
         pub const TRANSDUCERS: Transducers = {};\n",
        layout::broken(0, &constant)
    )
}

/// The constants of a motor on a board's own bridge, with its phase at the encoder's index and the servo's period in s.
fn current_loop_of(drive: &Drive, offset: Option<IndexOffset>, period: f64) -> String {
    let index = offset.map_or_else(String::new, |offset| {
        format!("\n        .with_index(EncoderIndex {{ offset: Some({offset:?}) }})")
    });
    let Drive { motor, supply, bandwidth, largest_temperature } = drive;
    let Motor { winding, resistance, inductance, torque_constant } = motor;
    let Supply { lowest, highest, regeneration } = supply;
    format!(
        "/// The motor, its supply, and the bandwidth of its current: ohm, H, N m/A, V, Hz, degrees Celsius.\n\
         pub const DRIVE: Drive = Drive {{\n    \
         motor: Motor {{\n        \
         winding: Winding::{winding:?},\n        \
         resistance: {resistance:?},\n        \
         inductance: {inductance:?},\n        \
         torque_constant: {torque_constant:?},\n    \
         }},\n    \
         supply: Supply {{\n        \
         lowest: {lowest:?},\n        \
         highest: {highest:?},\n        \
         regeneration: Regeneration::{regeneration:?},\n    \
         }},\n    \
         bandwidth: {bandwidth:?},\n    \
         largest_temperature: {largest_temperature:?},\n\
         }};\n\n\
         /// Its current loop, whose times are the scene's.\n\
         pub const CURRENT_LOOP: CurrentLoop =\n    \
         CurrentLoop::checked(&DRIVE, &B_G431B_ESC1, &TRANSDUCERS, {period:?}){index};\n\n"
    )
}

/// A module with the device of a file of this name, as the examples have one of the paddle.
pub fn device_module(
    device: &Device,
    transducers: &Transducers,
    chip: Option<&Chip>,
    source: &str,
) -> String {
    let items = format!(
        "use haptic_servo::encoder::CounterWidth;\n\
         use haptic_servo::scene::Device;\n\
         use haptic_servo::servo::Transducers;\n\n\
         /// The part that the hand holds: inertia in kg m^2, damping in N m s/rad.\n\
         pub const DEVICE: Device = {device:?};\n\n\
         {}",
        constant_of(transducers, chip)
    );
    let indented = |line: &str| if line.is_empty() { "\n".into() } else { format!("    {line}\n") };
    let items: String = items.lines().map(indented).collect();
    // A program that renders no scene has no use for the device itself.
    let source = excerpt(source);
    format!("/// The device of {source}.\n#[allow(dead_code)]\nmod device {{\n{items}}}\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::{Format, example, parse};

    /// One with both is compiled beside the page's sources.
    #[test]
    fn a_program_without_friction_and_phase_has_neither_option() {
        let wall = example::toml("damper-wall").unwrap();
        let file = parse("wall.toml", Format::Toml, &wall).unwrap();
        let text = program(&file, &file.transducers(None, None), None, "wall.toml").unwrap();
        assert!(text.contains("::servo::Transducers;") && !text.contains("Output"), "{text}");
        assert!(text.ends_with("    transducers: TRANSDUCERS,\n}\n"), "{text}");
    }
}
