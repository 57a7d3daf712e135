//! A scene from text, answered by two models, and its table read back.
//!
//! `cargo run -p fractal-contact --example scene -- DIRECTORY`
//!
//! ```text
//!  model    F in N  k in N/um  status
//!  bem3d     1.000      4.372  converged
//!  bem3d    10.000     20.372  converged
//!  bem3d   100.000     68.277  converged
//!  mdr1d     1.000      4.122  converged
//!  mdr1d    10.000     22.173  converged
//!  mdr1d   100.000     81.400  converged
//! ```

use fractal_contact::never;
use fractal_contact::scenes::{Options, Plan, Result, SceneFile, run};
use runs::{CsvFile, Silent};
use std::path::PathBuf;

const SCENE: &str = r#"
[scene]
models = ["bem3d", "mdr1d"]
contact_modulus = "100 GPa"
force_bar = [0.01, 0.1, 1.0]

[scene.surface]
kind = "self_affine"
fractal_dimension = 2.4
rms_height = "1 um"
side = "1 mm"

[models.bem3d]
cells = 129

[sampling]
seed = 1

[outputs]
stiffness = true
"#;

fn main() -> Result<()> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from).join("scene");
    let scene = SceneFile::parse("rough.toml".as_ref(), SCENE.into())?;
    let options = Options { out, threads: 1, fresh: false };
    let outcome = run(&scene, &Plan::new(&scene)?, &options, &Silent, &never)?;
    let table = CsvFile::read(&outcome.files[0])?;
    let (models, force) = (table.texts("model")?, table.numbers("force")?);
    let (stiffness, status) = (table.numbers("stiffness")?, table.texts("status")?);
    println!("{:>6} {:>9} {:>10}  status", "model", "F in N", "k in N/um");
    for i in 0..models.len() {
        let (f, k) = (force[i].unwrap_or(0.0), stiffness[i].unwrap_or(0.0) * 1e-6);
        println!("{:>6} {f:>9.3} {k:>10.3}  {}", models[i], status[i]);
        assert_eq!(status[i], "converged");
    }
    Ok(())
}
