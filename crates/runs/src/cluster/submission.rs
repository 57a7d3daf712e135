//! Batch scripts for the engines, and their submission.

use super::check::{Completeness, JobState, check};
use super::forecast::{Division, Forecast};
use super::plan::ShardPlan;
use super::shard_run::shards;
use super::status::submitted_tasks;
use super::words::{line, quoted, ranges, shown, toml};
use crate::amounts::duration;
use crate::error::{Error, Result};
use crate::files;
use crate::jobs::JobList;
use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::str::FromStr;

/// A year, and a petabyte: more is a slip of the finger.
#[cfg(feature = "clap")]
const MOST_MINUTES: u64 = 527_040;
#[cfg(feature = "clap")]
const MOST_MEGABYTES: u64 = 1_000_000_000;

/// A system that runs tasks on many machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// SLURM: a job array.
    Slurm,
    /// HyperQueue: a job definition file.
    Hyperqueue,
}

impl Engine {
    /// Its name, in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slurm => "slurm",
            Self::Hyperqueue => "hyperqueue",
        }
    }
}

impl FromStr for Engine {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let all = [Self::Slurm, Self::Hyperqueue];
        all.into_iter()
            .find(|engine| engine.name() == text)
            .ok_or_else(|| Error::parameter("engine", text, "slurm or hyperqueue"))
    }
}

/// Request to an engine.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct Submission {
    /// The engine: slurm or hyperqueue.
    #[cfg_attr(feature = "clap", arg(long))]
    pub engine: Engine,
    /// Time limit of a task in minutes [default: three times the predicted time of the longest one, at least
    /// 10].
    #[cfg_attr(feature = "clap", arg(long = "time", value_name = "MINUTES", value_parser = clap::value_parser!(u64).range(1..=MOST_MINUTES)))]
    pub minutes: Option<u64>,
    /// Memory of a task in megabytes [default: predicted].
    #[cfg_attr(feature = "clap", arg(long = "memory", value_name = "MB", value_parser = clap::value_parser!(u64).range(1..=MOST_MEGABYTES)))]
    pub megabytes: Option<u64>,
    /// Partition (SLURM).
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME"))]
    pub partition: Option<String>,
    /// Account that pays (SLURM).
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME"))]
    pub account: Option<String>,
    /// A further line of the batch script, such as --option=--constraint=avx512; may be given again (SLURM).
    #[cfg_attr(feature = "clap", arg(long = "option", value_name = "OPTION", allow_hyphen_values = true))]
    pub options: Vec<String>,
    /// Submit it, too: without this only the scripts are written.
    #[cfg_attr(feature = "clap", arg(long))]
    pub now: bool,
}

/// What was written, and submitted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Submitted {
    /// The scripts; the last one submits the others.
    pub files: Vec<PathBuf>,
    /// Shards with jobs that are not done.
    pub shards: Vec<usize>,
    /// Jobs that are left to do.
    pub jobs: usize,
    /// The answer of the engine, where it was submitted.
    pub answer: Option<String>,
}

impl fmt::Display for Submitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for file in &self.files {
            writeln!(f, "{}", file.display())?;
        }
        write!(f, "{} jobs to do in {} tasks", self.jobs, self.shards.len())?;
        match (&self.answer, self.files.last()) {
            (Some(answer), _) => write!(f, "; submitted: {}", answer.trim()),
            (None, Some(script)) => write!(f, "; submit with: bash {}", quoted(&script.to_string_lossy())),
            _ => Ok(()),
        }
    }
}

/// The program, its directory of results and how its jobs are divided.
pub(crate) struct SubmittedProgram<'a> {
    /// The program that the tasks run: a built binary.
    pub binary: &'a Path,
    /// Directory of the results.
    pub out: &'a Path,
    /// The plan.
    pub plan: &'a ShardPlan,
    /// Its jobs.
    pub jobs: &'a dyn JobList,
}

impl Submission {
    /// Writes the scripts of this program into `OUT/slurm` or `OUT/hyperqueue`, for the shards with jobs that
    /// are neither done nor, according to the engine, running or waiting; submits them on request. Returns
    /// the forecast and the list of files, in words. Without a number of tasks, that of an earlier submission
    /// is kept.
    ///
    /// # Errors
    /// [`Error::Parameter`] where nothing is left to do, for paths that a script cannot hold, and with what the
    /// engine said where it refuses; [`Error::File`] for files that cannot be written or read.
    pub fn submit(
        &self,
        plan: &ShardPlan,
        jobs: &dyn JobList,
        out: &Path,
        division: &Division,
        forecast: &dyn Fn(&Division) -> Forecast,
    ) -> Result<String> {
        files::create_directory(out)?;
        let found = check(plan, jobs, out)?;
        let tasks = division.tasks.or_else(|| submitted_tasks(out, plan));
        let forecast = forecast(&Division { tasks, ..division.clone() });
        let binary = std::env::current_exe().map_err(Error::file("find", Path::new("this program")))?;
        let submitted =
            self.write(&SubmittedProgram { binary: &binary, out, plan, jobs }, &forecast, &found)?;
        Ok(format!("{forecast}\n{submitted}"))
    }

    /// The same with a forecast and a program that are given.
    pub(crate) fn write(
        &self,
        target: &SubmittedProgram<'_>,
        forecast: &Forecast,
        found: &Completeness,
    ) -> Result<Submitted> {
        let SubmittedProgram { out, plan, jobs, .. } = *target;
        let of = shards(jobs, forecast.tasks);
        plan.write(out)?;
        let busy = super::status::busy(out, plan, forecast.tasks)?;
        let left: Vec<usize> = (0..of.len()).filter(|&job| found.states[job] != JobState::Done).collect();
        let wanted: BTreeSet<usize> =
            left.iter().filter_map(|&job| of[job]).filter(|shard| !busy.contains(shard)).collect();
        if left.is_empty() {
            let expected = format!("jobs to do; all are done: {} merge --out {}", plan.program, shown(out));
            return Err(Error::parameter("out", out.display(), expected));
        }
        if wanted.is_empty() {
            let expected = "shards that are not queued; the engine has all of those that are left";
            return Err(Error::parameter("out", out.display(), expected));
        }
        let shards: Vec<usize> = wanted.into_iter().collect();
        let directory = out.join(self.engine.name());
        files::create_directory(&directory)?;
        let script = Script::new(self, target, forecast, &directory)?;
        let texts = match self.engine {
            Engine::Slurm => script.slurm(&shards),
            Engine::Hyperqueue => script.hyperqueue(&shards),
        };
        let mut submitted = Submitted { files: Vec::new(), shards, jobs: left.len(), answer: None };
        for (name, text) in texts {
            let path = directory.join(name);
            files::write_whole(&path, text.as_bytes())?;
            submitted.files.push(path);
        }
        if self.now
            && let Some(last) = submitted.files.last()
        {
            submitted.answer = Some(run(last)?);
        }
        Ok(submitted)
    }
}

/// Runs a script that submits.
fn run(script: &Path) -> Result<String> {
    // A name that begins with a dash is no option.
    let script = &std::fs::canonicalize(script).map_err(Error::file("find", script))?;
    let done = Command::new("bash").arg(script).output().map_err(Error::file("run", script))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if done.status.success() {
        return Ok(text(&done.stdout));
    }
    let expected = format!("an engine that takes it; {} said: {}", script.display(), text(&done.stderr));
    Err(Error::parameter("engine", "submission", expected))
}

/// Parts of all scripts, as text.
struct Script<'a> {
    submission: &'a Submission,
    plan: &'a ShardPlan,
    forecast: &'a Forecast,
    directory: String,
    /// Where it was submitted: relative paths of the command begin there.
    here: String,
    /// The task's command and the merge's.
    task: Vec<String>,
    merge: Vec<String>,
    minutes: u64,
    megabytes: u64,
}

impl<'a> Script<'a> {
    fn new(
        submission: &'a Submission,
        target: &SubmittedProgram<'a>,
        forecast: &'a Forecast,
        directory: &Path,
    ) -> Result<Self> {
        // Tasks begin elsewhere.
        let absolute = |path: &Path| -> Result<String> {
            let path = std::fs::canonicalize(path).map_err(Error::file("find", path))?;
            let text =
                path.to_str().filter(|text| !text.contains(|c: char| c.is_control() || "\"\\%".contains(c)));
            let expected = "a path in UTF-8 without control characters, \", \\ and %, which engines read in their own ways";
            text.map(str::to_owned).ok_or_else(|| {
                Error::parameter("path", format!("{:?}", path.display().to_string()), expected)
            })
        };
        // They stand in a comment of the script, too.
        if let Some(word) = target.plan.arguments.iter().find(|word| word.contains(char::is_control)) {
            return Err(Error::parameter(
                "command",
                format!("{word:?}"),
                "words without control characters, for a script",
            ));
        }
        let (binary, out) = (absolute(target.binary)?, absolute(target.out)?);
        for word in
            [&submission.partition, &submission.account].into_iter().flatten().chain(&submission.options)
        {
            if word.is_empty() || word.contains(|c: char| c.is_control()) {
                return Err(Error::parameter(
                    "option",
                    format!("{word:?}"),
                    "one line without control characters, for --partition, --account or --option",
                ));
            }
        }
        let mut task = vec![binary.clone()];
        task.extend(target.plan.arguments.iter().cloned());
        task.extend(["--out".to_owned(), out.clone()]);
        let merge =
            vec![binary, "merge".into(), "--out".into(), out, "--plan".into(), target.plan.digest.clone()];
        Ok(Self {
            submission,
            plan: target.plan,
            forecast,
            directory: absolute(directory)?,
            here: absolute(Path::new("."))?,
            task,
            merge,
            minutes: submission.minutes.unwrap_or_else(|| forecast.minutes()),
            megabytes: submission.megabytes.unwrap_or_else(|| forecast.megabytes()),
        })
    }

    fn comment(&self, shards: usize) -> String {
        let Forecast { jobs, tasks, seconds: [total, longest, _], .. } = self.forecast;
        format!(
            "# {}\n# {jobs} jobs in {tasks} shards, {shards} of them here; predicted: {:.2} core-hours, the longest shard {}.\n",
            self.plan.command(),
            total / 3600.0,
            duration(*longest)
        )
    }

    /// An array, a merge after it whatever becomes of it (it says what is missing), and what submits both.
    fn slurm(&self, shards: &[usize]) -> Vec<(&'static str, String)> {
        let Self { submission, directory, minutes, megabytes, .. } = self;
        let count = self.forecast.tasks;
        let mut common = String::new();
        for (name, value) in [("partition", &submission.partition), ("account", &submission.account)] {
            if let Some(value) = value {
                common += &format!("#SBATCH --{name}={value}\n");
            }
        }
        for option in &submission.options {
            common += &format!("#SBATCH {option}\n");
        }
        let task = format!(
            "#!/bin/bash\n{}#SBATCH --job-name=fractal-contact\n#SBATCH --array={}\n#SBATCH --ntasks=1\n\
             #SBATCH --cpus-per-task={}\n#SBATCH --mem={megabytes}M\n#SBATCH --time={minutes}\n\
             #SBATCH --output=\"{directory}/shard-%a.%A.log\"\n{common}\
             cd {} || exit\n# exec: signals of SLURM go to the program itself.\n\
             exec {} --shard \"$SLURM_ARRAY_TASK_ID/{count}\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
            self.comment(shards.len()),
            ranges(shards),
            self.forecast.cores,
            quoted(&self.here),
            line(&self.task),
        );
        let merge = format!(
            "#!/bin/bash\n{}#SBATCH --job-name=fractal-contact-merge\n#SBATCH --ntasks=1\n#SBATCH --mem={}M\n\
             #SBATCH --time={minutes}\n#SBATCH --output=\"{directory}/merge.%j.log\"\n{common}cd {} || exit\nexec {}\n",
            self.comment(shards.len()),
            megabytes.max(&1000),
            quoted(&self.here),
            line(&self.merge),
        );
        let noted = quoted(&format!("../.units/plans/{}.submitted", self.plan.digest));
        let submit = format!(
            "#!/bin/bash\n# Submits the shards and, after them, the merge; remembers the job for `status`. Both or none.\nset -euo pipefail\n\
             cd {}\nnumber() {{ [[ $1 =~ ^[0-9]+$ ]] || {{ echo \"sbatch answered no number: '$1'\" >&2; exit 1; }}; }}\n\
             shards=$(sbatch --parsable shards.sh)\nshards=${{shards%%;*}}\nnumber \"$shards\"\n\
             if ! merge=$(sbatch --parsable --dependency=\"afterany:$shards\" merge.sh); then\n    \
             scancel \"$shards\"\n    echo \"the merge was refused, and job $shards is cancelled\" >&2\n    exit 1\nfi\n\
             merge=${{merge%%;*}}\necho \"slurm $shards {count}\" >> {noted}\n\
             echo \"SLURM jobs $shards (shards) and $merge (merge)\"\n",
            quoted(directory),
        );
        vec![("shards.sh", task), ("merge.sh", merge), ("submit.sh", submit)]
    }

    /// One job whose last task, the merge, depends on the others.
    fn hyperqueue(&self, shards: &[usize]) -> Vec<(&'static str, String)> {
        let Self { directory, minutes, megabytes, .. } = self;
        let count = self.forecast.tasks;
        let cores = self.forecast.cores;
        let mut job = self.comment(shards.len());
        job += &format!(
            "# A task needs about {megabytes} MB: on workers that count memory add \"mem\" = {megabytes} to the resources.\n"
        );
        job += "name = \"fractal-contact\"\n";
        let mut add = |id: usize, name: String, command: &[String], deps: String| {
            let words: Vec<String> = command.iter().map(|word| toml(word)).collect();
            let log = |end: &str| toml(&format!("{directory}/{name}.%{{JOB_ID}}.{end}"));
            job += &format!(
                "\n[[task]]\nid = {id}\ncommand = [{}]\ncwd = {}\nstdout = {}\nstderr = {}\ntime_limit = \"{minutes}m\"\n{deps}\
                 [[task.request]]\nresources = {{ \"cpus\" = \"{cores}\" }}\n",
                words.join(", "),
                toml(&self.here),
                log("out"),
                log("log"),
            );
        };
        for &shard in shards {
            let mut command = self.task.clone();
            let threads = cores.to_string();
            command.extend(["--shard".into(), format!("{shard}/{count}"), "--threads".into(), threads]);
            add(shard, format!("shard-{shard}"), &command, String::new());
        }
        let deps: Vec<String> = shards.iter().map(usize::to_string).collect();
        add(count, "merge".into(), &self.merge, format!("deps = [{}]\n", deps.join(", ")));
        let submit = format!(
            "#!/bin/bash\n# Submits the shards and the merge that depends on them; remembers the job for `status`.\nset -euo pipefail\n\
             cd {}\njob=$(hq --output-mode quiet job submit-file job.toml)\necho \"hyperqueue $job {count}\" >> {}\n\
             echo \"HyperQueue job $job\"\n",
            quoted(directory),
            quoted(&format!("../.units/plans/{}.submitted", self.plan.digest)),
        );
        vec![("job.toml", job), ("submit.sh", submit)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cluster::tests_support::Squares;
    use crate::cluster::{Division, ShardRun, check, run_shard};
    use crate::{Shard, Silent};
    use contact_model::never;

    fn submission(engine: Engine) -> Submission {
        Submission {
            engine,
            minutes: None,
            megabytes: None,
            partition: Some("long".into()),
            account: None,
            options: vec!["--constraint=avx512".into()],
            now: false,
        }
    }

    #[test]
    fn words_for_shells_and_ranges_for_engines() {
        assert_eq!(ranges(&[0, 1, 2, 5, 7, 8]), "0-2,5,7-8");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!((quoted(""), quoted("/a/b-1.0,2")), ("''".into(), "/a/b-1.0,2".into()));
        assert_eq!(toml("a\"b\\\n"), "\"a\\\"b\\\\\\u000a\"");
        assert!("pbs".parse::<Engine>().unwrap_err().to_string().ends_with("expected slurm or hyperqueue"));
    }

    /// Six jobs in three shards, of which the second is done, in a directory whose name shells read in their own way.
    struct SubmittedSquares {
        folder: tempfile::TempDir,
        out: PathBuf,
        squares: Vec<Squares>,
        plan: ShardPlan,
    }

    impl SubmittedSquares {
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            let out = folder.path().join("it's out");
            std::fs::create_dir(&out).unwrap();
            let squares = Squares::to(6);
            let plan = ShardPlan::new("p", vec!["squares".into()], &squares);
            let submitted = Self { folder, out, squares, plan };
            submitted.run(1);
            submitted
        }

        fn run(&self, index: usize) {
            let shard = Shard { index, count: 3 };
            run_shard(
                &self.plan,
                &self.squares,
                shard,
                ShardRun { out: &self.out, threads: 1, progress: &Silent, stop: &never },
            )
            .unwrap();
        }

        fn write(&self, engine: Engine) -> Result<Submitted> {
            self.write_for(engine, &self.plan, &self.out)
        }

        /// Writes the scripts of another plan, or for another directory.
        fn write_for(&self, engine: Engine, plan: &ShardPlan, out: &Path) -> Result<Submitted> {
            let binary = std::env::current_exe().unwrap();
            let target = SubmittedProgram { binary: &binary, out, plan, jobs: &self.squares };
            let forecast = Forecast::new(&self.squares, &Division { tasks: Some(3), cores: None });
            let found = check(plan, &self.squares, out).unwrap();
            submission(engine).write(&target, &forecast, &found)
        }
    }

    fn texts(submitted: &Submitted) -> Vec<String> {
        submitted.files.iter().map(|file| std::fs::read_to_string(file).unwrap()).collect()
    }

    #[test]
    fn scripts_of_slurm_name_what_is_left() {
        let squares = SubmittedSquares::new();
        let slurm = squares.write(Engine::Slurm).unwrap();
        assert_eq!((slurm.shards.clone(), slurm.jobs), (vec![0, 2], 4));
        assert!(slurm.to_string().contains("4 jobs to do in 2 tasks; submit with: bash '"), "{slurm}");
        let texts = texts(&slurm);
        for part in [
            "#SBATCH --array=0,2\n",
            "#SBATCH --partition=long\n",
            "#SBATCH --constraint=avx512\n",
            "#SBATCH --time=10\n",
            "--shard \"$SLURM_ARRAY_TASK_ID/3\"",
            r"it'\''s out' --shard",
        ] {
            assert!(texts[0].contains(part), "{part}: {}", texts[0]);
        }
        assert!(texts[1].contains(" merge --out ") && texts[2].contains("afterany:$shards"));
    }

    #[test]
    fn a_job_of_hyperqueue_names_what_is_left() {
        let squares = SubmittedSquares::new();
        let job = texts(&squares.write(Engine::Hyperqueue).unwrap()).remove(0);
        assert!(job.contains("\"--shard\", \"2/3\"") && job.contains("deps = [0, 2]"), "{job}");
    }

    /// Nothing is written that a shell or an engine would read in its own way.
    #[test]
    fn words_that_scripts_cannot_hold_are_refused() {
        let squares = SubmittedSquares::new();
        let hostile = ShardPlan::new("p", vec!["x\ntouch y".into()], &squares.squares);
        let refused = squares.write_for(Engine::Slurm, &hostile, &squares.out).unwrap_err().to_string();
        assert!(refused.starts_with("command = \"x\\ntouch y\""), "{refused}");
        let odd = squares.folder.path().join("a%j");
        std::fs::create_dir(&odd).unwrap();
        let refused = squares.write_for(Engine::Slurm, &squares.plan, &odd).unwrap_err().to_string();
        assert!(refused.starts_with("path = "), "{refused}");
    }

    #[test]
    fn shells_find_no_mistake_in_scripts() {
        let squares = SubmittedSquares::new();
        let [slurm, queue] = [Engine::Slurm, Engine::Hyperqueue].map(|engine| squares.write(engine).unwrap());
        // The job of HyperQueue is no script.
        for script in slurm.files.iter().chain(queue.files.last()) {
            assert!(Command::new("bash").arg("-n").arg(script).status().unwrap().success());
        }
    }

    #[test]
    fn nothing_is_submitted_when_all_jobs_are_done() {
        let squares = SubmittedSquares::new();
        squares.run(0);
        squares.run(2);
        let done = squares.write(Engine::Slurm).unwrap_err().to_string();
        assert!(done.contains("all are done: p merge --out"), "{done}");
    }
}
