//! Scenes and the program: one test program, which links once.

#![allow(clippy::unwrap_used, clippy::expect_used)] // Helpers of tests.

mod accuracy;
mod answers;
mod bad_scenes;
mod friction;
mod in_memory;
mod interface;
mod limits;
mod measured_maps;
mod own_models;
mod paths;
mod pictures;
mod press;
mod profiles;
mod program;
mod pull_off;
mod rectangles;
mod report;
mod resume;
mod scenes;
mod stiffnesses;
mod theories_on_maps;
