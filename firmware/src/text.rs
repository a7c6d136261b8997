//! Text built without allocation, also at compile time: the sentence that the compiler prints is
//! the sentence that the board sends.
