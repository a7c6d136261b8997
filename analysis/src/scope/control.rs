//! Commands to the board that the scope has keys for.

use super::keys::Key;
use crate::link::{Request, change};

/// The action of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Nothing, or only another picture.
    None,
    /// Ask the board.
    Request(Request),
    /// The user quits.
    Quit,
}

/// The keys, as the last line of the view names them.
pub const KEYS: &str = "q quits   t tunes   A arms   d disarms";
/// The keys while a line is typed.
pub const PROMPT_KEYS: &str = "Enter sends   Esc cancels";

/// The line that is typed, and the result of the last one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Control {
    /// The line so far, where one is typed.
    pub prompt: Option<String>,
    /// The reply to the last request, or the error in the line.
    pub message: Option<String>,
}

impl Control {
    /// Takes a key. Arming takes a capital letter: it switches a motor on. Ctrl-C quits from
    /// anywhere.
    pub fn press(&mut self, key: Key) -> Action {
        match self.prompt.take() {
            _ if key == Key::Interrupt => Action::Quit,
            Some(line) => self.edit(line, key),
            None => self.command(key),
        }
    }

    /// A letter behind Esc does what it does alone, but it does not arm: it may be part of another key.
    fn command(&mut self, key: Key) -> Action {
        match key {
            Key::Letter('A') => return Action::Request(Request::Arm),
            Key::Letter('d') | Key::Alt('d') => return Action::Request(Request::Disarm),
            Key::Letter('q') | Key::Alt('q') => return Action::Quit,
            Key::Letter('t' | ':') | Key::Alt('t' | ':') => self.prompt = Some(String::new()),
            _ => {}
        }
        Action::None
    }

    /// An invalid line stays, to be corrected.
    fn edit(&mut self, mut line: String, key: Key) -> Action {
        match key {
            Key::Escape => return Action::None,
            Key::Enter => match change::line(&line) {
                Ok(request) => return Action::Request(request),
                Err(why) => self.message = Some(why),
            },
            Key::Backspace => drop(line.pop()),
            Key::Letter(letter) | Key::Pasted(letter) => line.push(letter),
            _ => {}
        }
        self.prompt = Some(line);
        Action::None
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::certificate::Parameter;
    use haptic_servo::wire::message::Changes;

    use super::*;

    fn typed(control: &mut Control, text: &str) -> Action {
        let keys = text.chars().map(|letter| match letter {
            '\n' => Key::Enter,
            '\u{8}' => Key::Backspace,
            letter => Key::Letter(letter),
        });
        keys.map(|key| control.press(key)).last().unwrap_or(Action::None)
    }

    #[test]
    fn a_line_is_typed_mended_and_sent() {
        let mut control = Control::default();
        assert_eq!(typed(&mut control, "tstifness = 20\n"), Action::None);
        let message = control.message.clone().unwrap();
        assert!(message.contains("no parameter `stifness`"), "{message}");
        let mended = "\u{8}".repeat(10) + "ffness = 20\n";
        let wanted = Changes::from_slice(&[(Parameter::Stiffness, 20.0)]).unwrap();
        assert_eq!(control.prompt.as_deref(), Some("stifness = 20"));
        assert_eq!(typed(&mut control, &mended), Action::Request(Request::Set(wanted)));
        assert_eq!(control.prompt, None);
    }

    #[test]
    fn letters_of_a_line_are_no_commands() {
        let mut control = Control::default();
        assert_eq!(typed(&mut control, "tqAd"), Action::None);
        assert_eq!(control.prompt.as_deref(), Some("qAd"));
        assert_eq!(control.press(Key::Escape), Action::None);
        assert_eq!(typed(&mut control, "a"), Action::None);
        assert_eq!(typed(&mut control, "A"), Action::Request(Request::Arm));
        assert_eq!(typed(&mut control, "d"), Action::Request(Request::Disarm));
        assert_eq!(typed(&mut control, "q"), Action::Quit);
        typed(&mut control, "t");
        assert_eq!(control.press(Key::Interrupt), Action::Quit);
    }
}
