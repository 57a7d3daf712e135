//! Seconds of planning and of one solve of 512 x 512 cells, once for each line of standard input: for `benchmarks/overhead.py`.

use fractal_contact::{Bem3d, ContactModel, Error, Load, Scene, SelfAffine, Surface, surface_gen};
use std::io::Write as _;
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Error> {
    let rough = SelfAffine::new(2.2, 1.0, 0.01)?;
    let map = Arc::new(surface_gen::self_affine_map(&rough, 512, surface_gen::surface_seed(1, 0))?);
    let scene = Scene::new(Surface::Heights(map), 1.0);
    for _ in std::io::stdin().lines() {
        let start = Instant::now();
        let mut contact = Bem3d { tolerance: 1e-8, ..Bem3d::default() }.prepare(&scene, 0)?;
        let state = contact.solve(Load::force(0.01))?;
        println!("{} {}", start.elapsed().as_secs_f64(), state.stiffness.unwrap_or(f64::NAN));
        let _ = std::io::stdout().flush();
    }
    Ok(())
}
