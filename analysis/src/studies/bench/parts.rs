//! The parts of a tick and the state of each scene.

use comfy_table::Table;
use serde::Serialize;

use super::figure::Figure;
use crate::program::{Program, State};
use crate::studies::error::StudyError;
use crate::studies::tick_parts::{Part, Share, TickParts};
use crate::text_table::markdown_table;
use crate::toolchain::{self, NumberFormat};

/// The inventory of a scene's program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inventory {
    /// Name of the program.
    pub scene: &'static str,
    /// The tick from count to code in `f32`, as linked into the servo's interrupt: with and without injected
    /// damping together.
    pub tick: Share,
    /// Its parts, in the order of a tick.
    pub parts: Vec<PartShare>,
    /// Its state in `f32`.
    pub state_f32: State,
    /// Its state in the scene's fixed-point format.
    pub state_fixed: State,
    /// Bytes of flash of the whole program, without log.
    pub flash: u64,
    /// Bytes of its RAM.
    pub ram: u64,
}

/// One part of a tick.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartShare {
    /// The part.
    pub part: &'static str,
    /// The share of the part.
    #[serde(flatten)]
    pub share: Share,
}

impl Inventory {
    /// The inventory of a program that was built for the emulated board without log.
    pub fn of(program: &Program, built: &toolchain::Program) -> Result<Self, StudyError> {
        let tick = TickParts::of_file(&built.path)?;
        let part = |(part, name)| PartShare { part: name, share: tick.share(part) };
        Ok(Self {
            scene: program.name,
            tick: tick.whole(),
            parts: Part::ALL.map(part).to_vec(),
            state_f32: (program.state)(NumberFormat::F32),
            state_fixed: (program.state)(NumberFormat::Fixed),
            flash: built.sizes.flash(),
            ram: built.sizes.ram(),
        })
    }

    /// Its figures for a benchmark, without the parts.
    pub fn figures(&self) -> Vec<Figure> {
        let figures = [
            ("flash without log", self.flash, "bytes"),
            ("RAM without log", self.ram, "bytes"),
            ("both ticks in the linked program, f32", self.tick.bytes, "bytes"),
            ("both ticks in the linked program, f32", self.tick.instructions, "instructions"),
            ("both ticks in the linked program, f32", self.tick.multiplications, "multiplications"),
            ("state of the servo, f32", self.state_f32.servo as u64, "bytes"),
            ("state of the servo, fixed", self.state_fixed.servo as u64, "bytes"),
            ("state of the environment, f32", self.state_f32.environment as u64, "bytes"),
            ("state of the environment, fixed", self.state_fixed.environment as u64, "bytes"),
        ];
        let figure = |(what, value, unit)| {
            Figure::alone(format!("{}: {what}", self.scene), value as f64, unit)
        };
        figures.map(figure).to_vec()
    }
}

/// The scenes as a table.
pub fn table(scenes: &[Inventory]) -> Table {
    let header = [""].into_iter().chain(scenes.iter().map(|of| of.scene));
    let mut table = markdown_table(header, 1..=scenes.len());
    let mut row = |name: String, cell: &dyn Fn(&Inventory) -> String| {
        table.add_row([name].into_iter().chain(scenes.iter().map(cell)));
    };
    let share = |Share { instructions, multiplications, bytes }: Share| match instructions {
        0 => "-".to_owned(),
        _ => format!("{instructions}, {multiplications}, {bytes}"),
    };
    row("both ticks: instructions, of them multiplications, bytes".into(), &|of| share(of.tick));
    for (index, (_, name)) in Part::ALL.iter().enumerate() {
        row(format!("of it {name}"), &|of| share(of.parts[index].share));
    }
    let bytes = |[f32, fixed]: [usize; 2]| format!("{f32}, {fixed}");
    row("state of the servo in f32, in fixed: bytes".into(), &|of| {
        bytes([of.state_f32, of.state_fixed].map(|state| state.servo))
    });
    row("of it the environment".into(), &|of| {
        bytes([of.state_f32, of.state_fixed].map(|state| state.environment))
    });
    row("flash: bytes".into(), &|of| of.flash.to_string());
    row("RAM: bytes".into(), &|of| of.ram.to_string());
    table
}
