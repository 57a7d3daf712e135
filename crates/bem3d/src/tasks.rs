//! Tasks that threads share until a stop says to leave the rest.

use contact_model::{Interrupted, Stop};
use numerics::parallel::{for_each_until, threads_for};

/// Does `work` on each task, on as many threads as there are buffers.
///
/// # Errors
/// [`Interrupted`] where the stop left tasks undone. It is asked before each task: a task is never left inside.
pub fn for_each<T: Send, B: Send>(
    buffers: &mut [B],
    tasks: impl ExactSizeIterator<Item = T> + Send,
    stop: Stop<'_>,
    work: impl Fn(&mut B, T) + Sync,
) -> Result<(), Interrupted> {
    if for_each_until(buffers, tasks, &|| stop.stops(), work) { Ok(()) } else { Err(Interrupted) }
}

/// The same without buffers; the total amount of work, in elements of a vector loop, decides the number of threads.
///
/// # Errors
/// As [`for_each`].
pub fn each<T: Send>(
    total: usize,
    tasks: impl ExactSizeIterator<Item = T> + Send,
    stop: Stop<'_>,
    work: impl Fn(T) + Sync,
) -> Result<(), Interrupted> {
    for_each(&mut vec![(); threads_for(total)], tasks, stop, |(), task| work(task))
}
