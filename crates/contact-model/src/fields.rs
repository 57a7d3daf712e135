//! Fields on the cells of a map.

use crate::cells::{Cells, Size};
use crate::quantities::Output;

/// One number per cell of a rectangle, row-major (`values[iy * columns + ix]`: rows along y, as NPY arrays
/// `[row, column]`).
///
/// ```
/// use contact_model::Field;
/// let field = Field::new([3, 2], [6.0, 1.0], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0])?;
/// assert_eq!((field.columns(), field.rows(), field.dx(), field.dy()), (3, 2, 2.0, 0.5));
/// assert_eq!((field.at(2, 1), field.row(1)), (5.0, &[3.0, 4.0, 5.0][..]));
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    pub(crate) cells: Cells,
    pub(crate) size: Size,
    pub(crate) values: Vec<f64>,
}

impl Field {
    /// Numbers of columns and rows.
    pub fn cells(&self) -> Cells {
        self.cells
    }

    /// Number of columns, along x.
    pub fn columns(&self) -> usize {
        self.cells.columns
    }

    /// Number of rows, along y.
    pub fn rows(&self) -> usize {
        self.cells.rows
    }

    /// Sides of the rectangle.
    pub fn size(&self) -> Size {
        self.size
    }

    /// Side of one cell along x.
    pub fn dx(&self) -> f64 {
        self.size.x / self.cells.columns as f64
    }

    /// Side of one cell along y.
    pub fn dy(&self) -> f64 {
        self.size.y / self.cells.rows as f64
    }

    /// The values, row-major.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The values, row-major, to be changed.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The values, row-major, without a copy.
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// The value of cell (ix, iy); panics outside the map, as indexing does.
    pub fn at(&self, ix: usize, iy: usize) -> f64 {
        self.row(iy)[ix]
    }

    /// One row; panics outside the map, as indexing does.
    pub fn row(&self, iy: usize) -> &[f64] {
        &self.values[iy * self.cells.columns..][..self.cells.columns]
    }

    /// Integral over the rectangle, `sum values dx dy`: of a pressure the force.
    pub fn integral(&self) -> f64 {
        self.values.iter().sum::<f64>() * self.dx() * self.dy()
    }
}

/// Fields of a state on the cells of its map.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Fields {
    /// Pressure p; negative (a tension) with adhesion only.
    pub pressure: Option<Field>,
    /// Displacement u of the elastic surface under each cell centre.
    pub displacement: Option<Field>,
    /// Gap g = u + z - d; infinite at undefined points. Over a plastic indentation its depth is added: the
    /// gap to the indented surface.
    pub gap: Option<Field>,
    /// Depth of the plastic indentation >= 0.
    pub plastic_depth: Option<Field>,
}

impl Fields {
    /// The field of an output; `None` for an output that is no field, and where it was not asked for.
    pub fn get(&self, output: Output) -> Option<&Field> {
        output.field().and_then(|quantity| (quantity.get)(self))
    }
}

/// Which cell of a block stands for it, where a field is shown on fewer points than it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// That of the largest value, so that a single cell under pressure is seen; zero is no value worth a
    /// colour.
    Largest,
    /// That of the smallest value, so that a single cell without a gap is seen.
    Smallest,
    /// The one in the middle.
    Middle,
}

/// A field: all that is said of it anywhere.
#[derive(Debug, Clone, Copy)]
pub struct FieldQuantity {
    /// Its name in code, scenes, files and Python: that of its output.
    pub name: &'static str,
    /// What it is called beside a colour bar.
    pub words: &'static str,
    /// Its symbol, in the commands of TeX; may be empty.
    pub symbol: &'static str,
    /// Its unit of SI.
    pub unit: &'static str,
    /// What it is, in one sentence.
    pub meaning: &'static str,
    /// Which cell is shown.
    pub shown: Shown,
    /// Whether pictures outline the contact in it.
    pub outlined: bool,
    /// It among the fields of a state.
    pub get: fn(&Fields) -> Option<&Field>,
    /// Takes it away from the fields of a state.
    pub take: fn(&mut Fields) -> Option<Field>,
}

/// Every field of a state, in the order of a report.
pub static FIELDS: &[FieldQuantity] = &[
    FieldQuantity {
        name: "pressure",
        words: "pressure",
        symbol: "p",
        unit: "Pa",
        meaning: "pressure of each cell; negative, a tension, with adhesion only",
        shown: Shown::Largest,
        outlined: false,
        get: |fields| fields.pressure.as_ref(),
        take: |fields| fields.pressure.take(),
    },
    FieldQuantity {
        name: "gap",
        words: "gap",
        symbol: "g",
        unit: "m",
        meaning: "gap to the indented surface; infinite at undefined points",
        shown: Shown::Smallest,
        outlined: true,
        get: |fields| fields.gap.as_ref(),
        take: |fields| fields.gap.take(),
    },
    FieldQuantity {
        name: "plastic_depth",
        words: "plastic indentation",
        symbol: "",
        unit: "m",
        meaning: "depth of the plastic indentation >= 0",
        shown: Shown::Largest,
        outlined: true,
        get: |fields| fields.plastic_depth.as_ref(),
        take: |fields| fields.plastic_depth.take(),
    },
    FieldQuantity {
        name: "displacement",
        words: "displacement",
        symbol: "u",
        unit: "m",
        meaning: "displacement of the elastic surface",
        shown: Shown::Middle,
        outlined: true,
        get: |fields| fields.displacement.as_ref(),
        take: |fields| fields.displacement.take(),
    },
];

impl Output {
    /// The field that it asks for, where it is one.
    pub fn field(self) -> Option<&'static FieldQuantity> {
        FIELDS.iter().find(|field| field.name == self.name())
    }

    /// Whether it is a field over the cells.
    pub fn is_field(self) -> bool {
        self.field().is_some()
    }
}
