//! What was done for a state, in counts that no clock changes.

use std::ops::AddAssign;

/// Work beyond iterations and applications of the operator. Closed forms do none.
///
/// What is not asked for adds nothing: without fields `fields` and `bytes` are 0, without the stiffness its `linear_solves` are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Linear systems that were solved: factors made and runs of an iteration.
    pub linear_solves: usize,
    /// Fields over the whole grid that the state holds.
    pub fields: usize,
    /// Their bytes.
    pub bytes: usize,
}

impl Work {
    /// The work of one more field of so many values.
    pub fn add_field(&mut self, values: usize) {
        self.fields += 1;
        self.bytes += values * size_of::<f64>();
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
