//! `haptic scope`: a running board on a terminal or as a table.

use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::Args;
use haptic_model::board::timing::stream_every;
use signal_hook::consts::SIGHUP;

use super::status::{CommandError, CommandStatus};
use super::value_parsers::seconds;
use crate::link::{Address, BoardPoller, Link};
use crate::scope::control::Action;
use crate::scope::record::Recorder;
use crate::scope::screen::Screen;
use crate::scope::{Scope, tui};
use crate::terminal;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Address of the board: /dev/ttyACM0 (@BAUD), tcp://HOST:PORT, unix:PATH
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Record every received tick to a file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// End after this number of seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds,
          allow_hyphen_values = true)]
    pub duration: Option<Duration>,
    /// Receive only every Nth tick; default: as many as the terminal shows
    #[arg(long, value_name = "TICKS", value_parser = ticks, allow_hyphen_values = true)]
    pub every: Option<NonZeroU32>,
    /// Width of the view in seconds
    #[arg(long, value_name = "SECONDS", default_value = "5", value_parser = seconds)]
    pub window: Duration,
}

const PICTURE: Duration = Duration::from_millis(33);

/// Shows or records a board's telemetry until the time is up or the user quits.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let is_screen = io::stdout().is_terminal() && !terminal::is_dumb();
    // A pipe or a file gets rows.
    let to_output = arguments.csv.as_deref().map_or(!is_screen, |path| path == Path::new("-"));
    let link = Link::open(&arguments.port)?;
    let every = arguments.every.unwrap_or_else(|| stream_every(link.board().units.period));
    let rows: Option<Box<dyn Write>> = match &arguments.csv {
        _ if to_output => Some(Box::new(io::stdout())),
        Some(path) => Some(Box::new(create(path)?)),
        None => None,
    };
    let mut recorder = rows.map(|rows| Recorder::new(rows, every));
    let mut session = Session {
        interrupted: terminal::interrupted()?,
        scope: Scope::new(arguments.port.to_string(), arguments.window.as_secs_f64()),
        poller: BoardPoller::start(link, every),
        end: arguments.duration.map(|duration| Instant::now() + duration),
    };
    if to_output || !is_screen {
        session.record(recorder.as_mut())?;
    } else {
        session.show(recorder.as_mut())?;
    }
    if let Some(recorder) = &mut recorder {
        recorder.flush()?;
        let (count, gaps) = (recorder.count(), recorder.gaps());
        if !gaps.is_none() {
            writeln!(io::stderr(), "note: {gaps}")?;
        }
        if !to_output {
            writeln!(io::stderr(), "{count} ticks recorded")?;
        }
    }
    Ok(CommandStatus::Success)
}

fn ticks(text: &str) -> Result<NonZeroU32, String> {
    text.parse().map_err(|_| format!("`{text}` must be a whole number from 1 to {}", u32::MAX))
}

fn create(path: &Path) -> Result<File, CommandError> {
    File::create(path).map_err(|source| CommandError::Unwritable { path: path.to_owned(), source })
}

struct Session {
    interrupted: Arc<AtomicBool>,
    scope: Scope,
    poller: BoardPoller,
    end: Option<Instant>,
}

impl Session {
    fn is_over(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
            || self.end.is_some_and(|end| Instant::now() >= end)
    }

    /// Receives messages until then.
    fn listen(&mut self, until: Instant, mut recorder: Option<&mut Recorder>) -> io::Result<()> {
        loop {
            let timeout = until.saturating_duration_since(Instant::now());
            let Some(event) = self.poller.next(timeout) else { break };
            self.scope.take(event, |sample| match &mut recorder {
                Some(recorder) => recorder.add(sample),
                None => Ok(()),
            })?;
        }
        recorder.map_or(Ok(()), Recorder::flush)
    }

    /// Records without a view.
    fn record(&mut self, mut recorder: Option<&mut Recorder>) -> Result<(), CommandError> {
        let mut lost = None;
        while !self.is_over() {
            self.listen(Instant::now() + PICTURE, recorder.as_deref_mut())?;
            if self.scope.lost != lost {
                lost.clone_from(&self.scope.lost);
                let what = lost.as_deref().unwrap_or("connected again");
                writeln!(io::stderr(), "{what}")?;
            }
        }
        Ok(())
    }

    /// Shows a view. It ends with the terminal, too.
    fn show(&mut self, mut recorder: Option<&mut Recorder>) -> Result<(), CommandError> {
        signal_hook::flag::register(SIGHUP, self.interrupted.clone())?;
        let mut screen = Screen::open()?;
        while !self.is_over() {
            self.listen(Instant::now() + PICTURE, recorder.as_deref_mut())?;
            screen.show(&tui::draw(&self.scope, screen.size()), terminal::has_colour(true))?;
            for key in screen.keys()? {
                match self.scope.control.press(key) {
                    Action::None => {}
                    Action::Request(request) => self.poller.request(request),
                    Action::Quit => return Ok(()),
                }
            }
        }
        Ok(())
    }
}
