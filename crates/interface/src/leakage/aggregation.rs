//! Nodes that a coarser network takes as one.
//!
//! A node is paired with the neighbour to which it is connected best, and pairs are paired again. The
//! conductance between two aggregates is the sum of all conductances between their nodes, so that a coarser
//! network is a network again. Which neighbour is the best follows from the quality of a pair after Napov and
//! Notay, SIAM J. Sci. Comput. 34, A1079 (2012): a limit of the quality of all aggregates bounds the
//! condition of two levels, whatever the contrast of conductances. Pairs of pairs and nodes that join a pair
//! are judged by simpler rules in the same spirit. Nothing is proved for them; numbers of steps were
//! measured.

use super::graph::Graph;

/// Largest quality of a pair. The bound of the condition of two levels that belongs to it is about this
/// number.
const LARGEST_QUALITY: f64 = 8.0;
/// A node without a partner joins the pair of a neighbour to which at least one part in so many of its
/// conductance leads. Any number of such nodes may join a pair: the energy between them and the pair is in
/// the conductor itself.
const LEAF_SHARE: f64 = 4.0;
/// No aggregate.
const NONE: u32 = u32::MAX;

/// The aggregate of each node, and the number of aggregates. Aggregates are numbered as their first nodes
/// are.
#[derive(Debug)]
pub(super) struct Aggregates {
    pub of_node: Vec<u32>,
    pub count: usize,
}

/// Pairs of pairs, with the network between them. Cost: O(N).
pub(super) fn coarsen(fine: &Graph) -> (Aggregates, Graph) {
    let diagonal = fine.diagonal();
    let pairs = pair(fine, &diagonal);
    let between = contract(fine, &pairs);
    // The finer level smooths its own nodes. Two pairs that are each connected well, but not to each other,
    // would have a small diagonal between the levels, although no smoother of the finer one takes them apart.
    let mut together = vec![0.0; pairs.count];
    for (&pair, diagonal) in pairs.of_node.iter().zip(&diagonal) {
        together[pair as usize] += diagonal;
    }
    let pairs_of_pairs = pair(&between, &together);
    let coarse = contract(&between, &pairs_of_pairs);
    let of_node = pairs.of_node.iter().map(|&pair| pairs_of_pairs.of_node[pair as usize]).collect();
    (Aggregates { of_node, count: pairs_of_pairs.count }, coarse)
}

/// Pairs of nodes, and nodes that joined one. A node stays alone where no neighbour suits it. `diagonal` has
/// the sum of the diagonal of the finer level over each node.
fn pair(graph: &Graph, diagonal: &[f64]) -> Aggregates {
    let mut of_node = vec![NONE; graph.nodes()];
    let mut alone = Vec::new();
    let mut count = 0;
    for node in 0..graph.nodes() {
        if of_node[node] != NONE {
            continue;
        }
        let free = graph.conductors(node).filter(|&(other, _)| other != node && of_node[other] == NONE);
        let mut best = (LARGEST_QUALITY, NONE);
        for (other, weight) in free {
            let quality = pair_quality(graph, diagonal, [node, other], weight);
            if quality < best.0 {
                best = (quality, other as u32);
            }
        }
        of_node[node] = count;
        if best.1 == NONE {
            alone.push(node);
        } else {
            of_node[best.1 as usize] = count;
        }
        count += 1;
    }
    join_pairs(graph, diagonal, &mut of_node, &alone);
    renumber(of_node)
}

/// The quality of a pair with this conductance between its nodes; the smaller the better.
fn pair_quality(graph: &Graph, diagonal: &[f64], [a, b]: [usize; 2], weight: f64) -> f64 {
    let mean = 2.0 / (1.0 / diagonal[a] + 1.0 / diagonal[b]);
    let grounded = 1.0 / (1.0 / graph.ground[a] + 1.0 / graph.ground[b]);
    mean / (weight + grounded)
}

/// Nodes that found no partner join the aggregate of the neighbour to which they are connected best.
fn join_pairs(graph: &Graph, diagonal: &[f64], of_node: &mut [u32], alone: &[usize]) {
    let mut is_alone = vec![false; if alone.is_empty() { 0 } else { graph.nodes() }];
    for &node in alone {
        is_alone[node] = true;
    }
    for &node in alone {
        let paired = graph.conductors(node).filter(|&(other, _)| !is_alone[other]);
        let best = paired.fold(
            (0.0, node),
            |best, (other, weight)| {
                if weight > best.0 { (weight, other) } else { best }
            },
        );
        if best.0 * LEAF_SHARE >= diagonal[node] {
            of_node[node] = of_node[best.1];
        }
    }
}

/// Numbers without gaps, in the order of the first nodes.
fn renumber(mut of_node: Vec<u32>) -> Aggregates {
    let mut number = vec![NONE; of_node.len()];
    let mut count = 0;
    for aggregate in &mut of_node {
        let new = &mut number[*aggregate as usize];
        if *new == NONE {
            *new = count;
            count += 1;
        }
        *aggregate = *new;
    }
    Aggregates { of_node, count: count as usize }
}

/// The network between aggregates.
fn contract(fine: &Graph, aggregates: &Aggregates) -> Graph {
    let (first, members) = members(aggregates);
    let mut coarse = Graph { ground: vec![0.0; aggregates.count], ..Graph::default() };
    coarse.offsets.reserve_exact(aggregates.count + 1);
    coarse.offsets.push(0);
    // Where the conductor to each aggregate stands in the row that is being written.
    let mut entry_of = vec![NONE; aggregates.count];
    for aggregate in 0..aggregates.count {
        let begin = coarse.neighbours.len();
        for &node in &members[first[aggregate] as usize..first[aggregate + 1] as usize] {
            coarse.ground[aggregate] += fine.ground[node as usize];
            for (other, weight) in fine.conductors(node as usize) {
                let other = aggregates.of_node[other] as usize;
                if other == aggregate {
                    continue;
                }
                let entry = entry_of[other] as usize;
                if entry_of[other] != NONE && entry >= begin {
                    coarse.weights[entry] += weight;
                } else {
                    entry_of[other] = coarse.neighbours.len() as u32;
                    coarse.neighbours.push(other as u32);
                    coarse.weights.push(weight);
                }
            }
        }
        coarse.offsets.push(coarse.neighbours.len() as u32);
    }
    coarse
}

/// The nodes of each aggregate: where they begin, and one after the other.
fn members(aggregates: &Aggregates) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0; aggregates.count + 1];
    for &aggregate in &aggregates.of_node {
        first[aggregate as usize + 1] += 1;
    }
    for aggregate in 0..aggregates.count {
        first[aggregate + 1] += first[aggregate];
    }
    let mut next = first.clone();
    let mut members = vec![0; aggregates.of_node.len()];
    for (node, &aggregate) in aggregates.of_node.iter().enumerate() {
        members[next[aggregate as usize] as usize] = node as u32;
        next[aggregate as usize] += 1;
    }
    (first, members)
}
