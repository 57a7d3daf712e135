//! The network of the cells, and bounds of its conductance.

use super::bounds::FlowBounds;
use super::gradients::Potential;
use super::graph::{Graph, ROWS, WORK_PER_ROW};
use super::tree::{SINK, SOURCE, SpanningForest, rounded};
use crate::axis::Layers;
use crate::disjoint_sets::DisjointSets;
use numerics::parallel::map;
use numerics::sum::{Sum, sum};

/// Relative slack of a bound for the rounding of its terms, of which each has a few.
pub(super) const ROUNDING: f64 = 1e-13;
/// Rounding of a difference of potentials beyond its own relative one: twice the square of the machine
/// precision.
const POTENTIAL_ROUNDING: f64 = 1e-31;
/// Rounding that sums to twice the working precision leave in a current, as a share of all currents together.
const CURRENT_ROUNDING: f64 = 1e-29;

/// No unknown.
pub(super) const NONE: u32 = u32::MAX;

/// The cells that are connected to both edges, as a network.
///
/// Its nodes are the centres of these cells. Between two centres there is half of each cell, so that the
/// conductance over a face follows from the harmonic mean of both conductivities. Between a centre and an
/// edge there is half a cell. Cells that are connected to one edge only have its potential and carry no flow.
#[derive(Debug)]
pub(super) struct CellNetwork {
    pub layers: Layers,
    /// The node of each cell, or [`NONE`].
    pub node_of: Vec<u32>,
    /// The cell of each node.
    pub cells: Vec<u32>,
    pub graph: std::sync::Arc<Graph>,
    /// Conductance from each node to the edge of potential 1 and to that of potential 0.
    pub edges: [Vec<f64>; 2],
}

/// What a cell is connected to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Connected {
    /// To the edge of potential 1, before the first layer.
    pub source: bool,
    /// To the edge of potential 0, behind the last one.
    pub sink: bool,
}

/// Edges to which each open cell is connected. Cost: O(N).
pub(super) fn connections(layers: &Layers, conductivity: &[f64]) -> Vec<Connected> {
    let mut sets = DisjointSets::new(layers.cells());
    let is_open = |cell: usize| conductivity[cell] > 0.0;
    for cell in (0..layers.cells()).filter(|&cell| is_open(cell)) {
        for neighbour in layers.neighbours(cell).into_iter().flatten() {
            if neighbour < cell && is_open(neighbour) {
                sets.join(cell, neighbour);
            }
        }
    }
    let mut connected = vec![Connected { source: false, sink: false }; layers.cells()];
    for place in 0..layers.width {
        let (first, last) = (layers.cell(0, place), layers.cell(layers.count - 1, place));
        if is_open(first) {
            connected[sets.root(first)].source = true;
        }
        if is_open(last) {
            connected[sets.root(last)].sink = true;
        }
    }
    // A root is the first member of its set, so that it is passed before the others.
    for cell in (0..layers.cells()).filter(|&cell| is_open(cell)) {
        connected[cell] = connected[sets.root(cell)];
    }
    connected
}

impl CellNetwork {
    /// The network of conductivities between 0 and 1. Cost: O(N).
    pub fn new(layers: Layers, conductivity: &[f64], connected: &[Connected]) -> Self {
        let mut cells = Vec::new();
        let mut node_of = vec![NONE; layers.cells()];
        for (cell, connected) in connected.iter().enumerate() {
            if connected.source && connected.sink {
                node_of[cell] = cells.len() as u32;
                cells.push(cell as u32);
            }
        }
        let [side_along, side_across] = layers.sides;
        let (along, across) = (side_across / side_along, side_along / side_across);
        let mut edges = [vec![0.0; cells.len()], vec![0.0; cells.len()]];
        let mut graph = Graph::default();
        graph.offsets.reserve_exact(cells.len() + 1);
        graph.offsets.push(0);
        for (node, &cell) in cells.iter().enumerate() {
            let cell = cell as usize;
            let begin = graph.neighbours.len();
            for (face, neighbour) in layers.neighbours(cell).into_iter().enumerate() {
                let Some(neighbour) = neighbour.filter(|&n| n != cell && node_of[n] != NONE) else {
                    continue;
                };
                let aspect = if face < 2 { across } else { along };
                let weight = aspect * 2.0 / (1.0 / conductivity[cell] + 1.0 / conductivity[neighbour]);
                // In a ring of two cells both faces lead to the same cell.
                let known = graph.neighbours[begin..].iter().position(|&n| n == node_of[neighbour]);
                if let Some(known) = known {
                    graph.weights[begin + known] += weight;
                } else {
                    graph.neighbours.push(node_of[neighbour]);
                    graph.weights.push(weight);
                }
            }
            graph.offsets.push(graph.neighbours.len() as u32);
            let [layer, _] = layers.place(cell);
            let half_cell = 2.0 * along * conductivity[cell];
            if layer == 0 {
                edges[0][node] = half_cell;
            }
            if layer + 1 == layers.count {
                edges[1][node] = half_cell;
            }
        }
        graph.ground = edges[0].iter().zip(&edges[1]).map(|(source, sink)| source + sink).collect();
        Self { layers, node_of, cells, graph: std::sync::Arc::new(graph), edges }
    }

    /// Conductance from a node to an edge.
    pub fn to_edge(&self, node: usize, edge: u32) -> f64 {
        self.edges[usize::from(edge == SINK)][node]
    }

    /// Current from a node to an edge.
    pub fn edge_current(&self, node: usize, edge: u32, potential: &Potential) -> f64 {
        let known = if edge == SOURCE { 1.0 } else { 0.0 };
        let weight = self.to_edge(node, edge);
        if weight > 0.0 { weight * potential.above_known(node, known) } else { 0.0 }
    }

    /// Currents that flow into the nodes and not out again at these potentials, as sums of two numbers.
    pub fn surplus(&self, potential: &Potential) -> Vec<(f64, f64)> {
        let tasks = (0..self.graph.nodes()).step_by(ROWS);
        let parts = map(WORK_PER_ROW * self.graph.nodes(), tasks, |begin| {
            let end = (begin + ROWS).min(self.graph.nodes());
            let surplus = |node: usize| {
                let mut total = Sum::default();
                for (other, weight) in self.graph.conductors(node) {
                    total.add(-weight * potential.above(node, other));
                }
                for edge in [SOURCE, SINK] {
                    total.add(-self.edge_current(node, edge, potential));
                }
                rounded(total)
            };
            (begin..end).map(surplus).collect::<Vec<_>>()
        });
        parts.concat()
    }

    /// The same, rounded.
    pub fn residual(&self, potential: &Potential) -> Vec<f64> {
        self.surplus(potential).into_iter().map(|(high, _)| high).collect()
    }

    /// The energy of these potentials, which no conductance exceeds (Dirichlet's principle), with its
    /// rounding.
    pub fn upper_bound(&self, potential: &Potential) -> f64 {
        let mut energy = PotentialEnergy::default();
        let mut take = |weight: f64, drop: f64| energy.add(weight * drop * drop, weight);
        for node in 0..self.graph.nodes() {
            for (other, weight) in self.graph.conductors(node).filter(|&(other, _)| other > node) {
                take(weight, potential.above(node, other));
            }
            take(self.to_edge(node, SOURCE), potential.above_known(node, 1.0));
            take(self.to_edge(node, SINK), potential.above_known(node, 0.0));
        }
        energy.bound()
    }

    /// Currents at these potentials, made free of divergence along a spanning forest.
    pub fn currents<'a>(&'a self, forest: &'a SpanningForest, potential: &'a Potential) -> Currents<'a> {
        Currents { network: self, forest, potential, correction: forest.correction(self, potential) }
    }
}

/// Currents that are free of divergence.
#[derive(Debug)]
pub(super) struct Currents<'a> {
    network: &'a CellNetwork,
    forest: &'a SpanningForest,
    potential: &'a Potential,
    /// What was added to the current from each node to its parent.
    correction: Vec<f64>,
}

impl Currents<'_> {
    /// Current from a node to a neighbour over a conductor.
    pub fn between(&self, node: usize, other: usize, weight: f64) -> f64 {
        let current = weight * self.potential.above(node, other);
        if self.forest.parent[node] == other as u32 {
            current + self.correction[node]
        } else if self.forest.parent[other] == node as u32 {
            current - self.correction[other]
        } else {
            current
        }
    }

    /// Current from a node to an edge.
    pub fn to_edge(&self, node: usize, edge: u32) -> f64 {
        let current = self.network.edge_current(node, edge, self.potential);
        if self.forest.parent[node] == edge { current + self.correction[node] } else { current }
    }

    /// Currents out of a cell over its four faces, in the order of [`Layers::neighbours`].
    pub fn over_faces(&self, node: usize) -> [f64; 4] {
        let network = self.network;
        let cell = network.cells[node] as usize;
        let neighbours = network.layers.neighbours(cell);
        let [layer, _] = network.layers.place(cell);
        std::array::from_fn(|face| {
            if face == 2 && layer == 0 {
                return self.to_edge(node, SOURCE);
            }
            if face == 3 && layer + 1 == network.layers.count {
                return self.to_edge(node, SINK);
            }
            let Some(other) = neighbours[face].map(|n| network.node_of[n]).filter(|&n| n != NONE) else {
                return 0.0;
            };
            let conductor = network.graph.conductors(node).find(|&(to, _)| to == other as usize);
            let current = conductor.map_or(0.0, |(other, weight)| self.between(node, other, weight));
            // The two faces in a ring of two cells share their current.
            if face < 2 && neighbours[0] == neighbours[1] { 0.5 * current } else { current }
        })
    }

    /// The current from edge to edge.
    pub fn total(&self) -> f64 {
        sum((0..self.network.graph.nodes()).map(|node| -self.to_edge(node, SOURCE)))
    }

    /// What Thomson's principle makes of these currents: with the total current I and the dissipation W no
    /// conductance is below `I^2/W`, less its rounding.
    pub fn lower_bound(&self) -> f64 {
        let mut dissipation = Dissipation::default();
        for node in 0..self.network.graph.nodes() {
            for (other, weight) in self.network.graph.conductors(node).filter(|&(other, _)| other > node) {
                dissipation.take(self.between(node, other, weight), 1.0 / weight);
            }
            for edge in [SOURCE, SINK] {
                let weight = self.network.to_edge(node, edge);
                if weight > 0.0 {
                    dissipation.take(self.to_edge(node, edge), 1.0 / weight);
                }
            }
        }
        dissipation.conductance(self.total())
    }
}

/// The energy of a potential, with what bounds its rounding.
#[derive(Debug, Default)]
pub(super) struct PotentialEnergy {
    energy: Sum,
    weights: f64,
}

impl PotentialEnergy {
    /// Adds the energy of a difference of potentials over a conductance.
    pub fn add(&mut self, energy: f64, weight: f64) {
        self.energy.add(energy);
        self.weights += weight;
    }

    /// The energy, with the largest rounding that it may have. The rounding of the potentials has an energy
    /// of its own, and its product with the potentials is bounded after Cauchy and Schwarz.
    pub fn bound(&self) -> f64 {
        let (energy, rounding) =
            (self.energy.value(), self.weights * POTENTIAL_ROUNDING * POTENTIAL_ROUNDING);
        (energy + 2.0 * energy.sqrt() * rounding.sqrt() + rounding) * (1.0 + ROUNDING)
    }
}

/// The dissipation of currents, with what bounds its rounding.
#[derive(Debug, Default)]
pub(super) struct Dissipation {
    power: Sum,
    /// Sums of the currents, of the resistances, and of their products.
    currents: f64,
    resistances: f64,
    drops: f64,
}

impl Dissipation {
    /// Adds a current through a resistance.
    pub fn take(&mut self, current: f64, resistance: f64) {
        self.add(current * (current * resistance), current.abs(), resistance);
    }

    /// Adds a power of about `current^2 resistance`.
    pub fn add(&mut self, power: f64, current: f64, resistance: f64) {
        self.power.add(power);
        self.currents += current;
        self.resistances += resistance;
        self.drops += current * resistance;
    }

    /// The bound of the conductance that follows for this total current.
    pub fn conductance(&self, total: f64) -> f64 {
        let off = CURRENT_ROUNDING * self.currents;
        let power = self.power.value() + off * (2.0 * self.drops + off * self.resistances);
        let total = (total.abs() - off).max(0.0);
        if power > 0.0 && power.is_finite() { total * (total / power) * (1.0 - ROUNDING) } else { 0.0 }
    }
}

/// Bounds of the conductance of the network.
pub(super) fn bounds(network: &CellNetwork, currents: &Currents<'_>) -> FlowBounds {
    FlowBounds { lower: currents.lower_bound(), upper: network.upper_bound(currents.potential) }
}
