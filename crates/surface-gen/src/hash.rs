//! Seeds from seeds: the SplitMix64 finaliser and what is built on it.

/// Increment of SplitMix64, 2^64 / golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Separates the seeds of surfaces from the streams of phases.
const SURFACES: u64 = 0x7375_7266_6163_6573; // "surfaces" in ASCII

/// Finaliser of SplitMix64 (Steele, Lea, Flood 2014, as published by Vigna): a bijection of 64-bit words.
pub(crate) fn mix(word: u64) -> u64 {
    let mut z = word.wrapping_add(GOLDEN);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The first four outputs of SplitMix64 started at `key`: a state for Xoshiro256++.
pub(crate) fn expand(key: u64) -> [u64; 4] {
    [0, 1, 2, 3].map(|i: u64| mix(key.wrapping_add(GOLDEN.wrapping_mul(i))))
}

/// Seed of surface number `index` of an ensemble with the given master seed.
///
/// `seed = mix(mix(master xor "surfaces") + index)`, where `mix` is the SplitMix64 finaliser. For one master
/// seed different indices never give the same seed. The fractal dimension has no influence on the seed:
/// surfaces of different D_f and the same number have the same phases, so that curves of different D_f differ
/// by the spectrum alone (and their errors are correlated).
///
/// ```
/// use surface_gen::surface_seed;
/// assert_ne!(surface_seed(1, 0), surface_seed(1, 1));
/// assert_ne!(surface_seed(1, 0), surface_seed(2, 0));
/// ```
pub fn surface_seed(master: u64, index: u64) -> u64 {
    mix(mix(master ^ SURFACES).wrapping_add(index))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mix_is_splitmix64() {
        // First outputs of the reference implementation for the state 1234567.
        assert_eq!(
            expand(1_234_567),
            [
                6_457_827_717_110_365_317,
                3_203_168_211_198_807_973,
                9_817_491_932_198_370_423,
                4_593_380_528_125_082_431
            ]
        );
    }

    #[test]
    fn surface_seeds_are_pinned() {
        // From an independent implementation of the same words.
        assert_eq!(surface_seed(0, 0), 0xa1c6_b6cf_e186_c414);
        assert_eq!(surface_seed(1, 0), 0xc8af_2c8d_a646_165f);
        assert_eq!(surface_seed(1, 1), 0x3b51_705b_de26_b424);
        assert_eq!(surface_seed(u64::MAX, 59), 0x2b2a_748b_4bd5_7f4b);
    }
}
