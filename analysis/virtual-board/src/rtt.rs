//! The log's bytes out of their ring in RAM (SEGGER's real-time transfer), as a debug probe takes them.

use crate::image::Image;
use crate::processor::Processor;

/// Takes the buffered bytes.
pub fn drain(core: &mut Processor, image: &Image) -> Vec<u8> {
    let Some(block) = image.symbol("_SEGGER_RTT") else { return Vec::new() };
    if core.memory(block, 16).is_none_or(|mark| !mark.starts_with(b"SEGGER RTT")) {
        return Vec::new();
    }
    // Behind the mark and the two numbers of channels: name, buffer, size, write, read.
    let channel: [u32; 5] =
        std::array::from_fn(|i| core.word(block + 24 + 4 * i as u32).unwrap_or(0));
    let [_, buffer, size, write, read] = channel;
    let pieces = if write >= read { [(read, write), (0, 0)] } else { [(read, size), (0, write)] };
    let bytes = pieces
        .into_iter()
        .flat_map(|(from, to)| core.memory(buffer + from, (to - from) as usize).unwrap_or_default())
        .collect();
    core.set_memory(block + 24 + 16, &write.to_le_bytes());
    bytes
}
