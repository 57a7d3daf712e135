//! `fractal-contact-web-bindings INPUT.wasm OUT`: writes `fractal_contact.js`, a script without modules, and
//! `fractal_contact_bg.wasm` into a folder. `cargo xtask web` runs it.

use std::process::ExitCode;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let [input, out] = match std::env::args().skip(1).collect::<Vec<_>>().try_into() {
        Ok(arguments) => arguments,
        Err(given) => {
            eprintln!("expected the file of the WebAssembly and a folder, given {given:?}");
            return ExitCode::from(2);
        }
    };
    let mut bindgen = Bindgen::new();
    let made = bindgen.input_path(&input).out_name("fractal_contact").typescript(false).no_modules(true);
    match made.and_then(|bindgen| bindgen.generate(&out)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{input}: {error:#}");
            ExitCode::FAILURE
        }
    }
}
