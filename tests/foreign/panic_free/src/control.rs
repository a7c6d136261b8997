//! A function that can panic: shows that the check sees it.

use std::hint::black_box;

use no_panic::no_panic;

#[no_panic]
#[inline(never)]
fn control(values: &[u8], index: usize) -> u8 {
    values[index]
}

fn main() {
    black_box(control(black_box(&[1, 2]), black_box(1)));
}
