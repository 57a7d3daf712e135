//! Statistics of a given map that theories of rough contact need, and measures of how well it meets their
//! assumptions.

use super::moments::{HeightMoments, rms_height};
use super::plane::MapPlane;
use super::spectra::waves;
use super::window::windowed;
use crate::lattice::Lattice;
use contact_model::{Error, HeightMap, Result};
use std::borrow::Cow;
use std::f64::consts::TAU;

/// Opposite edges of a periodic map differ by no more than this times the largest step between neighbouring
/// lines of cells inside.
const MATCHING: f64 = 1.5;

/// Largest share of a plane in the variance of heights; a periodic wave has 6/pi^2 = 0.61 at most.
const TILTED: f64 = 0.75;

/// Bands are no narrower than this ratio of wavenumbers: an eighth of an octave.
const BAND: f64 = 1.090_507_732_665_257_7;

/// Waves with wavenumbers between two limits, of all directions together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Wavenumbers between which they lie, the edges of rings, in 1/L with `L = sqrt(Lx Ly)`.
    pub limits: [f64; 2],
    /// Variance of their heights, gradients and Laplacians: `2 pi int q^(1 + k) C_2D dq` for k = 0, 2, 4, in
    /// `h^2`, `(h/L)^2` and `(h/L^2)^2` with the rms height h.
    pub variances: [f64; 3],
}

/// Statistics of a map as a sample of a homogeneous surface.
///
/// Where opposite edges of the map match, it is taken as periodic and its gradient is the spectral
/// derivative, that of [`crate::rms_slope`]; elsewhere the spectrum is that under Hann's window
/// ([`windowed`]).
///
/// ```
/// use contact_model::Surface;
/// use surface_gen::{MapStatistics, height_map};
/// // h = 0.1 cos(2 pi x): variance 0.005, that of the gradient (2 pi)^2 times as much.
/// let sine = Surface::Sine { amplitude: 0.1, wavelength: 1.0, size: 1.0.into() };
/// let found = MapStatistics::new(&*height_map(&sine, 16, 0)?)?;
/// assert!((found.rms_slope() - 0.4442882938158366).abs() < 1e-14 && !found.windowed);
/// // All of it runs along x, and a sine has the kurtosis 3/2.
/// assert!(found.isotropy < 1e-7 && (found.kurtosis - 1.5).abs() < 1e-12);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MapStatistics {
    /// `L = sqrt(Lx Ly)`, a length.
    pub length: f64,
    /// Rms height h of the map itself, a length.
    pub rms_height: f64,
    /// Third moment of the heights about their mean over the cube of the rms height; 0 for Gaussian heights.
    pub skewness: f64,
    /// Fourth moment over the fourth power; 3 for Gaussian heights.
    pub kurtosis: f64,
    /// Share of the plane of least squares in the variance of heights.
    pub tilt: f64,
    /// Rms step between opposite edges over the largest one between neighbouring columns or rows inside, the
    /// larger of both directions.
    pub edge_step: f64,
    /// Whether the spectrum is that under Hann's window, because opposite edges differ.
    pub windowed: bool,
    /// Smallest over largest rms slope along a line, over all directions; 1 for an isotropic surface.
    pub isotropy: f64,
    /// Share in the variance of heights of the waves up to 2.5 times the smallest wavenumber.
    pub longest_waves: f64,
    /// The spectrum, bands of rising wavenumbers without gaps between them.
    pub bands: Vec<Band>,
}

impl MapStatistics {
    /// Measures a map.
    ///
    /// # Errors
    /// [`Error::Domain`] for undefined points, heights that are all equal, a tilt (a plane with more than 3/4
    /// of the variance of a map that is not periodic), and numbers beyond the range of f64. Cost O(N log N)
    /// for N cells, memory about that of the map.
    pub fn new(map: &HeightMap) -> Result<Self> {
        let Homogeneous { map: homogeneous, edge_step, tilt } = homogeneous(map)?;
        let (lattice, length) = (Lattice::new(map.cells(), map.size()), map.length());
        let rings = lattice.longest() / length;
        let mut sums: Vec<[f64; 3]> = Vec::new();
        let (mut along_x, mut product) = (0.0, 0.0);
        let unit = waves(&homogeneous, &lattice, |square, power, copies, [xx, xy]| {
            let ring = ((square.sqrt() * rings).round() as usize).max(1);
            if sums.len() < ring {
                sums.resize(ring, [0.0; 3]);
            }
            let weight = copies * power;
            for (sum, factor) in sums[ring - 1].iter_mut().zip([1.0, square, square * square]) {
                *sum += weight * factor;
            }
            along_x += weight * xx;
            product += weight * xy;
        })?;
        let total = |k: usize| sums.iter().map(|s| s[k]).sum::<f64>();
        // Eigenvalues of the tensor of slopes, from its trace.
        let gradient = total(1);
        let spread = (2.0 * along_x - gradient).hypot(2.0 * product);
        let isotropy = ((gradient - spread).max(0.0) / (gradient + spread)).sqrt();
        let longest_waves = sums.iter().take(2).map(|s| s[0]).sum::<f64>() / total(0);
        let rms = rms_height(map.heights());
        let scales = [0, 2, 4].map(|k| (unit / rms).powi(2) * TAU.powi(k));
        let bands = bands(&sums, scales, TAU / rings);
        let moments = HeightMoments::new(map.heights());
        let (skewness, kurtosis) = moments.map_or((0.0, 0.0), |found| (found.skewness, found.kurtosis));
        let windowed = edge_step > MATCHING;
        let found = Self {
            length,
            rms_height: rms,
            skewness,
            kurtosis,
            tilt,
            edge_step,
            windowed,
            isotropy,
            longest_waves,
            bands,
        };
        let gradient = found.rms_slope();
        if !gradient.is_normal() {
            return Err(Error::not_representable("rms slope of the map", gradient));
        }
        Ok(found)
    }

    /// Rms gradient `sqrt(mean |grad h|^2)`, dimensionless.
    pub fn rms_slope(&self) -> f64 {
        self.moment(1).sqrt() * (self.rms_height / self.length)
    }

    /// Moments m0, m2, m4 of a profile of the isotropic surface with this spectrum: variances of height,
    /// slope and curvature along a line, in `h^2`, `(h/L)^2` and `(h/L^2)^2`.
    ///
    /// They are the variances over the plane times 1, 1/2 and 3/8; the last two are the angular means of
    /// cos^2 and cos^4 (Nayak 1971).
    pub fn profile_moments(&self) -> [f64; 3] {
        [self.moment(0), 0.5 * self.moment(1), 0.375 * self.moment(2)]
    }

    fn moment(&self, k: usize) -> f64 {
        self.bands.iter().map(|band| band.variances[k]).sum()
    }
}

/// Rings put together until their limits differ by [`BAND`]; the first ring begins at the `longest` wave's
/// wavenumber.
fn bands(rings: &[[f64; 3]], scales: [f64; 3], longest: f64) -> Vec<Band> {
    let (mut bands, mut low, mut sum) = (Vec::new(), 1.0, [0.0; 3]);
    for (i, ring) in rings.iter().enumerate() {
        let high = i as f64 + 1.5;
        for ((sum, ring), scale) in sum.iter_mut().zip(ring).zip(scales) {
            *sum += ring * scale;
        }
        if high >= low * BAND || i + 1 == rings.len() {
            bands.push(Band { limits: [low * longest, high * longest], variances: sum });
            (low, sum) = (high, [0.0; 3]);
        }
    }
    bands
}

/// Rms heights of a map's waves by their wavenumber in multiples m = 1, 2, ... of `step`: wave q goes to the
/// nearest m, and to 1 where it is longer. For `step = 2 pi / L_1D` their squares are the variances
/// `2 B_1D^2` of the waves of the equivalent line: `C_1D = pi q C_2D` in each of its bands (Eq. 17).
///
/// # Errors
/// As [`MapStatistics::new`].
pub(crate) fn rms_by_wave(map: &HeightMap, step: f64) -> Result<Vec<f64>> {
    let (lattice, length) = (Lattice::new(map.cells(), map.size()), map.length());
    let mut sums: Vec<f64> = Vec::new();
    let unit = waves(&homogeneous(map)?.map, &lattice, |square, power, copies, _| {
        let m = ((square.sqrt() * (TAU / length / step)).round() as usize).max(1);
        if sums.len() < m {
            sums.resize(m, 0.0);
        }
        sums[m - 1] += copies * power;
    })?;
    Ok(sums.into_iter().map(|sum| sum.sqrt() * unit).collect())
}

/// A map as a sample of a homogeneous surface.
pub(crate) struct Homogeneous<'a> {
    /// The map where it is periodic, else under a window.
    pub(crate) map: Cow<'a, HeightMap>,
    edge_step: f64,
    tilt: f64,
}

/// The map as a sample of a homogeneous surface.
///
/// # Errors
/// As [`MapStatistics::new`].
pub(crate) fn homogeneous(map: &HeightMap) -> Result<Homogeneous<'_>> {
    if map.undefined() > 0 {
        let expected = "0: statistics of a surface need every height (`fill` or `crop` the map)";
        return Err(Error::domain("undefined points", map.undefined() as f64, expected));
    }
    let edges = MapEdges::new(map)?;
    let MapEdges { edge_step, tilt } = edges;
    if edges.match_each_other() {
        return Ok(Homogeneous { map: Cow::Borrowed(map), edge_step, tilt });
    }
    if tilt > TILTED {
        let expected = format!("at most {TILTED}: the map is tilted, subtract it (`detrend = \"plane\"`)");
        return Err(Error::domain("share of a plane in the variance of heights", tilt, expected));
    }
    Ok(Homogeneous { map: Cow::Owned(windowed(map)?), edge_step, tilt })
}

/// How the opposite edges of a map fit each other, and how far the map is tilted. Both are measured on the
/// defined points, so that they are known of a map with holes and of a tilted one too.
///
/// ```
/// use contact_model::HeightMap;
/// use surface_gen::MapEdges;
/// // A plane of 8 columns: all of its variance is a tilt, and one edge is 7 steps above the other.
/// let plane = HeightMap::from_fn(8, 1.0, |ix, _| ix as f64)?;
/// let edges = MapEdges::new(&plane)?;
/// assert!((edges.edge_step - 7.0).abs() < 1e-12 && (edges.tilt - 1.0).abs() < 1e-12);
/// assert!(!edges.match_each_other());
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapEdges {
    /// Rms step between opposite edges over the largest one between neighbouring columns or rows inside, the
    /// larger of both directions.
    pub edge_step: f64,
    /// Share of the plane of least squares in the variance of heights.
    pub tilt: f64,
}

impl MapEdges {
    /// Measures a map, which may have undefined points. Cost O(N) for N cells.
    ///
    /// # Errors
    /// [`Error::Domain`] for heights that are all equal and for numbers beyond the range of f64.
    pub fn new(map: &HeightMap) -> Result<Self> {
        let rms = rms_height(map.heights());
        // NaN and infinity are refused, too.
        if !(rms > 0.0 && rms.is_finite()) {
            return Err(Error::domain("rms height of the map", rms, "a rough surface: a finite number > 0"));
        }
        let edge_step = edge_step(map, rms).max(edge_step(&map.transposed(), rms));
        let tilt = if map.undefined() > 0 {
            plane_share(map, rms)
        } else {
            MapPlane::fit(map.cells(), map.heights().iter().map(|h| h / rms)).variance()
        };
        Ok(Self { edge_step, tilt })
    }

    /// Whether the map is a period of a surface as far as its edges show it: they differ by no more than
    /// 1.5 times the largest step inside.
    pub fn match_each_other(&self) -> bool {
        self.edge_step <= MATCHING
    }
}

/// Share of the plane of least squares through the defined points in the variance of their heights. Numbers of
/// columns and rows are made orthogonal to each other on these points, and each has its own part of the share.
fn plane_share(map: &HeightMap, rms: f64) -> f64 {
    let columns = map.columns();
    let points = || {
        let defined = map.heights().iter().enumerate().filter(|(_, h)| h.is_finite());
        defined.map(|(i, h)| [(i % columns) as f64, (i / columns) as f64, h / rms])
    };
    let count = points().count() as f64;
    let means = [0, 1, 2].map(|k: usize| points().map(|point| point[k]).sum::<f64>() / count);
    let product =
        |a: usize, b: usize| points().map(|p| (p[a] - means[a]) * (p[b] - means[b])).sum::<f64>() / count;
    let [xx, xy, yy, xh, yh] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2)].map(|(a, b)| product(a, b));
    let along = |height: f64, square: f64| if square > 0.0 { height * height / square } else { 0.0 };
    let common = if xx > 0.0 { xy / xx } else { 0.0 };
    along(xh, xx) + along(yh - common * xh, (yy - common * xy).max(0.0))
}

/// Rms step from the last column to the first over the largest one from a column to the next; 0 for fewer
/// than 3 columns, which carry no wave. Pairs with an undefined point are left out, and so are columns with
/// fewer than half as many pairs as others have: the mean of a few steps may be large by chance.
fn edge_step(map: &HeightMap, rms: f64) -> f64 {
    let columns = map.columns();
    if columns < 3 {
        return 0.0;
    }
    let mut steps = vec![(0.0, 0_usize); columns];
    for row in map.heights().chunks_exact(columns) {
        for (i, (sum, pairs)) in steps.iter_mut().enumerate() {
            let (next, own) = (row[(i + 1) % columns], row[i]);
            if next.is_finite() && own.is_finite() {
                *sum += ((next - own) / rms).powi(2);
                *pairs += 1;
            }
        }
    }
    let most = steps.iter().map(|&(_, pairs)| pairs).max().unwrap_or(0);
    let known = |&(_, pairs): &(f64, usize)| pairs > 0 && 2 * pairs >= most;
    let mean = |(sum, pairs): (f64, usize)| sum / pairs as f64;
    let across = steps.pop().filter(known).map_or(0.0, mean);
    let inside = steps.into_iter().filter(known).map(mean).fold(0.0, f64::max);
    // Without a step inside there is none across.
    if inside > 0.0 { (across / inside).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests;
