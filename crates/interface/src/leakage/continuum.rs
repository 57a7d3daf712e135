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
//!
//! Circulations lower the dissipation further: a current around a corner between open cells flows over the
//! faces that meet there and adds nothing to what a cell takes in or gives out. Their strengths are a stream
//! function, bilinear in each cell, of which `1/k` is the conductivity. The same conjugate gradients find
//! them. Corners of closed cells and of impermeable sides have none.

use super::currents::{Currents, Dissipation};
use super::gradients::{Potential, solve};
use super::graph::Graph;
use super::multigrid::Hierarchy;
use super::network::{CellNetwork, NONE, PotentialEnergy, SINK, SOURCE};
use contact_model::{Result, Stop, check_stop};
use numerics::sum::Sum;
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

/// Differences along the axis at both places of a cell, and across it in both layers.
type Differences = [[f64; 2]; 2];

/// The cells of a network with unknowns at their corners: potentials, or values of a stream function.
#[derive(Debug)]
struct BilinearCells {
    /// Sides of a cell along the axis and across it.
    sides: [f64; 2],
    /// Of the cell of each node.
    conductivity: Vec<f64>,
    /// Unknowns at the corners of each node's cell; [`SOURCE`] or [`SINK`] where the value is known.
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

/// The bound from below, and the steps of conjugate gradients that it took.
///
/// # Errors
/// [`contact_model::Error::Stopped`].
pub(super) fn lower_bound(
    network: &CellNetwork,
    conductivity: &[f64],
    currents: &Currents<'_>,
    stop: Stop<'_>,
) -> Result<(f64, usize)> {
    let cells = BilinearCells::of_stream_function(network, conductivity);
    let of_network: Vec<Differences> = (0..network.cells.len())
        .map(|node| {
            let [before, behind, up, down] = currents.over_faces(node);
            [[before, -behind], [-up, down]]
        })
        .collect();
    let lower = cells.bound_of_flux(&of_network, &[], currents);
    check_stop(stop)?;
    if cells.unknowns == 0 {
        return Ok((lower, 0));
    }
    let graph = cells.graph(cells.exact());
    // The currents of the network are off near corners alone: few steps from neighbour to neighbour do, and
    // further ones gain nearly nothing.
    let scale: Vec<f64> = graph.diagonal().iter().map(|d| 1.0 / d).collect();
    let precondition = |residual: &[f64], z: &mut [f64]| {
        z.iter_mut().zip(residual).zip(&scale).for_each(|((z, residual), scale)| *z = residual * scale);
    };
    let residual = cells.residual(|node| of_network[node]);
    let circulation = solve(&graph, precondition, residual, REDUCTION, stop)?;
    Ok((lower.max(cells.bound_of_flux(&of_network, &circulation.x, currents)), circulation.steps))
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
    let cells = BilinearCells::of_potential(network, conductivity);
    let mut potential = cells.mean_of_centres(centres);
    let mut upper = cells.energy(&potential);
    check_stop(stop)?;
    if cells.unknowns == 0 {
        return Ok((upper, 0));
    }
    let mut hierarchy = Hierarchy::new(Arc::new(cells.graph(cells.lumped())), stop)?;
    let (graph, mut steps) = (cells.graph(cells.exact()), 0);
    for _ in 0..ROUNDS {
        let residual = cells.residual(|node| cells.differences(node, &potential));
        let precondition = |residual: &[f64], z: &mut [f64]| hierarchy.apply(residual, z);
        let correction = solve(&graph, precondition, residual, REDUCTION, stop)?;
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

impl BilinearCells {
    /// Unknown potentials. Cost: O(N).
    fn of_potential(network: &CellNetwork, conductivity: &[f64]) -> Self {
        let layers = &network.layers;
        let mut unknowns = 0;
        // Corners at which two cells touch that share no other cell there. A point carries no flow, so that
        // each of them has a potential of its own.
        let mut is_split = vec![false; network.corners()];
        let mut first = vec![NONE; is_split.len()];
        for (corner, [layer, place]) in network.places_of_corners() {
            if layer == 0 || layer == layers.count {
                first[corner] = if layer == 0 { SOURCE } else { SINK };
                continue;
            }
            let around = network.around_corner(layer, place).map(|node| node == Some(true));
            if around.contains(&true) {
                first[corner] = unknowns;
                unknowns += 1;
            }
            if around == [true, false, false, true] || around == [false, true, true, false] {
                is_split[corner] = true;
                unknowns += 1;
            }
        }
        let of_corner = |corner: usize, l: usize| first[corner] + u32::from(is_split[corner] && l == 0);
        let own = network.cells.iter().map(|&cell| conductivity[cell as usize]).collect();
        Self::new(network, own, of_corner, unknowns)
    }

    /// Unknown circulations around the corners of which all cells carry a flow. Cost: O(N).
    fn of_stream_function(network: &CellNetwork, conductivity: &[f64]) -> Self {
        let layers = &network.layers;
        let mut unknowns = 0;
        let mut of_corner = vec![SINK; network.corners()];
        for (corner, [layer, place]) in network.places_of_corners() {
            let at_side = !layers.wraps && (place == 0 || place == layers.width);
            let closed = network.around_corner(layer, place).contains(&Some(false));
            if !at_side && !closed {
                of_corner[corner] = unknowns;
                unknowns += 1;
            }
        }
        // The same circulation around all corners is none: where all are unknown, one of them becomes known.
        if unknowns as usize == of_corner.len() {
            unknowns -= 1;
            of_corner[unknowns as usize] = SINK;
        }
        let own = network.cells.iter().map(|&cell| 1.0 / conductivity[cell as usize]).collect();
        Self::new(network, own, |corner, _| of_corner[corner], unknowns)
    }

    /// `unknown` names that of a corner for a cell of the layer before it (0) or behind it (1).
    fn new(
        network: &CellNetwork,
        conductivity: Vec<f64>,
        unknown: impl Fn(usize, usize) -> u32,
        unknowns: u32,
    ) -> Self {
        let corners = network.cells.iter().map(|&cell| {
            let [layer, place] = network.layers.place(cell as usize);
            [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(l, p)| unknown(network.corner(layer + l, place + p), l))
        });
        let (corners, sides) = (corners.collect(), network.layers.sides);
        Self { sides, conductivity, corners, unknowns: unknowns as usize }
    }

    /// Ratios of sides by which differences along the axis and across it count.
    fn ratios(&self) -> [f64; 2] {
        let [along, across] = self.sides;
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
                    let weight = weight * self.conductivity[node];
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
                    let weight = self.conductivity[node];
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

    fn differences(&self, node: usize, potential: &Potential) -> Differences {
        let [a, b, c, d] = self.corners[node];
        let above = |from, to| self.above(potential, to, from);
        [[above(a, c), above(b, d)], [above(a, b), above(c, d)]]
    }

    /// The energy of a potential, with its rounding.
    fn energy(&self, potential: &Potential) -> f64 {
        let mut energy = PotentialEnergy::default();
        for node in 0..self.corners.len() {
            let conductivity = self.conductivity[node];
            for ([a, b], ratio) in self.differences(node, potential).into_iter().zip(self.ratios()) {
                let weight = ratio * conductivity;
                energy.add(weight / 3.0 * (a * a + a * b + b * b), weight);
            }
        }
        energy.bound()
    }

    /// The bound from below that currents prove, given for each cell as differences of a stream function,
    /// together with circulations around corners.
    fn bound_of_flux(&self, of_network: &[Differences], circulation: &[f64], currents: &Currents<'_>) -> f64 {
        let value = |corner: u32| circulation.get(corner as usize).copied().unwrap_or(0.0);
        // A current with its rounding, which does not become smaller where a circulation cancels the current.
        let with = |current: f64, to: f64, from: f64| {
            let mut sum = Sum::from(current);
            sum.add(to);
            sum.add(-from);
            (sum.value(), f64::EPSILON * current.abs())
        };
        let mut dissipation = Dissipation::default();
        for (node, corners) in self.corners.iter().enumerate() {
            let [a, b, c, d] = corners.map(value);
            let [[before, behind], [up, down]] = of_network[node];
            let flux = [[with(before, c, a), with(behind, d, b)], [with(up, b, a), with(down, d, c)]];
            for ([(a, of_a), (b, of_b)], ratio) in flux.into_iter().zip(self.ratios()) {
                let resistance = ratio * self.conductivity[node];
                let rounding =
                    of_a * (2.0 * a.abs() + b.abs() + of_a + of_b) + of_b * (a.abs() + 2.0 * b.abs() + of_b);
                let power = a * a + a * b + b * b + rounding;
                dissipation.add(resistance / 3.0 * power, a.abs() + b.abs(), resistance);
            }
        }
        dissipation.conductance(currents)
    }

    /// The negative gradient of half of the energy of these differences.
    fn residual(&self, differences: impl Fn(usize) -> Differences) -> Vec<f64> {
        let mut residual = vec![0.0; self.unknowns];
        for (node, &[a, b, c, d]) in self.corners.iter().enumerate() {
            let conductivity = self.conductivity[node];
            let mut pull = |corner: u32, force: f64| {
                if let Some(residual) = residual.get_mut(corner as usize) {
                    *residual += force;
                }
            };
            let sides = [[(a, c), (b, d)], [(a, b), (c, d)]];
            let differences = differences(node);
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
