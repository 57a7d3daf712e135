//! Memory that control groups allow this process (Linux), by which containers and batch systems limit it.

use std::fs;
use std::path::Path;

/// The files of a group: limit, use, and the name in `memory.stat` of what the kernel takes back first.
const FIRST: [&str; 3] = ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"];
const SECOND: [&str; 3] = ["memory.max", "memory.current", "inactive_file"];

/// Bytes that remain below the limits; `None` without a limit.
pub(crate) fn memory_left() -> Option<u64> {
    memory_left_of(&fs::read_to_string("/proc/self/cgroup").ok()?, Path::new("/sys/fs/cgroup"))
}

/// The same for the groups of a text, `number:controllers:path` in each line, mounted at `root`.
fn memory_left_of(groups: &str, root: &Path) -> Option<u64> {
    let mut left: Option<u64> = None;
    for line in groups.lines() {
        let mut words = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(group)) = (words.next(), words.next()) else { continue };
        let (mount, files) = match controllers {
            "" => (root.to_owned(), SECOND),
            some if some.split(',').any(|name| name == "memory") => (root.join("memory"), FIRST),
            _ => continue,
        };
        // The limits of the groups above count too. In a container the path may be that of the host: its own
        // group is then the root.
        for group in Path::new(group.trim_start_matches('/')).ancestors() {
            if let Some(of_group) = left_in(&mount.join(group), files) {
                left = Some(left.map_or(of_group, |left| left.min(of_group)));
            }
        }
    }
    left
}

/// Bytes that remain in one group.
fn left_in(group: &Path, [limit, used, reclaimed]: [&str; 3]) -> Option<u64> {
    let number = |file: &str| fs::read_to_string(group.join(file)).ok()?.trim().parse::<u64>().ok();
    // Without a limit version 2 has `max`, version 1 the largest whole page.
    let limit = number(limit).filter(|limit| *limit < 1 << 62)?;
    let statistics = fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
    let reclaimed =
        statistics.lines().find_map(|line| line.strip_prefix(reclaimed)?.trim().parse::<u64>().ok());
    Some(limit.saturating_sub(number(used)?.saturating_sub(reclaimed.unwrap_or(0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(at: &Path, files: [&str; 3], values: [&str; 3]) {
        fs::create_dir_all(at).unwrap();
        fs::write(at.join(files[0]), values[0]).unwrap();
        fs::write(at.join(files[1]), values[1]).unwrap();
        fs::write(at.join("memory.stat"), format!("anon 1\n{} {}\n", files[2], values[2])).unwrap();
    }

    #[test]
    fn the_tightest_group_counts() {
        let root = tempfile::tempdir().unwrap();
        group(root.path(), SECOND, ["max\n", "900\n", "0"]);
        group(&root.path().join("job"), SECOND, ["5000\n", "1500\n", "500"]);
        group(&root.path().join("job/step"), SECOND, ["max\n", "1000\n", "0"]);
        let left = |groups: &str| memory_left_of(groups, root.path());
        assert_eq!(left("0::/job/step\n"), Some(4000));
        assert_eq!(left("0::/\n"), None);
        // The path of the host inside a container.
        assert_eq!(left("0::/elsewhere/job\n"), None);
        group(&root.path().join("memory"), FIRST, ["3000\n", "2000\n", "1000"]);
        assert_eq!(left("3:cpu,cpuacct:/a\n4:memory:/a/b\n0::/job\n"), Some(2000));
        group(&root.path().join("memory"), FIRST, ["9223372036854771712\n", "2000\n", "1000"]);
        assert_eq!(left("4:memory:/a/b\n"), None);
        assert_eq!(left("4:memory\nnothing\n"), None);
    }
}
