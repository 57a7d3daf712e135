//! Readers under files that nobody meant well: they never panic and never allocate more than a stated multiple of the file.

#![allow(clippy::unwrap_used)] // Tests, as a whole.
#![allow(unsafe_code)] // A global allocator that counts is unsafe by its nature; it hands everything to the system's.

use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use surface_io::{Crop, Decimal, Declared, Detrend, Fill, Format, Scan, Treatment};

thread_local! {
    /// Bytes that this thread holds, and the most that it held.
    static HELD: Cell<(usize, usize)> = const { Cell::new((0, 0)) };
}

struct Counting;

fn count(more: usize, less: usize) {
    // A thread that is ending has no more count; it is none of the test's.
    let _ = HELD.try_with(|held| {
        let (now, most) = held.get();
        let now = (now + more).saturating_sub(less);
        held.set((now, most.max(now)));
    });
}

// SAFETY: every call is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size(), 0);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(0, layout.size());
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // Old and new may exist at once.
        count(size, 0);
        count(0, layout.size());
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What is stated on the crate's front page: the file itself, 8 bytes for a hole between two commas, twice that for points on a half-empty grid.
const MULTIPLE: usize = 24;

/// Errors, words of `Understood`, the buffer of NPY.
const CONSTANT: usize = 100_000;

/// The most that `read` held beyond what was held before.
fn most_held<T>(read: impl FnOnce() -> T) -> (T, usize) {
    let before = HELD.get().0;
    HELD.set((before, before));
    let result = read();
    (result, HELD.get().1 - before)
}

const NAMES: [&str; 4] = ["a.npy", "a.txt", "a.xyz", "a"];

/// Reads the bytes under every name and with several declarations; what is read is treated in all ways.
fn torture(bytes: &[u8]) -> Result<(), TestCaseError> {
    let plain = Declared::default();
    let cell = Declared { cell: "1".parse().ok(), ..plain.clone() };
    let declarations = [
        plain.clone(),
        Declared { format: Some(Format::Xyz), missing: Some(0.0), skip_lines: 1, ..cell.clone() },
        Declared { format: Some(Format::Text), decimal: Decimal::Comma, ..cell.clone() },
        Declared {
            unit: "nm".parse().ok(),
            lateral_unit: "um".parse().ok(),
            cell: "1 um".parse().ok(),
            ..plain
        },
        cell,
    ];
    for name in NAMES {
        for declared in &declarations {
            let (scan, held) = most_held(|| Scan::from_bytes(name, bytes, declared));
            prop_assert!(held <= MULTIPLE * bytes.len() + CONSTANT, "{held} bytes for {}", bytes.len());
            let scan = match scan {
                Ok(scan) => scan,
                Err(error) => {
                    let text = error.to_string();
                    prop_assert!(text.starts_with(name) && text.len() < 2000, "{text}");
                    continue;
                }
            };
            prop_assert!(!scan.understood().to_string().is_empty());
            for detrend in [Detrend::Nothing, Detrend::Plane, Detrend::Quadric] {
                for fill in [None, Some(Fill::Neighbours), Some(Fill::Plane)] {
                    let treatment = Treatment { crop: Some(Crop::Centre), fill, detrend, cells: None };
                    match scan.map(&treatment) {
                        Ok(map) => prop_assert!(map.heights().iter().all(|h| h.is_finite())),
                        Err(error) => prop_assert!(!error.to_string().is_empty()),
                    }
                }
            }
        }
    }
    Ok(())
}

/// Valid files of all formats.
fn valid(which: usize) -> Vec<u8> {
    let heights: Vec<f64> = (0..9).map(|i| f64::from(i) / 3.0).collect();
    let map = contact_model::HeightMap::new(3, 1.5, heights.clone()).unwrap();
    match which {
        0 => surface_io::npy(&[3, 3], &heights).unwrap(),
        1 => surface_io::text(&map, surface_io::Metric::Metres).into_bytes(),
        2 => surface_io::xyz(&map, surface_io::Metric::Unitless).into_bytes(),
        3 => b"# Width: 10.00 um\n1,5;2,5;nan\n3;4;5\n-1e3;7;8\n".to_vec(),
        4 => b"\x93NUMPY\x01\x00\x46\x00{'descr': '>i2', 'fortran_order': True, 'shape': (2, 3), }           \n012345678901".to_vec(),
        _ => b"1,2,,4\n5,6,7,8\n9,,,,\n".to_vec(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1000,
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct("tests/hostile.proptest-regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        torture(&bytes)?;
    }

    #[test]
    fn random_bytes_behind_a_magic(version in 0..4_u8, bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        torture(&[b"\x93NUMPY", &[version, 0][..], &bytes].concat())?;
    }

    #[test]
    fn almost_text(text in "[-+0-9.,;eE \\t\\n#%naif]{0,120}") {
        torture(text.as_bytes())?;
    }

    #[test]
    fn almost_a_header(shape in "[0-9,() L]{0,24}", kind in "[<>|=]?[fiuc]?[0-9]{0,2}", order in "(True|False|1)") {
        let text = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': ({shape}), }}");
        let length = (text.len() as u16).to_le_bytes();
        torture(&[&b"\x93NUMPY\x01\x00"[..], &length, text.as_bytes(), &[0; 64]].concat())?;
    }

    #[test]
    fn valid_files_with_bytes_changed_lost_and_doubled(
        which in 0..6_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..6),
    ) {
        let mut bytes = valid(which);
        for (at, byte, how) in changes {
            if bytes.is_empty() {
                break;
            }
            let at = at.index(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => { bytes.remove(at); }
                2 => bytes.insert(at, bytes[at]),
                _ => bytes.truncate(at),
            }
        }
        torture(&bytes)?;
    }
}

#[test]
fn the_valid_files_are_valid() {
    for which in 0..6 {
        let declared = match which {
            3 => Declared { decimal: Decimal::Comma, ..Declared::default() },
            2 => Declared { format: Some(Format::Xyz), ..Declared::default() },
            _ => Declared::default(),
        };
        let scan = Scan::from_bytes("a", &valid(which), &declared);
        assert!(scan.is_ok(), "{which}: {scan:?}");
    }
}

#[test]
fn large_claims_allocate_nothing() {
    for bytes in [
        &b"\x93NUMPY\x02\x00\xff\xff\xff\xff"[..],
        b"\x93NUMPY\x01\x00\x50\x00{'descr': '<f8', 'fortran_order': False, 'shape': (400000, 400000), }            \n",
        b"\x93NUMPY\x01\x00\x50\x00{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296), }    \n",
        b"0 0 1\n1 1 2\n1000000 1000000 3\n",
        b"0 0 1\n1e-300 1e-300 2\n1 1 3\n",
    ] {
        for name in NAMES {
            let (scan, held) = most_held(|| Scan::from_bytes(name, bytes, &Declared::default()));
            assert!(held < MULTIPLE * bytes.len() + 5000, "{name}: {held}");
            assert!(scan.is_err() || name != "a.xyz");
        }
    }
}

#[test]
fn real_files_stay_below_the_multiple() {
    let n = 300_usize;
    let heights: Vec<f64> = (0..n * n).map(|i| (i % 977) as f64 / 7.0).collect();
    let map = contact_model::HeightMap::new(n, 1.0, heights.clone()).unwrap();
    let npy = surface_io::npy(&[n, n], &heights).unwrap();
    let holes = vec![b","[0]; n];
    let commas = std::iter::repeat_n([&b"1"[..], &holes, b"\n"].concat(), n).collect::<Vec<_>>().concat();
    let short: Vec<String> = (0..n * n).map(|i| format!("{} {} 1\n", i % n, i / n)).collect();
    for (name, bytes, multiple) in [
        ("a.npy", npy, 2),
        ("a.txt", surface_io::text(&map, surface_io::Metric::Metres).into_bytes(), 3),
        ("a.xyz", surface_io::xyz(&map, surface_io::Metric::Metres).into_bytes(), 5),
        ("a.txt", commas, 10),
        ("a.xyz", short.concat().into_bytes(), 10),
    ] {
        let (scan, held) = most_held(|| Scan::from_bytes(name, &bytes, &Declared::default()));
        assert!(scan.is_ok(), "{scan:?}");
        assert!(
            held <= multiple * bytes.len() + CONSTANT,
            "{name}: {} times",
            held as f64 / bytes.len() as f64
        );
    }
}
