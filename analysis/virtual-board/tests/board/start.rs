//! From power-on to the first torque.

use virtual_board::board::Event;
use virtual_board::chip::B_G431B_ESC1;
use virtual_board::device::FixedDevice;
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, build, on_both};

/// Counts from the face into the damper wall at which it pushes harder than its torque limit of
/// 1 N m: two springs in a row, of 44 and 22 N m/rad, and 61,440 counts a turn.
const DEEP: i32 = 900;

#[test]
fn nothing_is_driven_before_the_amplifier_is_off_and_that_is_on_only_once_it_is_armed() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
        bench.turn(DEEP);
        bench.run(300);
        let events: Vec<_> = bench.events().iter().map(|&(_, event)| event).collect();
        // The DAC is at mid-scale from the first moment on in which it drives its pin.
        let order = [Event::Amplifier(Level::Low), Event::Torque(Some(MID_SCALE))];
        assert_eq!(events, order);
        assert!(bench.board().watchdog.due().is_some());
        bench.armed();
        let (on, event) = bench.events()[2];
        assert_eq!(event, Event::Amplifier(Level::High));
        // In a tick, and in none of the program's other moments.
        let most = bench.board().meter.interrupt().most;
        let since =
            bench.period() - (bench.board().tick_timer.due().unwrap() - on) % bench.period();
        assert!(since <= most, "{since} of {most}");
    });
}

#[test]
fn where_the_encoder_stands_at_power_on_is_zero() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
        // Turned while the driver has set the counter up and the servo does not run yet.
        while !bench.board().encoder.counts_encoder() {
            bench.run_for(100);
        }
        assert_eq!(bench.board().samples, 0);
        bench.board_mut().turn_encoder(12_345);
        bench.armed();
        bench.run(200);
        assert_eq!(bench.status().count, 0);
        assert!(bench.pins().samples.iter().all(|sample| sample.code == Some(MID_SCALE)));
    });
}

/// Ports as the virtual boards number them.
const A: usize = 0;
const B: usize = 1;
const C: usize = 2;

#[test]
fn the_power_stage_of_an_esc_is_off_before_its_torque_pin_is_driven() {
    let file = build(&B_G431B_ESC1, &["damper_wall"]).remove(0);
    let mut bench = Bench::boot_file(&B_G431B_ESC1, &file, FixedDevice);
    while bench.board().torque().is_none() {
        bench.run_for(10);
    }
    let board = bench.board();
    // High sides and low sides of U, V and W (UM2516, table 4).
    for (port, pin) in [(A, 8), (A, 9), (A, 10), (C, 13), (A, 12), (B, 15)] {
        assert_eq!(board.level(port, pin), Level::Low, "port {port}, pin {pin}");
    }
    assert_eq!((board.torque(), board.amplifier()), (Some(MID_SCALE), Level::Low));
    bench.armed();
    let events: Vec<_> = bench.events().iter().map(|&(_, event)| event).collect();
    let [low, high] = [Level::Low, Level::High].map(Event::Amplifier);
    assert_eq!(events, [low, Event::Torque(Some(MID_SCALE)), high]);
}

/// The longest filter, of those in the reference manuals' table, that is a quarter of a count's time.
#[test]
fn the_encoders_inputs_are_filtered_as_its_edges_allow_and_pulled_where_they_bear_it() {
    /// Timer clocks by the setting ICxF.
    const CLOCKS: [u32; 16] = [0, 2, 4, 8, 12, 16, 24, 32, 48, 64, 80, 96, 128, 160, 192, 256];
    let count = std::f64::consts::TAU / 61_440.0 / 100.0;
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
        bench.run(3);
        let board = bench.board();
        let clock = (chip.core / board.clock.timer_divider()) as f64;
        let fits = |&clocks: &u32| f64::from(clocks) / clock <= count / 4.0;
        let longest = CLOCKS.iter().rposition(fits).unwrap() as u32;
        assert_eq!(board.encoder.filters(), [longest; 2]);
        // The F405's pins bear the 5 V of their connector only where the chip does not pull.
        assert_eq!(board.pulls_encoder(), chip.name == "nucleo-g474re");
    });
}
