//! The transport of requests to a measuring program, and of its answers.

use super::{EmulatorError, Guest};

/// A board with a program that answers requests in bytes.
pub trait Transport {
    /// Sends bytes to the board and waits until it has filled `answer`.
    fn exchange(&mut self, request: &[u8], answer: &mut [u8]) -> Result<(), EmulatorError>;

    /// The same with a request in words.
    fn ask(&mut self, request: &[u64], answer: &mut [u8]) -> Result<(), EmulatorError> {
        let bytes: Vec<u8> = request.iter().flat_map(|word| word.to_le_bytes()).collect();
        self.exchange(&bytes, answer)
    }

    /// Ends the requests, and waits for the program's end.
    fn finish(self: Box<Self>) -> Result<(), EmulatorError>;
}

/// Through pipes to QEMU.
impl Transport for Guest {
    fn exchange(&mut self, request: &[u8], answer: &mut [u8]) -> Result<(), EmulatorError> {
        Self::exchange(self, request, answer)
    }

    fn finish(self: Box<Self>) -> Result<(), EmulatorError> {
        Self::finish(*self).map(drop)
    }
}
