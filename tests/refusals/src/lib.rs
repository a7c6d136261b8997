//! Nothing is exported: the programs are in `refused` and `accepted`, the test in `tests`.
