//! `manifest.json`: how and where the files of a directory were made.

use crate::error::{Error, Result};
use crate::files;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Writes `manifest.json` into a directory as a whole and returns its path.
///
/// # Errors
/// [`Error::File`] when it cannot be written.
pub fn write_manifest(directory: &Path, content: &Value) -> Result<PathBuf> {
    let path = directory.join("manifest.json");
    let text = serde_json::to_string_pretty(content).map_err(|e| Error::content(&path, e.to_string()))?;
    files::write_whole(&path, (text + "\n").as_bytes())?;
    Ok(path)
}

/// The names of files without their directories.
pub fn file_names(files: &[PathBuf]) -> Vec<String> {
    files.iter().filter_map(|f| Some(f.file_name()?.to_string_lossy().into_owned())).collect()
}

/// Description of the computer, as far as the system provides it.
pub fn machine() -> Value {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let cpu = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|l| l.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let instructions = instructions();
    json!({ "os": std::env::consts::OS, "architecture": std::env::consts::ARCH, "cores": cores, "cpu": cpu, "instructions": instructions })
}

/// The vector instructions of the processor that transforms and factors choose between at run time: results
/// are the same bytes where they are the same.
pub(crate) fn instructions() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    {
        let all = [
            ("sse4.1", std::arch::is_x86_feature_detected!("sse4.1")),
            ("avx", std::arch::is_x86_feature_detected!("avx")),
            ("avx2", std::arch::is_x86_feature_detected!("avx2")),
            ("fma", std::arch::is_x86_feature_detected!("fma")),
            ("avx512f", std::arch::is_x86_feature_detected!("avx512f")),
        ];
        all.into_iter().filter(|(_, has)| *has).map(|(name, _)| name).collect()
    }
    #[cfg(target_arch = "aarch64")]
    return if std::arch::is_aarch64_feature_detected!("neon") { vec!["neon"] } else { Vec::new() };
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    Vec::new()
}
