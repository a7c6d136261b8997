//! Failures of common methods: the verdict of each on a loop, the truth, and the certificate's verdict.
//!
//! A case is a question about one loop. Common methods, the certificate and an exact reference answer it;
//! then the loop runs in simulation and with the servo of a board.

mod grid;
mod integration;
pub(crate) mod loaded;
pub mod loop_run;
pub mod method_result;
pub(crate) mod motion;
mod ratchet;
pub mod region;
pub mod report;
mod rules;
pub mod setting;
mod timing;
pub mod varying_hand;
pub mod zigzag;

pub use report::Case;

macro_rules! cases {
    ($($name:literal, $question:literal, $evaluate:path;)*) => {
        /// All cases, in their order of output.
        pub const ALL: &[Case] =
            &[$(Case { name: $name, question: $question, evaluate: $evaluate }),*];
    };
}

cases! {
    "semi-implicit-euler", "a spring of 1500 N m/rad", integration::semi_implicit_euler;
    "continuous-time", "a spring of 5000 N m/rad", rules::continuous_time;
    "negative-spring", "a spring of -200 N m/rad", rules::negative_spring;
    "damped-rule", "a late wall whose damping is the device's", rules::damped_rule;
    "grid", "a resonance of the wrong sign", grid::grid;
    "zigzag", "a wall with nearly the friction that it needs", zigzag::zigzag;
    "mean-delay", "a spring half a period late, behind a current loop", timing::mean_delay;
    "between-ends", "a wall computed ahead and written 5 us after its count", timing::between_ends;
    "varying-hand", "a resonance behind a current loop, just past its limit", varying_hand::varying_hand;
    "ratchet", "24 teeth that push on by 3 N m in the mean", ratchet::ratchet;
}
