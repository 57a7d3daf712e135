//! Generated surfaces as files: self-affine ones, and twins of a map.

use crate::scenes::read::{Drawn, Error, RandomSpectrum, RandomSurface, Result, System, description};
use contact_model::{Amplitude, Cells, HeightMap, SelfAffine, Size};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use surface_gen::{Anisotropy, HeightDistribution, TwinSpectrum};
use surface_io::{Dimension, Metric, Preprocessing, Quantity, ReadOptions, Scan, Sides, map_file};

/// Memory of drawing a surface and writing it, bytes per cell.
const BYTES: f64 = 24.0;
/// Largest number of columns or rows; whether they fit is decided by the memory.
const MOST: usize = 1 << 24;

/// A self-affine surface to be drawn. Lengths are texts such as `1 mm`, all of them or none with a unit.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneratedSurface {
    /// Columns.
    pub cells: usize,
    /// Rows; `None`: as many as make the cells nearest to squares.
    pub rows: Option<usize>,
    /// Side of a square, `1 mm`, or both of a rectangle, `2 mm x 1 mm`.
    pub size: String,
    /// Fractal dimension in [2, 3].
    pub fractal_dimension: f64,
    /// Rms height.
    pub rms_height: String,
    /// Roll-off wavelength: the spectrum is constant for longer waves.
    pub roll_off_wavelength: Option<String>,
    /// The shortest wave.
    pub shortest_wavelength: Option<String>,
    /// Waves longer along a lay; `None`: isotropic.
    pub anisotropy: Option<Anisotropy>,
    /// Distribution of its heights; `None`: what the random phases give, nearly Gaussian.
    pub heights: Option<HeightDistribution>,
    /// Surface number 0 of this seed, as in a scene.
    pub seed: u64,
}

impl GeneratedSurface {
    /// Generates the surface, writes it in the format of the name's ending ([`write_map`]) and returns a
    /// description in a few lines.
    ///
    /// # Errors
    /// [`Error::Argument`] for an invalid length or units that do not fit, [`Error::Run`] for numbers outside
    /// of their range, [`Error::Surface`] for an unknown ending or a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<String> {
        let mut units: Option<Dimension> = None;
        let wrong = |name: &'static str, e: surface_io::QuantityError| Error::Argument {
            name,
            reason: e.to_string(),
        };
        let mut known_length = |name: &'static str, quantity: Quantity| {
            let dimension = quantity.dimension();
            let known = *units.get_or_insert(dimension);
            if dimension != known || !(dimension == Dimension::LENGTH || dimension == Dimension::NONE) {
                return Err(Error::Argument {
                    name,
                    reason: format!(
                        "`{quantity}`: give all lengths with a unit of length (\"1 mm\"), or none of them"
                    ),
                });
            }
            Ok(quantity.value())
        };
        let [x, y] = self.size.parse::<Sides>().map_err(|e| wrong("size", e))?.both();
        let size = Size { x: known_length("size", x)?, y: known_length("size", y)? };
        let mut length =
            |name: &'static str, text: &str| known_length(name, text.parse().map_err(|e| wrong(name, e))?);
        let rms = length("rms-height", &self.rms_height)?;
        let mut wavenumber = |name, text: &Option<String>| -> Result<Option<f64>> {
            text.as_deref().map(|t| Ok(2.0 * PI / length(name, t)?)).transpose()
        };
        let roll_off = wavenumber("roll-off-wavelength", &self.roll_off_wavelength)?;
        let short_cutoff = wavenumber("shortest-wavelength", &self.shortest_wavelength)?;
        let metric = if units == Some(Dimension::LENGTH) { Metric::Metres } else { Metric::Unitless };
        let surface =
            SelfAffine::new(self.fractal_dimension, size, rms).map_err(runs::Error::model("the surface"))?;
        let surface = SelfAffine { amplitude: Amplitude::RmsHeight(rms), roll_off, short_cutoff, ..surface };
        let seed = surface_gen::surface_seed(self.seed, 0);
        let nearly_square = Cells::nearly_square(self.cells, size);
        let cells = self.rows.map_or(nearly_square, |rows| Cells { rows, ..nearly_square });
        for (name, count) in [("cells", cells.columns), ("rows", cells.rows)] {
            if !(1..=MOST).contains(&count) {
                let expected = format!("a whole number from 1 to {MOST}");
                return Err(runs::Error::parameter(name, count, expected).into());
            }
        }
        let memory = BYTES * cells.columns as f64 * cells.rows as f64;
        runs::threads_for_memory(1, memory, "cells", format!("{} x {}", cells.columns, cells.rows))?;
        let spectrum = RandomSpectrum::SelfAffine { surface, anisotropy: self.anisotropy };
        let drawn = RandomSurface::new(spectrum, self.heights.clone()).draw(cells, seed);
        write(path, &drawn.map_err(runs::Error::model("the surface"))?, metric)
    }
}

/// How a twin of a map is made.
#[derive(Debug, Clone, Copy)]
pub struct AskedTwin<'a> {
    /// How the file of the map is read.
    pub declared: &'a ReadOptions,
    /// What is done to the map.
    pub preprocessing: &'a Preprocessing,
    /// Whether each wave has its own power or that of its ring.
    pub like: TwinSpectrum,
    /// Whether the twin has the distribution of the map's heights.
    pub keep_heights: bool,
    /// Seed of the random phases.
    pub seed: u64,
}

/// Writes an artificial twin of a map into a file: a surface with the spectrum of the map and random phases
/// of a seed. Returns a description.
///
/// The map is read from a file with the options `declared` and processed by `preprocessing`. Where it is not
/// periodic, remove its trend and apply a window. With `keep_heights` the twin also has the distribution of
/// the map's heights.
///
/// # Errors
/// [`Error::Surface`] for files that cannot be read or written and an unknown ending, [`Error::Run`] for undefined
/// points and a map of equal heights.
pub fn write_twin(path: &Path, twin: &AskedTwin<'_>, out: &Path) -> Result<String> {
    let AskedTwin { declared, preprocessing, like, keep_heights, seed } = *twin;
    let scan = Scan::read(path, declared)?;
    let of = Arc::new(scan.map(preprocessing)?);
    let unit = scan.metadata().unit.as_ref().map_or(Ok(Metric::Unitless), |unit| Metric::of(&unit.value));
    let metric = unit.map_err(|problem| Error::Argument { name: "unit", reason: problem.to_string() })?;
    let (cells, heights) = (of.cells(), keep_heights.then(|| HeightDistribution::Of(Arc::clone(&of))));
    let twin = RandomSurface::new(RandomSpectrum::Twin { of, like }, heights);
    let drawn = twin.draw(cells, surface_gen::surface_seed(seed, 0));
    write(out, &drawn.map_err(runs::Error::model("the twin"))?, metric)
}

/// Writes a map whole or not at all, in the format of the name's ending ([`map_file`]).
///
/// # Errors
/// [`surface_io::Error::Content`] for another ending, a format that the build leaves out, and X3P without a unit;
/// [`surface_io::Error::System`] where the system refuses.
pub fn write_map(path: &Path, map: &HeightMap, metric: Metric) -> surface_io::Result<()> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let content = |problem| surface_io::Error::Content { path: path.to_owned(), problem };
    let bytes = map_file(ending, map, metric).map_err(content)?;
    runs::files::write_whole(path, &bytes).map_err(|refused| match refused {
        runs::files::Error::System { action, path, source } => {
            surface_io::Error::System { action, path, source }
        }
        other => {
            let source = std::io::Error::other(other.to_string());
            surface_io::Error::System { action: "write", path: path.to_owned(), source }
        }
    })
}

/// Writes a surface and returns a description.
fn write(path: &Path, Drawn { map, spectrum_residual }: &Drawn, metric: Metric) -> Result<String> {
    write_map(path, map, metric)?;
    let (unit, system) = if metric == Metric::Metres { ("m", System::Si) } else { ("none", System::None) };
    let mut text = format!("{}\nunit               {unit}\n{}\n", path.display(), description(map, system));
    if let Some(residual) = spectrum_residual {
        text += &format!(
            "heights            as prescribed; amplitudes of the waves within {residual:.2e} of the rms height\n"
        );
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_is_written_by_its_ending_and_nothing_where_it_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let map = HeightMap::new(2, 1e-6, vec![0.0, 1e-9, 2e-9, 3e-9]).unwrap();
        let write = |name: &str, metric| write_map(&dir.path().join(name), &map, metric);
        for name in ["a.hdf5", "a", "a.TXT"] {
            let error = write(name, Metric::Metres).unwrap_err();
            assert!(matches!(error, surface_io::Error::Content { .. }), "{error}");
        }
        assert!(write("a.x3p", Metric::Unitless).is_err());
        let error = write("missing/a.txt", Metric::Metres).unwrap_err();
        assert!(matches!(error, surface_io::Error::System { action: "write", .. }), "{error}");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
        write("a.txt", Metric::Metres).unwrap();
        let written = std::fs::read(dir.path().join("a.txt")).unwrap();
        assert_eq!(written, map_file("txt", &map, Metric::Metres).unwrap());
    }
}
