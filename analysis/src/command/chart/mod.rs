//! `haptic chart`: pictures of scenes, one module each.

pub mod bode;
pub mod budget;
pub mod failures;
pub mod identify;
pub mod latency;
pub mod limits;
pub mod map;
pub mod nyquist;
mod output;
pub mod profile;
pub mod trace;
pub mod tradeoff;
pub mod turn;

use clap::{Args, Subcommand};

use super::status::{CommandError, CommandStatus};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Which picture.
    #[command(subcommand)]
    pub kind: Kind,
}

/// Which picture.
#[derive(Debug, Subcommand)]
pub enum Kind {
    /// Draw the Nyquist curves of one or more scenes, with the critical line at -delta
    Nyquist(nyquist::Arguments),
    /// Draw gain and phase of the open loop of device and controller, with the margins
    Bode(bode::Arguments),
    /// Draw torque and potential of a torque profile over angle, its steepest slopes, and the slope that
    /// still certifies
    Profile(profile::Arguments),
    /// Draw what a hand feels that turns a torque profile, by the codes of its servo
    Turn(turn::Arguments),
    /// Draw a map of certified, stable and unstable walls over stiffness and damping (Z-width), or of
    /// torque profiles over torque and repetitions in a turn
    Map(map::Arguments),
    /// Draw the largest certified stiffness over the sample rate, with the encoder's torque ripple
    Limits(limits::Arguments),
    /// Draw the largest spring behind current loops over the servo's rate, certified and assumed
    Latency(latency::Arguments),
    /// Draw angle, velocity and torque of a simulation or a recorded run, shaded where limited
    Trace(trace::Arguments),
    /// Draw the energy that a hand takes from a hostile host over time, beside the budget, with the tank and
    /// without
    Budget(budget::Arguments),
    /// Draw the measured responses of a device in the disk of its passivity, with the fitted device
    Identify(identify::Arguments),
    /// Draw the stability limit of methods of integration over their steps in a tick
    Failures(failures::Arguments),
    /// Measure speed and accuracy of methods: tables, charts, Pareto fronts
    Tradeoff(tradeoff::Arguments),
}

pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    match &arguments.kind {
        Kind::Nyquist(of) => of.output.write(|| nyquist::draw(of)),
        Kind::Bode(of) => of.output.write(|| bode::draw(of)),
        Kind::Profile(of) => of.output.write(|| profile::draw(of)),
        Kind::Turn(of) => of.output.write(|| turn::draw(of)),
        Kind::Map(of) => of.output.write(|| map::draw(of)),
        Kind::Limits(of) => of.output.write(|| limits::draw(of)),
        Kind::Latency(of) => of.output.write(|| latency::draw(of)),
        Kind::Trace(of) => trace::run(of),
        Kind::Budget(of) => of.output.write(|| budget::draw(of)),
        Kind::Identify(of) => of.output.write(|| identify::draw(of)),
        Kind::Failures(of) => of.output.write(failures::draw),
        Kind::Tradeoff(of) => tradeoff::run(of),
    }
}
