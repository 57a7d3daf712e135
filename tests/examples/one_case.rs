//! Solves one hard case of the registry and prints why it is hard, what is asserted and what was found.
//!
//! `cargo run -p tests --example one_case -- NAME` (without a name: a checkerboard)
//!
//! ```text
//! a checkerboard (one of 61)
//! hard because: all black cells touch together; the kernel is nearest to singular at this wave
//! asserted: light loads: black cells only, F and k by relaxation and elimination; heavy: k of full contact
//! passed: largest deviation 2.2e-12, bound 1e-8
//! ```

use std::error::Error;
use tests::stability::{Effort, cases};

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "a checkerboard".to_owned());
    let all = cases();
    let Some(case) = all.iter().find(|case| case.name == name) else {
        let names: Vec<&str> = all.iter().map(|case| case.name).collect();
        return Err(format!("{name} is none of: {}", names.join("; ")).into());
    };
    println!("{} (one of {})", case.name, all.len());
    println!("hard because: {}", case.why);
    println!("asserted: {}", case.asserted);
    let verdict = case.run(Effort::Quick);
    let figure = verdict.figure.map_or_else(|| "none".to_owned(), |f| format!("{f:.1e}"));
    println!("{}: largest deviation {figure}, bound {:.0e}", verdict.status(), case.bound);
    verdict.broken.iter().for_each(|broken| println!("broken: {broken}"));
    assert!(verdict.passed());
    Ok(())
}
