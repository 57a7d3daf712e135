//! Fields on the cells of a map.

/// Fields on the cells of the map, row-major, `columns * rows` values each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fields {
    /// Pressure p >= 0.
    pub pressure: Option<Vec<f64>>,
    /// Displacement u of the elastic surface under each cell centre.
    pub displacement: Option<Vec<f64>>,
    /// Gap g = u + z - d; infinite at undefined points.
    pub gap: Option<Vec<f64>>,
}
