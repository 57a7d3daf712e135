//! The start and the end of every command.

use crate::error::Result;
use crate::files;
use crate::outcome::Outcome;
use crate::run::Run;
use crate::store::Store;
use std::time::Instant;

/// The directory, made and cleaned, and the clock.
pub(crate) struct Session {
    pub(crate) store: Store,
    start: Instant,
}

impl Session {
    pub(crate) fn open(run: &Run) -> Result<Self> {
        let start = Instant::now();
        files::create_directory(&run.out)?;
        files::clean(&run.out)?;
        Ok(Self { store: Store::open(&run.out, run.fresh)?, start })
    }

    #[allow(clippy::unnecessary_wraps)] // Ends the chain of `?` of each figure.
    pub(crate) fn close(&self, mut outcome: Outcome) -> Result<Outcome> {
        outcome.seconds = self.start.elapsed().as_secs_f64();
        Ok(outcome)
    }
}
