//! The stress in one plane below the surface.

use super::invariants::von_mises;
use contact_model::{Cells, Field, Result, Size};

/// The stress at the centres of all cells of a map, at one depth. Tension is positive.
///
/// ```
/// use contact_model::{Field, never};
/// use interface::stress::{StressedBody, SurfaceLoad, stress_at_depths};
/// let load = SurfaceLoad::new(Field::new(4, 1.0, vec![1.0; 16])?)?;
/// let planes = stress_at_depths(&load, StressedBody::new(0.3), &[0.0, 0.5], &never)?;
/// // Under the surface sigma_zz is the pressure, and it falls with the depth.
/// assert!((planes[0].zz().at(1, 2) + 1.0).abs() < 1e-13);
/// assert!((-1.0..-0.5).contains(&planes[1].zz().at(1, 2)));
/// assert_eq!(planes[1].at(1, 2)[2], planes[1].zz().at(1, 2));
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StressField {
    depth: f64,
    components: [Field; 6],
}

impl StressField {
    pub(super) fn new(depth: f64, cells: Cells, size: Size, components: [Vec<f64>; 6]) -> Result<Self> {
        let [xx, yy, zz, yz, xz, xy] = components.map(|values| Field::new(cells, size, values));
        Ok(Self { depth, components: [xx?, yy?, zz?, yz?, xz?, xy?] })
    }

    /// The depth z >= 0.
    pub fn depth(&self) -> f64 {
        self.depth
    }

    /// The fields of the components xx, yy, zz, yz, xz, xy.
    pub fn components(&self) -> &[Field; 6] {
        &self.components
    }

    /// The same without a copy.
    pub fn into_components(self) -> [Field; 6] {
        self.components
    }

    /// Normal stress along x.
    pub fn xx(&self) -> &Field {
        &self.components[0]
    }

    /// Normal stress along y.
    pub fn yy(&self) -> &Field {
        &self.components[1]
    }

    /// Normal stress along z, which is `-p` at the surface.
    pub fn zz(&self) -> &Field {
        &self.components[2]
    }

    /// Shear stress in the plane of y and z, which is minus the traction along y at the surface.
    pub fn yz(&self) -> &Field {
        &self.components[3]
    }

    /// Shear stress in the plane of x and z, which is minus the traction along x at the surface.
    pub fn xz(&self) -> &Field {
        &self.components[4]
    }

    /// Shear stress in the plane of x and y.
    pub fn xy(&self) -> &Field {
        &self.components[5]
    }

    /// All components in cell (ix, iy); panics outside the map, as indexing does.
    pub fn at(&self, ix: usize, iy: usize) -> [f64; 6] {
        std::array::from_fn(|component| self.components[component].at(ix, iy))
    }

    /// Von Mises' equivalent stress of each cell ([`von_mises`]).
    ///
    /// # Errors
    /// [`contact_model::Error::OutOfMemory`] where the map cannot be had.
    pub fn von_mises(&self) -> Result<Field> {
        let (cells, size) = (self.components[0].cells(), self.components[0].size());
        super::load::check_memory(cells, cells.map_bytes())?;
        Field::new(cells, size, self.stresses().map(|stress| von_mises(&stress)).collect())
    }

    /// The largest equivalent stress of von Mises, and the column and row of the first cell that has it.
    pub fn largest_von_mises(&self) -> (f64, [usize; 2]) {
        let columns = self.components[0].columns();
        let mut largest = (0.0, [0, 0]);
        for (i, stress) in self.stresses().enumerate() {
            let value = von_mises(&stress);
            if value > largest.0 {
                largest = (value, [i % columns, i / columns]);
            }
        }
        largest
    }

    fn stresses(&self) -> impl Iterator<Item = [f64; 6]> + '_ {
        let [xx, yy, zz, yz, xz, xy] = self.components.each_ref().map(Field::values);
        (0..xx.len()).map(move |i| [xx[i], yy[i], zz[i], yz[i], xz[i], xy[i]])
    }
}
