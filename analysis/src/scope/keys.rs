//! Keys, read from what a terminal sends.
//!
//! A key without a letter is a sequence that may contain letters: an arrow key is `ESC [ A`, and `A` alone
//! switches a motor on. A terminal, a network or a signal may split a sequence anywhere, for any time. So only
//! its last byte ends a sequence: no pause does, and no byte that does not belong there. Where programs
//! disagree on the end of a sequence, the longer reading counts. That can lose a key, which is then pressed
//! again, and never invents one. (ECMA-48, section 5; ctlseqs of xterm.)

use std::mem;

/// A key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A letter, a digit, a sign or a space.
    Letter(char),
    /// A letter with Alt, or the first one behind Esc: a terminal sends the same for both.
    Alt(char),
    /// A letter of a pasted text.
    Pasted(char),
    /// Enter.
    Enter,
    /// Backspace.
    Backspace,
    /// Esc.
    Escape,
    /// Ctrl-C.
    Interrupt,
}

const ESCAPE: u8 = 0x1b;
const BELL: u8 = 0x07;

/// What the next byte belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    /// A new key.
    #[default]
    Ground,
    /// The second byte of a sequence, unless ESC was a key.
    Escape { is_reported: bool },
    /// A control sequence, `ESC [` (CSI), after its first parameter so far.
    Control(Option<u16>),
    /// A key of `ESC O` (SS3), or what else ends with a byte from `@` to `~`.
    UpToFinal,
    /// So many more characters.
    Characters(u8),
    /// A text of the terminal, such as its colours, which ends with BEL or `ESC \`.
    Text,
}

/// Reads keys.
#[derive(Debug, Default)]
pub struct KeyReader {
    state: State,
    is_pasting: bool,
    /// The first bytes of a character that has more than one.
    character: Vec<u8>,
}

impl KeyReader {
    /// The keys in these bytes. No bytes show a pause: after it, an ESC that nothing followed is a key. What
    /// comes later is still read as its sequence.
    pub fn read(&mut self, bytes: &[u8]) -> Vec<Key> {
        if bytes.is_empty() && self.state == (State::Escape { is_reported: false }) {
            self.state = State::Escape { is_reported: true };
            return vec![Key::Escape];
        }
        bytes.iter().filter_map(|byte| self.byte(*byte)).collect()
    }

    fn byte(&mut self, byte: u8) -> Option<Key> {
        match byte {
            // Quits from anywhere.
            0x03 => return Some(Key::Interrupt),
            ESCAPE => {
                self.state = State::Escape { is_reported: false };
                return None;
            }
            _ => {}
        }
        match (self.state, byte) {
            (State::Ground, _) => return self.character(byte),
            (State::Escape { .. }, _) => return self.second(byte),
            (State::Control(first), b' '..=b'?') => {
                let digit = char::from(byte).to_digit(10).map(|digit| digit as u16);
                let longer = |digit| first.unwrap_or(0).saturating_mul(10).saturating_add(digit);
                self.state = State::Control(Some(digit.map_or(u16::MAX, longer)));
            }
            (State::Control(first), b'@'..=b'~') => self.end_control(first, byte),
            (State::UpToFinal, b'@'..=b'~') | (State::Text, BELL) => self.state = State::Ground,
            // Characters above 127 are one byte or more: only the first one counts.
            (State::Characters(left), ..=0x7f | 0xc0..) => {
                self.state = if left > 1 { State::Characters(left - 1) } else { State::Ground };
            }
            _ => {}
        }
        None
    }

    /// The byte behind ESC.
    fn second(&mut self, byte: u8) -> Option<Key> {
        let key = matches!(byte, b'!'..=b'~').then(|| Key::Alt(byte.into()));
        self.state = match byte {
            b'[' => State::Control(None),
            b'N' | b'O' | b' '..=b'/' => State::UpToFinal,
            b'P' | b'X' | b']' | b'^' | b'_' => State::Text,
            _ => State::Ground,
        };
        if byte > 0x7f {
            return self.character(byte);
        }
        key.filter(|_| self.state == State::Ground)
    }

    /// The last byte of a control sequence, after its first parameter. Some have characters behind it: function
    /// keys of the Linux console and reports of a mouse.
    fn end_control(&mut self, first: Option<u16>, last: u8) {
        self.state = match (first, last) {
            (None, b'[') => State::Characters(1),
            (None, b't') => State::Characters(2),
            (None, b'M') => State::Characters(3),
            (None, b'T') => State::Characters(6),
            _ => State::Ground,
        };
        match (first, last) {
            (Some(200), b'~') => self.is_pasting = true,
            (Some(201), b'~') => self.is_pasting = false,
            _ => {}
        }
    }

    /// A byte of a character outside of sequences.
    fn character(&mut self, byte: u8) -> Option<Key> {
        let mut bytes = mem::take(&mut self.character);
        if byte.is_ascii() {
            bytes.clear();
        }
        bytes.push(byte);
        let letter = match str::from_utf8(&bytes) {
            Ok(text) => text.chars().next()?,
            Err(error) if error.error_len().is_none() => {
                self.character = bytes;
                return None;
            }
            Err(_) if bytes.len() > 1 => return None,
            Err(_) => byte.into(),
        };
        match letter {
            '\r' | '\n' if !self.is_pasting => Some(Key::Enter),
            '\u{7f}' | '\u{8}' if !self.is_pasting => Some(Key::Backspace),
            // One byte for two: ESC and the byte 64 below.
            '\u{80}'..='\u{9f}' => self.second(letter as u8 - 0x40),
            letter if letter.is_control() => None,
            letter if self.is_pasting => Some(Key::Pasted(letter)),
            letter => Some(Key::Letter(letter)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::control::{Action, Control};
    use super::*;
    use crate::link::Request;

    /// Keys and reports of xterm, VTE, rxvt, kitty, the Linux console, a VT52 and an 8-bit terminal, where ␛, ␠,
    /// ␇, ␍ and ␡ are control characters, and every other character is one byte.
    const SEQUENCES: &str = "␛[A ␛[1;5A ␛[1;2:3A ␛[a ␛OA ␛Oa ␛O5A ␛␛[A ␛␛OA ␛[H ␛OF ␛[1~ ␛[5~ ␛[6;3~ ␛[3$A \
        ␛OP ␛[15~ ␛[24;2~ ␛[[A ␛[Z ␛[I ␛[O ␛[65;2u ␛[27;2;65~ \u{9b}A \u{8f}A \u{c2}\u{9b}A ␛A ␛NA ␛(A ␛␡ ␛␍ \
        ␛[<0;65;65M ␛[<0;65;65m ␛[32;65;65M ␛[M␠AA ␛[MAAA ␛[M␠\u{c2}\u{81}A ␛[M␠\u{c8}A ␛[tAA ␛[TAAAAAA \
        ␛[?1;2;65A ␛[?2026;2$y ␛]11;rgb:AAAA/A/A␇ ␛]0;A\u{c2}\u{9c}A␛\\ ␛P>|A␠A␛\\ ␛_GA;A␛\\ \
        ␛[200~A␍A␛[201~";

    fn sequences() -> impl Iterator<Item = Vec<u8>> {
        let byte = |letter| match letter {
            '␛' => ESCAPE,
            '␠' => b' ',
            '␇' => BELL,
            '␍' => b'\r',
            '␡' => 0x7f,
            letter => u8::try_from(letter).unwrap(),
        };
        SEQUENCES.split(' ').map(move |sequence| sequence.chars().map(byte).collect())
    }

    fn arms(reader: &mut KeyReader, bytes: &[u8]) -> bool {
        let mut control = Control::default();
        let armed = Action::Request(Request::Arm);
        reader.read(bytes).into_iter().any(|key| control.press(key) == armed)
    }

    #[test]
    fn no_part_of_a_sequence_arms_however_it_is_split_and_delayed() {
        for sequence in sequences() {
            for splits in 0..1_u32 << (sequence.len() - 1) {
                for pauses in 0..3 {
                    let mut reader = KeyReader::default();
                    let mut start = 0;
                    for end in 1..=sequence.len() {
                        if end < sequence.len() && splits >> (end - 1) & 1 == 0 {
                            continue;
                        }
                        let part = &sequence[start..end];
                        assert!(!arms(&mut reader, part), "{:?}", sequence.escape_ascii());
                        (0..pauses).for_each(|_| assert!(!arms(&mut reader, b"")));
                        start = end;
                    }
                }
            }
        }
    }

    #[test]
    fn a_sequence_ends_with_its_last_byte() {
        for sequence in sequences() {
            let mut reader = KeyReader::default();
            reader.read(&sequence);
            assert!(arms(&mut reader, b"A"), "{:?}", sequence.escape_ascii());
        }
    }

    /// Whatever has come before: Ctrl-C quits, and Esc and `d` disarm.
    #[test]
    fn every_part_of_a_sequence_leaves_a_way_out() {
        for sequence in sequences() {
            for end in 0..=sequence.len() {
                let mut reader = KeyReader::default();
                reader.read(&sequence[..end]);
                assert_eq!(reader.read(b"\x03"), [Key::Interrupt]);
                assert_eq!(reader.read(b"\x1bd"), [Key::Alt('d')]);
            }
        }
    }

    #[test]
    fn keys_are_told_apart() {
        let mut reader = KeyReader::default();
        let letters = [Key::Letter('t'), Key::Letter('é'), Key::Enter, Key::Backspace];
        assert_eq!(reader.read("té\r\u{7f}\u{1}".as_bytes()), letters);
        assert_eq!(reader.read(b"\xe2\x82"), []);
        assert_eq!(reader.read(b"\xacx"), [Key::Letter('€'), Key::Letter('x')]);
        assert_eq!(reader.read(b"\x1b[200~2\r0\x1b[201~"), ['2', '0'].map(Key::Pasted));
        // Esc is a key after a pause, once.
        assert_eq!(reader.read(b"\x1b"), []);
        assert_eq!((reader.read(b""), reader.read(b"")), (vec![Key::Escape], vec![]));
        assert_eq!(reader.read(b"AA"), [Key::Alt('A'), Key::Letter('A')]);
    }
}
