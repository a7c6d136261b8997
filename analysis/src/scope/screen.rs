//! The terminal as a screen: its keys one by one, and a canvas over all of it.

use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::panic;

use nix::libc::termios;
use nix::sys::termios::{SetArg, SpecialCharacterIndices, cfmakeraw, tcgetattr, tcsetattr};
use terminal_size::{Height, Width, terminal_size_of};

use super::canvas::Canvas;
use super::keys::{Key, KeyReader};

/// Switch to the alternate screen, hide the cursor, do not wrap lines, and mark pasted text; and back
/// (ECMA-48, private modes of xterm).
const OPEN: &str = "\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[?2004h";
const CLOSE: &str = "\x1b[?2004l\x1b[?7h\x1b[?25h\x1b[?1049l";
/// The begin and the end of a picture, which a terminal may show at once.
const BEGIN: &str = "\x1b[?2026h";
const END: &str = "\x1b[?2026l";

/// The terminal of this process, as a screen until it is dropped or the process panics.
pub struct Screen {
    terminal: File,
    before: termios,
    keys: KeyReader,
    /// The rows that it shows, and its size then.
    rows: Vec<String>,
    size: (usize, usize),
}

impl Screen {
    /// Takes the terminal.
    ///
    /// # Errors
    /// Where there is none.
    pub fn open() -> io::Result<Self> {
        let terminal = OpenOptions::new().read(true).write(true).open("/dev/tty")?;
        let mut raw = tcgetattr(&terminal)?;
        let before = raw.clone().into();
        cfmakeraw(&mut raw);
        // A read returns what there is, which may be nothing.
        raw.control_chars[SpecialCharacterIndices::VMIN as usize] = 0;
        raw.control_chars[SpecialCharacterIndices::VTIME as usize] = 0;
        let (panicking, hook) = (terminal.try_clone()?, panic::take_hook());
        panic::set_hook(Box::new(move |report| {
            restore(&panicking, before);
            hook(report);
        }));
        let (keys, rows) = (KeyReader::default(), Vec::new());
        let mut screen = Self { terminal, before, keys, rows, size: (0, 0) };
        // What was typed before the view was there is not for it.
        tcsetattr(&screen.terminal, SetArg::TCSAFLUSH, &raw)?;
        screen.terminal.write_all(OPEN.as_bytes())?;
        Ok(screen)
    }

    /// Columns and rows, now.
    pub fn size(&self) -> (usize, usize) {
        let size = terminal_size_of(&self.terminal);
        let (Width(width), Height(height)) = size.unwrap_or((Width(80), Height(24)));
        (width.into(), height.into())
    }

    /// Shows a canvas: writes the rows that have changed.
    ///
    /// # Errors
    /// Where the terminal is gone.
    pub fn show(&mut self, canvas: &Canvas, has_colour: bool) -> io::Result<()> {
        let rows: Vec<String> = canvas.rows(has_colour).collect();
        let mut output = BEGIN.to_owned();
        let size = self.size();
        if self.size != size {
            output += "\x1b[2J";
            self.rows.clear();
        }
        for (index, row) in rows.iter().enumerate() {
            if self.rows.get(index) != Some(row) {
                let _ = write!(output, "\x1b[{};1H{row}", index + 1);
            }
        }
        (self.rows, self.size) = (rows, size);
        self.terminal.write_all((output + END).as_bytes())
    }

    /// The keys that were pressed since the last call.
    ///
    /// # Errors
    /// Where the terminal is gone.
    pub fn keys(&mut self) -> io::Result<Vec<Key>> {
        let mut bytes = [0; 256];
        let length = self.terminal.read(&mut bytes)?;
        Ok(self.keys.read(&bytes[..length]))
    }
}

/// Where the terminal is gone, there is nothing to restore.
fn restore(mut terminal: &File, before: termios) {
    let _ = terminal.write_all(CLOSE.as_bytes());
    let _ = tcsetattr(terminal, SetArg::TCSANOW, &before.into());
}

impl Drop for Screen {
    fn drop(&mut self) {
        restore(&self.terminal, self.before);
    }
}
