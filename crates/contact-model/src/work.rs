//! The work done for a state, as counts that do not depend on a clock.

use crate::fields::{FIELDS, Fields};
use std::ops::AddAssign;

/// Work beyond iterations and applications of the operator. Closed forms do none.
///
/// Outputs that are not requested add nothing: without fields, `fields` and `bytes` are 0, and without the
/// stiffness its `linear_solves` are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Work {
    /// Linear systems solved on the grid itself: factors made and runs of an iteration.
    pub linear_solves: usize,
    /// Number of fields over the whole grid that the state holds; each component counts.
    pub fields: usize,
    /// Bytes of these fields.
    pub bytes: usize,
}

impl Work {
    /// The work of this number of linear solves and of the fields of a state.
    ///
    /// ```
    /// use contact_model::{Field, Fields, Work};
    /// let mut fields = Fields::default();
    /// fields.gap = Some(Field::new(3, 1.0, vec![0.0; 9])?);
    /// assert_eq!(Work::of(2, Some(&fields)), Work { linear_solves: 2, fields: 1, bytes: 72 });
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn of(linear_solves: usize, fields: Option<&Fields>) -> Self {
        let mut work = Self { linear_solves, ..Self::default() };
        if let Some(fields) = fields {
            for field in FIELDS.iter().flat_map(|quantity| (quantity.get)(fields)) {
                work.fields += 1;
                work.bytes += size_of_val(field.values());
            }
        }
        work
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        let Self { linear_solves, fields, bytes } = other;
        self.linear_solves += linear_solves;
        self.fields += fields;
        self.bytes += bytes;
    }
}
