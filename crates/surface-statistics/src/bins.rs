//! Intervals over which wavenumbers or distances are averaged.

use contact_model::{Error, HeightMap, Result};
use std::f64::consts::{PI, TAU};

/// Most edges of logarithmic bins.
const MOST: f64 = 1e5;

/// Adjacent intervals: bin k holds `edges[k] < x <= edges[k + 1]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Bins {
    edges: Vec<f64>,
}

impl Bins {
    /// Bins between these edges.
    ///
    /// # Errors
    /// [`Error::Shape`] for fewer than two edges, [`Error::Domain`] for edges that are not finite or do not
    /// rise.
    ///
    /// ```
    /// use surface_statistics::Bins;
    /// assert_eq!(Bins::new(vec![0.0, 1.0, 3.0])?.index(1.0), Some(0));
    /// assert!(Bins::new(vec![0.0, 2.0, 1.0]).is_err());
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(edges: Vec<f64>) -> Result<Self> {
        if edges.len() < 2 {
            return Err(Error::Shape {
                name: "edges of bins".into(),
                found: edges.len(),
                expected: "at least 2".into(),
            });
        }
        for (k, edge) in edges.iter().enumerate() {
            if !edge.is_finite() || (k > 0 && *edge <= edges[k - 1]) {
                return Err(Error::domain(
                    format!("edges[{k}]"),
                    *edge,
                    "a finite number above the one before",
                ));
            }
        }
        Ok(Self { edges })
    }

    /// Bins of equal ratio from `from` to `to`, about `per_decade` in a decade.
    ///
    /// # Errors
    /// [`Error::Domain`] unless `0 < from < to` and there are 1 to 1e5 bins.
    ///
    /// ```
    /// let bins = surface_statistics::Bins::logarithmic(1.0, 100.0, 5.0)?;
    /// assert_eq!(bins.edges().len(), 11);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn logarithmic(from: f64, to: f64, per_decade: f64) -> Result<Self> {
        if !(from > 0.0 && from.is_finite()) {
            return Err(Error::domain("first edge of bins", from, "a finite number > 0"));
        }
        if !(to > from && to.is_finite()) {
            return Err(Error::domain("last edge of bins", to, format!("a finite number > {from:e}")));
        }
        let decades = (to / from).log10();
        let count = (decades * per_decade).round().max(1.0);
        if !(per_decade > 0.0 && count <= MOST) {
            return Err(Error::domain(
                "bins per decade",
                per_decade,
                "a number > 0 that makes at most 1e5 bins",
            ));
        }
        let mut edges: Vec<f64> = (0..=count as usize)
            .map(|k| from * (decades * k as f64 / count * std::f64::consts::LN_10).exp())
            .collect();
        if let Some(last) = edges.last_mut() {
            *last = to;
        }
        Self::new(edges)
    }

    /// Bins of the wavenumbers of a map: from half of the longest wave's to `pi / max(dx, dy)`, about
    /// `per_decade` in a decade.
    ///
    /// # Errors
    /// As [`Bins::logarithmic`].
    pub fn of_wavenumbers(map: &HeightMap, per_decade: f64) -> Result<Self> {
        let longest = TAU / map.size().x.max(map.size().y);
        // The waves of the last shell stay inside their edge.
        Self::logarithmic(0.5 * longest, PI / map.dx().max(map.dy()) * (1.0 + 1e-12), per_decade)
    }

    /// Bins of the distances of a map: from half of the shorter cell side to half of the shorter side of the
    /// map, about `per_decade` in a decade.
    ///
    /// # Errors
    /// As [`Bins::logarithmic`].
    pub fn of_distances(map: &HeightMap, per_decade: f64) -> Result<Self> {
        Self::logarithmic(0.5 * map.dx().min(map.dy()), 0.5 * map.size().shorter(), per_decade)
    }

    /// The edges, rising.
    pub fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// The bin that holds x, unless it lies outside all.
    pub fn index(&self, x: f64) -> Option<usize> {
        let above = self.edges.partition_point(|edge| *edge < x);
        (above > 0 && above < self.edges.len()).then(|| above - 1)
    }
}
