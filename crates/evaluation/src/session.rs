//! The start and the end of every command.

use crate::outcome::Outcome;
use crate::run::Run;
use runs::{Result, Store, files};
use std::time::Instant;

/// The directory, made and cleaned, and the clock.
#[derive(Debug)]
pub struct Session {
    /// The result store of the directory.
    pub store: Store,
    start: Instant,
}

impl Session {
    /// Makes and cleans the directory of a run and opens its store.
    ///
    /// # Errors
    /// [`runs::Error::File`] where the system refuses.
    pub fn open(run: &Run) -> Result<Self> {
        let start = Instant::now();
        files::create_directory(&run.out)?;
        files::clean(&run.out)?;
        Ok(Self { store: Store::open(&run.out, run.fresh)?, start })
    }

    /// Enters the seconds since [`Session::open`].
    ///
    /// # Errors
    /// None; the result ends the chain of `?` of each command.
    #[allow(clippy::unnecessary_wraps)]
    pub fn close(&self, mut outcome: Outcome) -> Result<Outcome> {
        outcome.seconds = self.start.elapsed().as_secs_f64();
        Ok(outcome)
    }
}
