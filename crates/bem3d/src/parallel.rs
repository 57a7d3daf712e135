//! Work in pieces on the threads of the caller's pool.
//!
//! What a piece is depends on sizes alone, each is done by one thread, and what pieces give is put together in their order: no bit of a
//! result depends on the number of threads. The pool is that of `rayon` in which a solve runs; its threads that have nothing else to do help,
//! and none begins another solve while it waits. Without the feature `rayon` there is one thread.

use crate::tuning::SHARE;
#[cfg(feature = "rayon")]
use std::sync::{Mutex, PoisonError};

/// Threads that so much work is worth, in elements of a vector loop.
pub fn threads_for(work: usize) -> usize {
    #[cfg(feature = "rayon")]
    let threads = rayon::current_num_threads();
    #[cfg(not(feature = "rayon"))]
    let threads = 1;
    threads.min(work / SHARE).max(1)
}

/// Does `work` on each piece, on as many threads as there are rooms; each thread has its room.
pub fn for_each<P: Send, R: Send>(
    rooms: &mut [R],
    pieces: impl ExactSizeIterator<Item = P> + Send,
    work: impl Fn(&mut R, P) + Sync,
) {
    let helpers = pieces.len().saturating_sub(1);
    let Some((own, others)) = rooms.split_first_mut() else { return };
    #[cfg(feature = "rayon")]
    if helpers > 0 && !others.is_empty() {
        let queue = Mutex::new(pieces);
        let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
        let go_on = &|room: &mut R| {
            while let Some(piece) = next() {
                work(room, piece);
            }
        };
        rayon::in_place_scope(|scope| {
            for room in others.iter_mut().take(helpers) {
                scope.spawn(move |_| go_on(room));
            }
            go_on(own);
        });
        return;
    }
    let _ = (helpers, others);
    for piece in pieces {
        work(own, piece);
    }
}

/// Does `work` on each piece, where there is so much work in all, and gives the results in the order of the pieces.
pub fn map<P: Send, T: Send + Default>(
    total: usize,
    pieces: impl ExactSizeIterator<Item = P> + Send,
    work: impl Fn(P) -> T + Sync,
) -> Vec<T> {
    let mut results: Vec<T> = Vec::new();
    results.resize_with(pieces.len(), T::default);
    let mut rooms = vec![(); threads_for(total)];
    for_each(&mut rooms, pieces.zip(&mut results), |(), (piece, result)| *result = work(piece));
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_piece_is_done_once_and_results_keep_their_order() {
        for threads in [1, 2, 5] {
            for count in [0, 1, 2, 100] {
                let mut rooms = vec![0_usize; threads];
                let mut done = vec![0; count];
                for_each(&mut rooms, done.iter_mut(), |room, piece| {
                    *room += 1;
                    *piece += 1;
                });
                assert!(done.iter().all(|&times| times == 1), "{threads} threads, {count} pieces");
                assert_eq!(rooms.iter().sum::<usize>(), count);
            }
        }
        assert_eq!(map(usize::MAX, 0..50, |i| i * i), (0..50).map(|i| i * i).collect::<Vec<_>>());
        assert_eq!(threads_for(0), 1);
        assert_eq!(threads_for(2 * SHARE - 1), 1, "half a share is not worth a thread");
    }
}
