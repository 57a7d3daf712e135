//! The smallest network, solved by elimination.

use super::graph::Graph;

/// Elimination of the nodes of a small network, one after the other.
///
/// A node that is eliminated leaves conductors between its neighbours (star-mesh transform). All numbers are
/// sums, products and quotients of positive numbers, so that no contrast of conductances spoils a digit
/// (Grassmann, Taksar and Heyman, Oper. Res. 33, 1107 (1985)).
#[derive(Debug)]
pub(super) struct Elimination {
    nodes: usize,
    /// Before a node is eliminated: the share of its conductance that leads to each later node. Row-major.
    shares: Vec<f64>,
    /// Its conductance at that time.
    pivots: Vec<f64>,
}

impl Elimination {
    /// Cost: O(n^3) for n nodes.
    pub fn new(graph: &Graph) -> Self {
        let n = graph.nodes();
        let mut weights = vec![0.0; n * n];
        let mut ground = graph.ground.clone();
        for node in 0..n {
            for (other, weight) in graph.conductors(node) {
                weights[node * n + other] += weight;
            }
        }
        let mut pivots = vec![0.0; n];
        for k in 0..n {
            let (head, tail) = weights.split_at_mut((k + 1) * n);
            let row = &mut head[k * n..];
            pivots[k] = ground[k] + row[k + 1..].iter().sum::<f64>();
            let pivot = pivots[k];
            for i in k + 1..n {
                let share = row[i] / pivot;
                if share > 0.0 {
                    let later = &mut tail[(i - k - 1) * n..][..n];
                    later[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(w, &to)| *w += share * to);
                    ground[i] += share * ground[k];
                }
            }
            row[k + 1..].iter_mut().for_each(|w| *w /= pivot);
        }
        Self { nodes: n, shares: weights, pivots }
    }

    /// Potentials for currents that flow into the nodes. Cost: O(n^2).
    pub fn solve(&self, right: &[f64], potential: &mut [f64]) {
        let n = self.nodes;
        potential.copy_from_slice(right);
        for k in 0..n {
            let current = potential[k];
            let later = self.shares[k * n..][k + 1..n].iter();
            potential[k + 1..].iter_mut().zip(later).for_each(|(p, share)| *p += share * current);
        }
        for k in (0..n).rev() {
            let later = self.shares[k * n..][k + 1..n].iter().zip(&potential[k + 1..]);
            potential[k] = potential[k] / self.pivots[k] + later.map(|(share, p)| share * p).sum::<f64>();
        }
    }
}
