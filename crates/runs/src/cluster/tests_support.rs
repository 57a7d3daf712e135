//! Jobs for the tests of this module.

use crate::encoding::ResultKind;
use crate::error::{Error, Result};
use crate::jobs::Job;
use contact_model::Stop;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The square of a number; counts how many were solved.
#[derive(Debug, Clone)]
pub struct Squares {
    number: usize,
    solved: Arc<AtomicUsize>,
}

impl Squares {
    pub fn to(count: usize) -> Vec<Self> {
        let solved = Arc::new(AtomicUsize::new(0));
        (0..count).map(|number| Self { number, solved: Arc::clone(&solved) }).collect()
    }

    pub fn solved(&self) -> usize {
        self.solved.load(Ordering::Relaxed)
    }
}

impl Job for Squares {
    type Output = usize;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("square", 1);

    fn key(&self) -> String {
        format!("the square of {}\n", self.number)
    }

    fn name(&self) -> String {
        format!("the square of {}", self.number)
    }

    fn cost(&self) -> u64 {
        1000
    }

    fn solve(&self, _: Stop<'_>) -> Result<usize> {
        self.solved.fetch_add(1, Ordering::Relaxed);
        Ok(self.number * self.number)
    }
}
