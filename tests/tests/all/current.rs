//! What an instant of the current loop takes on the emulated board, and that it computes as the host does.

use firmware_harness::bench_request::BenchRequest;
use firmware_harness::currents::{CurrentBench, Input};
use haptic_servo::current::{Duties, Winding};

use crate::toolchain::bench_board;

fn inputs() -> Vec<u32> {
    (1..=4000).map(|instant| Input::of_steps(instant).0).collect()
}

#[test]
#[ignore = "builds for minutes"]
fn an_instant_is_within_its_budget_and_is_the_hosts() {
    let mut board = bench_board();
    for bench in CurrentBench::ALL {
        let outputs = board.compute(&BenchRequest::Current(bench), &inputs()).unwrap();
        let mut controller = bench.started();
        let mut faults = 0;
        for (instant, (input, output)) in (1..).zip(inputs().into_iter().zip(&outputs)) {
            let (sample, code) = Input(input).at(instant);
            let here = controller.step(&sample, code);
            let compare = here.map_or([0; 2], |Duties([u, v, _])| [u, v]);
            assert_eq!(
                (output.value, output.code),
                (compare[0].into(), compare[1]),
                "{instant}: {here:?}"
            );
            if here.is_err() {
                (controller, faults) = (bench.started(), faults + 1);
            }
        }
        let usual = outputs.iter().map(|output| output.instructions).min().unwrap();
        let most = outputs.iter().map(|output| output.instructions).max().unwrap();
        println!("{bench:?}: {usual} to {most} instructions, {faults} faults");
        let budget = match bench.design().winding() {
            Winding::Brushed => 250,
            Winding::Brushless { .. } => 460,
        };
        assert!(most <= budget && faults < 40, "{bench:?}: {most} of {budget}, {faults}");
    }
    board.finish().unwrap();
}
