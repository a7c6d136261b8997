//! `haptic worst-hand`: in which hand does a scene oscillate?

use clap::Args;

use super::answer::{Answer, CommandError};
use super::common::{ForWhom, SceneArgument};
use crate::quantity::significant;
use crate::worst_hand::{Search, search};

/// Arguments of `haptic worst-hand`.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub scene: SceneArgument,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub answer: ForWhom,
}

/// Searches: the answer is no where a hand was found.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let file = arguments.scene.load_to_simulate()?;
    let search = search(&file.scene, &file.chain)?;
    let period = file.scene.timing.period;
    arguments.answer.print(&search, |search| text(&file.name, period, search))?;
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
