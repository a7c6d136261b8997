//! Any bytes into the decoders of both ends.

use crc::{CRC_32_ISO_HDLC, Crc};
use haptic_servo::wire::message::{LONGEST_TO_BOARD, LONGEST_TO_HOST, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder, encode, largest_frame};

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The first byte selects the rest: bytes on the wire, or a message, which is then framed correctly, so that
/// the content of frames is reached as well.
pub fn run(data: &[u8]) {
    let Some((kind, rest)) = data.split_first() else { return };
    let bytes = match kind % 3 {
        0 => rest.to_vec(),
        1 => framed(rest),
        // Several, each of the length that its first byte says.
        _ => messages(rest).flat_map(framed).collect(),
    };
    to_board(&bytes);
    to_host(&bytes);
}

fn messages(mut rest: &[u8]) -> impl Iterator<Item = &[u8]> {
    std::iter::from_fn(move || {
        let (length, after) = rest.split_first()?;
        let (message, after) = after.split_at_checked(usize::from(*length)).unwrap_or((after, &[]));
        rest = after;
        Some(message)
    })
}

/// The frame of a message that may be none.
fn framed(message: &[u8]) -> Vec<u8> {
    let checked = [message, &CRC.checksum(message).to_le_bytes()].concat();
    let mut frame = vec![0; cobs::max_encoding_length(checked.len()) + 1];
    let length = cobs::encode(&checked, &mut frame);
    frame.truncate(length);
    frame.push(0);
    frame
}

/// Every piece between two zeros is decoded or counted, and a decoded message encodes to the same bytes.
fn to_board(bytes: &[u8]) {
    let mut decoder = Decoder::<{ LONGEST_TO_BOARD + CHECKSUM }>::new();
    let mut heard = 0;
    for &byte in bytes {
        let Some(message) = decoder.push::<ToBoard>(byte) else { continue };
        heard += 1;
        let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
        let frame = encode(&message, &mut buffer).expect("what came in a frame fits one");
        let mut again = Decoder::<{ LONGEST_TO_BOARD + CHECKSUM }>::new();
        let said = frame.iter().find_map(|&byte| again.push::<ToBoard>(byte));
        assert_eq!(format!("{said:?}"), format!("{:?}", Some(message)));
    }
    assert_eq!(heard + decoder.discarded().total(), pieces(bytes));
}

fn to_host(bytes: &[u8]) {
    let mut decoder = Decoder::<{ LONGEST_TO_HOST + CHECKSUM }>::new();
    let mut heard = 0;
    for &byte in bytes {
        let Some(message) = decoder.push::<ToHost<&str>>(byte) else { continue };
        heard += 1;
        if let ToHost::Telemetry(batch) = &message {
            assert!(batch.ticks().count() <= haptic_servo::wire::telemetry::BATCH);
        }
        if let ToHost::Status(status) = &message {
            let _ = status.fault.map(|fault| fault.to_string());
        }
    }
    assert_eq!(heard + decoder.discarded().total(), pieces(bytes));
}

/// Pieces that a zero ends.
fn pieces(bytes: &[u8]) -> u32 {
    let ended = bytes.split_inclusive(|&byte| byte == 0);
    ended.filter(|piece| piece.len() > 1 && piece.last() == Some(&0)).count() as u32
}
