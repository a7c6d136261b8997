//! What the page of `haptic explore` runs as WebAssembly: the certificate, the servo and the wire's decoder
//! of this workspace, and nothing of its own.
//!
//! A page calls a function in three steps, without any library in between (`page/engine.js`): it writes a
//! text where [`input()`] says, calls the function, and reads the answer where [`text()`] says, and where
//! [`numbers()`] says, if there are many numbers. A function gives 0, or 1 if its answer is
//! the sentence of a refusal. Everything is on one thread; a worker has an instance of its own.

pub mod buffer;
pub mod client;
pub mod constant;
pub mod handle;
pub mod judge;
pub mod keys;
pub mod map;
pub mod motion;
pub mod nyquist;
pub mod presets;
pub mod profile;
pub mod scene_text;
pub mod wire;

#[cfg(test)]
mod test_scenes;

use buffer::Answers;

/// What a function answers: a text or a refusal in a sentence. Numbers, if there are any, go to the buffer
/// beside it.
pub type PageResult = Result<String, String>;

/// The functions of the page, by the names that it calls them.
///
/// `unsafe` is the attribute's word for a name that no other function of the program may have: all that have
/// one are in this list, so that the compiler sees a name that is twice.
macro_rules! functions {
    ($($(#[doc = $doc:literal])* $name:ident = $function:path;)*) => {
        $(
            $(#[doc = $doc])*
            #[unsafe(no_mangle)]
            pub extern "C" fn $name() -> u32 {
                buffer::answer($function)
            }
        )*
    };
}

functions! {
    /// A scene as JSON: what `haptic certify --json` prints, or `{"error": ..}`.
    certify = judge::certify;
    /// A scene as JSON or TOML: its verdict in rows, or its faults, key by key.
    judge = judge::judge;
    /// The same without remedies.
    judge_without_remedies = judge::judge_without_remedies;
    /// Nothing: all keys of a scene, types of environment and presets.
    keys = keys::keys;
    /// A scene file as JSON or TOML: `{"scene": ..}`, whatever its keys are, or `{"errors": ..}`.
    parse = scene_text::parse;
    /// A scene: the scene file in TOML.
    toml = scene_text::toml;
    /// A scene: the constants of a Rust program.
    constant = constant::constant;
    /// A scene for the handle, and the hand that holds it.
    handle_hold = handle::hold;
    /// The handle's next ticks: their numbers.
    handle_move = handle::motion;
    /// Nothing: begins the handle's push.
    handle_push = handle::push;
    /// Nothing: counts and codes of the handle's servo, and its scene.
    handle_record = handle::recorded;
    /// A scene and counts: the codes that its servo makes of them.
    handle_replay = handle::replay;
    /// A scene and a turn: the torque at rest around its knob.
    handle_rim = handle::rim;
    /// A scene and the axes of a map: what it shows; the regions follow row by row.
    map_begin = map::begin;
    /// A row and columns: those cells of the map that was begun.
    map_row = map::row;
    /// A scene: what it would do in a hand, over time.
    motion = motion::motion;
    /// A scene: its Nyquist plot.
    nyquist = nyquist::nyquist;
    /// A scene: its torque over the angle.
    profile = profile::profile;
    /// Nothing: what holds for every board.
    wire_facts = wire::facts;
    /// An address: begins to talk to the board there.
    wire_start = wire::start;
    /// Takes time and bytes from the board; returns the news.
    wire_turn = wire::turn;
    /// Nothing: the link to the board is lost.
    wire_lost = wire::lost;
    /// What a board shall do.
    wire_request = wire::request;
    /// Changes of what runs on the board: a refusal is the board's.
    wire_judge = wire::judge;
    /// `on` or `off`: rows for a record.
    wire_record = wire::record;
    /// A number of columns: the curves of the last seconds.
    wire_curves = wire::curves;
}

/// Where to write the question of the next call, of so many bytes.
#[unsafe(no_mangle)]
pub extern "C" fn input(bytes: usize) -> *mut u8 {
    buffer::input(bytes)
}

/// Where the last answer's text begins.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    buffer::read(Answers::text)
}

/// Bytes of that text.
#[unsafe(no_mangle)]
pub extern "C" fn text_bytes() -> usize {
    buffer::read(Answers::text_bytes)
}

/// Where the last answer's numbers begin.
#[unsafe(no_mangle)]
pub extern "C" fn numbers() -> *const f64 {
    buffer::read(Answers::numbers)
}

/// How many they are.
#[unsafe(no_mangle)]
pub extern "C" fn numbers_count() -> usize {
    buffer::read(Answers::numbers_count)
}
