//! MATLAB files: of SciPy 1.17 (`scipy.mat`, `scipy-packed.mat`), and one written here with the bytes of
//! numbers the other way round.
//!
//! ```python
//! variables = {"Z": np.array([[1., 2, 3], [4, np.nan, 6]]), "dx": 0.5, "text": "some text", "s": {"a": 1},
//!              "counts": np.array([[1, -2], [3, 4]], "i2"), "complex": np.array([[1j, 2], [3, 4]])}
//! scipy.io.savemat("scipy.mat", variables)
//! scipy.io.savemat("scipy-packed.mat", variables, do_compression=True)
//! ```

use super::Small;

pub fn files() -> Vec<Small> {
    let small = |name, bytes: &[u8], number, shape, heights: &[f64], compressed| Small {
        name,
        bytes: bytes.to_vec(),
        number,
        shape,
        size: None,
        heights: heights.to_vec(),
        compressed,
    };
    let heights = [1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0];
    let plain = include_bytes!("mat/scipy.mat");
    let packed = include_bytes!("mat/scipy-packed.mat");
    vec![
        small("mat", plain, 0, [3, 2], &heights, false),
        small("mat of integers", plain, 1, [2, 2], &[1.0, -2.0, 3.0, 4.0], false),
        small("mat packed", packed, 0, [3, 2], &heights, true),
        small("mat packed of integers", packed, 1, [2, 2], &[1.0, -2.0, 3.0, 4.0], true),
        small("mat of bytes in the other order", &big(), 0, [2, 2], &[1.0, 3.0, 2.0, 255.0], false),
    ]
}

/// Doubles whose numbers are stored as bytes, in the tag itself.
fn big() -> Vec<u8> {
    let word = u32::to_be_bytes;
    let matrix = [
        [word(6), word(8), word(6), word(0)].concat(),
        [word(5), word(8), word(2), word(2)].concat(),
        [word(1 << 16 | 1), *b"Z\0\0\0"].concat(),
        [word(4 << 16 | 2), [1, 2, 3, 255]].concat(),
    ]
    .concat();
    let mut bytes = b"MATLAB 5.0 MAT-file, by hand".to_vec();
    bytes.resize(124, b' ');
    bytes.extend(b"\x01\x00MI");
    bytes.extend([word(14), word(matrix.len() as u32)].concat());
    bytes.extend(matrix);
    bytes
}
