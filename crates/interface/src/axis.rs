//! The axis between opposite edges, and a map seen along it.

use contact_model::{Boundary, Cells, Error, Field, Result};

/// The most cells of a map: indices of the nine entries of each cell fit into 32 bits.
const LARGEST_MAP: f64 = 4e8;

/// The axis along which something leads from one edge of a map to the opposite one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlowAxis {
    /// From the first column to the last one.
    X,
    /// From the first row to the last one.
    Y,
}

impl FlowAxis {
    /// The other axis.
    #[must_use]
    pub fn across(self) -> Self {
        match self {
            Self::X => Self::Y,
            Self::Y => Self::X,
        }
    }
}

/// The cells of a map in layers: a layer has all cells at one place along the axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layers {
    /// The axis.
    pub axis: FlowAxis,
    /// Number of layers, along the axis.
    pub count: usize,
    /// Number of cells in a layer.
    pub width: usize,
    /// Distance in memory between a cell and that of the next layer, and between neighbours in a layer.
    pub strides: [usize; 2],
    /// Whether the first and the last cell of a layer are neighbours.
    pub wraps: bool,
    /// Side of a cell along the axis and across it.
    pub sides: [f64; 2],
}

impl Layers {
    pub fn new(map: &Field, axis: FlowAxis, boundary: Boundary) -> Self {
        let [repeats_x, repeats_y] = boundary.repeats();
        let (columns, rows) = (map.columns(), map.rows());
        match axis {
            FlowAxis::X => Self {
                axis,
                count: columns,
                width: rows,
                strides: [1, columns],
                wraps: repeats_y,
                sides: [map.dx(), map.dy()],
            },
            FlowAxis::Y => Self {
                axis,
                count: rows,
                width: columns,
                strides: [columns, 1],
                wraps: repeats_x,
                sides: [map.dy(), map.dx()],
            },
        }
    }

    /// Extent across the axis over that along it.
    pub fn ratio(&self) -> f64 {
        let [along, across] = self.sides;
        self.width as f64 * across / (self.count as f64 * along)
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.count * self.width
    }

    /// Index in memory of the cell at this place of this layer.
    pub fn cell(&self, layer: usize, place: usize) -> usize {
        layer * self.strides[0] + place * self.strides[1]
    }

    /// Layer of a cell, and its place there.
    pub fn place(&self, cell: usize) -> [usize; 2] {
        if self.strides[0] == 1 {
            [cell % self.count, cell / self.count]
        } else {
            [cell / self.width, cell % self.width]
        }
    }

    /// The cell at a place and layer that may lie outside of the map by one; none where the map ends there.
    pub fn beside(&self, layer: isize, place: isize) -> Option<usize> {
        let (layers, width) = (self.count.cast_signed(), self.width.cast_signed());
        if layer < 0 || layer >= layers {
            return None;
        }
        let inside = (0..width).contains(&place);
        (inside || self.wraps).then(|| self.cell(layer as usize, place.rem_euclid(width) as usize))
    }

    /// The neighbours over the four faces of a cell: before and behind it in its layer, then in the layer
    /// before and in the next one.
    pub fn neighbours(&self, cell: usize) -> [Option<usize>; 4] {
        let [layer, place] = self.place(cell).map(usize::cast_signed);
        [
            self.beside(layer, place - 1),
            self.beside(layer, place + 1),
            self.beside(layer - 1, place),
            self.beside(layer + 1, place),
        ]
    }
}

/// An error where the memory cannot be had that a map needs with so many bytes for each cell, or where a cell
/// has no index of 32 bits with room for four faces each.
///
/// # Errors
/// [`Error::OutOfMemory`].
pub(crate) fn check_memory(cells: Cells, bytes_per_cell: f64) -> Result<()> {
    let count = cells.columns as f64 * cells.rows as f64;
    let bytes = bytes_per_cell * count;
    // A number beyond those of `usize` becomes the largest, which is refused.
    if count <= LARGEST_MAP && Vec::<u8>::new().try_reserve_exact(bytes as usize).is_ok() {
        return Ok(());
    }
    let Cells { columns, rows } = cells;
    Err(Error::out_of_memory(format!("the flow through a map of {columns} columns x {rows} rows"), bytes))
}
