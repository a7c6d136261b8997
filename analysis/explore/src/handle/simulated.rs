//! A scene's servo with its device, tick by tick.

use std::f64::consts::TAU;

use haptic_model::controller::{Controller, Tick};
use haptic_model::device::{Energy, HandSetpoint};
use haptic_model::file::SceneFile;
use haptic_model::simulation::device_in_hand::{DeviceInHand, ReadingOutcome};
use haptic_servo::dac::DacCode;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{EncoderReading, Scene};
use haptic_servo::servo::Transducers;
use serde::{Deserialize, Serialize};

use super::hosted::{HostMoved, Hosted};
use super::oscillation::{Oscillation, Watch};
use super::push::Push;
use super::servo::{Rendered, Rendering};
use super::settings::Settings;
use super::unchecked::Unchecked;
use crate::scene_text::read;

/// Largest number of ticks in which a servo settles before it takes over.
const MOST_SETTLING: u32 = 1000;
/// Ticks with the same code after which it has settled.
const SETTLED: u32 = 16;
/// Largest number of kept ticks: a quarter of an hour at 1 kHz.
const MOST_KEPT: usize = 1 << 20;
/// Largest speed of the hand's set-point in rad/s, even if a pointer jumps.
const FASTEST: f64 = 40.0;

/// A servo with its device.
pub struct Simulated {
    settings: Settings,
    scene: Scene,
    transducers: Transducers,
    rendered: Rendered,
    /// The servo with a host beside it, in place of the rendered one.
    hosted: Option<Hosted>,
    /// The reason if there is no host that the page wanted.
    host_refusal: Option<String>,
    has_host: bool,
    device: DeviceInHand,
    /// The hand's set-point in rad; the device's angle without a hand.
    setpoint: f64,
    push: Option<Push>,
    /// The servo's last tick, which stays where one is left out.
    last: Option<Tick>,
    /// The fault that has switched the servo off.
    fault: Option<String>,
    /// Counts and codes of the servo, beside its host, from its first tick on; later ones are dropped when it is
    /// full.
    record: Vec<(i32, u16)>,
    watch: Watch,
}

/// The data for the page's drawing of the handle.
#[derive(Serialize)]
pub struct Held<'a> {
    rendering: Rendering,
    /// The reason if it is not the servo of a certified scene.
    refusal: Option<&'a str>,
    /// In s.
    period: f64,
    counts_per_turn: f64,
    /// Torque in N m at the largest code.
    full_scale: f64,
    /// Largest possible torque in N m.
    torque_limit: f64,
    /// Whether it is drawn as a knob, and not as a paddle.
    is_knob: bool,
    /// The face of a wall in rad.
    face: Option<f64>,
    /// Whether it pushes in one direction only.
    one_sided: bool,
    /// Whether the scene may have a host.
    has_host: bool,
    /// The reason if there is no host that the page wanted.
    host_refusal: Option<&'a str>,
}

/// The motion of the hand over the next ticks.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    pub ticks: u32,
    /// The set-point in rad at their end, subject to the hand's largest speed.
    pub setpoint: f64,
    pub is_held: bool,
    /// Whether it takes over from a push, which continues otherwise.
    #[serde(default)]
    pub takes_over: bool,
}

/// The set-point's path over some ticks, at a constant possible speed of a hand.
struct Path {
    from: f64,
    to: f64,
    ticks: f64,
}

impl Path {
    fn new(from: f64, motion: &Motion, period: f64) -> Self {
        let ticks = f64::from(motion.ticks);
        let farthest = FASTEST * ticks * period;
        Self { from, to: motion.setpoint.clamp(from - farthest, from + farthest), ticks }
    }

    /// Angle in rad at the end of a tick; exact at the end of the last tick, so that a resting hand is
    /// detected.
    fn after(&self, tick: u32) -> f64 {
        let left = (self.ticks - f64::from(tick) - 1.0) / self.ticks;
        self.to + (self.from - self.to) * left
    }
}

/// The state after some ticks.
#[derive(Debug, Serialize)]
pub struct Moved {
    pub is_pushing: bool,
    pub is_held: bool,
    /// Its set-point in rad; the device's angle without a hand.
    pub setpoint: f64,
    /// Energy between hand and device since the scene was taken into the hand.
    pub energy: Energy,
    /// The torque's oscillation while the hand rests.
    pub oscillation: Option<Oscillation>,
    /// What the hand takes from a host.
    pub host: Option<HostMoved>,
    /// The fault that has switched the servo off.
    pub fault: Option<String>,
}

impl Simulated {
    /// A scene whose device continues its previous motion.
    ///
    /// # Errors
    /// If the scene is invalid, or has no motion.
    pub fn new(settings: Settings, before: Option<&Self>) -> Result<Self, String> {
        let file = read(&settings.scene).map_err(|error| error.to_string())?;
        let hand = settings.passive_hand()?;
        let transducers = file.transducers(settings.counts_per_turn, None);
        let counts = transducers.counts_per_turn;
        if !(counts > 0.0 && counts.is_finite()) {
            return Err(format!(
                "an encoder of {counts} counts a turn; they must be positive and finite"
            ));
        }
        let mut moved = file.scene;
        if settings.counts_per_turn.is_some() {
            moved.latency.encoder = EncoderReading::ideal();
        }
        let mut device = DeviceInHand::new(&moved, hand, &transducers)
            .map_err(|error| error.to_string())?
            .with_disturbance(file.disturbance());
        if settings.counts_per_turn.is_none() {
            device = device.failing(file.dropped());
        }
        if let Some(before) = before {
            let (old, new) = (&before.scene, &file.scene);
            let is_same = old.timing.period == new.timing.period && old.latency == new.latency;
            device = device.moving_as(&before.device, is_same);
        }
        let period = file.scene.timing.period;
        let step = transducers.full_scale_torque / f64::from(DacCode::CODES_TO_FULL_SCALE);
        let mut simulated = Self {
            rendered: Rendered::of(&file, &transducers, settings.is_checked),
            hosted: None,
            host_refusal: None,
            has_host: file.host.is_some(),
            setpoint: before.map_or(0.0, |before| before.setpoint),
            settings,
            scene: file.scene,
            transducers,
            device,
            push: None,
            last: None,
            fault: None,
            record: Vec::new(),
            watch: Watch::new(period, step, TAU / counts),
        };
        let count = simulated.settle();
        simulated.add_host(&file, count);
        Ok(simulated)
    }

    /// Puts the host of the settings beside the servo, if the scene may have it.
    fn add_host(&mut self, file: &SceneFile, count: i32) {
        let Some(law) = self.settings.host.as_deref().filter(|_| self.has_host) else { return };
        let off = Unchecked::off(&self.transducers);
        let servo = std::mem::replace(&mut self.rendered.servo, Box::new(off));
        let law = (law, self.settings.has_no_tank);
        match Hosted::new(servo, file, &self.transducers, law, count) {
            Ok(hosted) => self.hosted = Some(hosted),
            Err(refusal) => {
                self.host_refusal = Some(refusal);
                // The scene's servo alone.
                self.rendered = Rendered::of(file, &self.transducers, self.settings.is_checked);
                self.record.clear();
                self.settle();
            }
        }
    }

    /// Whether it renders the scene of these settings, in any hand.
    pub fn renders(&self, settings: &Settings) -> bool {
        self.settings == Settings { hand: self.settings.hand, ..settings.clone() }
    }

    /// Changes only the hand.
    ///
    /// # Errors
    /// If the hand is invalid, or there is no motion in it.
    pub fn change_hand(&mut self, settings: Settings) -> Result<(), String> {
        let hand = settings.passive_hand()?;
        self.device.change_hand(&self.scene, hand).map_err(|error| error.to_string())?;
        self.settings = settings;
        Ok(())
    }

    /// The data for the page's drawing.
    pub fn held(&self) -> Held<'_> {
        let (environment, full_scale) =
            (&self.scene.environment, self.transducers.full_scale_torque);
        let of_host = self.hosted.as_ref().map_or(0.0, Hosted::largest);
        let is_paddle = environment.wall().is_some() && environment.profile().is_none();
        Held {
            rendering: self.rendered.rendering,
            refusal: self.rendered.refusal.as_deref(),
            period: self.scene.timing.period,
            counts_per_turn: self.transducers.counts_per_turn,
            full_scale,
            torque_limit: self.scene.torque_limit.unwrap_or(full_scale) + of_host,
            is_knob: !is_paddle,
            face: environment.wall().map(Wall::face),
            one_sided: environment.wall().is_some_and(Wall::is_one_sided),
            has_host: self.has_host,
            host_refusal: self.host_refusal.as_deref(),
        }
    }

    pub fn scene_text(&self) -> &str {
        &self.settings.scene
    }

    /// Count and code of each tick of the servo.
    pub fn recorded(&self, numbers: &mut Vec<f64>) {
        let numbers_of = |&(count, code): &(i32, u16)| [f64::from(count), f64::from(code)];
        numbers.extend(self.record.iter().flat_map(numbers_of));
    }

    /// Begins the push that demonstrates the environment.
    pub fn push(&mut self) {
        let period = self.scene.timing.period;
        self.push = Some(Push::new(&self.scene.environment, self.setpoint, period));
    }

    /// The next ticks, with the numbers of [`super::motion`].
    pub fn run(&mut self, motion: &Motion, numbers: &mut Vec<f64>) -> Moved {
        if motion.takes_over {
            self.push = None;
        }
        let path = Path::new(self.setpoint, motion, self.scene.timing.period);
        let mut is_held = motion.is_held;
        for tick in 0..motion.ticks {
            let setpoint = match &mut self.push {
                Some(push) => {
                    let next = push.next();
                    is_held = next.is_some();
                    if next.is_none() {
                        self.push = None;
                    }
                    next
                }
                None => is_held.then(|| HandSetpoint { from: self.setpoint, to: path.after(tick) }),
            };
            self.tick(setpoint, numbers);
        }
        Moved {
            is_pushing: self.push.is_some(),
            is_held,
            setpoint: self.setpoint,
            energy: self.device.energy(),
            oscillation: self.watch.oscillation(),
            host: self.hosted.as_ref().map(Hosted::moved),
            fault: self.fault.clone(),
        }
    }

    fn tick(&mut self, setpoint: Option<HandSetpoint>, numbers: &mut Vec<f64>) {
        let raw = self.device.count();
        if let Some(fault) = self.device.fault().filter(|_| self.fault.is_none()) {
            self.rendered.servo = Box::new(Unchecked::off(&self.transducers));
            (self.hosted, self.fault) = (None, Some(fault));
        }
        let held = self.last.filter(|_| self.device.reading() == ReadingOutcome::LeftOut);
        let mut tick = match (held, &mut self.hosted) {
            (Some(held), _) => Tick { is_left_out: true, ..held },
            (None, Some(hosted)) => hosted.servo.tick(raw),
            (None, None) => self.rendered.servo.tick(raw),
        };
        self.last = Some(tick);
        // The codes that a servo computes of these counts.
        if !tick.is_left_out && self.fault.is_none() {
            self.keep(raw, tick.code);
        }
        let (torque, before) = (self.device.torque(tick.code), self.device.motion().position);
        self.device.push(torque, setpoint.unwrap_or_default(), setpoint.is_some());
        let position = self.device.motion().position;
        if let Some(hosted) = &mut self.hosted {
            hosted.add(position - before);
            // The motor's torque is that of both.
            tick.torque = -torque;
        }
        self.setpoint = setpoint.map_or(position, |setpoint| setpoint.to);
        let rests = setpoint.is_none_or(|setpoint| setpoint.from == setpoint.to);
        self.watch.add(tick.torque, position, rests);
        numbers.extend([
            tick.count as f64,
            tick.angle,
            tick.torque,
            f64::from(tick.code),
            f64::from(tick.limit as u8),
            self.setpoint,
            position,
        ]);
    }

    fn keep(&mut self, count: i32, code: u16) {
        if self.record.len() < MOST_KEPT {
            self.record.push((count, code));
        }
    }

    /// Runs the servo with the device at its present angle until the servo's memory has settled. Returns the
    /// count of that angle.
    fn settle(&mut self) -> i32 {
        let count = self.device.count();
        let (mut code, mut same) = (DacCode::MID_SCALE.get(), 0);
        for _ in 0..MOST_SETTLING {
            let next = self.rendered.servo.tick(count).code;
            self.keep(count, next);
            same = if next == code { same + 1 } else { 0 };
            code = next;
            if same == SETTLED {
                break;
            }
        }
        count
    }
}
