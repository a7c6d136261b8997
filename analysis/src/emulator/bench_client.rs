//! Torques and sines computed by the emulated board, with the instructions of each.

use firmware_harness::bench_request::{BLOCK, BenchRequest, Output, Outputs};

use super::EmulatorError;
use super::client::Client;

/// The programs `bench_programs` and `bench_all`.
pub enum BenchPrograms {}

/// The client of a board that measures computations for the host.
pub type BenchClient = Client<BenchPrograms>;

impl BenchClient {
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
}
