//! Text for standard output and standard error that never ends in a panic.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write as _};

/// What a shell reports of a program that SIGPIPE has ended.
const BROKEN_PIPE: i32 = 141;

/// Writes a line to standard output, for programs.
///
/// Where nobody reads it any more (`... | head -1`), the process ends quietly with the exit code 141, as if by SIGPIPE; where it cannot
/// be written (a full device), with a message and 1. Files are written whole, so that nothing half-written stays.
#[macro_export]
macro_rules! out {
    ($($text:tt)*) => { $crate::print(format_args!("{}\n", format_args!($($text)*))) };
}

/// Writes a line to standard error, for programs; where that is closed or full the line is lost, and what is computed goes on.
#[macro_export]
macro_rules! err {
    ($($text:tt)*) => { $crate::print_error(format_args!("{}\n", format_args!($($text)*))) };
}

/// [`out!`](crate::out) without the end of the line.
pub fn print(text: Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_fmt(text).and_then(|()| out.flush()) {
        if error.kind() != ErrorKind::BrokenPipe {
            print_error(format_args!("error: cannot write to standard output: {error}\n"));
            std::process::exit(1);
        }
        std::process::exit(BROKEN_PIPE);
    }
}

/// [`err!`](crate::err) without the end of the line.
pub fn print_error(text: Arguments<'_>) {
    let _ = std::io::stderr().lock().write_fmt(text);
}
