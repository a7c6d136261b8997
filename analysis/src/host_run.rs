//! A run with a host that wants energy: what its torques cost, and what the hand takes of the budget.

use haptic_model::host::{HostEnergy, HostSender, HostTick, HostedServo};
use haptic_servo::host::HostTorque;
use haptic_servo::scene::Scene;
use haptic_servo::servo::OutputTiming;
use haptic_servo::wire::host::{HostCommand, HostReport, HostState};
use haptic_servo::wire::message::{LONGEST_TO_HOST, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder};

use crate::board_message::frame;
use crate::compare_run::{BoardMeasurement, RunError, RunOutcome};
use crate::controller::Controller;
use crate::emulator::Emulator;
use crate::lockstep::{PlantIo, Run, SimulatedDevice};
use crate::virtual_board::VirtualBoard;
