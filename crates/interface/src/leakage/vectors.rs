//! Loops over vectors that threads share, with the same bits for any number of them.

use numerics::parallel::{map, widest};

/// Elements that one task takes.
const CHUNK: usize = 1 << 14;
/// Sums side by side.
const LANES: usize = 8;

/// `a'b`.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let parts = map(a.len(), a.chunks(CHUNK).zip(b.chunks(CHUNK)), |(a, b)| {
        widest(
            #[inline(always)]
            move || {
                let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
                let mut lanes = [0.0; LANES];
                for (a, b) in a.iter().zip(b) {
                    for lane in 0..LANES {
                        lanes[lane] += a[lane] * b[lane];
                    }
                }
                lanes.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
            },
        )
    });
    parts.iter().sum()
}

/// `a = factor a + share b`.
pub(super) fn combine(a: &mut [f64], factor: f64, share: f64, b: &[f64]) {
    map(a.len(), a.chunks_mut(CHUNK).zip(b.chunks(CHUNK)), |(a, b)| {
        widest(
            #[inline(always)]
            move || a.iter_mut().zip(b).for_each(|(a, &b)| *a = factor * *a + share * b),
        );
    });
}
