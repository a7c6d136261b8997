//! Requests to a board that plays a sweep ([`excitation`](crate::excitation)), in the frames of the protocol.
//!
//! Nothing is certified while a sweep drives the motor, so noise must not begin one: a request to begin has a
//! checksum of 32 bits and the version, and other bytes end a sweep.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::decoder::Decoder;
use super::frame::{CHECKSUM, encode, largest_frame};
use crate::excitation::SWEEP_PROTOCOL;

/// Longest request in bytes, without checksum: its number and a varint.
const LONGEST: usize = 6;
/// Longest frame of a request in bytes.
const FRAME: usize = largest_frame(LONGEST);

/// A request of the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SweepRequest {
    /// Requests the description, a line of text: `identify,PROTOCOL,period,counts per turn,ticks,travel,speed`,
    /// and, with the board's own bridge, `,gain,resistance,inductance,feedback,instant,loss,step,crossing` of
    /// its [`TorqueSource`](crate::current::TorqueSource). The same in every version from 3 on.
    Describe,
    /// Begins the sweep. The record follows, and after it `end,WORD,count`. During a sweep, it ends the sweep.
    Begin {
        /// [`SWEEP_PROTOCOL`] of the host; a board with another version does not begin.
        protocol: u32,
    },
    /// Keep-alive of the host.
    Listening,
    /// Ends the sweep.
    Stop,
}

impl SweepRequest {
    /// Begins a sweep of this version.
    pub const BEGIN: Self = Self::Begin { protocol: SWEEP_PROTOCOL };

    /// The frame of this request.
    pub fn frame(&self) -> Vec<u8, FRAME> {
        let mut buffer = [0; FRAME];
        // The buffer has room for the longest request.
        let frame = encode(self, &mut buffer).unwrap_or_default();
        Vec::from_slice(frame).unwrap_or_default()
    }
}

/// The requests in the bytes that a board receives.
#[derive(Debug, Default)]
pub struct SweepReceiver(Decoder<{ LONGEST + CHECKSUM }>);

impl SweepReceiver {
    /// A receiver at the beginning of the line.
    pub const fn new() -> Self {
        Self(Decoder::new())
    }

    /// Takes a byte, and returns the request that it completes. A frame that is not a request, and a request
    /// to begin from a host of another version, are requests to stop.
    pub fn push(&mut self, byte: u8) -> Option<SweepRequest> {
        let before = self.0.discarded();
        let request = self.0.push(byte);
        match request {
            Some(SweepRequest::Begin { protocol }) if protocol != SWEEP_PROTOCOL => {
                Some(SweepRequest::Stop)
            }
            None if self.0.discarded() != before => Some(SweepRequest::Stop),
            request => request,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    const ALL: [SweepRequest; 4] =
        [SweepRequest::Describe, SweepRequest::BEGIN, SweepRequest::Listening, SweepRequest::Stop];

    fn received(receiver: &mut SweepReceiver, bytes: &[u8]) -> std::vec::Vec<SweepRequest> {
        bytes.iter().filter_map(|&byte| receiver.push(byte)).collect()
    }

    fn begins(receiver: &mut SweepReceiver, bytes: &[u8]) -> bool {
        received(receiver, bytes).contains(&SweepRequest::BEGIN)
    }

    /// The checksum is that of zlib, computed by another program.
    #[test]
    fn a_request_is_its_frame() {
        let frame = [0x00, 0x07, 0x01, 0x03, 0x04, 0x72, 0xcb, 0xc1, 0x00];
        assert_eq!(SweepRequest::BEGIN.frame(), frame);
        let longest = SweepRequest::Begin { protocol: u32::MAX };
        assert_eq!(longest.frame().len(), FRAME);
        let mut receiver = SweepReceiver::new();
        let all: std::vec::Vec<u8> = ALL.iter().flat_map(SweepRequest::frame).collect();
        assert_eq!(received(&mut receiver, &all), ALL);
    }

    #[test]
    fn no_byte_and_no_other_version_begins_a_sweep() {
        let mut receiver = SweepReceiver::new();
        // Also each as a frame of its own.
        for byte in 0..=u8::MAX {
            assert!(!begins(&mut SweepReceiver::new(), &[byte, 0]));
            assert!(!begins(&mut receiver, &[byte]));
            assert!(!begins(&mut receiver, &[byte, 0]));
        }
        for protocol in [0, SWEEP_PROTOCOL - 1, SWEEP_PROTOCOL + 1, u32::MAX] {
            let frame = SweepRequest::Begin { protocol }.frame();
            assert_eq!(received(&mut receiver, &frame), [SweepRequest::Stop]);
        }
    }

    #[test]
    fn a_spoilt_frame_ends_a_sweep_and_the_next_one_is_received() {
        let whole = SweepRequest::BEGIN.frame();
        for (place, bit) in
            (1..whole.len() - 1).flat_map(|place| (0..8).map(move |bit| (place, bit)))
        {
            let mut frame = whole.clone();
            frame[place] ^= 1 << bit;
            let mut receiver = SweepReceiver::new();
            let requests = received(&mut receiver, &frame);
            assert!(!requests.is_empty() && requests.iter().all(|it| *it == SweepRequest::Stop));
            assert_eq!(received(&mut receiver, &whole), [SweepRequest::BEGIN]);
        }
    }

    /// A host of the protocol of scenes that finds a sweep's board at its port.
    #[test]
    fn no_message_to_a_scene_begins_a_sweep() {
        use crate::wire::message::{Changes, LONGEST_TO_BOARD, ToBoard};
        let messages = [
            ToBoard::Hello,
            ToBoard::Get,
            ToBoard::Status,
            ToBoard::Set { id: 3, changes: Changes::new() },
            ToBoard::Stream(core::num::NonZeroU32::new(3)),
            ToBoard::Describe,
        ];
        let with_id = (0..=u16::MAX)
            .flat_map(|id| [ToBoard::Arm { id }, ToBoard::Disarm { id }, ToBoard::Align { id }]);
        let mut receiver = SweepReceiver::new();
        for message in messages.into_iter().chain(with_id) {
            let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
            assert!(!begins(&mut receiver, encode(&message, &mut buffer).unwrap()), "{message:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

        #[test]
        fn no_noise_begins_a_sweep(
            noise in vec(prop_oneof![any::<u8>(), Just(0), 0_u8..8], 0..200),
        ) {
            prop_assert!(!begins(&mut SweepReceiver::new(), &noise));
        }
    }
}
