//! Leakage and paths through the gap of a state, and the stress below its surface.
//!
//! The crate `interface` computes these numbers from the fields of a state. They belong to the state because
//! tables and pictures take all numbers from there.

/// Leakage, paths and the largest stress below the surface; each part is `None` where it was not requested.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InterfaceState {
    /// Flow of a fluid between opposite edges.
    pub leakage: Option<LeakageState>,
    /// Paths along x and along y.
    pub percolation: Option<[PathState; 2]>,
    /// The largest stress below the surface.
    pub stress: Option<LargestStress>,
    /// Conduction through the contact and a film in the gap around it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub film: Option<FilmState>,
    /// How far the gap of any cell is at most from that of the exact solution on the same cells; `None` where no
    /// bound is known.
    pub gap_error: Option<f64>,
}

/// Flow of an incompressible fluid through the gap of a state, between opposite edges.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LeakageState {
    /// Flow through the network of the cells, volume per time: the middle of its bounds.
    pub flow: f64,
    /// Half of the distance between these bounds, over the flow; 0 where no path leads through.
    pub error: f64,
    /// Half of the difference between the flows with all gaps larger and all gaps smaller by `gap_error`, over the
    /// flow; `None` where no bound of the gap is known, and without a flow.
    pub contact_error: Option<f64>,
    /// Lower and upper bound of the flow through the continuum with a constant gap in each cell.
    pub continuum: [f64; 2],
    /// The flow over that between smooth surfaces at the mean gap, cells in contact counting as 0; `None` for
    /// an interface without any gap.
    pub flow_factor: Option<f64>,
}

/// Conduction through the contact of a state and a film that fills the gap around it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FilmState {
    /// From one body to the other: the conductance of the sample with free boundaries; with periodic ones that of the
    /// interface alone, per area. The middle of its bounds.
    pub through: f64,
    /// Half of the distance between these bounds, over the conductance.
    pub error: f64,
    /// Conductance of the film alone between opposite edges of the map, and half of the distance between its bounds
    /// over it; `None` where it was not requested.
    pub along: Option<(f64, f64)>,
}

/// Paths from one edge of a map to the opposite one, and the narrowest place of the widest path.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PathState {
    /// Whether cells with a gap lead from edge to edge.
    pub open: bool,
    /// Whether cells in contact lead from edge to edge.
    pub contact: bool,
    /// Gap of the critical constriction, the narrowest cell of the widest path.
    pub constriction: f64,
    /// Centre (x, y) of this cell; `None` where the contact closes every path.
    pub centre: Option<[f64; 2]>,
}

/// The largest equivalent stress of von Mises below the surface, at the centres of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LargestStress {
    /// Its value.
    pub von_mises: f64,
    /// Its depth.
    pub depth: f64,
    /// Centre (x, y) of the cell.
    pub centre: [f64; 2],
    /// Factor on all tractions at which this stress is the yield stress; `None` where no yield stress is
    /// given, and without a load.
    pub factor_until_yield: Option<f64>,
}
