//! Measurements of this process by the operating system; absent where there are none.

use crate::cgroup;
use crate::error::{Error, Result};
use contact_model::units::{number, rounded};
use std::borrow::Cow;
use std::fmt;
use std::fs;
use std::time::Duration;

/// Processor seconds of this thread (Linux).
///
/// The kernel brings the number up to date when the thread leaves the processor, so it sleeps first, for some
/// ten microseconds.
pub fn cpu_seconds() -> Option<f64> {
    std::thread::sleep(Duration::from_micros(1));
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<u64>().ok().map(|ns| ns as f64 * 1e-9)
}

/// Processor seconds of all threads of the process that are alive (Linux).
pub fn process_cpu_seconds() -> Option<f64> {
    std::thread::sleep(Duration::from_micros(1));
    let tasks = fs::read_dir("/proc/self/task").ok()?;
    let of = |task: std::io::Result<fs::DirEntry>| -> Option<u64> {
        let text = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok()
    };
    Some(tasks.filter_map(of).sum::<u64>() as f64 * 1e-9)
}

/// Resets [`peak_memory`] where the system allows it; else it still counts from the start of the process.
pub fn reset_peak_memory() {
    // 5: the peak becomes what is resident now (proc(5), clear_refs).
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Largest resident memory of the process, in bytes (Linux).
pub fn peak_memory() -> Option<u64> {
    memory("VmHWM:")
}

/// Memory that the system could give to this process now, in bytes (Linux); less where the address space of
/// the process or the memory of its control group is limited.
pub fn available_memory() -> Option<u64> {
    let there = memory_in("/proc/meminfo", "MemAvailable:")?;
    Some([address_space(), cgroup::memory_left()].into_iter().flatten().fold(there, u64::min))
}

/// Refuses work that needs more memory than is available. Where the system gives no number, everything is
/// accepted.
///
/// # Errors
/// [`contact_model::Error::OutOfMemory`] with both numbers; `what` names the size.
pub fn check_memory(what: impl Into<Cow<'static, str>>, bytes: f64) -> contact_model::Result<()> {
    match available_memory().map(|bytes| bytes as f64) {
        Some(available) if bytes > available => {
            Err(contact_model::Error::OutOfMemory { what: what.into(), bytes, available: Some(available) })
        }
        _ => Ok(()),
    }
}

/// Address space that a limit (`ulimit -v`) leaves to this process, in bytes; `None` without a limit.
pub(crate) fn address_space() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|l| l.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(memory("VmSize:")?))
}

/// Address space, not memory, that a thread reserves: twice the largest cache for products of matrices
/// (`private-gemm-x86`), and 128 MB for the arena of its allocator.
fn reserved_by_thread() -> u64 {
    let cache = fs::read_to_string("/sys/devices/system/cpu/cpu0/cache/index3/size").unwrap_or_default();
    let kilobytes = cache.trim().strip_suffix('K').and_then(|k| k.parse::<u64>().ok()).unwrap_or(32 << 10);
    2 * 1024 * kilobytes + (1 << 27)
}

/// Number of jobs of a given size that fit into memory at the same time, at most `threads`. Under a limit of
/// the address space, the reservation of each thread counts too.
///
/// # Errors
/// [`Error::Parameter`] where a single job needs more memory than is available; `name` and `value` are the
/// parameter that decides its size. Where the system gives no number, every number of threads is accepted.
pub fn threads_for_memory(
    threads: usize,
    bytes: f64,
    name: &'static str,
    value: impl fmt::Display,
) -> Result<usize> {
    let Some(available) = available_memory().map(|bytes| bytes as f64) else { return Ok(threads) };
    let each = if address_space().is_some() { bytes + reserved_by_thread() as f64 } else { bytes };
    if each > available {
        // Two digits would often be the same for both.
        let [needed, there] = [each, available].map(|bytes| number(rounded(1e-9 * bytes, 3)));
        let expected =
            format!("a size that fits in memory (it needs about {needed} GB, {there} GB are available)");
        return Err(Error::parameter(name, value, expected));
    }
    Ok(((available / each) as usize).clamp(1, threads.max(1)))
}

/// Resident memory of the process now, in bytes (Linux).
pub fn resident_memory() -> Option<u64> {
    memory("VmRSS:")
}

fn memory(field: &str) -> Option<u64> {
    memory_in("/proc/self/status", field)
}

fn memory_in(file: &str, field: &str) -> Option<u64> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix(field))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kb| 1024 * kb)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn work_and_memory_are_seen() {
        let cpu = cpu_seconds().unwrap();
        let before = peak_memory().unwrap();
        let block: Vec<u64> = (0..1 << 20).collect();
        assert!(std::hint::black_box(&block).iter().sum::<u64>() > 0);
        assert!(cpu_seconds().unwrap() > cpu && process_cpu_seconds().unwrap() >= cpu);
        assert!(before > 0 && peak_memory().is_some() && resident_memory().is_some());
        reset_peak_memory();
    }

    #[test]
    fn what_needs_more_than_there_is_is_refused() {
        assert!(check_memory("a small map", 1e3).is_ok());
        let refused = check_memory("a map", 1e18).unwrap_err().to_string();
        assert!(refused.starts_with("a map: needs about 1.0e9 GB of memory, "), "{refused}");
        assert!(refused.ends_with(" GB are available"), "{refused}");
    }

    #[test]
    fn no_more_threads_than_memory() {
        let available = available_memory().unwrap() as f64;
        assert_eq!(threads_for_memory(4, 1.0, "cells", 9).unwrap(), 4);
        assert_eq!(threads_for_memory(4, 0.4 * available, "cells", 9).unwrap(), 2);
        let refused = threads_for_memory(4, 2.0 * available, "cells", 9).unwrap_err().to_string();
        assert!(
            refused.starts_with("cells = 9: expected a size that fits in memory (it needs about"),
            "{refused}"
        );
    }
}
