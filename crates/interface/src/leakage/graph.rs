//! Conductors between nodes.

use numerics::parallel::map;

/// Rows that one task multiplies.
pub(super) const ROWS: usize = 1 << 14;
/// Operations on elements of a vector that a row of a graph is worth, to choose the number of threads.
pub(super) const WORK_PER_ROW: usize = 8;

/// A network of conductors between nodes of unknown potential, and from these to nodes of known potential.
///
/// The currents out of the nodes at potentials v are `(A v)_i = ground_i v_i + sum_j w_ij (v_i - v_j)`: A is
/// symmetric. It is evaluated in this form, with differences of potentials, because the entries of its
/// diagonal would lose small differences between nodes of large conductance.
#[derive(Debug, Default)]
pub(super) struct Graph {
    /// Where the entries of each node begin, and the number of entries at last.
    pub offsets: Vec<u32>,
    /// The node at the other end of each conductor; a conductor stands with both of its nodes, and there is
    /// one conductor at most between two nodes.
    pub neighbours: Vec<u32>,
    /// The conductance of each conductor.
    pub weights: Vec<f64>,
    /// Conductance from each node to all nodes of known potential.
    pub ground: Vec<f64>,
}

impl Graph {
    /// Number of nodes of unknown potential.
    pub fn nodes(&self) -> usize {
        self.ground.len()
    }

    /// The entries of a node.
    #[inline]
    pub fn entries(&self, node: usize) -> std::ops::Range<usize> {
        self.offsets[node] as usize..self.offsets[node + 1] as usize
    }

    /// The neighbours of a node with the conductances to them.
    #[inline]
    pub fn conductors(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let entries = self.entries(node);
        let neighbours = self.neighbours[entries.clone()].iter().map(|&node| node as usize);
        neighbours.zip(self.weights[entries].iter().copied())
    }

    /// The diagonal of A.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.nodes())
            .map(|node| self.ground[node] + self.weights[self.entries(node)].iter().sum::<f64>())
            .collect()
    }

    /// Current out of a node.
    #[inline]
    pub fn current(&self, node: usize, potential: &[f64]) -> f64 {
        let own = potential[node];
        let between = self.conductors(node).map(|(other, weight)| weight * (own - potential[other]));
        self.ground[node] * own + between.sum::<f64>()
    }

    /// Calls `row` with every node and the current out of it, and a vector to be written there.
    fn each_row(&self, potential: &[f64], out: &mut [f64], row: impl Fn(usize, f64) -> f64 + Sync) {
        let tasks = out.chunks_mut(ROWS).enumerate();
        map(WORK_PER_ROW * self.nodes(), tasks, |(chunk, out)| {
            for (i, out) in out.iter_mut().enumerate() {
                let node = chunk * ROWS + i;
                *out = row(node, self.current(node, potential));
            }
        });
    }

    /// `out = A v`.
    pub fn multiply(&self, potential: &[f64], out: &mut [f64]) {
        self.each_row(potential, out, |_, current| current);
    }

    /// `out = right - A v`.
    pub fn residual(&self, right: &[f64], potential: &[f64], out: &mut [f64]) {
        self.each_row(potential, out, |node, current| right[node] - current);
    }
}
