//! The memory that a program for a board may use, from the linker's map.

/// Bytes of the linker's map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Flash.
    pub flash: u64,
    /// RAM for variables.
    pub ram: u64,
    /// RAM for the stack.
    pub stack: u64,
    /// Memory in addition to the RAM, on chips that have it.
    pub fast: u64,
}

impl Memory {
    /// Reads a linker's map.
    pub fn of_map(map: &str) -> Result<Self, String> {
        let length = |region| {
            let mut lengths = map.lines().filter_map(|line| length(line, region));
            lengths.next().ok_or_else(|| format!("it does not say the length of {region}"))
        };
        let (flash, ram) = (length("FLASH")?, length("RAM")?);
        Ok(Self { flash, ram, stack: length("STACK")?, fast: length("FAST")? })
    }
}

/// The length in a line like `RAM : ORIGIN = 0x20000000, LENGTH = 2K`, if it is a line of that region.
fn length(line: &str, region: &str) -> Option<u64> {
    let (name, rest) = line.split_once(':')?;
    let (_, length) = rest.split_once("LENGTH = ").filter(|_| name.trim() == region)?;
    match length.trim().strip_suffix('K') {
        Some(kibibytes) => kibibytes.parse::<u64>().ok()?.checked_mul(1024),
        None => length.trim().parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_map_of_the_boards() {
        let memory = Memory::of_map(include_str!("../../../memory.x")).unwrap();
        assert_eq!((memory.flash, memory.ram + memory.stack), (128 << 10, 22 << 10));
    }

    #[test]
    fn says_what_a_map_lacks() {
        let map = "FLASH : ORIGIN = 0, LENGTH = 512\nRAM : LENGTH = 1K\nSTACK : LENGTH = many\n\
                   FAST : LENGTH = 10K";
        let error = Memory::of_map(map).unwrap_err();
        assert_eq!(error, "it does not say the length of STACK");
        let memory = Memory::of_map(&map.replace("many", "7")).unwrap();
        assert_eq!(memory, Memory { flash: 512, ram: 1024, stack: 7, fast: 10_240 });
    }
}
