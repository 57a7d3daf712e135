//! Answers to flags and commands that there are not: what was meant by them, in the words of what was typed.

use crate::arguments::flag_of;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use fractal_contact::scenes::{meant_by_flag, scene_keys};

/// Other words for commands, and what does their work.
const COMMANDS: &[(&[&str], &str)] = &[
    (
        &["statistics", "stats", "roughness", "spectrum", "psd", "hurst", "parameters"],
        "`fractal-contact info MAP --out DIR` writes the statistics of a map",
    ),
    (
        &["resume", "continue", "restart", "go-on"],
        "the same `fractal-contact run SCENE`, with the same --out, goes on where it was stopped",
    ),
    (
        &["solve", "simulate", "compute", "start", "calculate"],
        "`fractal-contact run SCENE` computes a scene, and `fractal-contact press MAP` the contact of a map",
    ),
    (&["contact", "indent"], "`fractal-contact press MAP` computes the contact of a map"),
    (&["generate", "make", "create"], "`fractal-contact surface FILE --seed 1` generates a random surface"),
    (
        &["show", "describe", "read", "open", "inspect", "view"],
        "`fractal-contact info FILE` describes a scene, a surface or results",
    ),
    (
        &["plot", "draw", "picture", "report"],
        "`run` and `press` draw their pictures and write report.html into the folder of the results",
    ),
    (
        &["accuracy", "error"],
        "`fractal-contact press MAP --accuracy '1 %'` or `accuracy = \"1 %\"` in [scene] choose the grid by the error",
    ),
    (
        &["convert", "export"],
        "`fractal-contact info MAP --json` prints the heights of a map; `press` and `run` write fields as NPY, PNG or VTI",
    ),
    (&["version"], "`fractal-contact --version`"),
    (&["check", "validate", "dry-run"], "`fractal-contact plan SCENE` checks a scene and computes nothing"),
];

/// The answer to a command line that clap refuses, where more can be said than clap does.
pub fn answer(error: &clap::Error, command: &clap::Command, words: &[String]) -> Option<String> {
    let of = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::InvalidSubcommand => unknown_command(of(ContextKind::InvalidSubcommand)?, command, words),
        ErrorKind::UnknownArgument => {
            let typed = of(ContextKind::InvalidArg)?;
            let name = words.iter().find(|word| !word.starts_with('-'))?;
            let called = command.find_subcommand(name)?;
            if typed.starts_with("--") {
                Some(unknown_flag(typed, called, command))
            } else {
                extra_word(typed, words)
            }
        }
        _ => None,
    }
}

fn unknown_command(typed: &str, command: &clap::Command, words: &[String]) -> Option<String> {
    let after_help = words.first().is_some_and(|word| word == "help");
    let other = COMMANDS.iter().find(|(others, _)| others.contains(&typed.to_lowercase().as_str()));
    let near = || {
        let names = command.get_subcommands().map(clap::Command::get_name);
        let close = |name: &&str| strsim::damerau_levenshtein(name, typed) <= 1 + typed.len() / 4;
        names.filter(close).min_by_key(|name| strsim::damerau_levenshtein(name, typed))
    };
    let help = match other {
        Some((_, instead)) => (*instead).to_owned(),
        None if after_help => format!("did you mean `fractal-contact help {}`?", near()?),
        None => format!("did you mean `fractal-contact {}`?", near()?),
    };
    Some(format!("error: there is no command `{typed}`\n  = help: {help}"))
}

fn unknown_flag(typed: &str, called: &clap::Command, command: &clap::Command) -> String {
    let flag = typed.split('=').next().unwrap_or(typed);
    let name = called.get_name();
    let presses = ["press", "new"].contains(&name);
    let has = |command: &clap::Command| {
        command.get_arguments().any(|argument| argument.get_long() == Some(flag.trim_start_matches('-')))
    };
    let near = || {
        let flags = called.get_arguments().filter(|of| !of.is_hide_set()).filter_map(clap::Arg::get_long);
        let bare = flag.trim_start_matches('-');
        let close = |name: &&str| {
            strsim::damerau_levenshtein(name, bare) <= 1 + bare.len() / 4
                || bare.len() > 3 && name.starts_with(bare)
        };
        let found = flags.filter(close).min_by_key(|name| strsim::damerau_levenshtein(name, bare))?;
        Some(format!("did you mean `--{found}`?"))
    };
    let others: Vec<&str> =
        command.get_subcommands().filter(|of| has(of)).map(clap::Command::get_name).collect();
    let of_others =
        (!others.is_empty() && !presses).then(|| format!("it is a flag of `{}`", others.join("`, `")));
    let of_scene = || {
        let key = scene_keys().into_iter().find(|key| flag_of(key.name) == flag)?;
        Some(format!("a scene says it itself, with `{}` in [{}]", key.name, key.table))
    };
    let help = match near() {
        Some(near) => Some(near),
        None if presses => meant_by_flag(flag),
        None if ["run", "plan"].contains(&name) => {
            let both: Vec<String> = of_others.into_iter().chain(of_scene()).collect();
            Some(both.join("; ")).filter(|words| !words.is_empty())
        }
        None => of_others,
    };
    let all = format!("`fractal-contact {name} --help` lists the flags");
    let help = help.unwrap_or(all);
    format!("error: `{name}` has no flag `{flag}`\n  = help: {help}")
}

/// A word that no flag takes, such as the unit of a value without quotation marks.
fn extra_word(typed: &str, words: &[String]) -> Option<String> {
    let at = words.iter().position(|word| word == typed)?;
    let before = words.get(at.checked_sub(1)?)?;
    let flag = words[..at].iter().rev().find(|word| word.starts_with("--"))?;
    let is_value = before.parse::<f64>().is_ok() || before == "rigid";
    // All words up to the next flag.
    let first = words.iter().position(|word| word == flag)? + 1;
    let whole: Vec<&str> =
        words[first..].iter().take_while(|word| !word.starts_with("--")).map(String::as_str).collect();
    let whole = whole.join(" ");
    is_value.then(|| {
        format!(
            "error: unexpected `{typed}` after `{flag} {before}`\n  = help: a value with blanks stands in quotation marks: `{flag} '{whole}'`"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(line: &str) -> String {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let command = crate::arguments::command();
        let all = std::iter::once("fractal-contact".to_owned()).chain(words.iter().cloned());
        let error = command.clone().try_get_matches_from(all).unwrap_err();
        answer(&error, &command, &words).unwrap()
    }

    #[test]
    fn flags_and_commands_that_there_are_not_lead_to_those_that_there_are() {
        for (line, expected) in [
            ("press map.txt --load 1", "`--force '1 N'`"),
            ("press map.txt --young 1", "`--bodies"),
            ("press map.txt --E 210e9", "`--bodies"),
            ("press map.txt --output area", "did you mean `--outputs`?"),
            ("press map.txt --leakage", "the leakage is requested by `--set"),
            ("press map.txt --rms-height 1", "`--set 'scene.surface.rms_height=VALUE'`"),
            ("run scene.toml --mean-gap 1", "a scene says it itself, with `mean_gap` in [scene]"),
            ("press map.txt --nonsense 1", "`fractal-contact press --help` lists the flags"),
            ("press map.txt --bodies 210 GPa 0.3, rigid --force 1", "`--bodies '210 GPa 0.3, rigid'`"),
            ("run scene.toml --accuracy 1", "it is a flag of `press`, `new`"),
            ("statistics map.txt", "`fractal-contact info MAP --out DIR`"),
            ("resume out/scene", "goes on where it was stopped"),
            ("pres map.txt", "did you mean `fractal-contact press`?"),
            ("help pres", "did you mean `fractal-contact help press`?"),
        ] {
            assert!(told(line).contains(expected), "{line}: {}", told(line));
        }
    }
}
