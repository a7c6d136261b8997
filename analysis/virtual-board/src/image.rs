//! A program's file, and its content in memory.

use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol};

/// A program.
#[derive(Clone, Debug)]
pub struct Image {
    /// Its pieces, each with its address in flash.
    pub pieces: Vec<(u32, Vec<u8>)>,
    /// Its file.
    pub file: Vec<u8>,
}

impl Image {
    /// The program in an ELF file.
    pub fn of_elf(file: Vec<u8>) -> Result<Self, object::Error> {
        let data = file.as_slice();
        let header = FileHeader32::<Endianness>::parse(data)?;
        let endian = header.endian()?;
        let mut pieces = Vec::new();
        for segment in header.program_headers(endian, data)? {
            let bytes = segment.data(endian, data).unwrap_or_default();
            if segment.p_type(endian) == PT_LOAD && !bytes.is_empty() {
                pieces.push((segment.p_paddr(endian), bytes.to_vec()));
            }
        }
        Ok(Self { pieces, file })
    }

    /// The address of a symbol.
    pub fn symbol(&self, name: &str) -> Option<u32> {
        let file = object::File::parse(self.file.as_slice()).ok()?;
        let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name))?;
        u32::try_from(symbol.address()).ok()
    }

    /// Address and size of the only symbol whose mangled name has this end.
    pub fn symbol_ending(&self, end: &str) -> Option<(u32, u32)> {
        let file = object::File::parse(self.file.as_slice()).ok()?;
        let ends =
            |symbol: &object::Symbol<'_, '_>| symbol.name().is_ok_and(|name| name.ends_with(end));
        let mut symbols = file.symbols().filter(ends);
        let symbol = symbols.next().filter(|_| symbols.next().is_none())?;
        Some((u32::try_from(symbol.address()).ok()?, u32::try_from(symbol.size()).ok()?))
    }
}
