//! What is measured on samples.

mod moments;

pub use moments::rms_height;
