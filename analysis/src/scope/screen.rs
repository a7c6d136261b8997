//! The terminal as a screen: its keys one by one, and a canvas over all of it.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::fd::AsFd;

use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::termios::{SetArg, Termios, cfmakeraw, tcgetattr, tcsetattr};
use terminal_size::{Height, Width, terminal_size};

use super::canvas::Canvas;
use super::control::Key;

/// Switch to the alternate screen and hide the cursor; and back (ECMA-48, private modes of xterm).
const OPEN: &str = "\x1b[?1049h\x1b[?25l";
const CLOSE: &str = "\x1b[?25h\x1b[?1049l";

/// The screen, until it is dropped.
pub struct Screen {
    terminal: File,
    before: Termios,
    /// The rows that it shows.
    rows: Vec<String>,
}

impl Screen {
    /// Takes the terminal.
    ///
    /// # Errors
    /// Where there is none.
    pub fn open() -> io::Result<Self> {
        let terminal = OpenOptions::new().read(true).write(true).open("/dev/tty")?;
        let before = tcgetattr(&terminal)?;
        let mut raw = before.clone();
        cfmakeraw(&mut raw);
        tcsetattr(&terminal, SetArg::TCSANOW, &raw)?;
        let screen = Self { terminal, before, rows: Vec::new() };
        io::stdout().write_all(OPEN.as_bytes())?;
        Ok(screen)
    }

    /// Columns and rows.
    pub fn size() -> (usize, usize) {
        let (Width(width), Height(height)) = terminal_size().unwrap_or((Width(80), Height(24)));
        (width.into(), height.into())
    }

    /// Shows a canvas: writes the rows that have changed.
    ///
    /// # Errors
    /// Where the terminal is gone.
    pub fn show(&mut self, canvas: &Canvas, has_colour: bool) -> io::Result<()> {
        let rows: Vec<_> = canvas.rows(has_colour).collect();
        let mut output = io::stdout().lock();
        if rows.len() != self.rows.len() {
            self.rows = vec![String::new(); rows.len()];
        }
        for (index, (row, before)) in rows.iter().zip(&self.rows).enumerate() {
            if row != before {
                write!(output, "\x1b[{};1H{row}\x1b[K", index + 1)?;
            }
        }
        self.rows = rows;
        output.flush()
    }

    /// The keys that were pressed since the last call.
    ///
    /// # Errors
    /// Where the terminal is gone.
    pub fn keys(&mut self) -> io::Result<Vec<Key>> {
        let mut keys = Vec::new();
        let mut bytes = [0; 64];
        while poll(&mut [PollFd::new(self.terminal.as_fd(), PollFlags::POLLIN)], PollTimeout::ZERO)?
            > 0
        {
            match self.terminal.read(&mut bytes)? {
                0 => return Err(io::ErrorKind::UnexpectedEof.into()),
                length => keys.extend(keys_of(&bytes[..length])),
            }
        }
        Ok(keys)
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // Where the terminal is gone, there is nothing to restore.
        let _ = io::stdout().write_all(CLOSE.as_bytes());
        let _ = io::stdout().flush();
        let _ = tcsetattr(&self.terminal, SetArg::TCSANOW, &self.before);
    }
}

/// The keys of what a terminal in raw mode sends. An escape alone is a key; with more behind it, it is one of
/// the keys that have no letter and no meaning here.
fn keys_of(bytes: &[u8]) -> Vec<Key> {
    let key = |letter| match letter {
        '\r' | '\n' => Some(Key::Enter),
        '\u{7f}' | '\u{8}' => Some(Key::Backspace),
        '\u{3}' => Some(Key::Interrupt),
        letter => (!letter.is_control()).then_some(Key::Letter(letter)),
    };
    match bytes {
        [0x1b] => vec![Key::Escape],
        [0x1b, ..] => Vec::new(),
        _ => String::from_utf8_lossy(bytes).chars().filter_map(key).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_told_apart() {
        let letters = [Key::Letter('t'), Key::Letter('é'), Key::Enter, Key::Backspace];
        assert_eq!(keys_of("té\r\u{7f}\u{1}".as_bytes()), letters);
        assert_eq!((keys_of(b"\x1b"), keys_of(b"\x03")), (vec![Key::Escape], vec![Key::Interrupt]));
        assert_eq!(keys_of(b"\x1b[A"), []);
    }
}
