use virtual_board::power_stage::gate_log::{any_high, shortest_dead_time};

use super::bench::{boot, gates, has_high_gate};
use super::paddle::Paddle;
use crate::bench::MID_SCALE;

#[test]
fn no_gate_is_high_before_the_servo_is_armed() {
    let mut bench = boot(Paddle::still());
    bench.run(300);
    let now = bench.machine.board().now;
    assert!(!any_high(gates(&bench), 0, now));
    bench.armed();
    bench.run(100);
    assert!(has_high_gate(bench.machine.board()));
    println!("{:?} {}", shortest_dead_time(gates(&bench)), super::bench::code(&mut bench));
    println!("{:?}", bench.status());
    println!("{:?}", bench.log());
    assert_eq!(super::bench::code(&mut bench), MID_SCALE);
}
