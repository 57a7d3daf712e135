//! The network of the cells, and bounds of its conductance.

use super::gradients::Potential;
use super::graph::{Graph, ROWS, WORK_PER_ROW};
use crate::axis::Layers;
use crate::disjoint_sets::DisjointSets;
use numerics::parallel::map;
use numerics::sum::Sum;

/// Relative slack of a bound for the rounding of its terms, of which each has a few.
pub(super) const ROUNDING: f64 = 1e-13;
/// Rounding of a difference of potentials beyond its own relative one: twice the square of the machine
/// precision.
const POTENTIAL_ROUNDING: f64 = 1e-31;

/// The edge of the high potential, in the place of a node.
pub(super) const SOURCE: u32 = u32::MAX;
/// The edge of the low potential, in the place of a node.
pub(super) const SINK: u32 = u32::MAX - 1;
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

    /// Number of corners of all cells.
    pub fn corners(&self) -> usize {
        (self.layers.count + 1) * self.corners_in_layer()
    }

    fn corners_in_layer(&self) -> usize {
        self.layers.width + usize::from(!self.layers.wraps)
    }

    /// The corner before a layer and a place; corners follow each other as cells do in memory.
    pub fn corner(&self, layer: usize, place: usize) -> usize {
        let width = self.corners_in_layer();
        if self.layers.strides[0] == 1 {
            layer + place % width * (self.layers.count + 1)
        } else {
            layer * width + place % width
        }
    }

    /// All corners, each with the layer and the place that it is before.
    pub fn places_of_corners(&self) -> impl Iterator<Item = (usize, [usize; 2])> {
        let (layers, width) = (self.layers.count + 1, self.corners_in_layer());
        let first_is_layer = self.layers.strides[0] == 1;
        (0..self.corners()).map(move |corner| {
            (
                corner,
                if first_is_layer {
                    [corner % layers, corner / layers]
                } else {
                    [corner / width, corner % width]
                },
            )
        })
    }

    /// Whether the four cells around a corner are nodes; none beyond the map.
    pub fn around_corner(&self, layer: usize, place: usize) -> [Option<bool>; 4] {
        let (layer, place) = (layer.cast_signed(), place.cast_signed());
        [(-1, -1), (-1, 0), (0, -1), (0, 0)]
            .map(|(l, p)| self.layers.beside(layer + l, place + p).map(|cell| self.node_of[cell] != NONE))
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

/// A sum as its value and what the rounding of it leaves.
pub(super) fn rounded(mut sum: Sum) -> (f64, f64) {
    let value = sum.value();
    sum.add(-value);
    (value, sum.value())
}
