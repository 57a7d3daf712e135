//! Connected contact areas.

/// The connected areas of a contact, the largest first; together they are the real contact area.
///
/// Two cells belong to one patch when they share an edge (four neighbours; a common corner has no length that
/// could carry anything).
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Patches {
    areas: Vec<f64>,
}

impl Patches {
    /// Patches of these areas, in any order.
    ///
    /// ```
    /// let patches = contact_model::Patches::new(vec![1.0, 3.0]);
    /// assert_eq!((patches.count(), patches.areas()), (2, [3.0, 1.0].as_slice()));
    /// ```
    pub fn new(mut areas: Vec<f64>) -> Self {
        areas.sort_by(|a, b| b.total_cmp(a));
        Self { areas }
    }

    /// Number of patches.
    pub fn count(&self) -> usize {
        self.areas.len()
    }

    /// Their areas, the largest first.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }
}
