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

/// State of a cell under a tangential load: the values of the map of stick and slip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StickSlip {
    /// The cell is not in contact.
    Open,
    /// It sticks: its traction is below what friction can hold.
    Stick,
    /// It slips: its traction is what friction can hold.
    Slip,
}

impl StickSlip {
    /// All of them, in the order of their values.
    pub const ALL: [Self; 3] = [Self::Open, Self::Stick, Self::Slip];

    /// Its value in the map.
    pub fn value(self) -> f64 {
        match self {
            Self::Open => 0.0,
            Self::Stick => 1.0,
            Self::Slip => 2.0,
        }
    }
}

/// Fields of a state on the cells of its map.
///
/// A field of two components has the component along x (columns) first and that along y (rows) second.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Fields {
    /// Pressure p; negative (a tension) with adhesion only.
    pub pressure: Option<Field>,
    /// Displacement u of the elastic surface under each cell centre.
    pub displacement: Option<Field>,
    /// Gap g = u + z - d; infinite at undefined points. The depth of a plastic indentation is added, so that
    /// it is the gap to the indented surface.
    pub gap: Option<Field>,
    /// Depth of the plastic indentation >= 0.
    pub plastic_depth: Option<Field>,
    /// Tangential traction q on the first body: its integrals are the components of the tangential force.
    pub traction: Option<[Field; 2]>,
    /// Slip s of the second body relative to the first since the cell came into contact; 0 where there is no
    /// contact.
    pub slip: Option<[Field; 2]>,
    /// State of each cell, as [`StickSlip::value`].
    pub stick_slip: Option<Field>,
    /// Pressure of a fluid in the gap; 0 in cells that no edge is connected to. A scene adds it, from the gap.
    pub fluid_pressure: Option<Field>,
    /// Equivalent stress of von Mises below each cell, at the depth where it is largest; of a scene too.
    pub von_mises: Option<Field>,
    /// Equivalent stress of von Mises in a vertical section below the largest one: a row for each depth, from the surface
    /// down; of a scene too.
    pub stress_section: Option<Field>,
    /// Stress below the surface, in layers of the same thickness: the components xx, yy, zz, yz, xz, xy one after the
    /// other, each layer by layer from the surface down; of a scene too.
    pub stress_volume: Option<Vec<Field>>,
    /// Flow of this fluid per width along x and along y, in volume per time and length; of a scene too.
    pub flux: Option<[Field; 2]>,
}

impl Fields {
    /// The field of an output, component by component; empty where the output is no field or was not
    /// requested.
    pub fn get(&self, output: Output) -> &[Field] {
        output.field().map_or(&[], |quantity| (quantity.get)(self))
    }
}

/// A field of a state, with everything that tables, files and pictures need to know about it.
#[derive(Debug, Clone, Copy)]
pub struct FieldQuantity {
    /// Its name in code, scenes, files and Python, which is that of its output.
    pub name: &'static str,
    /// Its name beside a colour bar.
    pub words: &'static str,
    /// Its symbol, in the commands of TeX; may be empty.
    pub symbol: &'static str,
    /// Its unit of SI.
    pub unit: &'static str,
    /// Its meaning, in one sentence.
    pub meaning: &'static str,
    /// Number of components: 1, or 2 along x and y, or the 6 of a stress, each in several layers.
    pub components: usize,
    /// Whether pictures leave zeros white: where there is no contact, there is no pressure.
    pub white_zero: bool,
    /// Whether the sign matters: zero then separates pressures from tensions, or two directions.
    pub signed: bool,
    /// The classes that the values 0, 1, ... stand for; empty for a field of measured values.
    pub classes: &'static [&'static str],
    /// Whether pictures outline the contact in it.
    pub outlined: bool,
    /// Its components among the fields of a state; empty where it was not requested.
    pub get: fn(&Fields) -> &[Field],
    /// Moves its components out of the fields of a state.
    pub take: fn(&mut Fields) -> Vec<Field>,
}

/// Every field of a state, in the order of a report.
pub static FIELDS: &[FieldQuantity] = &[
    FieldQuantity {
        name: "pressure",
        words: "pressure",
        symbol: "p",
        unit: "Pa",
        meaning: "pressure of each cell; negative, a tension, with adhesion only",
        components: 1,
        white_zero: true,
        signed: true,
        classes: &[],
        outlined: false,
        get: |fields| fields.pressure.as_slice(),
        take: |fields| fields.pressure.take().into_iter().collect(),
    },
    FieldQuantity {
        name: "gap",
        words: "gap",
        symbol: "g",
        unit: "m",
        meaning: "gap to the indented surface; infinite at undefined points",
        components: 1,
        white_zero: false,
        signed: false,
        classes: &[],
        outlined: true,
        get: |fields| fields.gap.as_slice(),
        take: |fields| fields.gap.take().into_iter().collect(),
    },
    FieldQuantity {
        name: "plastic_depth",
        words: "plastic indentation",
        symbol: "",
        unit: "m",
        meaning: "depth of the plastic indentation >= 0",
        components: 1,
        white_zero: true,
        signed: false,
        classes: &[],
        outlined: true,
        get: |fields| fields.plastic_depth.as_slice(),
        take: |fields| fields.plastic_depth.take().into_iter().collect(),
    },
    FieldQuantity {
        name: "displacement",
        words: "displacement",
        symbol: "u",
        unit: "m",
        meaning: "displacement of the elastic surface",
        components: 1,
        white_zero: false,
        signed: true,
        classes: &[],
        outlined: true,
        get: |fields| fields.displacement.as_slice(),
        take: |fields| fields.displacement.take().into_iter().collect(),
    },
    FieldQuantity {
        name: "traction",
        words: "tangential traction",
        symbol: "q",
        unit: "Pa",
        meaning: "tangential traction of each cell, along x and along y",
        components: 2,
        white_zero: true,
        signed: false,
        classes: &[],
        outlined: false,
        get: |fields| fields.traction.as_slice().as_flattened(),
        take: |fields| fields.traction.take().into_iter().flatten().collect(),
    },
    FieldQuantity {
        name: "slip",
        words: "slip",
        symbol: "s",
        unit: "m",
        meaning: "slip of the bodies relative to each other since the cell came into contact, along x and along y",
        components: 2,
        white_zero: true,
        signed: false,
        classes: &[],
        outlined: true,
        get: |fields| fields.slip.as_slice().as_flattened(),
        take: |fields| fields.slip.take().into_iter().flatten().collect(),
    },
    FieldQuantity {
        name: "stick_slip",
        words: "stick and slip",
        symbol: "",
        unit: "",
        meaning: "0 where there is no contact, 1 where it sticks, 2 where it slips",
        components: 1,
        white_zero: true,
        signed: false,
        classes: &["open", "stick", "slip"],
        outlined: false,
        get: |fields| fields.stick_slip.as_slice(),
        take: |fields| fields.stick_slip.take().into_iter().collect(),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::work::Work;

    #[test]
    fn fields_have_their_components_and_are_taken_away() {
        let field = |value| Field::new(2, 1.0, vec![value; 4]).unwrap();
        let mut fields = Fields {
            pressure: Some(field(1.0)),
            traction: Some([field(2.0), field(3.0)]),
            slip: Some([field(4.0), field(5.0)]),
            stick_slip: Some(field(StickSlip::Slip.value())),
            ..Fields::default()
        };
        assert_eq!(Work::of(0, Some(&fields)), Work { linear_solves: 0, fields: 6, bytes: 6 * 32 });
        assert_eq!(fields.get(Output::Traction), [field(2.0), field(3.0)]);
        assert!(fields.get(Output::Gap).is_empty() && fields.get(Output::Area).is_empty());
        for quantity in FIELDS {
            let asked = (quantity.get)(&fields).to_vec();
            assert!(asked.is_empty() || asked.len() == quantity.components, "{}", quantity.name);
            assert_eq!((quantity.take)(&mut fields), asked);
        }
        assert_eq!(fields, Fields::default());
        let classes = FIELDS.iter().find(|field| field.name == "stick_slip").unwrap().classes;
        let named = StickSlip::ALL.map(|class| classes[class.value() as usize]);
        assert_eq!((named, classes.len()), (["open", "stick", "slip"], StickSlip::ALL.len()));
    }
}
