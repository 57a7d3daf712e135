//! How does the real contact area grow with the force, and what do shorter waves change? One question is asked three
//! times, each time with shorter waves, and the areas are read from the states.
//!
//! `cargo run --release -p fractal-contact --example area_over_force -- DIRECTORY`
//!
//! ```text
//! waves a side   contact area over A0 under F_bar = 0.01, 0.03, 0.1, 0.3
//!            4   0.0053  0.0118  0.0323  0.0754
//!            8   0.0040  0.0091  0.0244  0.0643
//!           16   0.0028  0.0069  0.0205  0.0517
//! ```

use fractal_contact::scenes::{Question, SceneFile, jobs_of_scenes, solve_jobs};
use runs::{Silent, Store};
use std::path::PathBuf;

const QUESTION: &str = r#"
[scene]
units = "none"
models = ["bem3d"]
contact_modulus = 1
force_bar = [0.01, 0.03, 0.1, 0.3]

[scene.surface]
kind = "self_affine"
side = 1
hurst = 0.8
rms_height = 0.01

[outputs]
area = true

[models.bem3d]
cells = 128

[sampling]
seed = 1
surfaces = 4
"#;

/// Waves along a side at the end of the spectrum.
const BANDWIDTHS: [f64; 3] = [4.0, 8.0, 16.0];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from).join("area-over-force");
    std::fs::create_dir_all(&out)?;
    let scene = |waves: f64| {
        let mut question = Question::parse(QUESTION)?;
        question.set("scene.surface.shortest_wavelength", &(1.0 / waves).to_string())?;
        SceneFile::of(question, &out.join(format!("{waves} waves a side")))
    };
    let scenes = BANDWIDTHS.into_iter().map(scene).collect::<Result<Vec<_>, _>>()?;
    let jobs = jobs_of_scenes(&scenes, &out);
    let states = solve_jobs("area over force", &jobs, &Store::open(&out, false)?, 2, &Silent)?;
    // Mean share of the area in contact, by bandwidth and force.
    let mut means = [[0.0; 4]; BANDWIDTHS.len()];
    for (job, states) in jobs.iter().zip(&states) {
        for (load, mean) in means[job.scene()].iter_mut().enumerate() {
            let (state, normalisation) = states.state(load)?;
            *mean += state.area.map_or(f64::NAN, |area| normalisation.contact_fraction(area)) / 4.0;
        }
    }
    println!("waves a side   contact area over A0 under F_bar = 0.01, 0.03, 0.1, 0.3");
    for (waves, means) in BANDWIDTHS.iter().zip(means) {
        println!("{waves:>12}   {}", means.map(|mean| format!("{mean:.4}")).join("  "));
    }
    assert!(means.windows(2).all(|pair| pair[0].iter().zip(pair[1]).all(|(long, short)| *long > short)));
    Ok(())
}
