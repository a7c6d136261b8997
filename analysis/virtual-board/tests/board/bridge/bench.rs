//! A virtual board with a motor at its bridge.

use std::path::PathBuf;
use std::sync::OnceLock;

use analysis::toolchain::TorqueOutput;
use haptic_servo::current::{Drive, Regeneration, Winding};
use haptic_servo::dac::DacCode;
use haptic_servo::servo::Transducers;
use virtual_board::board::{BusAccess, VirtualBoard};
use virtual_board::bridge_memory::BridgeMemory;
use virtual_board::chip::B_G431B_ESC1;
use virtual_board::device::Device;
use virtual_board::motor::{self, Motor};
use virtual_board::peripheral::pins::Level;
use virtual_board::power_stage::{Circuit, Gates, Supply};

use super::bridge_wall::{CURRENT_LOOP, DRIVE};
use crate::bench::{Bench, MID_SCALE, build_for};

/// Core clocks in a period of the modulation.
pub const INSTANT: u64 = 2 * CURRENT_LOOP.timer_counts() as u64;

/// The programs that drive the bridge.
const PROGRAMS: [&str; 4] = ["bridge_identify", "bridge_wall", "brushless_index", "brushless_wall"];

/// A program's file. All of them are built when the first is asked for.
fn program(name: &str) -> &'static PathBuf {
    static FILES: OnceLock<Vec<PathBuf>> = OnceLock::new();
    let files = FILES.get_or_init(|| build_for(&B_G431B_ESC1, TorqueOutput::Bridge, &PROGRAMS));
    let place = PROGRAMS.iter().position(|known| *known == name);
    &files[place.expect("it drives the bridge")]
}

/// The motor that a program is for.
pub fn motor(drive: &Drive) -> Motor {
    let haptic_servo::current::Motor { winding, resistance, inductance, torque_constant } =
        drive.motor;
    let winding = match winding {
        Winding::Brushed => motor::Winding::Brushed,
        Winding::Brushless { pole_pairs } => {
            motor::Winding::Brushless { pole_pairs: pole_pairs.into(), offset: 0.0 }
        }
    };
    Motor::new(winding, resistance, inductance, torque_constant)
}

/// The supply that a program is for.
pub fn supply(drive: &Drive) -> Supply {
    let volts = drive.supply.open_voltage();
    match drive.supply.regeneration {
        Regeneration::Sinks => Supply::stiff(volts),
        Regeneration::Stores { capacitance, .. } => Supply::that_stores(volts, capacitance),
    }
}

/// A bench with the motor of `bridge_wall`, whose gates are recorded.
pub fn boot(device: impl Device + Send + 'static) -> Bench {
    let mut bench = boot_program("bridge_wall", motor(&DRIVE), device);
    bench.board_mut().gates = Some(Vec::new());
    bench
}

/// A bench with a program and a motor.
pub fn boot_program(name: &str, motor: Motor, device: impl Device + Send + 'static) -> Bench {
    let mut bench = Bench::boot_file(&B_G431B_ESC1, program(name), device);
    let circuit = circuit(&mut bench);
    circuit.motor = Some(motor);
    circuit.supply = supply(&DRIVE);
    bench
}

/// The same, armed and run until the scene is felt.
pub fn running(device: impl Device + Send + 'static) -> Bench {
    /// More than the time of the start-up, and the tenth of a second in which the clamp opens.
    const OPEN: u64 = 125;
    let mut bench = boot(device);
    armed(&mut bench);
    bench.run(OPEN);
    bench
}

/// Has the gates switched on, once the amplifiers' offsets are known; gives the tick in which they were.
pub fn armed(bench: &mut Bench) -> usize {
    /// More than the 256 instants of which the offsets are the mean.
    const MEASURED: u64 = 10;
    bench.run(MEASURED);
    bench.armed()
}

/// The circuit at the power stage.
pub fn circuit(bench: &mut Bench) -> &mut Circuit {
    &mut bench.board_mut().power_stage.circuit
}

/// The changes of the gates so far.
pub fn gates(bench: &Bench) -> &[(u64, Gates)] {
    bench.board().gates.as_deref().unwrap()
}

/// Whether any gate is high now.
pub fn has_high_gate(board: &VirtualBoard) -> bool {
    board.power_stage.gates().contains(&Level::High)
}

/// The accesses to peripherals since the last time.
pub fn take_accesses(bench: &mut Bench) -> Vec<BusAccess> {
    bench.board_mut().accesses.replace(Vec::new()).unwrap_or_default()
}

/// The code that the servo gave last.
pub fn code(bench: &mut Bench) -> u16 {
    let machine = &bench.machine;
    let memory = BridgeMemory::of(machine.image()).expect("the bridge's waiting code has a place");
    memory.code(machine.core()).expect("that is in memory")
}

/// The torque in N m of the code that the servo gave last.
pub fn asked_torque(bench: &mut Bench, transducers: &Transducers) -> f64 {
    let step = transducers.full_scale_torque / f64::from(DacCode::CODES_TO_FULL_SCALE);
    (f64::from(code(bench)) - f64::from(MID_SCALE)) * step
}

/// Runs to the next valley of the modulation.
pub fn run_to_valley(bench: &mut Bench) {
    let board = bench.board();
    let valley = board.power_stage.timer.valley().expect("the counter runs");
    bench.run_for(valley + INSTANT - board.now);
}
