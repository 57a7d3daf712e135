//! Currents of the network that are free of divergence, and the lower bound that follows from them.

use super::bounds::FlowBounds;
use super::gradients::Potential;
use super::network::{CellNetwork, NONE, ROUNDING, SINK, SOURCE};
use super::tree::SpanningForest;
use numerics::sum::{Sum, sum};

/// Rounding that sums to twice the working precision leave in a current, as a share of all currents together.
const CURRENT_ROUNDING: f64 = 1e-29;

/// Currents that are free of divergence.
#[derive(Debug)]
pub(super) struct Currents<'a> {
    network: &'a CellNetwork,
    forest: &'a SpanningForest,
    potential: &'a Potential,
    /// What was added to the current from each node to its parent.
    correction: Vec<(f64, f64)>,
}

impl<'a> Currents<'a> {
    /// Currents at these potentials, made free of divergence along a spanning forest.
    pub fn new(network: &'a CellNetwork, forest: &'a SpanningForest, potential: &'a Potential) -> Self {
        Self { network, forest, potential, correction: forest.correction(network, potential) }
    }

    /// Current from a node to a neighbour over a conductor.
    pub fn between(&self, node: usize, other: usize, weight: f64) -> f64 {
        let current = weight * self.potential.above(node, other);
        if self.forest.parent[node] == other as u32 {
            corrected(current, self.correction[node])
        } else if self.forest.parent[other] == node as u32 {
            -corrected(-current, self.correction[other])
        } else {
            current
        }
    }

    /// Current from a node to an edge.
    pub fn to_edge(&self, node: usize, edge: u32) -> f64 {
        let current = self.network.edge_current(node, edge, self.potential);
        if self.forest.parent[node] == edge { corrected(current, self.correction[node]) } else { current }
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

    /// By how much these currents and their total may differ from currents that are exactly free of divergence:
    /// the rounding of their sums, and that of the currents that the total has.
    pub fn rounding(&self) -> [f64; 2] {
        let nodes = || 0..self.network.graph.nodes();
        let corrections = sum(self.correction.iter().map(|correction| correction.0.abs()));
        let of_total = sum(nodes().map(|node| self.to_edge(node, SOURCE).abs()));
        [CURRENT_ROUNDING * corrections, f64::EPSILON * of_total]
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
        dissipation.conductance(self)
    }
}

/// A current with what is added to it. Where the two nearly cancel each other the result has all digits.
fn corrected(current: f64, (high, low): (f64, f64)) -> f64 {
    let mut sum = Sum::from(current);
    sum.add(high);
    sum.add(low);
    sum.value()
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

    /// The bound of the conductance that follows for these currents.
    pub fn conductance(&self, currents: &Currents<'_>) -> f64 {
        let [of_sums, of_total] = currents.rounding();
        let off = CURRENT_ROUNDING * self.currents + of_sums;
        let power = self.power.value() + off * (2.0 * self.drops + off * self.resistances);
        let total = (currents.total().abs() - off - of_total).max(0.0);
        if power > 0.0 && power.is_finite() { total * (total / power) * (1.0 - ROUNDING) } else { 0.0 }
    }
}

/// Bounds of the conductance of the network.
pub(super) fn bounds(network: &CellNetwork, currents: &Currents<'_>) -> FlowBounds {
    FlowBounds { lower: currents.lower_bound(), upper: network.upper_bound(currents.potential) }
}
