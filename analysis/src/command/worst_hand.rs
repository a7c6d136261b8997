//! `haptic worst-hand`: searches for a passive hand in which a scene oscillates.

use clap::Args;

use super::shared_arguments::{JsonOption, SceneArgument};
use super::status::{CommandError, CommandStatus};
use crate::quantity::significant;
use crate::worst_hand::{SearchResult, search};

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub scene: SceneArgument,
    #[command(flatten)]
    pub answer: JsonOption,
}

/// Searches: the status is negative if a hand was found.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let file = arguments.scene.load_to_simulate()?;
    let search = search(&file.scene, &file.chain)?;
    let period = file.scene.timing.period;
    arguments.answer.print(&search, |search| text(&file.name, period, search))?;
    Ok(CommandStatus::of(!search.oscillates))
}

/// The growth of a motion, over a time that gives a readable number.
fn growth(spectral_radius: f64, period: f64) -> String {
    let in_a_second = spectral_radius.powf(1.0 / period);
    match in_a_second < 1e6 {
        true => format!("growing {}-fold in a second", significant(in_a_second, 6)),
        false => format!("growing {}-fold in a sample", significant(spectral_radius, 6)),
    }
}

fn text(name: &str, period: f64, search: &SearchResult) -> String {
    let SearchResult { worst, oscillates, lighter, tried, left_out } = search;
    let number = |value: f64| significant(value, 6);
    let loop_of = left_out.map_or_else(String::new, |words| format!(" ({words})"));
    let mut text = format!("scene    {name}{loop_of}\nsearched {tried} passive hands\n");
    if !oscillates {
        text += "result   the device oscillates in none of them\n";
        if let Some(held) = lighter {
            let inertia = number(held.device_inertia);
            text += &format!(
                "         a device of the same damping and {inertia} kg m^2 would, at {} Hz\n",
                number(held.frequency)
            );
        }
        return text;
    }
    let grows = growth(worst.spectral_radius, period);
    text += &format!(
        "result   OSCILLATES at {} Hz, {grows}, in this hand:\n\
         \n[human]\ninertia = {}    # kg m^2\ndamping = {}    # N m s/rad\n\
         stiffness = {}    # N m/rad\n",
        number(worst.frequency),
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
    for absorber in &worst.hand.absorbers {
        text += &format!(
            "# and a mass of {} kg m^2 on a spring of {} N m/rad, on the device\n",
            number(absorber.inertia),
            number(absorber.stiffness)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::growth;

    #[test]
    fn growth_is_over_a_time_in_which_it_can_be_read() {
        assert_eq!(growth(1.001, 1e-3), "growing 2.71692-fold in a second");
        assert_eq!(growth(1.5, 1e-3), "growing 1.5-fold in a sample");
        assert_eq!(growth(1e9, 1e-5), "growing 1e9-fold in a sample");
    }
}
