//! Commands to the board that the scope has keys for.

pub use haptic_model::board::request::{Reply, Request};
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use crate::link::change;

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
    pub fn press(&mut self, key: KeyEvent) -> Action {
        if key.kind == KeyEventKind::Release {
            return Action::None;
        }
        if key.modifiers.contains(KeyModifiers::CONTROL) {
            return if key.code == KeyCode::Char('c') { Action::Quit } else { Action::None };
        }
        match self.prompt.take() {
            Some(line) => self.edit(line, key.code),
            None => self.command(key.code),
        }
    }

    fn command(&mut self, key: KeyCode) -> Action {
        match key {
            KeyCode::Char('q') | KeyCode::Esc => Action::Quit,
            KeyCode::Char('A') => Action::Request(Request::Arm),
            KeyCode::Char('d') => Action::Request(Request::Disarm),
            KeyCode::Char('t' | ':') => {
                self.prompt = Some(String::new());
                Action::None
            }
            _ => Action::None,
        }
    }

    /// An invalid line stays, to be corrected.
    fn edit(&mut self, mut line: String, key: KeyCode) -> Action {
        match key {
            KeyCode::Esc => return Action::None,
            KeyCode::Enter => match change::line(&line) {
                Ok(changes) => return Action::Request(Request::Set(changes)),
                Err(why) => self.message = Some(why),
            },
            KeyCode::Backspace => drop(line.pop()),
            KeyCode::Char(letter) => line.push(letter),
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
            '\n' => KeyCode::Enter,
            '\u{8}' => KeyCode::Backspace,
            letter => KeyCode::Char(letter),
        });
        keys.map(|key| control.press(key.into())).last().unwrap_or(Action::None)
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
        assert_eq!(control.press(KeyCode::Esc.into()), Action::None);
        assert_eq!(typed(&mut control, "a"), Action::None);
        assert_eq!(typed(&mut control, "A"), Action::Request(Request::Arm));
        assert_eq!(typed(&mut control, "d"), Action::Request(Request::Disarm));
        assert_eq!(typed(&mut control, "q"), Action::Quit);
        let interrupt = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        typed(&mut control, "t");
        assert_eq!(control.press(interrupt), Action::Quit);
    }
}
