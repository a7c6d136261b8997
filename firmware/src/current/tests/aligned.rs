//! Alignment against motors with any wiring, and their torque afterwards.

use super::rig::{Handle, ThreePhases};
use super::*;

pub const WIRES: [[usize; 3]; 6] =
    [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]];

pub const HANDLE: Handle =
    Handle { inertia: 2.2e-5, damping: 1e-3, friction: 1e-3, cogging: (0.0, 0.0) };

/// Runs an alignment to its end; the longest of all takes less than seven seconds.
pub fn align(rig: &mut ThreePhases) -> Result<PhaseAlignment, AlignmentError> {
    let mut alignment = rig.controller.start_alignment().unwrap();
    for _ in 0..280_000 {
        match rig.controller.align(&rig.sample(), &mut alignment).unwrap() {
            AlignmentStep::Turning(duties) => rig.pass_with(duties),
            AlignmentStep::Ended(result) => {
                assert!(rig.largest() < 0.2, "{}", rig.largest());
                return result;
            }
        }
        // A quarter of full scale, with its tolerance.
        assert!(rig.largest() < 1.3, "{}", rig.largest());
    }
    panic!("it has no end")
}

pub fn rig(wires: [usize; 3], encoder: f64, handle: Option<Handle>) -> ThreePhases {
    let mut rig = ThreePhases::off(&BRUSHLESS);
    (rig.wires, rig.encoder, rig.handle, rig.edges) = (wires, encoder, handle, false);
    rig.angle = 0.3;
    rig.measured()
}

/// Torque in N m in the direction in which the encoder counts up, at several angles: of a code of 1000.
pub fn torques(rig: &mut ThreePhases) -> Vec<f64> {
    (rig.handle, rig.speed, rig.edges) = (None, 0.0, true);
    rig.controller.start().unwrap();
    let torque = |_| {
        rig.speed = 10.0;
        for _ in 0..350 {
            rig.instant(1000).unwrap();
        }
        rig.encoder * rig.torque()
    };
    (0..12).map(torque).collect()
}

#[test]
fn any_wires_and_any_encoder_give_torque_of_the_right_sign() {
    for wires in WIRES {
        for encoder in [1.0, -1.0] {
            let mut rig = rig(wires, encoder, Some(HANDLE));
            let begin = rig.angle;
            let phase = align(&mut rig).unwrap();
            let is_odd = [[1, 0, 2], [0, 2, 1], [2, 1, 0]].contains(&wires);
            assert_eq!(phase.is_reversed, is_odd != (encoder < 0.0), "{wires:?}, {encoder}");
            // It returns to the magnets' zero, which is at most an electrical turn away.
            assert!((rig.angle - begin).abs() < std::f64::consts::TAU / 7.0, "{}", rig.angle);
            let wanted = 0.2 * 1000.0 / 1791.0;
            for torque in torques(&mut rig) {
                assert!(
                    (torque / wanted - 1.0).abs() < 0.04,
                    "{wires:?}, {encoder}: {torque}, {wanted}"
                );
            }
        }
    }
}

#[test]
fn begins_at_any_angle() {
    for part in 0..16 {
        let mut rig = rig(WIRES[0], 1.0, Some(HANDLE));
        rig.angle = f64::from(part) / 16.0 * std::f64::consts::TAU / 7.0 - 1.0 / 7.0;
        rig = rig.measured();
        let phase = align(&mut rig).unwrap();
        let off = phase.offset.wrapping_sub((1.0 / std::f64::consts::TAU * 2_f64.powi(32)) as u32);
        let degrees = f64::from(off.cast_signed()) / 2_f64.powi(32) * 360.0;
        assert!(degrees.abs() < 5.0 && !phase.is_reversed, "{part}: {degrees}");
    }
}

#[test]
fn other_pole_pairs_are_refused() {
    for pole_pairs in [1.0, 2.0, 5.0, 6.0, 8.0, 9.0, 14.0, 21.0] {
        let mut rig = rig(WIRES[0], 1.0, Some(HANDLE));
        rig.pole_pairs = pole_pairs;
        let Err(AlignmentError::PolePairs { moved, expected: 8777 }) = align(&mut rig) else {
            panic!("{pole_pairs}: {:?}", align(&mut rig))
        };
        let turn = 61_440.0 / pole_pairs;
        assert!((f64::from(moved) / turn - 1.0).abs() < 0.05, "{pole_pairs}: {moved}, {turn}");
        // And nothing runs afterwards.
        assert_eq!(rig.controller.start(), Err(PowerFault::NotAligned { by_index: false }));
    }
}

#[test]
fn a_blocked_handle_is_refused() {
    for friction in [1.0, 0.06] {
        let mut rig = rig(WIRES[0], 1.0, Some(Handle { friction, ..HANDLE }));
        let result = align(&mut rig);
        assert!(matches!(result, Err(AlignmentError::Blocked { .. })), "{result:?}");
        assert!(result.unwrap_err().to_string().contains("an electrical turn has 8777"));
    }
}

/// Aligned well, or refused: with friction and cogging of up to all that the current has.
#[test]
fn friction_and_cogging_leave_a_good_phase_or_none() {
    let (mut good, mut refused) = (0, 0);
    for friction in [0.0, 5e-3, 2.5e-2] {
        for cogging in [0.0, 5e-3, 2e-2, 6e-2] {
            for periods in [42.0, 12.0] {
                let handle = Handle { friction, cogging: (cogging, periods), ..HANDLE };
                let mut rig = rig(WIRES[3], -1.0, Some(handle));
                match align(&mut rig) {
                    Ok(_) => {
                        let wanted = 0.2 * 1000.0 / 1791.0;
                        let least = torques(&mut rig).into_iter().fold(f64::INFINITY, f64::min);
                        assert!(least > 0.85 * wanted, "{friction}, {cogging}, {periods}: {least}");
                        good += 1;
                    }
                    Err(error) => {
                        assert!(cogging + friction > 1e-2, "{friction}, {cogging}: {error}");
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(good > 8 && refused > 4, "{good}, {refused}");
}

#[test]
fn a_hand_that_moves_the_handle_is_refused() {
    let mut rig = rig(WIRES[0], 1.0, None);
    rig.speed = 0.4;
    assert!(align(&mut rig).is_err());
}

#[test]
fn a_brushed_motor_needs_none() {
    let mut controller = CurrentController::new(&BRUSHED);
    let sample = rig(WIRES[0], 1.0, None).sample();
    for _ in 0..300 {
        controller.measure_offset(&sample);
    }
    let mut alignment = controller.start_alignment().unwrap();
    let ended = AlignmentStep::Ended(Err(AlignmentError::NotNeeded));
    assert_eq!(controller.align(&sample, &mut alignment), Ok(ended));
}
