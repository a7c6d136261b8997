//! The client of the harness's programs, which answer requests in bytes.

use std::path::Path;

use firmware_harness::bench_request::{BLOCK, BenchRequest, Output, Outputs};
use firmware_harness::scene_codec::{CertifyReply, CertifyRequest, FRAME, decode, encode};
use haptic_servo::scene::Scene;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{EmulatorError, Guest};

/// The client of a program of the harness, which answers one kind of requests: `certify_server` certificates,
/// `bench_programs` and `bench_all` torques and sines, with the instructions of each.
pub struct Client {
    board: Guest,
}

impl Client {
    /// Starts the program, built by [`build_harness`](crate::toolchain::Toolchain::build_harness).
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self { board: Guest::boot(elf)? })
    }

    /// Sends a request to the board, and returns its reply.
    fn ask<Q: Serialize, R: DeserializeOwned>(&mut self, request: &Q) -> Result<R, EmulatorError> {
        let mut reply = [0; FRAME];
        self.board.exchange(&encode(request), &mut reply)?;
        decode(&reply).ok_or(EmulatorError::NoReply)
    }

    /// Lets the board certify a scene.
    pub fn certify(&mut self, scene: &Scene) -> Result<CertifyReply, EmulatorError> {
        self.ask(&CertifyRequest(*scene))
    }

    /// Lets the board compute the results of all inputs: counts of an encoder, or the bits of parts of a
    /// turn.
    pub fn compute(
        &mut self,
        request: &BenchRequest,
        inputs: &[u32],
    ) -> Result<Vec<Output>, EmulatorError> {
        if !self.ask(request)? {
            return Err(EmulatorError::NoBenchProgram);
        }
        let mut outputs = Vec::with_capacity(inputs.len() + BLOCK);
        for block in inputs.chunks(BLOCK) {
            outputs.extend(self.block(block)?);
        }
        // The padding of the last block.
        outputs.truncate(inputs.len());
        self.board.exchange(&[0], &mut [])?;
        Ok(outputs)
    }

    fn block(&mut self, block: &[u32]) -> Result<Outputs, EmulatorError> {
        let last = block.last().copied().unwrap_or_default();
        let inputs: [[u8; 4]; BLOCK] =
            std::array::from_fn(|i| block.get(i).copied().unwrap_or(last).to_le_bytes());
        let request = [&[1], inputs.as_flattened()].concat();
        let mut answer = [[0; Output::BYTES]; BLOCK];
        self.board.exchange(&request, answer.as_flattened_mut())?;
        Ok(answer.map(Output::from_bytes))
    }

    /// Ends the board.
    pub fn finish(self) -> Result<(), EmulatorError> {
        self.board.finish().map(drop)
    }
}
