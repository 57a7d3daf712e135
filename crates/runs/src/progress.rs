//! What a run tells while it works.

/// Listens to a run. All methods may be called from any thread.
pub trait Progress: Sync {
    /// A stage begins; `total` is its relative cost.
    fn begin(&self, what: &str, total: u64);
    /// A job of this relative cost is done; `reused` when it was found on disk.
    fn advance(&self, cost: u64, reused: bool);
    /// A job of this relative cost has `done` of its `all` states.
    fn states(&self, job: &str, cost: u64, done: usize, all: usize) {
        let _ = (job, cost, done, all);
    }
    /// The stage is over.
    fn end(&self);
    /// Something that the user should know, in whole sentences.
    fn note(&self, text: &str) {
        let _ = text;
    }
}

/// Listens to nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64, _: bool) {}
    fn end(&self) {}
}
