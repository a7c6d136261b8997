//! Failures of common methods: the verdict of each on a loop, the truth, and the certificate's verdict.
//!
//! A case is a question about one loop. Common methods, the certificate and an exact reference answer it;
//! then the loop runs in simulation and with the emulated board as its servo.

mod case;
pub mod encoder;
pub mod grid;
pub mod integration;
pub mod loaded;
pub mod loop_run;
pub mod method_result;
pub mod motion;
pub mod ratchet;
pub mod region;
pub mod report;
pub mod roots;
pub mod rules;
pub mod setting;
pub mod timing;
pub mod varying_hand;
pub mod zigzag;

pub use case::{Case, CaseResult};

macro_rules! cases {
    ($($name:literal, $question:literal, $evaluate:path;)*) => {
        /// All cases, in their order of output.
        pub const ALL: &[Case] =
            &[$(Case { name: $name, question: $question, evaluate: $evaluate }),*];
    };
}

cases! {
    "explicit-euler", "a certified wall on two masses", integration::explicit_euler;
    "semi-implicit-euler", "a spring of 1500 N m/rad", integration::semi_implicit_euler;
    "continuous-time", "a spring of 5000 N m/rad", rules::continuous_time;
    "negative-spring", "a spring of -200 N m/rad", rules::negative_spring;
    "damped-rule", "a late wall whose damping is the device's", rules::damped_rule;
    "grid", "a resonance of the wrong sign", grid::grid;
    "pole-outside", "a filter with a pole at 1 + 2^-20", roots::outside;
    "pole-inside", "a filter with a pole at 1 - 2^-20", roots::inside;
    "encoder", "the paper's wall behind an encoder", encoder::encoder;
    "zigzag", "a wall with nearly the friction that it needs", zigzag::zigzag;
    "missed-ticks", "a spring near its limit, ticks missed", timing::missed_ticks;
    "mean-delay", "a spring half a period late, behind a current loop", timing::mean_delay;
    "between-ends", "a wall computed ahead and written 5 us after its count", timing::between_ends;
    "varying-hand", "a resonance behind a current loop, just past its limit", varying_hand::varying_hand;
    "ratchet", "24 teeth that push on by 3 N m in the mean", ratchet::ratchet;
}

impl Case {
    /// The case of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|case| case.name == name)
    }
}
