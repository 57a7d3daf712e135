//! Disjoint sets of cells.

/// Disjoint sets whose root is their smallest member.
#[derive(Debug)]
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// As many sets as members.
    pub fn new(members: usize) -> Self {
        Self { parent: (0..members as u32).collect() }
    }

    /// The root of the set of a member; the path to it is halved on the way.
    pub fn root(&mut self, mut member: usize) -> usize {
        loop {
            let above = self.parent[member] as usize;
            if above == member {
                return member;
            }
            let next = self.parent[above];
            self.parent[member] = next;
            member = next as usize;
        }
    }

    /// Joins the sets of two members, and says whether they were apart.
    pub fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        let (first, second) = (a.min(b), a.max(b));
        self.parent[second] = first as u32;
        a != b
    }
}

/// Disjoint sets of cells of a ring, which know how far each member lies from its root.
///
/// Each member has a distance to its parent, counted along the ring. Two members that are joined twice, with
/// distances that differ, have a way between them that winds round the ring.
#[derive(Debug)]
pub(crate) struct RingSets {
    parent: Vec<u32>,
    distance: Vec<i64>,
}

impl RingSets {
    pub fn new(members: usize) -> Self {
        Self { parent: (0..members as u32).collect(), distance: vec![0; members] }
    }

    /// The root of the set of a member, and the distance from the root to the member.
    fn root(&mut self, member: usize) -> (usize, i64) {
        let (mut root, mut total) = (member, 0);
        while self.parent[root] as usize != root {
            total += self.distance[root];
            root = self.parent[root] as usize;
        }
        // Everything on the way now has the root as its parent.
        let (mut at, mut left) = (member, total);
        while at != root {
            let (next, step) = (self.parent[at] as usize, self.distance[at]);
            (self.parent[at], self.distance[at]) = (root as u32, left);
            left -= step;
            at = next;
        }
        (root, total)
    }

    /// Whether two members are in one set.
    pub fn are_joined(&mut self, a: usize, b: usize) -> bool {
        self.root(a).0 == self.root(b).0
    }

    /// Joins the sets of two members, of which the second lies `step` further along the ring. Says whether
    /// there is now a way round the ring.
    pub fn join(&mut self, a: usize, b: usize, step: i64) -> bool {
        let ((root_a, to_a), (root_b, to_b)) = (self.root(a), self.root(b));
        if root_a == root_b {
            return to_a + step != to_b;
        }
        // b is at `to_a + step` from the root of a, and at `to_b` from its own.
        let between = to_a + step - to_b;
        if root_a < root_b {
            (self.parent[root_b], self.distance[root_b]) = (root_a as u32, between);
        } else {
            (self.parent[root_a], self.distance[root_a]) = (root_b as u32, -between);
        }
        false
    }
}
