//! Time, memory and work.

/// What a run costs, or will cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cost {
    /// Seconds of one thread.
    pub seconds: f64,
    /// Memory of one thread at the peak, bytes; 0 where nothing to speak of.
    pub memory: f64,
    /// Applications of the elastic operator.
    pub applications: f64,
    /// Linear systems solved.
    pub linear_solves: f64,
    /// Fields over the grid.
    pub fields: f64,
    /// Their bytes.
    pub field_bytes: f64,
}
