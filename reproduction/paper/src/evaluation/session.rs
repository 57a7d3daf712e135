//! The start and the end of every command.

use crate::evaluation::outcome::Outcome;
use runs::{Result, Store, files};
use std::path::Path;
use std::time::Instant;

/// The directory of the results, and the clock of the command.
#[derive(Debug)]
pub struct Session {
    /// The result store of the directory.
    pub store: Store,
    start: Instant,
}

impl Session {
    /// Creates and cleans a directory of results and opens its store; `fresh` removes the stored results.
    ///
    /// # Errors
    /// [`runs::Error::File`] where the system refuses.
    pub fn open(out: &Path, fresh: bool) -> Result<Self> {
        let start = Instant::now();
        files::create_directory(out)?;
        files::clean(out)?;
        Ok(Self { store: Store::open(out, fresh)?, start })
    }

    /// Adds the seconds since [`Session::open`] to an outcome.
    ///
    /// # Errors
    /// Never; it returns a result for convenience at the end of a command.
    #[allow(clippy::unnecessary_wraps)]
    pub fn close(&self, mut outcome: Outcome) -> Result<Outcome> {
        outcome.seconds = self.start.elapsed().as_secs_f64();
        Ok(outcome)
    }
}
