//! Benchmarks of the solver, in `solve.rs`; this library is empty.
