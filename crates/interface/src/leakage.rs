//! Flow between opposite edges: leakage of a fluid, conduction of a current.
//!
//! How much fluid leaks through an interface, from one edge of the map to the opposite one? In a narrow gap g
//! a fluid of viscosity eta has the flux `q = -g^3/(12 eta) grad p` per unit width (Reynolds). Where the gap
//! is closed nothing flows. The same equation with another conductivity describes a current in a film of the
//! thickness of the gap. [`conductance`] therefore takes any map of conductivities `k >= 0`, and [`leakage`]
//! is [`conductance`] of `g^3`.
//!
//! The **conductance** is the flow per drop of the potential from edge to edge. It has the unit of k: a
//! uniform map of length L along the flow and width W across it has `k W/L`.
//!
//! # Bounds on both sides
//!
//! No result is a single number. Two variational principles give a bound on each side, and each bound is a
//! certificate: it holds whatever the solver did, rounding included. An admissible potential has at least the
//! energy of the true one (Dirichlet). A flux that is free of divergence dissipates at least as much as the
//! true one (Thomson).
//!
//! | bounds | of what | relative width |
//! |---|---|---|
//! | [`SheetFlow::network`] | the network of the cells: harmonic means of k at the faces, half cells at both edges (a finite-volume scheme) | 1e-10, or as requested |
//! | [`SheetFlow::continuum`] | the continuum whose conductivity is constant in each cell | the discretisation error |
//!
//! The currents of the network are made free of divergence along a spanning tree of the best conductors.
//! Potentials have more than double precision. Both matter because the cube of the gap has a contrast of 1e17
//! in a common contact.
//!
//! # How it is solved
//!
//! Only cells that are connected to both edges are unknown. Conjugate gradients solve their network,
//! preconditioned by a hierarchy of aggregates. They start anew from the residual in more than double
//! precision until the bounds are as close as requested.
//!
//! # Accuracy and speed
//!
//! The maps of this table are rough gaps of which 36 % are closed; their conductivities have contrasts from
//! 4e15 to 1e21 (the script is in `tests/data`). Times are those of two cores of an AMD EPYC.
//!
//! | cells | steps | time | with the continuum | width of the continuum |
//! |---|---|---|---|---|
//! | 256 x 256 | 15 | 0.1 s | 0.2 s | 2 % |
//! | 512 x 512 | 17 | 0.5 s | 0.8 s | 0.9 % |
//! | 1024 x 1024 | 18 | 2.0 s | 3.5 s | 0.04 % |
//! | 2048 x 2048 | 20 | 9 s | 16 s | 0.015 % |
//!
//! Gaps that are independent from cell to cell and cover six decades take 108 steps on 1024 cells a side. The
//! last map of the table takes 1.4 GB. The width of the continuum depends on the map: where conductivities
//! jump at corners, as on a checkerboard, the bounds of the continuum converge slowly.
//!
//! # What it does not do
//!
//! The flow is that of Reynolds: viscous, incompressible, and in gaps whose slopes are small. The bound of
//! the continuum from below keeps the currents of the network around closed cells and changes them by
//! circulations elsewhere.

mod aggregation;
mod bounds;
mod continuum;
mod currents;
mod dense;
mod gradients;
mod graph;
mod multigrid;
mod network;
mod stream;
mod tree;
mod vectors;

pub use bounds::FlowBounds;
pub use stream::{StreamFunction, stream_function};

use crate::axis::{FlowAxis, Layers, check_memory};
use contact_model::{Boundary, Error, Field, Result, Stop, check_stop, never};
use currents::{Currents, bounds};
use gradients::Potential;
use multigrid::Hierarchy;
use network::{CellNetwork, NONE};
use numerics::sum::sum;
use tree::SpanningForest;

/// Bytes for each cell at the peak: networks, hierarchy, tree and vectors; more with the continuum. On 2048
/// cells a side, all of them open, 274 and 490 were measured.
const BYTES_PER_CELL: f64 = 300.0;
const BYTES_WITH_CONTINUUM: f64 = 550.0;
/// Conductivities below this share of the largest one count as zero; the upper bounds include what they could
/// carry.
const NEGLIGIBLE: f64 = 1e-200;
/// Ratios of the sides of a cell for which products neither overflow nor underflow.
const SIDE_RATIOS: std::ops::RangeInclusive<f64> = 1e-20..=1e20;
/// Rounds of conjugate gradients at most.
const ROUNDS: usize = 12;
/// Reduction of the squared residual in the first round.
const FIRST_REDUCTION: f64 = 1e-12;
/// A round aims at this share of the requested width.
const AIM: f64 = 0.3;
/// Rounds end where one of them leaves more than this share of the width: rounding is then all that is left.
const PROGRESS: f64 = 0.5;

/// What is computed, and how closely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowOptions {
    /// Relative width of the bounds of the network at which the solver ends. Where rounding does not allow
    /// it, the bounds are wider, and hold.
    pub tolerance: f64,
    /// Whether the continuum is bounded too, which takes about as long again.
    pub continuum: bool,
}

/// A relative width of 1e-10, with the continuum.
impl Default for FlowOptions {
    fn default() -> Self {
        Self { tolerance: 1e-10, continuum: true }
    }
}

/// The flow between opposite edges whose potentials differ by 1, the higher one before the first layer of
/// cells.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetFlow {
    /// Conductance of the network of the cells.
    pub network: FlowBounds,
    /// Conductance of the continuum with constant conductivity in each cell; `None` where it was not
    /// requested.
    pub continuum: Option<FlowBounds>,
    /// Potential at the centre of each cell; 0 where no edge is connected to the cell (see `reached`).
    pub potential: Field,
    /// Whether a cell is connected to an edge. The potential is defined in these cells alone.
    pub reached: Vec<bool>,
    /// Flux in each cell along x and along y, per unit of width: the mean of the currents over opposite
    /// faces. Its unit is that of k over a length.
    pub flux: [Field; 2],
    /// Steps of conjugate gradients, those for the continuum included.
    pub iterations: usize,
}

/// Leakage of an incompressible fluid through a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Leakage {
    /// Bounds of the conductance of `g^3` in the network of the cells, a volume. The flow under a pressure
    /// drop is [`Leakage::flow_rate`].
    pub network: FlowBounds,
    /// The same in the continuum with a constant gap in each cell.
    pub continuum: Option<FlowBounds>,
    /// Mean gap over all cells, where those in contact count as 0.
    pub mean_gap: f64,
    /// The conductance of the network over that of a smooth gap of the mean gap, `mean_gap^3 W/L` (the
    /// pressure flow factor of Patir and Cheng, J. Lubr. Technol. 100, 12 (1978)); `None` for a closed
    /// interface.
    pub flow_factor: Option<FlowBounds>,
    /// Pressure and flux of `g^3` for a pressure drop of 1, with its bounds.
    pub flow: SheetFlow,
}

/// Flow in the units of the caller, in volume per time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowRate {
    /// Flow through the network of the cells.
    pub network: FlowBounds,
    /// Flow through the continuum.
    pub continuum: Option<FlowBounds>,
}

impl Leakage {
    /// The flow under a pressure drop, `conductance drop/(12 viscosity)`: m^3/s for a gap in m, Pa and Pa s.
    ///
    /// # Errors
    /// [`Error::Domain`] for a pressure drop that is negative or a viscosity that is not positive, and where
    /// the flow overflows.
    pub fn flow_rate(&self, pressure_drop: f64, viscosity: f64) -> Result<FlowRate> {
        if !(pressure_drop.is_finite() && pressure_drop >= 0.0) {
            return Err(Error::of_non_negative("pressure drop", pressure_drop));
        }
        if !(viscosity.is_finite() && viscosity > 0.0) {
            return Err(Error::of_positive("viscosity", viscosity));
        }
        let factor = pressure_drop / (12.0 * viscosity);
        let flow = |bounds: FlowBounds| bounds.scaled(factor).finite("flow");
        Ok(FlowRate { network: flow(self.network)?, continuum: self.continuum.map(flow).transpose()? })
    }
}

/// [`leakage_until`] with the usual options, to the end.
///
/// # Errors
/// As [`leakage_until`].
pub fn leakage(gap: &Field, along: FlowAxis, boundary: Boundary) -> Result<Leakage> {
    leakage_until(gap, along, boundary, FlowOptions::default(), &never)
}

/// Leakage of an incompressible fluid through a gap, from edge to edge along an axis.
///
/// Cells whose gap is 0 or negative are in contact and carry nothing. The boundary says whether the map
/// repeats across the axis; its sides are impermeable otherwise. An example is on the [front page](crate).
///
/// # Errors
/// [`Error::Domain`] for a gap that is infinite, as at undefined points, or not a number, and where the
/// conductance overflows or underflows; otherwise as [`conductance_until`].
pub fn leakage_until(
    gap: &Field,
    along: FlowAxis,
    boundary: Boundary,
    options: FlowOptions,
    stop: Stop<'_>,
) -> Result<Leakage> {
    if let Some((cell, &g)) = gap.values().iter().enumerate().find(|(_, g)| !g.is_finite()) {
        let expected = "a finite gap: undefined points are to be filled or cropped";
        return Err(Error::domain(name_of("gap", gap, cell), g, expected));
    }
    check_memory(gap.cells(), bytes_per_cell(options))?;
    let largest = gap.values().iter().fold(0.0_f64, |largest, &g| largest.max(g));
    // In units of the largest gap nothing overflows.
    let unit = if largest > 0.0 { largest } else { 1.0 };
    let mut cubes = gap.clone();
    for g in cubes.values_mut() {
        let share = g.max(0.0) / unit;
        *g = share * share * share;
    }
    let mean_share = sum(gap.values().iter().map(|g| g.max(0.0) / unit)) / gap.values().len() as f64;
    let mut flow = conductance_until(&cubes, along, boundary, options, stop)?;
    drop(cubes);
    let smooth = mean_share.powi(3) * Layers::new(gap, along, boundary).ratio();
    let flow_factor = (largest > 0.0).then(|| flow.network.scaled(1.0 / smooth));
    let volume = unit * unit * unit;
    flow.scale(volume)?;
    let (network, continuum) = (flow.network, flow.continuum);
    Ok(Leakage { network, continuum, mean_gap: mean_share * unit, flow_factor, flow })
}

/// [`conductance_until`] with the usual options, to the end.
///
/// # Errors
/// As [`conductance_until`].
pub fn conductance(conductivity: &Field, along: FlowAxis, boundary: Boundary) -> Result<SheetFlow> {
    conductance_until(conductivity, along, boundary, FlowOptions::default(), &never)
}

/// Conductance between opposite edges of a map of conductivities `k >= 0`, with potential and flux.
///
/// `k` is a conductivity of the sheet: the flux per unit of width is `-k` times the gradient of the
/// potential. For a current in a film of thickness g and resistivity rho it is `g/rho`. Without a path of
/// open cells the conductance is exactly 0. Conductivities below 1e-200 of the largest one count as 0; the
/// upper bounds include what they could carry.
///
/// # Errors
/// [`Error::Domain`] for a conductivity that is negative, infinite or not a number, which is named, for cells
/// whose sides differ by more than a factor of 1e20, for a tolerance that is not positive, and where the
/// conductance overflows or underflows. [`Error::OutOfMemory`] where the map is too large, [`Error::Stopped`]
/// without a state.
///
/// Cost: O(N) for each step of conjugate gradients, of which there are some tens, and O(N log N) for the
/// tree. The memory is [`flow_memory`].
///
/// ```
/// use contact_model::{Boundary, Field};
/// use interface::{FlowAxis, conductance};
/// // Two strips side by side carry their currents side by side: (1 + 3)/2 for a square.
/// let strips = Field::new(2, 1.0, vec![1.0, 1.0, 3.0, 3.0])?;
/// let flow = conductance(&strips, FlowAxis::X, Boundary::Free)?;
/// assert!(flow.network.contains(2.0) && flow.continuum.unwrap().contains(2.0));
/// assert!((flow.potential.at(0, 0) - 0.75).abs() < 1e-9);
/// assert!((flow.flux[0].at(1, 1) - 3.0).abs() < 1e-9);
/// // Across the strips the resistances add: 2/(1 + 1/3).
/// assert!(conductance(&strips, FlowAxis::Y, Boundary::Free)?.network.contains(1.5));
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn conductance_until(
    conductivity: &Field,
    along: FlowAxis,
    boundary: Boundary,
    options: FlowOptions,
    stop: Stop<'_>,
) -> Result<SheetFlow> {
    check(conductivity, options)?;
    check_memory(conductivity.cells(), bytes_per_cell(options))?;
    let layers = Layers::new(conductivity, along, boundary);
    let [side_along, side_across] = layers.sides;
    if !SIDE_RATIOS.contains(&(side_along / side_across)) {
        return Err(Error::domain(
            "ratio of the sides of a cell",
            side_along / side_across,
            "a number from 1e-20 to 1e20",
        ));
    }
    let largest = conductivity.values().iter().fold(0.0_f64, |largest, &k| largest.max(k));
    let unit = if largest > 0.0 { largest } else { 1.0 };
    let mut neglected = 0_usize;
    let scaled = conductivity.values().iter().map(|&k| {
        let share = k / unit;
        neglected += usize::from(k > 0.0 && share < NEGLIGIBLE);
        if share < NEGLIGIBLE { 0.0 } else { share }
    });
    let scaled: Vec<f64> = scaled.collect();
    let mut flow = solve(layers, &scaled, conductivity, options, stop)?;
    // With potentials between 0 and 1 a cell has at most the energy of four differences of 1.
    let ratios = side_along / side_across + side_across / side_along;
    let extra = 4.0 * neglected as f64 * NEGLIGIBLE * ratios;
    if neglected > 0 {
        flow.network.upper += extra;
        flow.continuum = flow.continuum.map(|bounds| FlowBounds { upper: bounds.upper + extra, ..bounds });
    }
    flow.scale(unit)?;
    Ok(flow)
}

/// Bytes that [`leakage_until`] and [`conductance_until`] need at their peak for a map of these cells.
pub fn flow_memory(cells: impl Into<contact_model::Cells>, options: FlowOptions) -> f64 {
    cells.into().map_bytes() / 8.0 * bytes_per_cell(options)
}

fn bytes_per_cell(options: FlowOptions) -> f64 {
    if options.continuum { BYTES_WITH_CONTINUUM } else { BYTES_PER_CELL }
}

/// A cell of a map by its row and column.
fn name_of(name: &str, map: &Field, cell: usize) -> String {
    format!("{name}[{}, {}]", cell / map.columns(), cell % map.columns())
}

fn check(conductivity: &Field, options: FlowOptions) -> Result<()> {
    let wrong = |k: f64| !(k.is_finite() && k >= 0.0);
    if let Some((cell, &k)) = conductivity.values().iter().enumerate().find(|&(_, &k)| wrong(k)) {
        return Err(Error::of_non_negative(name_of("conductivity", conductivity, cell), k));
    }
    let tolerance = options.tolerance;
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(Error::of_positive("tolerance", tolerance));
    }
    Ok(())
}

/// The flow for conductivities between 0 and 1.
fn solve(
    layers: Layers,
    conductivity: &[f64],
    map: &Field,
    options: FlowOptions,
    stop: Stop<'_>,
) -> Result<SheetFlow> {
    let zero = || Field::new(map.cells(), map.size(), vec![0.0; layers.cells()]);
    let connected = network::connections(&layers, conductivity);
    let reached = connected.iter().map(|cell| cell.source || cell.sink).collect();
    let mut potential = zero()?;
    for (potential, cell) in potential.values_mut().iter_mut().zip(&connected) {
        *potential = if cell.source { 1.0 } else { 0.0 };
    }
    let network = CellNetwork::new(layers, conductivity, &connected);
    drop(connected);
    let mut flow = SheetFlow {
        network: FlowBounds::ZERO,
        continuum: options.continuum.then_some(FlowBounds::ZERO),
        potential,
        reached,
        flux: [zero()?, zero()?],
        iterations: 0,
    };
    if network.cells.is_empty() {
        return Ok(flow);
    }
    let forest = SpanningForest::new(&network, stop)?;
    let solved = solve_network(&network, &forest, options, stop)?;
    let currents = Currents::new(&network, &forest, &solved.potential);
    (flow.network, flow.iterations) = (solved.bounds.consistent(), solved.steps);
    flow.take_fields(&currents, &network, &solved.potential);
    if options.continuum {
        // The network underestimates the continuum.
        let below = flow.network.lower;
        let (upper, steps) = continuum::upper_bound(&network, conductivity, &solved.potential, below, stop)?;
        let (lower, more) = continuum::lower_bound(&network, conductivity, &currents, stop)?;
        flow.continuum = Some(FlowBounds { lower, upper }.consistent());
        flow.iterations += steps + more;
    }
    Ok(flow)
}

/// The potentials of a network, with the bounds that follow from them.
struct SolvedNetwork {
    potential: Potential,
    bounds: FlowBounds,
    steps: usize,
}

/// Rounds of conjugate gradients until the bounds are as close as requested, or no longer come closer.
fn solve_network(
    network: &CellNetwork,
    forest: &SpanningForest,
    options: FlowOptions,
    stop: Stop<'_>,
) -> Result<SolvedNetwork> {
    let nodes = network.cells.len();
    let mut hierarchy = Hierarchy::new(network.graph.clone(), stop)?;
    let mut best = SolvedNetwork { potential: Potential::zero(nodes), bounds: FlowBounds::ZERO, steps: 0 };
    let mut potential = Potential::zero(nodes);
    let (mut reduction, mut width) = (FIRST_REDUCTION, f64::INFINITY);
    for _ in 0..ROUNDS {
        let residual = network.residual(&potential);
        let precondition = |residual: &[f64], z: &mut [f64]| hierarchy.apply(residual, z);
        let correction = gradients::solve(&network.graph, precondition, residual, reduction, stop)?;
        best.steps += correction.steps;
        potential.add(&correction.x);
        drop(correction);
        check_stop(stop)?;
        let bounds = bounds(network, &Currents::new(network, forest, &potential));
        // Bounds that contradict each other prove nothing.
        let reached = if bounds.lower <= bounds.upper { bounds.relative_width() } else { f64::MAX };
        if reached < width {
            (best.potential, best.bounds) = (potential.clone(), bounds);
        }
        if reached <= options.tolerance || reached > PROGRESS * width && reached < f64::MAX {
            break;
        }
        width = reached;
        reduction = (AIM * options.tolerance / width).clamp(FIRST_REDUCTION, 1e-2);
    }
    Ok(best)
}

impl SheetFlow {
    /// Takes potential and flux of the cells that are connected to both edges.
    fn take_fields(&mut self, currents: &Currents<'_>, network: &CellNetwork, potential: &Potential) {
        let [side_along, side_across] = network.layers.sides;
        // The total current is not stationary as its bounds are: it takes the value between them.
        let share = self.network.middle() / currents.total();
        let [x, y] = &mut self.flux;
        let (flux_along, flux_across) = if network.layers.axis == FlowAxis::X { (x, y) } else { (y, x) };
        for (node, &cell) in network.cells.iter().enumerate() {
            let cell = cell as usize;
            debug_assert!(network.node_of[cell] != NONE);
            let [before, behind, up, down] = currents.over_faces(node);
            // Where nearly nothing conducts, a potential may be rounded out of its range.
            self.potential.values_mut()[cell] = potential.high[node].clamp(0.0, 1.0);
            flux_along.values_mut()[cell] = 0.5 * share * (down - up) / side_across;
            flux_across.values_mut()[cell] = 0.5 * share * (behind - before) / side_along;
        }
    }

    /// Brings everything into the units of the caller.
    fn scale(&mut self, unit: f64) -> Result<()> {
        self.network = self.network.scaled(unit).finite("conductance")?;
        let continuum = self.continuum.map(|bounds| bounds.scaled(unit).finite("conductance"));
        self.continuum = continuum.transpose()?;
        for flux in &mut self.flux {
            for q in flux.values_mut() {
                *q *= unit;
            }
            if let Some(q) = flux.values().iter().find(|q| !q.is_finite()) {
                return Err(Error::not_representable("flux", *q));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
