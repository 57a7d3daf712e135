//! HDF5 files: of h5py 3.16 (`chunks.h5`, `packed.h5`), and of this crate.
//!
//! ```python
//! with h5py.File("chunks.h5", "w") as f:
//!     g = f.create_group("scan"); f["words"] = [b"a", b"bc"]
//!     d = g.create_dataset("z", data=np.arange(12.0).reshape(3, 4).astype(">f4"), chunks=(2, 3),
//!                          compression="gzip", shuffle=True, fletcher32=True)
//!     d.dims[0].label = "y"; d.dims[1].label = "x"; d.attrs["units"] = "nm"
//!     d.attrs["size"] = [4.0, 1.5]; d.attrs["size_unit"] = "um"
//!     g["phase"] = np.ones((3, 4)); g["phase"].attrs["unit"] = "deg"
//!     f["again"] = g
//! with h5py.File("packed.h5", "w", libver="latest") as f:
//!     d = f.create_dataset("heights", data=np.array([[1, 2, -9], [4, 5, 6]], "i2"), chunks=(1, 3))
//!     d.attrs["scale_factor"] = 0.5; d.attrs["add_offset"] = 10.0
//!     d.attrs["_FillValue"] = np.int16(-9); d.attrs["units"] = "mm"
//!     f.create_dataset("hole", shape=(4, 4), dtype="f8")
//!     n = f.create_dataset("part", shape=(2, 4), dtype="f8", chunks=(1, 4)); n[1, :] = [1, 2, 3, 4]
//! ```
//!
//! And of programs that write attributes of their own: `fringes.datx` and `nanometers.datx` after the
//! description of Zygo's files, `matlab73.mat` after that of MATLAB's, `counts.h5` after JPK's:
//!
//! ```python
//! largest = np.finfo("f8").max
//! with h5py.File("fringes.datx", "w", libver="latest") as f:
//!     d = f.create_dataset("Data/Surface/{7B5E}", data=np.array([[1, 2, 3], [4, largest, 6]]))
//!     d.attrs["No Data"] = np.array([largest]); d.attrs["Unit"] = ["Fringes"]  # or NanoMeters
//!     d.attrs["Wavelength"] = [6.33e-7]; d.attrs["Interferometric Scale Factor"] = [0.5]
//!     d.attrs["Obliquity Factor"] = [1.0]  # besides, X, Y and Z Converter: (text, text, list of numbers)
//! with h5py.File("matlab73.mat", "w", userblock_size=512) as f:
//!     d = f.create_dataset("Z", data=np.array([[1., 4], [2, 5], [3, 6]])); d.attrs["MATLAB_class"] = b"double"
//!     d = f.create_dataset("dx", data=np.array([[0.5]])); d.attrs["MATLAB_class"] = b"double"
//!     d = f.create_dataset("t", data=np.array([[65, 66]], "u2")); d.attrs["MATLAB_class"] = b"char"
//! with h5py.File("counts.h5", "w", libver="latest") as f:
//!     g = f.create_group("a"); g.attrs["encoder.scaling.multiplier"] = 1.5e-15
//!     g.attrs["encoder.scaling.offset"] = -1e-6; g.attrs["encoder.scaling.unit.unit"] = b"m"
//!     d = g.create_dataset("z", data=np.array([[10, -20, 30], [40, 50, 60]], "i4")); d.attrs["units"] = "m"
//!     d = f.create_dataset("b", data=np.array([[1, 2], [3, 4]], "i2")); d.attrs["unit"] = "nm"
//!     d = f.create_dataset("c", data=np.array([[1, 2], [3, 4]], "i2")); d.attrs["unit"] = "nm"
//!     d.attrs["scale_factor"] = "two"
//! ```

use super::Small;

pub fn files() -> Vec<Small> {
    [files_of_instruments(), files_of_h5py(), vec![file_of_this_crate()]].concat()
}

/// A channel in a file without a size.
fn small(name: &'static str, bytes: &[u8], number: usize, shape: [usize; 2], heights: Vec<f64>) -> Small {
    Small { name, bytes: bytes.to_vec(), number, shape, size: None, heights, compressed: true }
}

fn files_of_instruments() -> Vec<Small> {
    let counts = include_bytes!("hdf5/counts.h5");
    let fringes = include_bytes!("hdf5/fringes.datx");
    let nanometers = include_bytes!("hdf5/nanometers.datx");
    let matlab = include_bytes!("hdf5/matlab73.mat");
    let zygo = |factor: f64| [1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0].map(|h: f64| h * factor).to_vec();
    let jpk = [10.0, 40.0, -20.0, 50.0, 30.0, 60.0].map(|n: f64| 1.5e-15 * n - 1e-6).to_vec();
    vec![
        small("hdf5 of Zygo in fringes", fringes, 0, [3, 2], zygo(0.5 * 6.33e-7)),
        small("hdf5 of Zygo", nanometers, 0, [3, 2], zygo(1e-9)),
        small("hdf5 of MATLAB", matlab, 0, [3, 2], vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        small("hdf5 of JPK", counts, 0, [2, 3], jpk),
        // Integers in nm without a scale: counts.
        small("hdf5 of counts", counts, 1, [2, 2], vec![1.0, 3.0, 2.0, 4.0]),
    ]
}

fn files_of_h5py() -> Vec<Small> {
    let chunks = include_bytes!("hdf5/chunks.h5");
    let packed = include_bytes!("hdf5/packed.h5");
    let count = (0..12).map(|i| f64::from(i) * 1e-9).collect();
    let undefined = f64::NAN;
    vec![
        // Channel 0 is again/phase.
        Small { size: Some([4e-6, 1.5e-6]), ..small("hdf5 in chunks", chunks, 1, [4, 3], count) },
        // The first index is x.
        small(
            "hdf5 packed",
            packed,
            0,
            [2, 3],
            [10.5, 12.0, 11.0, 12.5, undefined, 13.0].map(|mm: f64| mm * 1e-3).to_vec(),
        ),
        small(
            "hdf5 half written",
            packed,
            1,
            [2, 4],
            vec![undefined, 1.0, undefined, 2.0, undefined, 3.0, undefined, 4.0],
        ),
    ]
}

fn file_of_this_crate() -> Small {
    let heights = vec![1e-9, -2e-9, f64::NAN, 0.0, 5e-9, 1.0];
    let size = [3e-6, 1e-6];
    let map = contact_model::HeightMap::with_undefined([3, 2], size, heights.clone()).unwrap();
    let own = surface_io::hdf5(&map, surface_io::Metric::Metres).unwrap();
    Small { size: Some(size), ..small("hdf5 of this crate", &own, 0, [3, 2], heights) }
}
