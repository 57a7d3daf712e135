//! The tractions on the surface of a body, and the body.

use contact_model::{Body, Boundary, Cells, Error, Field, Fields, Pair, Result, Size};

/// Depths and distances beyond this number of sides of a cell are refused: their powers leave the range of
/// f64.
pub(super) const FARTHEST: f64 = 1e60;

/// Which of the two bodies of a contact.
///
/// The traction of a state ([`Fields::traction`]) acts on the first body, and the opposite one on the second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LoadedBody {
    /// The body on which the traction of a state acts as it is.
    #[default]
    First,
    /// The body on which the opposite traction acts.
    Second,
}

/// What acts on the surface of one body: a pressure and, with friction, tangential tractions; constant in
/// each cell.
///
/// ```
/// use contact_model::Field;
/// use interface::stress::SurfaceLoad;
/// let load = SurfaceLoad::new(Field::new(2, 1.0, vec![0.0, 1.0, 2.0, 3.0])?)?;
/// assert_eq!(load.pressure().integral(), 1.5);
/// assert!(load.traction().is_none());
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceLoad {
    pressure: Field,
    traction: Option<[Field; 2]>,
}

impl SurfaceLoad {
    /// A pressure p, positive where it pushes the body in.
    ///
    /// # Errors
    /// [`Error::Domain`] with the first value that is not finite.
    pub fn new(pressure: Field) -> Result<Self> {
        finite("pressure", &pressure)?;
        Ok(Self { pressure, traction: None })
    }

    /// A pressure and the tangential tractions on the body along x and along y, on the same cells.
    ///
    /// # Errors
    /// As [`SurfaceLoad::new`]; [`Error::Shape`] for other cells, and [`Error::Domain`] for another size.
    pub fn with_traction(pressure: Field, traction: [Field; 2]) -> Result<Self> {
        finite("pressure", &pressure)?;
        for (name, field) in ["traction along x", "traction along y"].into_iter().zip(&traction) {
            if field.cells() != pressure.cells() {
                let Cells { columns, rows } = pressure.cells();
                let expected = format!("{rows} rows x {columns} columns, those of the pressure").into();
                return Err(Error::Shape { name: name.into(), found: field.values().len(), expected });
            }
            let (found, expected) = (field.size(), pressure.size());
            for (axis, found, expected) in [("x", found.x, expected.x), ("y", found.y, expected.y)] {
                if found.to_bits() != expected.to_bits() {
                    let name = format!("side along {axis} of the {name}");
                    return Err(Error::domain(name, found, format!("{expected}, that of the pressure")));
                }
            }
            finite(name, field)?;
        }
        Ok(Self { pressure, traction: Some(traction) })
    }

    /// What acts on one body in a state of a contact: its pressure and, if the state has one, its traction.
    ///
    /// # Errors
    /// [`Error::Shape`] without a pressure, which has to be requested of the model; else as
    /// [`SurfaceLoad::with_traction`].
    pub fn of_state(fields: &Fields, body: LoadedBody) -> Result<Self> {
        let Some(pressure) = fields.pressure.clone() else {
            let expected = "those of a map: request the output pressure".into();
            return Err(Error::Shape { name: "pressure".into(), found: 0, expected });
        };
        let Some(mut traction) = fields.traction.clone() else { return Self::new(pressure) };
        if body == LoadedBody::Second {
            for value in traction.iter_mut().flat_map(Field::values_mut) {
                *value = -*value;
            }
        }
        Self::with_traction(pressure, traction)
    }

    /// The pressure.
    pub fn pressure(&self) -> &Field {
        &self.pressure
    }

    /// The tangential tractions along x and along y.
    pub fn traction(&self) -> Option<&[Field; 2]> {
        self.traction.as_ref()
    }

    /// Numbers of columns and rows.
    pub fn cells(&self) -> Cells {
        self.pressure.cells()
    }

    /// Sides of the map.
    pub fn size(&self) -> Size {
        self.pressure.size()
    }

    /// The fields that there are, with the axis along which each acts.
    pub(super) fn components(&self) -> Vec<(usize, &Field)> {
        let tangential = self.traction.iter().flatten().enumerate();
        tangential.chain([(2, &self.pressure)]).collect()
    }

    /// The largest traction in size.
    pub(super) fn largest(&self) -> f64 {
        let values = self.components().into_iter().flat_map(|(_, field)| field.values());
        values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
    }

    /// `c = sqrt(dx dy)`, and the sides of a cell over it.
    pub(super) fn unit(&self) -> (f64, [f64; 2]) {
        let (dx, dy) = (self.pressure.dx(), self.pressure.dy());
        let ratio = (dx / dy).sqrt();
        (dx / ratio, [ratio, ratio.recip()])
    }
}

/// The body whose stress is wanted.
///
/// ```
/// use contact_model::Boundary;
/// use interface::stress::StressedBody;
/// let steel = StressedBody::new(0.3);
/// let repeated = StressedBody { boundary: Boundary::Periodic, ..steel };
/// assert_eq!(steel.boundary, Boundary::Free);
/// # let _ = repeated;
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressedBody {
    /// Poisson's ratio nu in [0, 1/2]. The stress depends on no other constant of the material.
    pub poisson: f64,
    /// Whether the map repeats itself, and along which axes.
    pub boundary: Boundary,
    /// The load between the centres of cells, where the map repeats itself.
    pub periodic: PeriodicLoad,
}

/// The load between the centres of cells, where the map repeats itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PeriodicLoad {
    /// Constant in each cell.
    #[default]
    Cells,
    /// The waves of the grid, two cells long or longer, through the values at the centres.
    Waves,
}

impl StressedBody {
    /// A half-space that is unloaded outside of the map.
    pub fn new(poisson: f64) -> Self {
        Self { poisson, boundary: Boundary::Free, periodic: PeriodicLoad::Cells }
    }

    /// Checks Poisson's ratio.
    ///
    /// # Errors
    /// [`Error::Domain`] unless it is in [0, 1/2].
    pub fn validate(&self) -> Result<()> {
        let body = Body::Elastic { young: 1.0, poisson: self.poisson };
        Pair { first: body, second: Body::Rigid }.contact_modulus().map(|_| ())
    }
}

fn finite(name: &str, field: &Field) -> Result<()> {
    match field.values().iter().position(|value| !value.is_finite()) {
        Some(i) => {
            let (ix, iy) = (i % field.columns(), i / field.columns());
            Err(Error::domain(format!("{name}[{iy}, {ix}]"), field.values()[i], "a finite number"))
        }
        None => Ok(()),
    }
}

/// Checks depths, and returns them in units of c.
pub(super) fn scaled_depths(load: &SurfaceLoad, depths: &[f64]) -> Result<Vec<f64>> {
    let (c, _) = load.unit();
    let scaled = depths.iter().enumerate().map(|(i, &depth)| {
        let name = || format!("depths[{i}]");
        if !(depth.is_finite() && depth >= 0.0) {
            return Err(Error::of_non_negative(name(), depth));
        }
        near(name, depth, depth / c)
    });
    scaled.collect()
}

/// A distance in sides of a cell, unless it is too large.
pub(super) fn near(name: impl Fn() -> String, value: f64, scaled: f64) -> Result<f64> {
    if scaled.abs() <= FARTHEST {
        Ok(scaled)
    } else {
        Err(Error::domain(name(), value, format!("at most {FARTHEST:e} sides of a cell")))
    }
}

/// Checks that memory can be had before work begins. It is not kept.
pub(super) fn check_memory(cells: Cells, bytes: f64) -> Result<()> {
    // A number beyond those of `usize` becomes the largest, which is refused.
    Vec::<u8>::new().try_reserve_exact(bytes as usize).map_err(|_| {
        let Cells { columns, rows } = cells;
        Error::out_of_memory(format!("the stress below a map of {columns} columns x {rows} rows"), bytes)
    })
}
