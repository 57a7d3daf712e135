//! Random surfaces that are generated from a seed: self-affine surfaces, isotropic or anisotropic with a lay,
//! and artificial twins of a map; all of them optionally with a prescribed distribution of heights.

use crate::scenes::read::{System, amount, number, sampled, sampled_cells};
use contact_model::{Amplitude, Cells, HeightMap, Result, SelfAffine, Size};
use runs::fnv1a_128;
use std::f64::consts::PI;
use std::sync::Arc;
use surface_gen::{Anisotropy, Exact, HeightDistribution, PrescribedMap, TwinSpectrum, WaveGenerator};

/// The amplitudes of the waves of a random surface.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum RandomSpectrum {
    /// Self-affine.
    SelfAffine {
        /// Its parameters.
        surface: SelfAffine,
        /// Waves longer along a lay; `None`: isotropic.
        anisotropy: Option<Anisotropy>,
    },
    /// The spectrum of a map, on the cells of the map.
    Twin {
        /// The map.
        of: Arc<HeightMap>,
        /// Which part of the spectrum the twin has in common with the map.
        like: TwinSpectrum,
    },
}

/// A surface that is generated from a seed on a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomSurface {
    /// The amplitudes of its waves.
    pub spectrum: RandomSpectrum,
    /// The distribution of its heights; `None` leaves that of random phases, which is nearly Gaussian.
    pub heights: Option<HeightDistribution>,
    /// Where it is sampled on a coarser grid: the cells on which it is generated, and the largest number of
    /// cells along the longer side that are kept.
    sampling: Option<(Cells, usize)>,
}

/// A drawn surface.
pub(crate) struct Drawn {
    pub map: HeightMap,
    /// Rms difference of the amplitudes of its waves from the spectrum, over the rms height, where its
    /// heights are prescribed.
    pub spectrum_residual: Option<f64>,
}

impl RandomSurface {
    /// A surface of this spectrum and this distribution of heights.
    pub fn new(spectrum: RandomSpectrum, heights: Option<HeightDistribution>) -> Self {
        Self { spectrum, heights, sampling: None }
    }

    /// Sides of the rectangle.
    pub fn size(&self) -> Size {
        match &self.spectrum {
            RandomSpectrum::SelfAffine { surface, .. } => surface.size,
            RandomSpectrum::Twin { of, .. } => of.size(),
        }
    }

    /// The cells that it defines itself: those of the map for a twin, those that are kept for a sampled
    /// surface.
    pub(crate) fn own_cells(&self) -> Option<Cells> {
        match (&self.sampling, &self.spectrum) {
            (Some((cells, longer)), _) => Some(sampled_cells(*cells, *longer)),
            (None, RandomSpectrum::Twin { of, .. }) => Some(of.cells()),
            (None, RandomSpectrum::SelfAffine { .. }) => None,
        }
    }

    /// The same surface on at most `longer` cells along the longer side, where it is otherwise generated on
    /// `cells`.
    ///
    /// A self-affine surface without a prescribed distribution of heights is generated on the coarser cells,
    /// with fewer short waves. With a prescribed distribution, maps generated on two grids differ by some per
    /// cent of the rms height; such a surface is generated on the finer cells and sampled.
    pub(crate) fn coarser(&self, cells: Cells, longer: usize) -> Self {
        let drawn = matches!(self.spectrum, RandomSpectrum::SelfAffine { .. }) && self.heights.is_none();
        let finest = self.sampling.map_or(cells, |(finest, _)| finest);
        Self { sampling: (!drawn).then_some((finest, longer)), ..self.clone() }
    }

    /// The map of a seed on these cells; a twin always has the cells of its map.
    ///
    /// # Errors
    /// Those of [`WaveGenerator`], [`PrescribedMap`] and [`surface_gen::self_affine_map`].
    pub fn map(&self, cells: impl Into<Cells>, seed: u64) -> Result<HeightMap> {
        Ok(self.draw(cells.into(), seed)?.map)
    }

    /// Peak memory of generating it in bytes, the map included.
    pub fn memory(&self, cells: impl Into<Cells>) -> f64 {
        let cells = self.sampling.map_or(cells.into(), |(finest, _)| finest);
        match (&self.heights, &self.spectrum) {
            (None, RandomSpectrum::SelfAffine { surface, anisotropy: None }) => {
                surface_gen::height_map_memory(&contact_model::Surface::SelfAffine(*surface), cells)
            }
            (heights, RandomSpectrum::SelfAffine { .. }) => {
                surface_gen::wave_map_memory(cells, heights.is_some())
            }
            (heights, RandomSpectrum::Twin { of, .. }) => {
                surface_gen::wave_map_memory(of.cells(), heights.is_some())
            }
        }
    }

    /// Generates it; `cells` is used where it does not define its own cells.
    ///
    /// # Errors
    /// Those of [`WaveGenerator`], [`PrescribedMap`] and [`surface_gen::self_affine_map`].
    pub(crate) fn draw(&self, cells: Cells, seed: u64) -> Result<Drawn> {
        let cells = self.sampling.map_or(cells, |(finest, _)| finest);
        let waves = || match &self.spectrum {
            RandomSpectrum::SelfAffine { surface, anisotropy } => {
                let isotropic = Anisotropy { ratio: 1.0, lay: 0.0 };
                WaveGenerator::anisotropic(surface, anisotropy.unwrap_or(isotropic), cells)
            }
            RandomSpectrum::Twin { of, like } => WaveGenerator::twin(of, *like),
        };
        let (map, spectrum_residual) = match (&self.heights, &self.spectrum) {
            (Some(heights), _) => {
                let found = PrescribedMap::new(&waves()?, heights, Exact::Distribution, seed)?;
                (found.map, Some(found.spectrum_residual))
            }
            (None, RandomSpectrum::SelfAffine { surface, anisotropy: None }) => {
                (surface_gen::self_affine_map(surface, cells, seed)?, None)
            }
            (None, _) => (waves()?.map(seed)?, None),
        };
        let map = match self.sampling {
            Some((_, longer)) => sampled(&map, longer)?,
            None => map,
        };
        Ok(Drawn { map, spectrum_residual })
    }

    /// A description in a phrase.
    pub(crate) fn describe(&self, system: System) -> String {
        let mut text = match &self.spectrum {
            RandomSpectrum::SelfAffine { surface, anisotropy } => {
                let mut text = describe_self_affine(surface, system);
                if let Some(Anisotropy { ratio, lay }) = anisotropy {
                    text += &format!(
                        ", waves {} times as long along the lay at {} degrees as across",
                        number(*ratio),
                        number(*lay)
                    );
                }
                text
            }
            RandomSpectrum::Twin { of, like } => {
                let rings = if *like == TwinSpectrum::Rings { "isotropic " } else { "" };
                let (columns, rows) = (of.columns(), of.rows());
                format!(
                    "an artificial {rings}twin of a map of {columns} x {rows} cells, {}",
                    describe_sides(of.size(), system)
                )
            }
        };
        match &self.heights {
            None => {}
            Some(HeightDistribution::Weibull { shape }) => {
                text += &format!(", heights of Weibull's law with the shape {}", number(*shape));
            }
            Some(HeightDistribution::Of(_)) => text += ", with the distribution of its heights",
            Some(_) => text += ", Gaussian heights",
        }
        text
    }

    /// Everything that determines the surface of a seed, in a line.
    pub(crate) fn key(&self) -> String {
        let spectrum = match &self.spectrum {
            RandomSpectrum::Twin { of, like } => format!("twin {like:?} of {}", map_key(of)),
            other @ RandomSpectrum::SelfAffine { .. } => format!("{other:?}"),
        };
        let heights = match &self.heights {
            Some(HeightDistribution::Of(map)) => map_key(map),
            other => format!("{other:?}"),
        };
        format!("{spectrum} heights {heights} sampling {:?}", self.sampling)
    }
}

/// A map as a part of a key.
pub(crate) fn map_key(map: &HeightMap) -> String {
    let bytes: Vec<u8> = map.heights().iter().flat_map(|h| h.to_le_bytes()).collect();
    format!("map {:?} {:?} {:032x}", map.cells(), map.size(), fnv1a_128(&bytes))
}

/// One side of a square or both of a rectangle.
pub(crate) fn describe_sides(size: Size, system: System) -> String {
    let length = |length| amount(length, system.shown("m"));
    if size.is_square() {
        format!("side {}", length(size.x))
    } else {
        format!("sides {} x {}", length(size.x), length(size.y))
    }
}

/// A self-affine surface in a phrase.
pub(crate) fn describe_self_affine(s: &SelfAffine, system: System) -> String {
    let length = |length| amount(length, system.shown("m"));
    let mut text =
        format!("a self-affine surface, D_f = {}, {}", s.fractal_dimension(), describe_sides(s.size, system));
    if let Amplitude::RmsHeight(h) = s.amplitude {
        text += &format!(", rms height {}", length(h));
    }
    if let Some(q) = s.roll_off {
        text += &format!(", roll-off at the wavelength {}", length(2.0 * PI / q));
    }
    if let Some(q) = s.short_cutoff {
        text += &format!(", shortest wavelength {}", length(2.0 * PI / q));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::SelfAffine;

    /// Cells of the coarser grid are nearest to these of the finer one, twice as many.
    fn every_second(map: &HeightMap) -> Vec<f64> {
        let inside = |i: &usize| (i / map.columns()) % 2 == 1 && i % map.columns() % 2 == 1;
        (0..map.heights().len()).filter(inside).map(|i| map.heights()[i]).collect()
    }

    #[test]
    fn surfaces_that_depend_on_the_grid_are_sampled_on_coarser_grids() {
        let surface = SelfAffine { roll_off: Some(30.0), ..SelfAffine::new(2.2, 1.0, 0.01).unwrap() };
        let plain = RandomSpectrum::SelfAffine { surface, anisotropy: None };
        let of = Arc::new(RandomSurface::new(plain.clone(), None).map(64, 1).unwrap());
        let weibull = Some(HeightDistribution::Weibull { shape: 1.5 });
        let twin = RandomSpectrum::Twin { of: Arc::clone(&of), like: TwinSpectrum::EachWave };
        for random in [RandomSurface::new(plain.clone(), weibull), RandomSurface::new(twin, None)] {
            let fine = random.map(64, 7).unwrap();
            let coarse = random.coarser(fine.cells(), 32);
            let found = coarse.map(32, 7).unwrap();
            assert_eq!((found.cells(), coarse.own_cells()), ([32, 32].into(), Some([32, 32].into())));
            assert_eq!(found.heights(), every_second(&fine));
            // And of what is sampled already, the finest grid is.
            let coarsest = coarse.coarser(found.cells(), 16).map(16, 7).unwrap();
            assert_eq!(coarsest, sampled(&fine, 16).unwrap());
        }
        // Waves of its own alone: drawn again.
        let drawn = RandomSurface::new(plain, None).coarser([64, 64].into(), 32);
        assert!(drawn.own_cells().is_none() && drawn.map(32, 7).unwrap().columns() == 32);
    }
}
