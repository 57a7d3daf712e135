//! Percolation of the open cells and of the contact.
//!
//! Is there a way through the interface? A cell is open where its gap exceeds a smallest gap `g_min`, and in
//! contact elsewhere. The interface leaks if open cells lead from one edge to the opposite one. Among all
//! ways the widest one matters: its narrowest cell, the **critical constriction**, is the narrowest cell that
//! the fluid has to pass. It decides on the leakage near the percolation threshold, because the flow through
//! a cell varies as the cube of the gap (Dapp and Mueser, EPL 109, 44001 (2015); Persson and Yang, J. Phys.:
//! Condens. Matter 20, 315011 (2008)).
//!
//! Open cells are neighbours over an edge. Contact that blocks the way may also touch at corners. With these
//! two rules exactly one of two statements holds: the open cells lead from edge to edge, or the contact
//! closes the way.

use crate::axis::{FlowAxis, Layers};
use crate::disjoint_sets::{DisjointSets, RingSets};
use contact_model::{Boundary, Error, Field, Result};

/// The critical constriction: the narrowest cell of the widest way between opposite edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constriction {
    /// Its column.
    pub column: usize,
    /// Its row.
    pub row: usize,
    /// Its gap. Cells with at least this gap lead from edge to edge, and cells with a larger gap do not.
    pub gap: f64,
}

/// What leads from one edge of an interface to the opposite one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Percolation {
    /// Whether open cells, whose gap exceeds `g_min`, lead from edge to edge: neighbours share an edge. It is
    /// the same as `constriction.gap > g_min`.
    pub spans: bool,
    /// The critical constriction, which does not depend on `g_min`. Of several cells with the same gap it is
    /// one on which the result does not depend otherwise; the choice depends on the map alone.
    pub constriction: Constriction,
    /// Whether cells in contact, whose gap is at most `g_min`, lead from edge to edge along the same axis:
    /// neighbours share an edge.
    pub contact_spans: bool,
    /// Whether the contact closes the way across the axis, where cells that touch at a corner are neighbours
    /// as well. It leads from side to side, or round the map where the map repeats across the axis. It is the
    /// opposite of `spans`, and found independently of it.
    pub contact_blocks: bool,
}

/// Bytes that [`percolation`] needs for each cell: the order of the cells with their gaps, and two kinds of
/// disjoint sets one after the other.
const BYTES_PER_CELL: f64 = 20.0;

/// Percolation of the open cells, `gap > g_min`, and of the contact, `gap <= g_min`, from edge to edge along
/// an axis.
///
/// `gap` and `g_min` have the same unit of length. A gap may be infinite, as it is at undefined points: such
/// a cell is open. The boundary says whether cells are neighbours round the edge across the axis.
///
/// # Errors
/// [`Error::Domain`] for a gap or a `g_min` that is not a number; [`Error::OutOfMemory`] where the map is too
/// large.
///
/// Cost: O(N log N) for a map of N cells, to sort them by their gap; everything else takes O(N) in practice,
/// with disjoint sets. It needs 20 N bytes.
///
/// ```
/// use contact_model::{Boundary, Field};
/// use interface::{FlowAxis, percolation};
/// let gap = Field::new([3, 2], [3.0, 2.0], vec![5.0, 1.0, 4.0, 6.0, 2.0, 0.0])?;
/// // In the first row the way leads over a gap of 1, in the second one over a gap of 0.
/// let found = percolation(&gap, 0.5, FlowAxis::X, Boundary::Free)?;
/// assert!(found.spans && !found.contact_blocks);
/// assert_eq!((found.constriction.column, found.constriction.row, found.constriction.gap), (1, 0, 1.0));
/// assert!(!percolation(&gap, 1.0, FlowAxis::X, Boundary::Free)?.spans);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn percolation(gap: &Field, g_min: f64, along: FlowAxis, boundary: Boundary) -> Result<Percolation> {
    if g_min.is_nan() {
        return Err(Error::domain("g_min", g_min, "a number"));
    }
    if let Some(cell) = gap.values().iter().position(|g| g.is_nan()) {
        let name = format!("gap[{}, {}]", cell / gap.columns(), cell % gap.columns());
        return Err(Error::domain(name, f64::NAN, "a number; infinite at undefined points"));
    }
    crate::axis::check_memory(gap.cells(), BYTES_PER_CELL)?;
    let layers = Layers::new(gap, along, boundary);
    let constriction = find_constriction(gap, &layers);
    let is_contact = |cell: usize| gap.values()[cell] <= g_min;
    Ok(Percolation {
        spans: constriction.gap > g_min,
        constriction,
        contact_spans: leads_along(&layers, is_contact),
        contact_blocks: leads_across(&layers, is_contact),
    })
}

/// The last cell that is needed when cells are added, the widest first, until they lead from edge to edge.
fn find_constriction(gap: &Field, layers: &Layers) -> Constriction {
    let values = gap.values();
    let mut order: Vec<u32> = (0..layers.cells() as u32).collect();
    order.sort_unstable_by(|&a, &b| values[b as usize].total_cmp(&values[a as usize]).then(a.cmp(&b)));
    let (first_edge, last_edge) = (layers.cells(), layers.cells() + 1);
    let mut sets = DisjointSets::new(layers.cells() + 2);
    let mut added = vec![false; layers.cells()];
    let mut last = 0;
    for cell in order {
        last = cell as usize;
        added[last] = true;
        for neighbour in layers.neighbours(last).into_iter().flatten() {
            if added[neighbour] {
                sets.join(last, neighbour);
            }
        }
        let [layer, _] = layers.place(last);
        if layer == 0 {
            sets.join(last, first_edge);
        }
        if layer + 1 == layers.count {
            sets.join(last, last_edge);
        }
        if sets.root(first_edge) == sets.root(last_edge) {
            break;
        }
    }
    Constriction { column: last % gap.columns(), row: last / gap.columns(), gap: values[last] }
}

/// Whether cells of a set that share edges lead from the first layer to the last one.
pub(crate) fn leads_along(layers: &Layers, holds: impl Fn(usize) -> bool) -> bool {
    let (first_edge, last_edge) = (layers.cells(), layers.cells() + 1);
    let mut sets = DisjointSets::new(layers.cells() + 2);
    for cell in (0..layers.cells()).filter(|&cell| holds(cell)) {
        let [layer, _] = layers.place(cell);
        for neighbour in layers.neighbours(cell).into_iter().flatten() {
            if neighbour < cell && holds(neighbour) {
                sets.join(cell, neighbour);
            }
        }
        if layer == 0 {
            sets.join(cell, first_edge);
        }
        if layer + 1 == layers.count {
            sets.join(cell, last_edge);
        }
    }
    sets.root(first_edge) == sets.root(last_edge)
}

/// Whether cells of a set that share edges or corners lead from the first place of the layers to the last
/// one, or round the ring where the layers close.
fn leads_across(layers: &Layers, holds: impl Fn(usize) -> bool) -> bool {
    let (first_side, last_side) = (layers.cells(), layers.cells() + 1);
    let mut sets = RingSets::new(layers.cells() + 2);
    let mut winds = false;
    for layer in 0..layers.count {
        for place in (0..layers.width).filter(|&place| holds(layers.cell(layer, place))) {
            let cell = layers.cell(layer, place);
            let (layer, place) = (layer.cast_signed(), place.cast_signed());
            for (to_layer, step) in [(layer, 1), (layer + 1, -1), (layer + 1, 0), (layer + 1, 1)] {
                if let Some(neighbour) = layers.beside(to_layer, place + step).filter(|&cell| holds(cell)) {
                    winds |= sets.join(cell, neighbour, step as i64);
                }
            }
            if !layers.wraps && place == 0 {
                sets.join(cell, first_side, 0);
            }
            if !layers.wraps && place + 1 == layers.width.cast_signed() {
                sets.join(cell, last_side, 0);
            }
        }
    }
    if layers.wraps { winds } else { sets.are_joined(first_side, last_side) }
}

#[cfg(test)]
mod tests;
