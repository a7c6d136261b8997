//! Frames through a decoder: as they were sent, and in every way spoilt.

use heapless::Vec;
use proptest::collection::vec;
use proptest::prelude::*;

use super::frame::DELIMITER;
use super::*;

/// Any message of up to 300 bytes: longer than a block of COBS.
const LONGEST: usize = 300;
type Message = Vec<u8, LONGEST>;
/// Two bytes say how long it is, four are its checksum.
type FrameDecoder = Decoder<{ LONGEST + 6 }>;

/// Decoding of noise.
const NOTHING: [Message; 0] = [];

fn framed(message: &Message) -> std::vec::Vec<u8> {
    let mut buffer = [0; largest_frame(LONGEST + 2)];
    encode(message, &mut buffer).unwrap().to_vec()
}

fn decode(decoder: &mut FrameDecoder, bytes: &[u8]) -> std::vec::Vec<Message> {
    bytes.iter().filter_map(|&byte| decoder.push::<Message>(byte)).collect()
}

fn message() -> impl Strategy<Value = Message> {
    let byte = prop_oneof![3 => any::<u8>(), 1 => Just(0)];
    let bytes = prop_oneof![vec(byte, 0..40), vec(any::<u8>(), 0..=LONGEST), vec(1_u8.., 240..270)];
    bytes.prop_map(|bytes| Message::from_slice(&bytes).unwrap())
}

/// Made by another program: zlib's checksum, and COBS by its definition.
#[test]
fn a_frame_is_postcard_with_zlibs_checksum_in_cobs() {
    let mut buffer = [0xaa; 16];
    let frame = encode(&(7_u8, true, 0_u8, 16_511_u32), &mut buffer).unwrap();
    assert_eq!(
        frame,
        [0x00, 0x03, 0x07, 0x01, 0x08, 0xff, 0x80, 0x01, 0x9b, 0x24, 0xbb, 0x63, 0x00]
    );
}

#[test]
fn a_frame_that_does_not_fit_is_an_error_at_every_size() {
    let message = Message::from_slice(&[0, 1, 2, 0]).unwrap();
    let whole = framed(&message);
    for size in 0..whole.len() {
        let refused = encode(&message, &mut std::vec![0; size]).unwrap_err();
        assert_eq!(refused, TooLong { size });
    }
    assert_eq!(encode(&message, &mut std::vec![0; whole.len()]).unwrap(), whole);
}

#[test]
fn each_way_to_be_spoilt_has_its_count() {
    let mut decoder = FrameDecoder::new();
    let frame = framed(&Message::from_slice(&[1, 2, 3]).unwrap());
    // Only three of the checksum's four bytes.
    assert_eq!(decode(&mut decoder, &[4, 9, 9, 9, 0]), NOTHING);
    // The end of a block is missing.
    assert_eq!(decode(&mut decoder, &[9, 9, 9, 0]), NOTHING);
    assert_eq!(decoder.discarded(), Discarded { broken: 2, ..Discarded::default() });
    let mut wrong = frame.clone();
    wrong[3] ^= 0x40;
    assert_eq!(decode(&mut decoder, &wrong), NOTHING);
    assert_eq!(decoder.discarded().checksum, 1);
    let mut buffer = [0; 2 * LONGEST];
    let long = encode(&[[7_u8; 31]; 12], &mut buffer).unwrap();
    assert_eq!(decode(&mut decoder, long), NOTHING);
    assert_eq!(decoder.discarded().too_long, 1);
    // A list with a length beyond its message, and a shorter one.
    for foreign in [(5_u8, 1_u8, 2_u8), (1, 1, 2)] {
        let mut buffer = [0; 16];
        assert_eq!(decode(&mut decoder, encode(&foreign, &mut buffer).unwrap()), NOTHING);
    }
    assert_eq!(decoder.discarded().unknown, 2);
    assert_eq!(decoder.discarded().total(), 6);
    assert_eq!(decode(&mut decoder, &frame).len(), 1);
}

proptest! {
    #[test]
    fn what_is_sent_is_heard(messages in vec(message(), 1..5)) {
        let mut decoder = FrameDecoder::new();
        for message in &messages {
            let frame = framed(message);
            prop_assert!(!frame[1..frame.len() - 1].contains(&DELIMITER));
            prop_assert_eq!(decode(&mut decoder, &frame), [message.clone()]);
        }
        prop_assert_eq!(decoder.discarded(), Discarded::default());
    }

    /// Three wrong bits are within what CRC-32 finds for certain at these lengths; a zero that
    /// comes of one splits the frame, and neither piece is another message. The message itself is
    /// heard where the zero takes the place of an end that says nothing.
    #[test]
    fn wrong_bits_are_never_another_message(
        message in message(),
        flips in vec((any::<prop::sample::Index>(), 0_u8..8), 1..4),
    ) {
        let right = framed(&message);
        let mut wrong = right.clone();
        for (place, bit) in flips {
            let inner = 1..right.len() - 1;
            wrong[inner.start + place.index(inner.len())] ^= 1 << bit;
        }
        let mut decoder = FrameDecoder::new();
        let heard = decode(&mut decoder, &wrong);
        prop_assert!(heard.is_empty() || heard == [message]);
        prop_assert!(!heard.is_empty() || decoder.discarded().total() > 0);
    }

    #[test]
    fn the_frame_after_noise_is_heard(
        noise in vec(prop_oneof![any::<u8>(), Just(0), Just(0xff)], 0..1000),
        message in message(),
    ) {
        let mut decoder = FrameDecoder::new();
        let before = decode(&mut decoder, &noise);
        prop_assert_eq!(before, NOTHING);
        prop_assert_eq!(decode(&mut decoder, &framed(&message)), [message]);
    }

    /// Whether a byte is lost at any place or the wire falls silent there: the next one is heard.
    #[test]
    fn the_frame_after_a_truncated_one_is_heard(
        first in message(), second in message(), cut in any::<prop::sample::Index>(), lost in any::<bool>(),
    ) {
        let mut wire = framed(&first);
        let place = cut.index(wire.len());
        if lost {
            wire.remove(place);
        } else {
            wire.truncate(place);
        }
        wire.extend(framed(&second));
        let heard = decode(&mut FrameDecoder::new(), &wire);
        prop_assert_eq!(heard.last(), Some(&second));
        prop_assert!(heard.len() == 1 || heard == [first, second]);
    }
}
