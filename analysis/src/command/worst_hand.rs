//! `haptic worst-hand`: in which hand does a scene oscillate?

use std::io::{self, Write};

use clap::Args;

use super::{Answer, CommandError};
use crate::file::{self, Purpose};
use crate::quantity::significant;
use crate::worst_hand::{Search, search};

/// Arguments of `haptic worst-hand`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Searches: the answer is no where a hand was found.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let file = file::load_for(Purpose::Simulate, &arguments.file)?;
    let search = search(&file.scene, &file.chain)?;
    let mut out = io::stdout().lock();
    if arguments.json {
        serde_json::to_writer(&mut out, &search).map_err(io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{}", text(&file.name, file.scene.timing.period, &search))?;
    }
    out.flush()?;
    Ok(if search.oscillates { Answer::No } else { Answer::Yes })
}

fn text(name: &str, period: f64, search: &Search) -> String {
    let Search { worst, oscillates, lighter, tried } = search;
    let number = |value: f64| significant(value, 6);
    let mut text = format!("scene    {name}\nsearched {tried} passive hands\n");
    if !oscillates {
        text += "result   in none of them does the device oscillate\n";
        if let Some(held) = lighter {
            let inertia = number(held.device_inertia);
            text += &format!(
                "         a device of the same damping and {inertia} kg m^2 would, at {} Hz\n",
                number(held.frequency)
            );
        }
        return text;
    }
    let grows = worst.spectral_radius.powf(1.0 / period);
    text += &format!(
        "result   OSCILLATES at {} Hz, growing {}-fold in a second, in this hand:\n\
         \n[human]\ninertia = {}    # kg m^2\ndamping = {}    # N m s/rad\n\
         stiffness = {}    # N m/rad\n",
        number(worst.frequency),
        number(grows),
        number(worst.hand.inertia),
        number(worst.hand.damping),
        number(worst.hand.stiffness)
    );
    if let Some(link) = worst.hand.link {
        text += &format!(
            "# behind a spring of {} N m/rad and a damper of {} N m s/rad\n",
            number(link.stiffness),
            number(link.damping)
        );
    }
    text
}
