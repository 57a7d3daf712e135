//! What an interface lets through and what its bodies bear, computed from the fields of a contact state.
//!
//! Two bodies are in contact, and a solver has found the gap between them. Is the interface tight? If it is
//! not, how much leaks through it, and which constriction decides? And where below the surface does the
//! material yield first? These functions answer from the [`contact_model::Field`] of the gap, or of the
//! pressure, alone. They contain no contact solver, so that a field from a file serves as well.
//!
//! | module | contents |
//! |---|---|
//! | [`percolation`](mod@percolation) | whether the open cells, or the cells in contact, lead from edge to edge, and the critical constriction |
//! | [`leakage`](mod@leakage) | flow of a fluid or of a current between opposite edges, with bounds on both sides |
//! | [`stress`] | the stress below the surface, and where it is largest |
//! | [`open_gap`], [`gap_error`] | the gap of a state with 0 in contact, and its error by the solver |
//! | [`bracketed_force`] | the force at which the interface closes, or a body yields |
//!
//! ```
//! use contact_model::{Boundary, Field};
//! use interface::{FlowAxis, leakage, percolation};
//! // Three cells one behind the other; the middle one has half of the gap.
//! let gap = Field::new([3, 1], [3.0, 1.0], vec![2e-6, 1e-6, 2e-6])?;
//! let found = percolation(&gap, 0.0, FlowAxis::X, Boundary::Free)?;
//! assert!(found.spans && found.constriction.column == 1 && found.constriction.gap == 1e-6);
//! // In series, a cell of side 1 resists the flow by 1/g^3.
//! let leak = leakage(&gap, FlowAxis::X, Boundary::Free)?;
//! let exact = 1.0 / (2.0 / 8e-18 + 1.0 / 1e-18);
//! assert!(leak.network.lower <= exact && exact <= leak.network.upper);
//! assert!(leak.network.relative_width() < 1e-10);
//! // Water under a pressure drop of 1 bar, in m^3/s.
//! let flow = leak.flow_rate(1e5, 1e-3)?.network;
//! assert!((flow.middle() - exact * 1e5 / 12e-3).abs() < 1e-9 * flow.middle());
//! # Ok::<(), contact_model::Error>(())
//! ```
//!
//! # Conventions
//!
//! * A map has its columns along x and its rows along y, and its cells may be oblong.
//! * Flow and paths lead between **opposite edges** along a [`FlowAxis`]. They do so even where the map
//!   repeats along this axis: the two edges are then those of the map. Across the axis cells are neighbours
//!   round the edge where the map repeats ([`contact_model::Boundary::repeats`]). Elsewhere the sides are
//!   impermeable.
//! * Lengths, pressures and viscosities need to fit together; no unit is assumed.

mod axis;
mod disjoint_sets;
mod gap;
pub mod leakage;
pub mod percolation;
pub mod stress;
mod thresholds;

pub use axis::FlowAxis;
pub use gap::{gap_error, open_gap};
pub use leakage::{
    FlowBounds, FlowOptions, FlowRate, Leakage, SheetFlow, StreamFunction, conductance, conductance_until,
    flow_memory, leakage, leakage_until, stream_function,
};
pub use percolation::{Constriction, Percolation, percolation};
pub use thresholds::{bracketed, bracketed_force};
