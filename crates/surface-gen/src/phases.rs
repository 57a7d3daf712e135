//! The random phase of every wave: a pure function of (seed, mode).
//!
//! # The stream, version 1
//!
//! 1. A wave has a stream (map or line), a *row* and an *index* in it. On a map the wave (mx, my) of the
//!    canonical half-plane (`mx > 0`, or `mx = 0` and `my > 0`) has row `mx` and index `2 |my| + (my < 0 ? 1
//!    : 0)`; the other half-plane has `phi(-q) = -phi(q)`. On a line the wave m >= 1 has row 0 and index m.
//! 2. Indices are cut into blocks of 256: `block = index / 256`. With `mix` the SplitMix64 finaliser,
//!    `key = mix(mix(mix(seed xor stream) + row) + block)`; `stream` is the ASCII word "map wave" or
//!    "linewave" as a big-endian number.
//! 3. The state of Xoshiro256++ is the four first outputs of SplitMix64 started at `key`. Its output number
//!    `index mod 256` is the word u of the wave.
//! 4. `phi = 2 pi (u >> 11) / 2^53`, uniform on [0, 2 pi).
//!
//! No resolution, thread or order enters. The tests pin literal values.

use crate::hash::{expand, mix};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

/// Waves per block.
const BLOCK: u64 = 256;

/// Keeps the 53 leading bits: what an `f64` fraction of a turn holds.
const FRACTION: u64 = !0x7ff;

/// Which family of waves.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stream {
    Map,
    Line,
}

impl Stream {
    fn word(self) -> u64 {
        u64::from_be_bytes(match self {
            Self::Map => *b"map wave",
            Self::Line => *b"linewave",
        })
    }
}

/// Phases of the indices 0, 1, 2, ... of one row, as fractions of a turn in units of 2^-64.
#[derive(Debug)]
pub(crate) struct Turns {
    row_key: u64,
    index: u64,
    generator: Xoshiro256PlusPlus,
}

impl Turns {
    pub(crate) fn new(seed: u64, stream: Stream, row: u64) -> Self {
        Self::starting_at(seed, stream, row, 0)
    }

    /// The same sequence from `index` on.
    fn starting_at(seed: u64, stream: Stream, row: u64, index: u64) -> Self {
        let row_key = mix(mix(seed ^ stream.word()).wrapping_add(row));
        let mut generator = block_generator(row_key, index / BLOCK);
        for _ in 0..index % BLOCK {
            generator.next_u64();
        }
        Self { row_key, index, generator }
    }

    /// The next index's phase.
    #[inline]
    pub(crate) fn next(&mut self) -> u64 {
        if self.index.is_multiple_of(BLOCK) {
            self.generator = block_generator(self.row_key, self.index / BLOCK);
        }
        self.index += 1;
        self.generator.next_u64() & FRACTION
    }
}

fn block_generator(row_key: u64, block: u64) -> Xoshiro256PlusPlus {
    let mut state = [0; 32];
    let words = expand(mix(row_key.wrapping_add(block)));
    for (bytes, word) in state.chunks_exact_mut(8).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    Xoshiro256PlusPlus::from_seed(state)
}

/// An angle in [0, 2 pi) from a fraction of a turn that has 53 significant bits.
fn radians(turn: u64) -> f64 {
    TAU * ((turn >> 11) as f64 / (1_u64 << 53) as f64)
}

/// Phase of the wave with `mx` periods along x and `my` along y over the rectangle (radians).
///
/// In [0, 2 pi) on the canonical half-plane (`mx > 0`, or `mx = 0` and `my > 0`), `-phi(-mx, -my)` on the
/// other one, 0 for the mean. The paper prints `phi(q) = phi(-q)` below Eq. 5, which would make every surface
/// symmetric about the origin.
///
/// ```
/// use surface_gen::map_phase;
/// assert!((map_phase(7, 3, -2) + map_phase(7, -3, 2)).abs() == 0.0);
/// ```
pub fn map_phase(seed: u64, mx: i32, my: i32) -> f64 {
    match (mx, my) {
        (0, 0) => 0.0,
        (..=-1, _) | (0, ..=-1) => -positive_map_phase(seed, mx.unsigned_abs(), my.unsigned_abs(), my > 0),
        _ => positive_map_phase(seed, mx.unsigned_abs(), my.unsigned_abs(), my < 0),
    }
}

fn positive_map_phase(seed: u64, mx: u32, my: u32, negative: bool) -> f64 {
    let index = 2 * u64::from(my) + u64::from(negative);
    radians(Turns::starting_at(seed, Stream::Map, u64::from(mx), index).next())
}

/// Phase of the wave with `m` periods over the line (radians): in [0, 2 pi) for `m > 0`, `-phi(-m)` for `m <
/// 0`, 0 for the mean.
///
/// ```
/// use surface_gen::line_phase;
/// assert!((0.0..std::f64::consts::TAU).contains(&line_phase(7, 1)));
/// ```
pub fn line_phase(seed: u64, m: i32) -> f64 {
    let phase = |m: u32| radians(Turns::starting_at(seed, Stream::Line, 0, u64::from(m)).next());
    match m {
        0 => 0.0,
        1.. => phase(m.unsigned_abs()),
        _ => -phase(m.unsigned_abs()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    /// One rounding of 2 pi times a fraction that both sides hold exactly.
    const ROUNDING: f64 = f64::EPSILON;

    /// From an independent implementation of the stream as written above. These numbers never change.
    #[test]
    fn the_stream_is_pinned() {
        for (seed, mx, my, phase) in [
            (0, 1, 0, 6.227_021_147_532_822),
            (0, 0, 1, 2.117_013_336_396_112_8),
            (1, 3, -2, 1.992_376_711_560_797_3),
            (12345, 1000, -1000, 1.422_088_761_948_071),
            (u64::MAX, 7, 128, 5.319_361_775_393_973),
        ] {
            assert_relative_eq!(map_phase(seed, mx, my), phase, max_relative = ROUNDING);
            assert_relative_eq!(map_phase(seed, -mx, -my), -phase, max_relative = ROUNDING);
        }
        for (seed, m, phase) in [
            (0, 1, 5.938_681_511_061_623),
            (1, 255, 1.040_334_255_401_237_4),
            (1, 256, 4.470_092_531_528_349),
            (u64::MAX, 524_287, 1.173_025_401_734_64),
        ] {
            assert_relative_eq!(line_phase(seed, m), phase, max_relative = ROUNDING);
            assert_relative_eq!(line_phase(seed, -m), -phase, max_relative = ROUNDING);
        }
    }

    #[test]
    fn a_row_read_in_order_is_the_same_row() {
        let mut turns = Turns::new(3, Stream::Line, 0);
        turns.next();
        for m in 1..1000 {
            assert_relative_eq!(radians(turns.next()), line_phase(3, m), max_relative = ROUNDING);
        }
    }

    #[test]
    fn phases_are_uniform() {
        /// Four standard errors of the mean of 10^4 cosines, sqrt(1 / (2 n)) each.
        const BOUND: f64 = 4.0 * 0.007_07;
        for harmonic in [1.0, 2.0, 3.0] {
            let mean = |phase: &dyn Fn(i32, i32) -> f64| {
                let waves = (1..=100).flat_map(|a| (-50..50).map(move |b| (a, b)));
                waves.map(|(a, b)| (harmonic * phase(a, b)).cos()).sum::<f64>() / 1e4
            };
            assert_abs_diff_eq!(mean(&|a, b| map_phase(1, a, b)), 0.0, epsilon = BOUND);
            assert_abs_diff_eq!(mean(&|a, b| line_phase(1, 100 * a + b)), 0.0, epsilon = BOUND);
            // Neighbouring waves and neighbouring seeds are independent.
            let neighbour = |a, b| map_phase(1, a, b) - map_phase(1, a, b + 1);
            assert_abs_diff_eq!(mean(&neighbour), 0.0, epsilon = BOUND);
            let seeds = |a, b| map_phase(1, a, b) - map_phase(2, a, b);
            assert_abs_diff_eq!(mean(&seeds), 0.0, epsilon = BOUND);
        }
    }
}
