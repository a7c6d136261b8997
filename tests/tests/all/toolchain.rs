//! What all tests of emulated and flashed programs build with.

use std::path::PathBuf;
use std::sync::LazyLock;

use analysis::emulator::Client;
use analysis::toolchain::{NumberFormat, Toolchain, Tools, prepare};

pub static TOOLCHAIN: LazyLock<Toolchain> =
    LazyLock::new(|| prepare(Tools::CompilerAndEmulator).unwrap_or_else(|error| panic!("{error}")));

/// The program of a scene in f32 on the emulated board.
pub fn scene(name: &str) -> PathBuf {
    let built = TOOLCHAIN.build_scene(name, NumberFormat::F32);
    built.unwrap_or_else(|error| panic!("{error}"))
}

/// A server of `firmware-harness` on the emulated board.
pub fn harness(name: &str) -> PathBuf {
    TOOLCHAIN.build_harness(name).unwrap_or_else(|error| panic!("{error}"))
}

/// The board that runs whatever program it is asked for.
pub fn bench_board() -> Client {
    Client::boot(&harness("bench_programs")).unwrap()
}
