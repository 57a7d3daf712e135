//! Memory that maps need, checked before it is used.

use contact_model::{Cells, Error, Result, Surface};

/// Bytes that drawing a self-affine map takes for each of the map: half of its waves, as complex numbers,
/// beside it.
const DRAWN: f64 = 2.0;
/// The same with amplitudes of their own, those of a lay or of an artificial twin.
const WITH_AMPLITUDES: f64 = 3.0;
/// The same with prescribed heights: sorted heights, those of two steps of the iteration, their order and
/// their waves.
const PRESCRIBED: f64 = 7.0;

/// Bytes that [`crate::height_map`] needs at its peak: those of the map, twice as many for a random map, and
/// none for a given map.
///
/// ```
/// use contact_model::{SelfAffine, Surface};
/// let flat = Surface::Flat { size: 1.0.into() };
/// let drawn = Surface::SelfAffine(SelfAffine::new(2.4, 1.0, 1.0)?);
/// assert_eq!(surface_gen::height_map_memory(&flat, 1000), 8e6);
/// assert_eq!(surface_gen::height_map_memory(&drawn, 1000), 16e6);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn height_map_memory(surface: &Surface, cells: impl Into<Cells>) -> f64 {
    let map = cells.into().map_bytes();
    match surface {
        Surface::Heights(_) | Surface::Profile(_) => 0.0,
        Surface::SelfAffine(_) => DRAWN * map,
        _ => map,
    }
}

/// Bytes that [`crate::WaveGenerator`] and a map of it take at their peak, with the heights of a
/// [`crate::PrescribedMap`] or without.
pub fn wave_map_memory(cells: impl Into<Cells>, prescribed: bool) -> f64 {
    cells.into().map_bytes() * if prescribed { PRESCRIBED } else { WITH_AMPLITUDES }
}

/// An error where the bytes cannot be had that a map of these cells takes while it is drawn. They are not
/// kept: each thread touches its own part of them first.
pub(crate) fn check(cells: Cells, bytes: f64) -> Result<()> {
    // A number beyond those of `usize` becomes the largest, which is refused.
    Vec::<u8>::new().try_reserve_exact(bytes as usize).map_err(|_| {
        let Cells { columns, rows } = cells;
        Error::out_of_memory(format!("a map of {columns} columns x {rows} rows"), bytes)
    })
}

/// [`check`] for a map whose amplitudes are kept.
pub(crate) fn check_with_amplitudes(cells: Cells) -> Result<()> {
    check(cells, wave_map_memory(cells, false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused() {
        assert!(check_with_amplitudes(Cells::from(100)).is_ok());
        for cells in [Cells::from(1 << 30), Cells::from(usize::MAX)] {
            let refused = check_with_amplitudes(cells);
            assert!(
                matches!(refused, Err(Error::OutOfMemory { bytes, .. }) if bytes >= 1.8e19),
                "{refused:?}"
            );
        }
    }
}
