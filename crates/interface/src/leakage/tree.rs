//! A spanning tree of good conductors, along which currents are made exactly free of divergence.

use super::gradients::Potential;
use super::network::{CellNetwork, SINK, SOURCE, rounded};
use crate::disjoint_sets::DisjointSets;
use contact_model::{Result, Stop, check_stop};
use numerics::sum::Sum;

/// A spanning forest of the network whose roots are the two edges of the map.
///
/// It is the one of the largest conductances: the way from any node to an edge along it has the largest
/// possible smallest conductance. Surplus currents that go along it therefore cost little.
#[derive(Debug)]
pub(super) struct SpanningForest {
    /// The node that is next to each node on the way to its root; [`SOURCE`] or [`SINK`] where that is an
    /// edge.
    pub parent: Vec<u32>,
    /// All nodes, each one after its parent.
    order: Vec<u32>,
}

/// A conductor with its conductance as an integer of the same order.
type Conductor = (std::cmp::Reverse<u64>, u32, u32);

impl SpanningForest {
    /// Takes the conductors one by one, the largest first (Kruskal). Cost: O(N log N).
    ///
    /// # Errors
    /// [`contact_model::Error::Stopped`].
    pub fn new(network: &CellNetwork, stop: Stop<'_>) -> Result<Self> {
        let nodes = network.graph.nodes();
        let mut conductors = all_conductors(network);
        conductors.sort_unstable();
        check_stop(stop)?;
        // Both edges are one member.
        let mut sets = DisjointSets::new(nodes + 1);
        let member = |node: u32| (node as usize).min(nodes);
        conductors.retain(|&(_, a, b)| sets.join(member(a), member(b)));
        check_stop(stop)?;
        Ok(Self::rooted(nodes, &conductors))
    }

    /// Directs a forest towards its roots.
    fn rooted(nodes: usize, conductors: &[Conductor]) -> Self {
        let mut first = vec![0_u32; nodes + 1];
        let inner = |node: u32| ((node as usize) < nodes).then_some(node as usize);
        for &(_, a, b) in conductors {
            for node in [a, b].into_iter().filter_map(inner) {
                first[node + 1] += 1;
            }
        }
        for node in 0..nodes {
            first[node + 1] += first[node];
        }
        let mut next = first.clone();
        let mut beside = vec![0; first[nodes] as usize];
        let mut parent = vec![u32::MAX; nodes];
        let mut order = Vec::with_capacity(nodes);
        for &(_, a, b) in conductors {
            for (node, other) in [(a, b), (b, a)] {
                if let Some(node) = inner(node) {
                    beside[next[node] as usize] = other;
                    next[node] += 1;
                } else {
                    parent[other as usize] = node;
                    order.push(other);
                }
            }
        }
        let mut done = 0;
        while done < order.len() {
            let node = order[done] as usize;
            for &other in &beside[first[node] as usize..first[node + 1] as usize] {
                if other != parent[node] && inner(other).is_some() {
                    parent[other as usize] = node as u32;
                    order.push(other);
                }
            }
            done += 1;
        }
        Self { parent, order }
    }

    /// What has to be added to the current from each node to its parent, so that as much flows into every
    /// node as out of it. The currents on the other conductors stay as they are.
    ///
    /// The sums are carried out to twice the working precision, and so are the results: behind a narrow
    /// constriction the current of a potential that is rounded may be far larger than the true one, which is
    /// what remains of both.
    pub fn correction(&self, network: &CellNetwork, potential: &Potential) -> Vec<(f64, f64)> {
        let mut surplus = network.surplus(potential);
        let mut correction = vec![(0.0, 0.0); self.parent.len()];
        for &node in self.order.iter().rev() {
            let given = surplus[node as usize];
            correction[node as usize] = given;
            if let Some(parent) = surplus.get_mut(self.parent[node as usize] as usize) {
                // The first numbers are added exactly, the rest is rounded.
                let mut sum = Sum::from(parent.0);
                for term in [given.0, parent.1, given.1] {
                    sum.add(term);
                }
                *parent = rounded(sum);
            }
        }
        correction
    }
}

/// Every conductor once, those to the edges included.
fn all_conductors(network: &CellNetwork) -> Vec<Conductor> {
    let key = |conductance: f64| std::cmp::Reverse(conductance.to_bits());
    let mut all = Vec::with_capacity(network.graph.neighbours.len() / 2 + network.graph.nodes() / 64);
    for node in 0..network.graph.nodes() {
        let later = network.graph.conductors(node).filter(|&(other, _)| other > node);
        all.extend(later.map(|(other, weight)| (key(weight), node as u32, other as u32)));
        for edge in [SOURCE, SINK] {
            let weight = network.to_edge(node, edge);
            if weight > 0.0 {
                all.push((key(weight), node as u32, edge));
            }
        }
    }
    all
}
