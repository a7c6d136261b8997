//! How questions get to a program that measures, and its answers back.

use super::{EmulatorError, Guest};

/// A board with a program that answers bytes by bytes.
pub trait Transport {
    /// Gives bytes to the board and waits until it has filled `answer`.
    ///
    /// # Errors
    /// Where it does not.
    fn exchange(&mut self, request: &[u8], answer: &mut [u8]) -> Result<(), EmulatorError>;

    /// The same with a question of words.
    ///
    /// # Errors
    /// As of [`exchange`](Self::exchange).
    fn ask(&mut self, request: &[u64], answer: &mut [u8]) -> Result<(), EmulatorError> {
        let bytes: Vec<u8> = request.iter().flat_map(|word| word.to_le_bytes()).collect();
        self.exchange(&bytes, answer)
    }

    /// Tells the program that there is no more, and waits for its end.
    ///
    /// # Errors
    /// Where it does not end, or ends with a failure.
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
