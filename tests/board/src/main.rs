//! Trial.
use virtual_board::{chip, device::Still, machine::Machine};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let chip = if args[2] == "g4" { &chip::NUCLEO_G474RE } else { &chip::STM32F405 };
    let mut m = Machine::boot(args[1].as_ref(), chip, Box::new(Still)).unwrap();
    m.board_mut().events = Some(vec![]);
    let t = std::time::Instant::now();
    let r = m.run_samples(args[3].parse().unwrap());
    println!(
        "{:?} now {} samples {} resets {:?}",
        r.as_ref().map_err(|e| e.to_string()),
        m.board().now,
        m.board().samples,
        m.resets()
    );
    println!("events {:?}", m.board().events.as_ref().unwrap().iter().take(20).collect::<Vec<_>>());
    println!("log {:?}", m.log().len());
    println!("{:?}", t.elapsed());
}
