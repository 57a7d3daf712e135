//! A hierarchy of coarser networks, as a preconditioner.
//!
//! Each level has an aggregate of about four nodes of the level below as a node. On each of them but the
//! finest one, two steps of conjugate gradients, which are preconditioned by the next coarser level, solve
//! the problem that the finer one leaves (the K-cycle of Notay, Electron. Trans. Numer. Anal. 37, 123
//! (2010)). Without these two steps the number of iterations would grow with the number of levels. Nodes are
//! smoothed by Gauss-Seidel sweeps within fixed blocks of rows, so that threads can share them and no bit
//! depends on their number.

use super::aggregation::{Aggregates, coarsen};
use super::dense::Elimination;
use super::graph::{Graph, WORK_PER_ROW};
use super::vectors::{combine, dot};
use contact_model::{Result, Stop, check_stop};
use numerics::parallel::map;
use std::sync::Arc;

/// A network with this many nodes or fewer is solved by elimination.
const ELIMINATED: usize = 200;
/// Coarsening ends where less than one part in so many of the nodes disappears: the rest is smoothed.
const SLOWEST: usize = 20;
/// Sweeps that stand for a solution where coarsening ended early.
const LAST_SWEEPS: usize = 20;
/// Rows of a block that is smoothed by itself.
const BLOCK: usize = 1 << 16;

/// One level: a network with what leads to the next coarser one.
#[derive(Debug)]
struct GraphLevel {
    /// Its network; the caller shares that of the finest level.
    graph: Arc<Graph>,
    /// The reciprocals of the diagonal.
    inverse: Vec<f64>,
    /// The aggregates of its nodes; `None` at the coarsest level.
    aggregates: Option<Aggregates>,
    vectors: LevelVectors,
}

/// Vectors of a level, kept from cycle to cycle. The first four are of the problem that the finer level left,
/// so that the finest level has none of them.
#[derive(Debug, Default)]
struct LevelVectors {
    right: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
    first_current: Vec<f64>,
    second_current: Vec<f64>,
    residual: Vec<f64>,
}

/// All levels, the finest first.
#[derive(Debug)]
pub(super) struct Hierarchy {
    levels: Vec<GraphLevel>,
    /// The coarsest network; `None` where coarsening ended early.
    elimination: Option<Elimination>,
}

impl Hierarchy {
    /// The hierarchy above a network, in which every node has a path to known potentials.
    ///
    /// # Errors
    /// [`contact_model::Error::Stopped`].
    ///
    /// Cost: O(N).
    pub fn new(finest: Arc<Graph>, stop: Stop<'_>) -> Result<Self> {
        let mut levels = Vec::new();
        let mut graph = finest;
        loop {
            check_stop(stop)?;
            let nodes = graph.nodes();
            let coarser = (nodes > ELIMINATED).then(|| coarsen(&graph));
            let coarser =
                coarser.filter(|(aggregates, _)| aggregates.count * SLOWEST < nodes * (SLOWEST - 1));
            let vectors = LevelVectors::new(nodes, levels.is_empty());
            let inverse = graph.diagonal().iter().map(|d| 1.0 / d).collect();
            let Some((aggregates, coarse)) = coarser else {
                let elimination = (nodes <= ELIMINATED).then(|| Elimination::new(&graph));
                levels.push(GraphLevel { graph, inverse, aggregates: None, vectors });
                return Ok(Self { levels, elimination });
            };
            levels.push(GraphLevel { graph, inverse, aggregates: Some(aggregates), vectors });
            graph = Arc::new(coarse);
        }
    }

    /// Potentials for currents that flow into the nodes of the finest level, approximately.
    pub fn apply(&mut self, right: &[f64], potential: &mut [f64]) {
        cycle(&mut self.levels, self.elimination.as_ref(), right, potential);
    }
}

impl LevelVectors {
    fn new(nodes: usize, finest: bool) -> Self {
        let inner = || vec![0.0; if finest { 0 } else { nodes }];
        Self {
            right: inner(),
            first: inner(),
            second: inner(),
            first_current: inner(),
            second_current: inner(),
            residual: vec![0.0; nodes],
        }
    }
}

/// One cycle from the first of the levels.
fn cycle(levels: &mut [GraphLevel], elimination: Option<&Elimination>, right: &[f64], potential: &mut [f64]) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    let GraphLevel { graph, inverse, aggregates, vectors } = level;
    let Some(aggregates) = aggregates else {
        if let Some(elimination) = elimination {
            elimination.solve(right, potential);
        } else {
            sweep_down(graph, inverse, right, potential);
            for _ in 0..LAST_SWEEPS {
                sweep_up(graph, inverse, right, potential, &mut vectors.residual);
                sweep_again(graph, inverse, right, potential, &mut vectors.residual);
            }
            sweep_up(graph, inverse, right, potential, &mut vectors.residual);
        }
        return;
    };
    sweep_down(graph, inverse, right, potential);
    graph.residual(right, potential, &mut vectors.residual);
    let coarse_right = &mut coarser[0].vectors.right;
    coarse_right.fill(0.0);
    for (&aggregate, residual) in aggregates.of_node.iter().zip(&vectors.residual) {
        coarse_right[aggregate as usize] += residual;
    }
    solve_coarse(coarser, elimination);
    let correction = &coarser[0].vectors.first;
    for (&aggregate, potential) in aggregates.of_node.iter().zip(potential.iter_mut()) {
        *potential += correction[aggregate as usize];
    }
    sweep_up(graph, inverse, right, potential, &mut vectors.residual);
}

/// Solves a coarser problem by two steps of conjugate gradients; what comes out is `first`.
fn solve_coarse(levels: &mut [GraphLevel], elimination: Option<&Elimination>) {
    let mut vectors = std::mem::take(&mut levels[0].vectors);
    let LevelVectors { right, first, second, first_current, second_current, residual } = &mut vectors;
    // The cycle needs the residual of this level.
    let mut within = |levels: &mut [GraphLevel], right: &[f64], potential: &mut [f64]| {
        levels[0].vectors.residual = std::mem::take(residual);
        cycle(levels, elimination, right, potential);
        *residual = std::mem::take(&mut levels[0].vectors.residual);
    };
    within(levels, right, first);
    if levels[0].aggregates.is_some() {
        levels[0].graph.multiply(first, first_current);
        let energy = dot(first, first_current);
        let step = if energy > 0.0 { dot(first, right) / energy } else { 0.0 };
        combine(right, 1.0, -step, first_current);
        within(levels, right, second);
        levels[0].graph.multiply(second, second_current);
        let mixed = if energy > 0.0 { dot(second, first_current) / energy } else { 0.0 };
        let second_energy = dot(second, second_current) - mixed * mixed * energy;
        let second_step = if second_energy > 0.0 { dot(second, right) / second_energy } else { 0.0 };
        combine(first, step - mixed * second_step, second_step, second);
    }
    levels[0].vectors = vectors;
}

/// Gauss-Seidel within each block from potentials of zero, from the first row to the last.
fn sweep_down(graph: &Graph, inverse: &[f64], right: &[f64], potential: &mut [f64]) {
    let tasks = potential.chunks_mut(BLOCK).enumerate();
    map(WORK_PER_ROW * graph.nodes(), tasks, |(block, own)| {
        let begin = block * BLOCK;
        for i in 0..own.len() {
            let node = begin + i;
            let before = graph.conductors(node).filter(|&(other, _)| (begin..node).contains(&other));
            let current = before.map(|(other, weight)| weight * own[other - begin]).sum::<f64>();
            own[i] = (right[node] + current) * inverse[node];
        }
    });
}

/// Gauss-Seidel within each block from the last row to the first; neighbours in other blocks keep their
/// potentials.
fn sweep_up(graph: &Graph, inverse: &[f64], right: &[f64], potential: &mut [f64], before: &mut [f64]) {
    copy_for_blocks(potential, before);
    let before = &*before;
    let tasks = potential.chunks_mut(BLOCK).enumerate();
    map(WORK_PER_ROW * graph.nodes(), tasks, |(block, own)| {
        let block = SmoothedBlock { graph, inverse, right, before, begin: block * BLOCK };
        for i in (0..own.len()).rev() {
            own[i] = block.relaxed(own, i);
        }
    });
}

/// As [`sweep_up`], from the first row to the last.
fn sweep_again(graph: &Graph, inverse: &[f64], right: &[f64], potential: &mut [f64], before: &mut [f64]) {
    copy_for_blocks(potential, before);
    let before = &*before;
    let tasks = potential.chunks_mut(BLOCK).enumerate();
    map(WORK_PER_ROW * graph.nodes(), tasks, |(block, own)| {
        let block = SmoothedBlock { graph, inverse, right, before, begin: block * BLOCK };
        for i in 0..own.len() {
            own[i] = block.relaxed(own, i);
        }
    });
}

/// Keeps the potentials that other blocks see.
fn copy_for_blocks(potential: &[f64], before: &mut [f64]) {
    if potential.len() > BLOCK {
        before.copy_from_slice(potential);
    }
}

/// Rows that are smoothed together, from `begin` on.
struct SmoothedBlock<'a> {
    graph: &'a Graph,
    inverse: &'a [f64],
    right: &'a [f64],
    /// Potentials of all nodes before the sweep; not read where there is one block.
    before: &'a [f64],
    begin: usize,
}

impl SmoothedBlock<'_> {
    /// The potential at which no current is left in a node of the block.
    #[inline]
    fn relaxed(&self, own: &[f64], i: usize) -> f64 {
        let node = self.begin + i;
        let at = |other: usize| {
            own.get(other.wrapping_sub(self.begin)).copied().unwrap_or_else(|| self.before[other])
        };
        let current = self.graph.conductors(node).map(|(other, weight)| weight * at(other)).sum::<f64>();
        (self.right[node] + current) * self.inverse[node]
    }
}
