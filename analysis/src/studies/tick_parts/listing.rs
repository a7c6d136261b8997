//! The instructions of a linked program.

use std::collections::BTreeMap;

use addr2line::Context;
use addr2line::gimli::{EndianSlice, Error as DwarfError, LittleEndian, SectionId};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind};
use thiserror::Error;

/// The reason why a program cannot be listed.
#[derive(Debug, Error)]
pub enum ListingError {
    /// The file is not an ELF file.
    #[error("not an ELF file: {0}")]
    Elf(#[from] object::read::Error),
    /// Its line tables are invalid.
    #[error("bad line tables: {0}")]
    Lines(#[from] DwarfError),
    /// It has no symbols or no line information.
    #[error(
        "the program has no {0}; it must be built with the release profile of this repository, and not \
         stripped"
    )]
    Stripped(&'static str),
}

/// An instruction.
pub(super) struct Instruction<'a> {
    /// The functions that it was inlined from, the innermost first, by their names in Rust.
    pub functions: &'a [String],
    /// Its length.
    pub bytes: u64,
    /// Whether it multiplies floating-point numbers.
    pub multiplies: bool,
}

type Lines<'elf> = Context<EndianSlice<'elf, LittleEndian>>;

/// Shows each instruction of a program.
pub(super) fn listing(
    elf: &[u8],
    mut show: impl FnMut(Instruction<'_>),
) -> Result<(), ListingError> {
    let file = object::File::parse(elf)?;
    let lines = lines(&file)?;
    let marks = marks(&file);
    if marks.is_empty() {
        return Err(ListingError::Stripped("symbols that distinguish code from data"));
    }
    for section in file.sections().filter(|section| section.kind() == SectionKind::Text) {
        let (start, data) = (section.address(), section.data()?);
        let mut at = 0;
        while let Some(first) = halfword(data, at) {
            let address = start + at as u64;
            let bytes = if is_long(first) { 4 } else { 2 };
            let is_code = marks.range(..=address).next_back().is_some_and(|(_, is_code)| *is_code);
            if !is_code {
                at += 2;
                continue;
            }
            let second = halfword(data, at + 2).filter(|_| bytes == 4);
            let multiplies = second.is_some_and(|second| is_multiplication(first, second));
            let functions = functions(&lines, address)?;
            show(Instruction { functions: &functions, bytes, multiplies });
            at += bytes as usize;
        }
    }
    Ok(())
}

fn lines<'elf>(file: &object::File<'elf>) -> Result<Lines<'elf>, ListingError> {
    if file.section_by_name(SectionId::DebugLine.name()).is_none() {
        return Err(ListingError::Stripped("line tables"));
    }
    let dwarf = addr2line::gimli::Dwarf::load(|id: SectionId| {
        let section = file.section_by_name(id.name());
        let data = section.map_or(Ok(&[][..]), |section| section.data())?;
        Ok::<_, ListingError>(EndianSlice::new(data, LittleEndian))
    })?;
    Ok(Context::from_dwarf(dwarf)?)
}

/// The beginnings of code and data, by the linker's mapping symbols (ELF for the Arm Architecture).
fn marks(file: &object::File<'_>) -> BTreeMap<u64, bool> {
    let mark = |name: &str| match name.get(..2)? {
        "$t" => Some(true),
        "$d" => Some(false),
        _ => None,
    };
    let symbols = file.symbols();
    symbols.filter_map(|symbol| Some((symbol.address(), mark(symbol.name().ok()?)?))).collect()
}

fn halfword(data: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(data.get(at..at + 2)?.try_into().ok()?))
}

/// Whether an instruction has two halfwords (Armv7-M, A5.1).
fn is_long(first: u16) -> bool {
    first >> 11 > 0b11100
}

/// `VMUL`, `VMLA`, `VFMA` and those that negate (Armv7-M, A6.4): the bits that choose among the
/// floating-point operations are 23, 21 and 20.
fn is_multiplication(first: u16, second: u16) -> bool {
    let is_float = first & 0xff00 == 0xee00 && second & 0x0e10 == 0x0a00;
    let operation = (first >> 5 & 0b100) | (first >> 4 & 0b011);
    is_float && matches!(operation, 0b000 | 0b001 | 0b010 | 0b101 | 0b110)
}

fn functions(lines: &Lines<'_>, address: u64) -> Result<Vec<String>, ListingError> {
    // Line tables in other files are ignored: the linker does not write them.
    let mut frames = lines.find_frames(address).skip_all_loads()?;
    let mut functions = Vec::new();
    while let Some(frame) = frames.next()? {
        if let Some(function) = frame.function {
            functions.push(function.demangle()?.into_owned());
        }
    }
    Ok(functions)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Encodings as an assembler gives them.
    #[test]
    fn multiplications_are_told_from_other_operations() {
        let is = |word: u32| {
            let [first, second] = [word >> 16, word & 0xffff].map(|half| half as u16);
            assert!(is_long(first));
            is_multiplication(first, second)
        };
        // vmul, vmla, vmls, vnmul, vfma, vfms of single precision.
        for word in [0xee20_0a20, 0xee00_0a20, 0xee00_0a60, 0xee20_0a60, 0xeea0_0a20, 0xeea0_0a60] {
            assert!(is(word), "{word:x}");
        }
        // vadd, vsub, vdiv, vcmp, vmov to a core register, vldr.
        for word in [0xee30_0a20, 0xee30_0a60, 0xee80_0a20, 0xeeb4_0a60, 0xee10_0a10, 0xed90_0a00] {
            assert!(!is(word), "{word:x}");
        }
        // nop, bx lr.
        assert!(!is_long(0xbf00) && !is_long(0x4770));
    }
}
