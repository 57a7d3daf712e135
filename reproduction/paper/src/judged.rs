//! The outcome of a command of the paper.

use crate::claim::Claim;
use crate::evaluation::Outcome;
use std::ops::Deref;

/// The outcome of a command, with the statements of the paper that its numbers can judge.
#[derive(Debug, Clone)]
pub struct Judged {
    outcome: Outcome,
    /// The paper's claims, compared with the numbers found here.
    pub claims: Vec<Claim>,
}

impl Judged {
    /// An outcome with these claims.
    pub fn new(outcome: Outcome, claims: Vec<Claim>) -> Self {
        Self { outcome, claims }
    }

    /// The outcome without its claims.
    pub fn into_outcome(self) -> Outcome {
        self.outcome
    }
}

impl From<Outcome> for Judged {
    fn from(outcome: Outcome) -> Self {
        Self::new(outcome, Vec::new())
    }
}

impl Deref for Judged {
    type Target = Outcome;

    fn deref(&self) -> &Outcome {
        &self.outcome
    }
}
