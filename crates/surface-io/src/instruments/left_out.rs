//! Formats whose feature is off. They are still recognised, and the refusal names the feature.

use super::magic;
use super::prelude::*;
use crate::error::ContentError;
#[cfg(not(all(feature = "hdf5", feature = "x3p")))]
use contact_model::HeightMap;

#[cfg(not(feature = "hdf5"))]
pub(super) const HDF5: Reader = Reader {
    format: Format::Hdf5,
    recognises: magic::is_hdf5,
    channels: |source| refused(source, Format::Hdf5),
};

#[cfg(not(feature = "tiff"))]
pub(super) const TIFF: Reader = Reader {
    format: Format::Tiff,
    recognises: magic::is_tiff,
    channels: |source| refused(source, Format::Tiff),
};

#[cfg(not(feature = "x3p"))]
pub(super) const X3P: Reader =
    Reader { format: Format::X3p, recognises: magic::is_archive, channels: archive };

#[cfg(not(all(feature = "hdf5", feature = "tiff")))]
fn refused(source: &mut OpenedFile<'_>, format: Format) -> Result<Vec<StoredChannel>> {
    Err(source.content(ContentError::LeftOut { format }))
}

/// An archive without the member that describes an X3P file is none.
#[cfg(not(feature = "x3p"))]
fn archive(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let members = crate::zip::members(source)?;
    let problem = match magic::main_member(&members) {
        Some(_) => ContentError::LeftOut { format: Format::X3p },
        None => crate::zip::refused(&members),
    };
    Err(source.content(problem))
}

/// The bytes of an HDF5 file, where the feature `hdf5` is on.
///
/// # Errors
/// [`ContentError::LeftOut`].
#[cfg(not(feature = "hdf5"))]
pub fn hdf5(_map: &HeightMap, _metric: crate::write::Metric) -> Result<Vec<u8>, ContentError> {
    Err(ContentError::LeftOut { format: Format::Hdf5 })
}

/// The bytes of an X3P file, where the feature `x3p` is on.
///
/// # Errors
/// [`ContentError::LeftOut`].
#[cfg(not(feature = "x3p"))]
pub fn x3p(_map: &HeightMap) -> Result<Vec<u8>, ContentError> {
    Err(ContentError::LeftOut { format: Format::X3p })
}

#[cfg(test)]
mod tests {
    use crate::{Format, Metric, ReadOptions, Scan, map_file};
    use contact_model::HeightMap;

    #[test]
    fn errors_name_the_feature() {
        let map = HeightMap::new(1, 1.0, vec![0.0]).unwrap();
        let files: [(Format, &[u8], bool, bool); 2] = [
            (Format::Hdf5, super::magic::HDF5, cfg!(feature = "hdf5"), true),
            (Format::Tiff, b"II*\0", cfg!(feature = "tiff"), false),
        ];
        for (format, start, there, written) in files {
            if there {
                continue;
            }
            let words = format!("the feature {} of the crate surface-io", format.word());
            let read = Scan::from_bytes("a", start, &ReadOptions::default()).unwrap_err().to_string();
            assert!(read.contains(&words), "{read}");
            if written {
                let write = map_file("h5", &map, Metric::Metres).unwrap_err().to_string();
                assert!(write.contains(&words), "{write}");
            }
        }
        if !cfg!(feature = "x3p") {
            let write = map_file("x3p", &map, Metric::Metres).unwrap_err().to_string();
            assert!(write.contains("the feature x3p of the crate surface-io"), "{write}");
            let other = crate::zip::archive(&[("a.txt", vec![1])]).unwrap();
            let read = Scan::from_bytes("a", &other, &ReadOptions::default()).unwrap_err().to_string();
            assert!(read.contains("an archive of a.txt"), "{read}");
            let other = crate::zip::archive(&[("main.xml", vec![1])]).unwrap();
            let read = Scan::from_bytes("a", &other, &ReadOptions::default()).unwrap_err().to_string();
            assert!(read.contains("the feature x3p of the crate surface-io"), "{read}");
        }
    }
}
