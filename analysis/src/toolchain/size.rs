//! The size of a program in a board's memory.

use object::{Object, ObjectSection, SectionKind};

/// The size of a program in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Code, in flash.
    pub text: u64,
    /// Constants and the vector table, in flash.
    pub rodata: u64,
    /// Variables with an initial value, in flash and RAM.
    pub data: u64,
    /// Variables that begin at zero or uninitialised, in RAM.
    pub bss: u64,
    /// Content of the fast memory of chips that have one: code, which is also in flash, and the values for a
    /// debug probe.
    pub fast: u64,
}

/// Prefix of the names of sections in the fast memory.
const FAST: &str = ".fast";

impl Sizes {
    /// Bytes of flash.
    pub fn flash(&self) -> u64 {
        self.text + self.rodata + self.data
    }

    /// Bytes of RAM without the stack.
    pub fn ram(&self) -> u64 {
        self.data + self.bss
    }

    /// Sums up the sections of a program that are loaded.
    pub(super) fn of_elf(bytes: &[u8]) -> Result<Self, object::read::Error> {
        let mut sizes = Self::default();
        for section in object::File::parse(bytes)?.sections() {
            if section.name().is_ok_and(|name| name.starts_with(FAST)) {
                sizes.fast += section.size();
                if section.kind() == SectionKind::Text {
                    sizes.text += section.size();
                }
                continue;
            }
            let part = match section.kind() {
                SectionKind::Text => &mut sizes.text,
                SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => &mut sizes.rodata,
                SectionKind::Data => &mut sizes.data,
                SectionKind::UninitializedData => &mut sizes.bss,
                _ => continue,
            };
            *part += section.size();
        }
        Ok(sizes)
    }
}
