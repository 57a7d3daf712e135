//! Bounds for the continuum whose conductivity is constant in each cell.
//!
//! The network replaces the continuum by conductors between centres. Its conductance differs from that of the
//! continuum by the discretisation error, which two further bounds enclose.
//!
//! From above: a continuous potential that has the known values at both edges has at least the energy of the
//! true one. Here it is bilinear in each cell, with values at the corners of cells. Those of the smallest
//! energy are found by conjugate gradients. The energy of a cell is that of its differences `d_1` and `d_2`
//! along two opposite sides, `k (d_1^2 + d_1 d_2 + d_2^2)/3` times the ratio of sides, for both directions.
//! If it is replaced by `k (d_1^2 + d_2^2)/2`, which is between 1 and 3 times as large, the corners become a
//! network with five-point stencils. Its hierarchy is the preconditioner, for any contrast and any ratio of
//! sides.
//!
//! From below: a flux that is free of divergence dissipates at least as much as the true one. The currents of
//! the network over the faces of a cell are continued into it linearly (the element of Raviart and Thomas of
//! lowest order). A cell with the currents a and b over opposite faces dissipates `(a^2 + a b + b^2)/(3 k)`
//! times the ratio of sides. In the network it dissipates `(a^2 + b^2)/(2 k)`, which is not less. The network
//! therefore underestimates the conductance of the continuum, and this bound is the better one of the two.

use super::currents::{Currents, Dissipation};
use super::gradients::{Potential, solve};
use super::graph::Graph;
use super::multigrid::Hierarchy;
use super::network::{CellNetwork, NONE, PotentialEnergy, SINK, SOURCE};
use contact_model::{Result, Stop, check_stop};
use std::sync::Arc;

/// Reduction of the squared residual in one round.
const REDUCTION: f64 = 1e-4;
/// Rounds end when one of them lowers the bound by less than this share of the distance of both bounds: it is
/// then as good as the space of bilinear potentials.
const SHARE: f64 = 1e-3;
/// Rounds end, too, when one of them lowers the bound by less than this share of it.
const LEAST_GAIN: f64 = 1e-10;
/// Rounds at most: every potential is admissible, so that the bound holds wherever they end.
const ROUNDS: usize = 8;

/// Corners of a cell: two before it along the axis, then two behind it.
type CellCorners = [u32; 4];

/// The cells of a network with the unknown potentials at their corners.
#[derive(Debug)]
struct BilinearCells<'a> {
    network: &'a CellNetwork,
    conductivity: &'a [f64],
    /// Unknowns at the corners of each node's cell; [`SOURCE`] or [`SINK`] where the potential is known.
    corners: Vec<CellCorners>,
    unknowns: usize,
}

/// Conductances between corners of a cell of conductivity 1.
#[derive(Debug, Clone, Copy)]
struct CornerWeights {
    along: f64,
    across: f64,
    diagonal: f64,
}

/// The bound from below. Cost: O(N).
pub(super) fn lower_bound(network: &CellNetwork, conductivity: &[f64], currents: &Currents<'_>) -> f64 {
    let [side_along, side_across] = network.layers.sides;
    let mut dissipation = Dissipation::default();
    for (node, &cell) in network.cells.iter().enumerate() {
        let [before, behind, up, down] = currents.over_faces(node);
        let resistivity = 1.0 / conductivity[cell as usize];
        for ([a, b], ratio) in
            [([-before, behind], side_across / side_along), ([-up, down], side_along / side_across)]
        {
            let resistance = ratio * resistivity;
            dissipation.add(resistance / 3.0 * (a * a + a * b + b * b), a.abs() + b.abs(), resistance);
        }
    }
    dissipation.conductance(currents)
}

/// The bound from above, and the steps of conjugate gradients that it took; `lower` is the bound from below
/// and `centres` the potentials of the network.
///
/// # Errors
/// [`contact_model::Error::Stopped`].
pub(super) fn upper_bound(
    network: &CellNetwork,
    conductivity: &[f64],
    centres: &Potential,
    lower: f64,
    stop: Stop<'_>,
) -> Result<(f64, usize)> {
    let cells = BilinearCells::new(network, conductivity);
    let mut potential = cells.mean_of_centres(centres);
    let mut upper = cells.energy(&potential);
    check_stop(stop)?;
    if cells.unknowns == 0 {
        return Ok((upper, 0));
    }
    let mut hierarchy = Hierarchy::new(Arc::new(cells.graph(cells.lumped())), stop)?;
    let (graph, mut steps) = (cells.graph(cells.exact()), 0);
    for _ in 0..ROUNDS {
        let residual = cells.residual(&potential);
        let correction = solve(&graph, &mut hierarchy, residual, REDUCTION, stop)?;
        steps += correction.steps;
        let mut next = potential.clone();
        next.add(&correction.x);
        let energy = cells.energy(&next);
        let gain = upper - energy;
        if energy < upper {
            (upper, potential) = (energy, next);
        }
        if gain.is_nan() || gain <= (SHARE * (upper - lower)).max(LEAST_GAIN * upper) {
            break;
        }
    }
    Ok((upper, steps))
}

impl<'a> BilinearCells<'a> {
    /// Cost: O(N).
    fn new(network: &'a CellNetwork, conductivity: &'a [f64]) -> Self {
        let layers = &network.layers;
        let width = if layers.wraps { layers.width } else { layers.width + 1 };
        let strides = if layers.strides[0] == 1 { [1, layers.count + 1] } else { [width, 1] };
        let is_node = |layer: isize, place: isize| {
            layers.beside(layer, place).is_some_and(|cell| network.node_of[cell] != NONE)
        };
        let mut first = vec![NONE; (layers.count + 1) * width];
        // Corners at which two cells touch that share no other cell there. A point carries no flow, so that
        // each of them has a potential of its own.
        let mut is_split = vec![false; first.len()];
        let mut unknowns = 0;
        for corner in 0..first.len() {
            let (layer, place) = if strides[0] == 1 {
                (corner % (layers.count + 1), corner / (layers.count + 1))
            } else {
                (corner / width, corner % width)
            };
            if layer == 0 || layer == layers.count {
                first[corner] = if layer == 0 { SOURCE } else { SINK };
                continue;
            }
            let (layer, place) = (layer.cast_signed(), place.cast_signed());
            let around = [(-1, -1), (-1, 0), (0, -1), (0, 0)].map(|(l, p)| is_node(layer + l, place + p));
            if around.contains(&true) {
                first[corner] = unknowns;
                unknowns += 1;
            }
            if around == [true, false, false, true] || around == [false, true, true, false] {
                is_split[corner] = true;
                unknowns += 1;
            }
        }
        let corners = network.cells.iter().map(|&cell| {
            let [layer, place] = layers.place(cell as usize);
            [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(l, p)| {
                let corner = (layer + l) * strides[0] + (place + p) % width * strides[1];
                first[corner] + u32::from(is_split[corner] && l == 0)
            })
        });
        let corners = corners.collect();
        Self { network, conductivity, corners, unknowns: unknowns as usize }
    }

    /// Ratios of sides by which differences along the axis and across it count.
    fn ratios(&self) -> [f64; 2] {
        let [along, across] = self.network.layers.sides;
        [across / along, along / across]
    }

    /// Conductances with the energy of bilinear potentials. Those between corners of a long side may be
    /// negative.
    fn exact(&self) -> CornerWeights {
        let [along, across] = self.ratios();
        CornerWeights {
            along: (2.0 * along - across) / 6.0,
            across: (2.0 * across - along) / 6.0,
            diagonal: (along + across) / 6.0,
        }
    }

    /// Conductances of which each is on one side of the cell.
    fn lumped(&self) -> CornerWeights {
        let [along, across] = self.ratios();
        CornerWeights { along: 0.5 * along, across: 0.5 * across, diagonal: 0.0 }
    }

    /// Conductivity of a node's cell.
    fn conductivity_of(&self, node: usize) -> f64 {
        self.conductivity[self.network.cells[node] as usize]
    }

    /// The cells around each unknown, as `4 node + corner`: where they begin, and one after the other.
    fn cells_around(&self) -> (Vec<u32>, Vec<u32>) {
        let mut begin = vec![0_u32; self.unknowns + 1];
        let inner = |unknown: u32| (unknown as usize) < self.unknowns;
        for &unknown in self.corners.as_flattened().iter().filter(|&&unknown| inner(unknown)) {
            begin[unknown as usize + 1] += 1;
        }
        for unknown in 0..self.unknowns {
            begin[unknown + 1] += begin[unknown];
        }
        let mut next = begin.clone();
        let mut around = vec![0; begin[self.unknowns] as usize];
        for (at, &unknown) in self.corners.as_flattened().iter().enumerate() {
            if inner(unknown) {
                around[next[unknown as usize] as usize] = at as u32;
                next[unknown as usize] += 1;
            }
        }
        (begin, around)
    }

    /// The network of the unknowns with these conductances in each cell. Cost: O(N).
    fn graph(&self, weights: CornerWeights) -> Graph {
        let (begin, around) = self.cells_around();
        let mut graph = Graph { offsets: vec![0], ..Graph::default() };
        for unknown in 0..self.unknowns {
            let row = graph.neighbours.len();
            let mut ground = 0.0;
            for &at in &around[begin[unknown] as usize..begin[unknown + 1] as usize] {
                let (node, own) = (at as usize / 4, at as usize % 4);
                for other in (0..4).filter(|&other| other != own) {
                    // Corners differ in their place, in their layer, or in both.
                    let weight = [0.0, weights.across, weights.along, weights.diagonal][own ^ other];
                    let weight = weight * self.conductivity_of(node);
                    let to = self.corners[node][other];
                    if to as usize >= self.unknowns {
                        ground += weight;
                    } else if to as usize != unknown && weight.abs() > 0.0 {
                        let known = graph.neighbours[row..].iter().position(|&n| n == to);
                        if let Some(known) = known {
                            graph.weights[row + known] += weight;
                        } else {
                            graph.neighbours.push(to);
                            graph.weights.push(weight);
                        }
                    }
                }
            }
            graph.offsets.push(graph.neighbours.len() as u32);
            graph.ground.push(ground);
        }
        graph
    }

    /// Means of the potentials of the network around each corner, weighted by conductivities.
    fn mean_of_centres(&self, centres: &Potential) -> Potential {
        let mut potential = Potential::zero(self.unknowns);
        let mut weights = vec![0.0; self.unknowns];
        for (node, corners) in self.corners.iter().enumerate() {
            for &corner in corners {
                if let Some(total) = weights.get_mut(corner as usize) {
                    let weight = self.conductivity_of(node);
                    *total += weight;
                    potential.high[corner as usize] += weight * centres.high[node];
                }
            }
        }
        potential.high.iter_mut().zip(&weights).for_each(|(potential, weight)| *potential /= weight);
        potential
    }

    /// Potential of one corner above another one.
    fn above(&self, potential: &Potential, corner: u32, other: u32) -> f64 {
        let known = |corner: u32| if corner == SOURCE { 1.0 } else { 0.0 };
        match [corner, other].map(|corner| (corner as usize) < self.unknowns) {
            [true, true] => potential.above(corner as usize, other as usize),
            [true, false] => potential.above_known(corner as usize, known(other)),
            [false, true] => -potential.above_known(other as usize, known(corner)),
            [false, false] => known(corner) - known(other),
        }
    }

    /// Differences along the axis at both places, and across it in both layers.
    fn differences(&self, node: usize, potential: &Potential) -> [[f64; 2]; 2] {
        let [a, b, c, d] = self.corners[node];
        let above = |from, to| self.above(potential, to, from);
        [[above(a, c), above(b, d)], [above(a, b), above(c, d)]]
    }

    /// The energy of a potential, with its rounding.
    fn energy(&self, potential: &Potential) -> f64 {
        let mut energy = PotentialEnergy::default();
        for node in 0..self.corners.len() {
            let conductivity = self.conductivity_of(node);
            for ([a, b], ratio) in self.differences(node, potential).into_iter().zip(self.ratios()) {
                let weight = ratio * conductivity;
                energy.add(weight / 3.0 * (a * a + a * b + b * b), weight);
            }
        }
        energy.bound()
    }

    /// The negative gradient of half of the energy.
    fn residual(&self, potential: &Potential) -> Vec<f64> {
        let mut residual = vec![0.0; self.unknowns];
        for (node, &[a, b, c, d]) in self.corners.iter().enumerate() {
            let conductivity = self.conductivity_of(node);
            let mut pull = |corner: u32, force: f64| {
                if let Some(residual) = residual.get_mut(corner as usize) {
                    *residual += force;
                }
            };
            let sides = [[(a, c), (b, d)], [(a, b), (c, d)]];
            let differences = self.differences(node, potential);
            for ((sides, differences), ratio) in sides.into_iter().zip(differences).zip(self.ratios()) {
                let weight = ratio * conductivity / 6.0;
                for (i, (from, to)) in sides.into_iter().enumerate() {
                    let force = weight * (2.0 * differences[i] + differences[1 - i]);
                    pull(from, force);
                    pull(to, -force);
                }
            }
        }
        residual
    }
}
