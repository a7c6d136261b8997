//! The programs that are flashed, unmodified, on the virtual board.

mod device;
