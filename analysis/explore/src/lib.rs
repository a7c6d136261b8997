//! The WebAssembly module of the page of `haptic explore`: the certificate, the servo and the wire's decoder
//! of this workspace.
//!
//! A page calls a function in three steps, without a library (`page/engine.js`): it writes a text at the
//! address of [`input()`], calls the function, and reads the answer at [`text()`], and many numbers at
//! [`numbers()`]. A function returns 0, or 1 if its answer is the text of a refusal. Everything runs on one
//! thread; a worker has its own instance.

pub mod buffer;
pub mod client;
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

/// The answer of a function: a text, or the text of a refusal. Numbers go to the buffer in addition.
pub type PageResult = Result<String, String>;

/// The functions of the page, by their names.
///
/// The attribute is `unsafe` because another function of the program might have the same name: all such names
/// are in this list, so the compiler detects duplicates.
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
    constant = scene_text::constant;
    /// A scene for the handle, and the hand that holds it.
    handle_hold = handle::hold;
    /// The handle's next ticks: their numbers.
    handle_move = handle::motion;
    /// Nothing: begins the handle's push.
    handle_push = handle::push;
    /// Nothing: counts and codes of the handle's servo, and its scene.
    handle_record = handle::recorded;
    /// A scene and counts: the codes of its servo.
    handle_replay = handle::replay;
    /// A scene and a turn: the torque at rest around its knob.
    handle_rim = handle::rim;
    /// A scene and the axes of a map: its description; the regions follow row by row.
    map_begin = map::begin;
    /// A row and columns: these cells of the map.
    map_row = map::row;
    /// A scene: its motion in a hand.
    motion = motion::motion;
    /// A scene: its Nyquist plot.
    nyquist = nyquist::nyquist;
    /// A scene: its torque over the angle.
    profile = profile::profile;
    /// Nothing: the facts that hold for every board.
    wire_facts = wire::facts;
    /// An address: begins a conversation with the board there.
    wire_start = wire::start;
    /// Takes time and bytes from the board; returns the news.
    wire_turn = wire::turn;
    /// Nothing: the link to the board is lost.
    wire_lost = wire::lost;
    /// A request to a board.
    wire_request = wire::request;
    /// Changes of the running scene: the board's refusal, if any.
    wire_judge = wire::judge;
    /// `on` or `off`: rows for a record.
    wire_record = wire::record;
    /// Nothing: the scene that runs on the board, of the shape of a scene file; null where it is not known.
    wire_scene = wire::scene;
    /// A number of columns: the curves of the last seconds.
    wire_curves = wire::curves;
}

/// Address for the request of the next call, with this size in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn input(bytes: usize) -> *mut u8 {
    buffer::input(bytes)
}

/// Address of the last answer's text.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    buffer::read(|answer| answer.text.as_ptr())
}

/// Size of that text in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn text_bytes() -> usize {
    buffer::read(|answer| answer.text.len())
}

/// Address of the last answer's numbers.
#[unsafe(no_mangle)]
pub extern "C" fn numbers() -> *const f64 {
    buffer::read(|answer| answer.numbers.as_ptr())
}

/// Number of the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn numbers_count() -> usize {
    buffer::read(|answer| answer.numbers.len())
}
