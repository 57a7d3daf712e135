//! In a process of its own: the memory of other tests would count.

#![allow(clippy::unwrap_used)] // Helpers of tests; clippy.toml allows it in the tests themselves.

use fractal_contact::{Bem3d, ContactModel, Load, Outputs, Scene, SelfAffine, Surface, runs};

/// So many loads on surfaces of 17 x 17 cells, a hundred on each.
fn solve(count: usize) {
    let model = Bem3d { cells: 17, ..Bem3d::default() };
    let outputs = Outputs { stiffness: true, area: true, pressure: true, ..Outputs::default() };
    let surface = Surface::SelfAffine(SelfAffine::new(2.3, 1.0, 0.01).unwrap());
    let scene = Scene { outputs, ..Scene::new(surface, 1.0) };
    for seed in 0..count as u64 / 100 {
        let mut contact = model.prepare(&scene, seed).unwrap();
        for i in 0..100 {
            contact.solve(Load::force(1e-4 * 1.1_f64.powi(i % 60))).unwrap();
        }
    }
}

#[test]
fn ten_thousand_solves_keep_memory_flat() {
    solve(1000);
    let Some(before) = runs::resident_memory() else { return };
    solve(10_000);
    let grown = runs::resident_memory().unwrap().saturating_sub(before);
    assert!(grown < 2 << 20, "{grown} bytes");
}
