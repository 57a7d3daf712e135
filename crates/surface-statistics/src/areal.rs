//! Areal parameters of ISO 25178-2:2021.
//!
//! The parameters are those of the map as it is: the caller does the levelling and the filtering of ISO
//! 25178-3 (S, L, F). Heights z are relative to the mean of the defined points, and each cell has the same
//! weight. Symbols are those of the standard, in lower case; ratios are not in per cent.

mod hills;
mod holes;
mod material_ratio;

pub use material_ratio::FunctionalParameters;

use crate::difference::DifferenceMap;
use crate::relative::{Relative, finite};
use contact_model::{Boundary, Cells, Error, HeightMap, Result};
use numerics::range::range;
use numerics::sum::pairwise;
use std::f64::consts::PI;
use surface_gen::{HeightMoments, defined_everywhere, periodogram, rms_slope_differences};

/// Autocorrelation at which a surface counts as decorrelated (ISO 25178-3:2012, 4.4).
const DECAYED: f64 = 0.2;
/// Limit of the pruning of hills, as a share of Sz (ISO 25178-3).
const PRUNING: f64 = 0.05;
/// Largest share of hills that may be incomplete because of holes.
const CUT: f64 = 0.1;
/// Sectors of directions over half a turn.
const SECTORS: usize = 90;

/// Height parameters (ISO 25178-2, 4.1). Maps may have undefined points.
///
/// ```
/// use contact_model::HeightMap;
/// use surface_statistics::HeightParameters;
/// let map = HeightMap::new(2, 1.0, vec![0.0, 0.0, 0.0, 4.0])?;
/// let found = HeightParameters::new(&map)?;
/// assert!((found.sa - 1.5).abs() < 1e-15 && (found.sq - 3.0_f64.sqrt()).abs() < 1e-15);
/// assert!((found.sp - 3.0).abs() < 1e-15 && (found.sz - 4.0).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightParameters {
    /// Arithmetic mean height `mean |z|`, a length.
    pub sa: f64,
    /// Root mean square height `sqrt(mean z^2)`, a length: [`surface_gen::rms_height`].
    pub sq: f64,
    /// Skewness `mean z^3/Sq^3`.
    pub ssk: f64,
    /// Kurtosis `mean z^4/Sq^4`.
    pub sku: f64,
    /// Maximum peak height `max z`, a length.
    pub sp: f64,
    /// Maximum pit depth `-min z`, a length.
    pub sv: f64,
    /// Maximum height `Sp + Sv`, a length.
    pub sz: f64,
}

impl HeightParameters {
    /// Measures a map. Cost O(N).
    ///
    /// # Errors
    /// [`Error::Domain`] for heights that are all equal (which have no skewness), and numbers beyond the
    /// range of f64.
    pub fn new(map: &HeightMap) -> Result<Self> {
        let Relative { heights, unit } = Relative::new(map);
        let defined: Vec<f64> = heights.into_iter().filter(|h| !h.is_nan()).collect();
        let Some(HeightMoments { mean, rms, skewness, kurtosis }) = HeightMoments::new(&defined) else {
            return Err(Error::domain("rms height of the map", 0.0, "a rough surface: a finite number > 0"));
        };
        let (low, high) = range(&defined);
        Ok(Self {
            sa: pairwise(&defined, |h| (h - mean).abs()) / defined.len() as f64 * unit,
            sq: rms * unit,
            ssk: skewness,
            sku: kurtosis,
            sp: (high - mean) * unit,
            sv: (mean - low) * unit,
            sz: finite("Sz", (high - low) * unit)?,
        })
    }
}

/// Hybrid parameters (ISO 25178-2, 4.3). Maps may have undefined points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HybridParameters {
    /// Root mean square gradient, dimensionless, from differences of neighbours; each direction is averaged
    /// over all of its own pairs: [`surface_gen::rms_slope_differences`].
    pub sdq: f64,
    /// Developed interfacial area ratio, dimensionless: area of the surface over its projection, less 1.
    /// Between the centres of four cells the area is the mean of those of both pairs of triangles (ISO
    /// 25178-2:2021, Eq. D.15); only where all four are defined.
    pub sdr: f64,
}

impl HybridParameters {
    /// Measures a map. Cost O(N).
    ///
    /// # Errors
    /// [`Error::Domain`] where no four neighbouring points are defined, and for numbers beyond the range of
    /// f64.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// // A plane of slope 3/4 along x: 5/4 of its projection.
    /// let map = HeightMap::from_fn(3, 3.0, |ix, _| 0.75 * ix as f64)?;
    /// let found = surface_statistics::HybridParameters::new(&map)?;
    /// assert!((found.sdr - 0.25).abs() < 1e-15 && (found.sdq - 0.75).abs() < 1e-15);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(map: &HeightMap) -> Result<Self> {
        let Cells { columns, rows } = map.cells();
        let heights = map.heights();
        let (mut sum, mut count) = (0.0, 0_usize);
        for iy in 1..rows {
            for ix in 1..columns {
                let i = iy * columns + ix;
                let [a, b, c, d] =
                    [heights[i - columns - 1], heights[i - columns], heights[i - 1], heights[i]];
                let x = [(b - a) / map.dx(), (d - c) / map.dx()];
                let y = [(c - a) / map.dy(), (d - b) / map.dy()];
                // The area of a triangle over its projection less 1, without cancellation for small slopes.
                let excess = |sx: f64, sy: f64| {
                    let square = sx * sx + sy * sy;
                    square / (1.0 + (1.0 + square).sqrt())
                };
                let mean = 0.25
                    * (excess(x[0], y[0]) + excess(x[0], y[1]) + excess(x[1], y[0]) + excess(x[1], y[1]));
                if mean.is_finite() {
                    sum += mean;
                    count += 1;
                }
            }
        }
        if count == 0 {
            let expected = "at least 1: an area needs two columns and two rows of defined points";
            return Err(Error::domain("four defined neighbours", 0.0, expected));
        }
        Ok(Self { sdq: finite("Sdq", rms_slope_differences(map))?, sdr: finite("Sdr", sum / count as f64)? })
    }
}

/// Spatial parameters (ISO 25178-2, 4.2). Maps may have undefined points.
///
/// They are found from the unbiased autocorrelation of the map, taken as not periodic
/// ([`DifferenceMap::autocorrelation`]): from the outline of its central part above s = 0.2, which is
/// interpolated linearly between neighbouring vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpatialParameters {
    /// Autocorrelation length, a length: distance of the fastest decay to s. `None` where the autocorrelation
    /// reaches s in no direction inside the map.
    pub sal: Option<f64>,
    /// Distance of the slowest decay to s, a length. `None` where the autocorrelation does not reach s in all
    /// directions inside the map.
    pub slowest: Option<f64>,
    /// Texture aspect ratio, fastest over slowest decay; 1 for an isotropic surface. `None` where `slowest`
    /// is: the ratio is then at most about Sal over the shorter side.
    pub str: Option<f64>,
}

impl SpatialParameters {
    /// Measures a map. Cost and memory are those of [`DifferenceMap::new`].
    ///
    /// # Errors
    /// [`Error::Domain`] for heights that are all one.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// // Grooves of the period 32: cos(2 pi r/32) = 0.2 at r = 6.97; no decay along them.
    /// let map = HeightMap::from_fn([512, 16], [512.0, 16.0], |ix, _| (ix as f64 * std::f64::consts::PI / 16.0).sin())?;
    /// let found = surface_statistics::SpatialParameters::new(&map)?;
    /// assert!((found.sal.unwrap() - 6.97).abs() < 0.1 && found.str.is_none());
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(map: &HeightMap) -> Result<Self> {
        let correlation = DifferenceMap::new(map, Boundary::Free);
        if correlation.autocorrelation([0, 0]).is_none() {
            return Err(Error::domain("rms height of the map", 0.0, "a rough surface: a finite number > 0"));
        }
        let Cells { columns, rows } = map.cells();
        let [reach_x, reach_y] = [columns, rows].map(|n| n.cast_signed() - 1);
        let width = 2 * columns - 1;
        let mut seen = vec![false; width * (2 * rows - 1)];
        let mut queue = vec![[0_isize, 0]];
        let (mut nearest, mut farthest, mut leaves) = (f64::INFINITY, 0.0_f64, false);
        while let Some([x, y]) = queue.pop() {
            let Some(here) = correlation.autocorrelation([x, y]) else {
                leaves = true;
                continue;
            };
            for [step_x, step_y] in NEIGHBOURS {
                let next = [x + step_x, y + step_y];
                if next[0].abs() > reach_x || next[1].abs() > reach_y {
                    leaves = true;
                    continue;
                }
                let Some(there) = correlation.autocorrelation(next) else {
                    leaves = true;
                    continue;
                };
                if there > DECAYED {
                    let index =
                        (next[1] + reach_y).cast_unsigned() * width + (next[0] + reach_x).cast_unsigned();
                    // The part is joined along the axes.
                    if step_x * step_y == 0 && !seen[index] {
                        seen[index] = true;
                        queue.push(next);
                    }
                } else {
                    let share = (here - DECAYED) / (here - there);
                    let distance = ((x as f64 + share * step_x as f64) * map.dx())
                        .hypot((y as f64 + share * step_y as f64) * map.dy());
                    nearest = nearest.min(distance);
                    farthest = farthest.max(distance);
                }
            }
        }
        let sal = nearest.is_finite().then_some(nearest);
        let slowest = sal.map(|_| farthest).filter(|_| !leaves);
        Ok(Self { sal, slowest, str: slowest.map(|farthest| nearest / farthest) })
    }
}

/// Steps to the neighbours of a point.
const NEIGHBOURS: [[isize; 2]; 8] = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [1, -1], [-1, 1], [-1, -1]];

/// Texture direction Std (ISO 25178-2, 4.4): angle in degrees from x towards y, 0 to 180, of the wave vectors
/// with most of the variance. The lay, along which heights change least, is perpendicular to it.
///
/// It is the middle of the largest of 90 sectors of 2 degrees of the angular power spectrum `int C q dq`
/// under Hann's window. Waves shorter than twice the longer cell side, which not all directions have, and
/// longer than half of the shorter side, which the window spreads over all directions, are left out. The row
/// number rises with y: in a picture with the first row on top, the angle is clockwise. Cost O(N log N).
///
/// # Errors
/// [`Error::Domain`] for undefined points, heights that are all one and maps of fewer than about 8 cells
/// along a side.
///
/// ```
/// use contact_model::HeightMap;
/// // Wave vector (3, 4): atan(4/3) = 53.1 degrees.
/// let wave = |ix: usize, iy: usize| ((0.6 * ix as f64 + 0.8 * iy as f64) * 0.9).sin();
/// let direction = surface_statistics::texture_direction(&HeightMap::from_fn(128, 128.0, wave)?)?;
/// assert!((direction - 53.1).abs() <= 1.0);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn texture_direction(map: &HeightMap) -> Result<f64> {
    defined_everywhere(map, "a texture direction")?;
    let windowed = crate::taper::Taper::Hann.over(map)?;
    let size = map.size();
    let limits = [2.0 / size.shorter(), 0.5 / map.dx().max(map.dy())];
    let mut sectors = vec![0.0; SECTORS];
    periodogram(&windowed, |wave| {
        let [x, y] = [wave.index[0] as f64 / size.x, wave.index[1] as f64 / size.y];
        if (limits[0]..=limits[1]).contains(&x.hypot(y)) {
            let turn = (y.atan2(x) / PI).rem_euclid(1.0);
            let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
            sectors[sector] += wave.copies * wave.variance;
        }
    })?;
    let (sector, largest) = sectors
        .iter()
        .enumerate()
        .fold((0, 0.0), |best, (k, sum)| if *sum > best.1 { (k, *sum) } else { best });
    if largest <= 0.0 {
        let name = "variance of waves with a direction";
        return Err(Error::domain(name, largest, "a number > 0: a rough surface of about 8 cells a side"));
    }
    Ok((sector as f64 + 0.5) * 180.0 / SECTORS as f64)
}

/// Feature parameters of hills (ISO 25178-2, 4.8). Maps may have scattered undefined points.
///
/// A hill is the part of the map from which steepest ascent, among eight neighbours, leads to the same peak.
/// The hill whose peak rises least above its highest saddle is merged with its neighbour there, and so on as
/// long as this height is less than 5 % of Sz (pruning after Wolf). Hills that touch the edge of the map or
/// an undefined point are incomplete and do not count.
///
/// Patches of up to 16 undefined points are first filled with the mean height of their neighbours, because
/// each of them would remove a hill. Larger patches stay undefined. One that touches the edge of the map
/// counts as outside of the map; those inside may make at most a tenth of the hills incomplete.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureParameters {
    /// Number of hills that count.
    pub hills: usize,
    /// Density of peaks: the number of complete hills over the area of the map without the parts outside, in
    /// 1/length^2.
    pub spd: f64,
    /// Arithmetic mean peak curvature, mean of half the Laplacian of -z at the peaks by second differences,
    /// in 1/length, over the peaks whose four neighbours were measured; `None` without one.
    pub spc: Option<f64>,
    /// Number of undefined points that were filled.
    pub filled: usize,
}

impl FeatureParameters {
    /// Measures a map. Cost O(N log N).
    ///
    /// # Errors
    /// [`Error::Domain`] where holes make more than a tenth of the hills incomplete, and for curvatures
    /// beyond the range of f64.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// // Egg box of period 8: the hill in the middle is complete, the eight around it touch the edge.
    /// let wave = |i: usize| (i as f64 * std::f64::consts::PI / 4.0).cos();
    /// let map = HeightMap::from_fn(25, 25.0, |ix, iy| -wave(ix) - wave(iy))?;
    /// let found = surface_statistics::FeatureParameters::new(&map)?;
    /// assert_eq!(found.hills, 1);
    /// // Second differences of a cosine of this period: 2 - 2 cos(pi/4).
    /// assert!((found.spc.unwrap() - 0.585786).abs() < 1e-6);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(map: &HeightMap) -> Result<Self> {
        let Relative { mut heights, unit } = Relative::new(map);
        let cells = map.cells();
        let points = holes::fill_small(&mut heights, cells);
        // Sz is 2 of these units.
        let hills::Hills { peaks, cut } = hills::hills(&heights, &points, cells, 2.0 * PRUNING);
        if cut as f64 > CUT * (peaks.len() + cut) as f64 {
            let expected =
                format!("at most a tenth of all {}: fill undefined points first", peaks.len() + cut);
            return Err(Error::domain("hills that touch undefined points", cut as f64, expected));
        }
        let columns = cells.columns;
        let (mut sum, mut whole) = (0.0, 0_usize);
        for &i in &peaks {
            // A complete hill has all neighbours of its peak. Filled ones are lower or higher than what was
            // there.
            if [i - columns, i - 1, i, i + 1, i + columns]
                .iter()
                .any(|&j| points[j] != holes::HolePoint::Measured)
            {
                continue;
            }
            let x = (2.0 * heights[i] - heights[i - 1] - heights[i + 1]) * (map.dy() / map.dx());
            let y = (2.0 * heights[i] - heights[i - columns] - heights[i + columns]) * (map.dx() / map.dy());
            sum += 0.5 * (x + y);
            whole += 1;
        }
        let spc = if whole == 0 {
            None
        } else {
            Some(finite("Spc", sum / whole as f64 * unit / map.dx() / map.dy())?)
        };
        let count = |of: holes::HolePoint| points.iter().filter(|point| **point == of).count();
        let seen = 1.0 - count(holes::HolePoint::Outside) as f64 / points.len() as f64;
        let spd =
            if peaks.is_empty() { 0.0 } else { peaks.len() as f64 / map.size().x / map.size().y / seen };
        Ok(Self { hills: peaks.len(), spd, spc, filled: count(holes::HolePoint::Filled) })
    }
}
