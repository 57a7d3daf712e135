//! Benchmarks of the parts that take most of the time: the kernel, one application of each operator, one load
//! solved from a cold start in sparse and in dense contact with each strategy, a sweep of loads, and a step
//! of a path with adhesion.
//!
//! `cargo bench -p benches -- --save-baseline before` on one commit and `-- --baseline before` on
//! another compare both; run them one after the other on an idle machine. `-- --quick` only shows that they
//! run.

use bem3d::{Bem3d, Method, benchmarks, love};
use contact_model::{
    Adhesion, AdhesionLaw, Boundary, ContactModel, Load, Scene, SelfAffine, Step, Surface, never,
};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn kernel(c: &mut Criterion) {
    c.bench_function("kernel, 256 x 256 lags", |b| {
        b.iter(|| (0..256).map(|y| (0..256).map(|x| love::influence(x, y)).sum::<f64>()).sum::<f64>());
    });
}

/// One application between all cells of a pattern on 512 x 512: one cell in 400 for sums and the two-level
/// operator, all for transforms.
fn applications(c: &mut Criterion) {
    let side = 512;
    let mut group = c.benchmark_group("one application, N = 512");
    group.sample_size(20);
    for (name, step) in
        [("direct", 400), ("two levels", 400), ("two transforms", 1), ("f32", 1), ("f64", 1), ("inverse", 1)]
    {
        let Some(mut apply) = benchmarks::timed(name, side, step) else { continue };
        group.bench_function(format!("{name}, one cell in {step}"), |b| b.iter(&mut apply));
    }
    group.bench_function("factor of 1000 cells", |b| b.iter(|| benchmarks::factor(side, 1000)));
    group.finish();
}

/// Cold solves at N = 257, D_f = 2.4 whose contact is small enough to be factored, scattered or dense, and
/// the same without coarser grids.
fn solves(c: &mut Criterion) {
    let Ok(surface) = SelfAffine::new(2.4, 1.0, 1.0) else { return };
    let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    let mut group = c.benchmark_group("cold solve with stiffness, N = 257, D_f = 2.4, 1e-6");
    group.sample_size(10);
    for method in [Method::Auto, Method::Iterative, Method::SingleLevel] {
        for force in [1e-3, 3e-2, 1.0, 20.0] {
            group.bench_with_input(BenchmarkId::new(format!("{method:?}"), force), &force, |b, &force| {
                b.iter(|| {
                    let contact = Bem3d { method, ..Bem3d::default() }.prepare(&scene, 1);
                    contact.and_then(|mut contact| contact.solve(Load::force(black_box(force))))
                });
            });
        }
    }
    group.finish();
}

/// Twelve loads from first touch to nearly full contact on one surface, prepared anew for each measurement.
fn sweep(c: &mut Criterion) {
    let Ok(surface) = SelfAffine::new(2.4, 1.0, 1.0) else { return };
    let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    let loads: Vec<Load> = (0..12).map(|i| Load::force(1e-4 * 2e5_f64.powf(f64::from(i) / 11.0))).collect();
    let mut group = c.benchmark_group("sweep with stiffness, N = 257, D_f = 2.4, 1e-6");
    group.sample_size(10);
    group.bench_function("F = 1e-4 .. 20 in 12 loads", |b| {
        b.iter(|| {
            let mut contact = Bem3d::default().prepare(&scene, 1)?;
            contact.sweep(black_box(&loads), &never, &mut |_, state| state.map(drop))
        });
    });
    group.finish();
}

/// A step up and one down of a path in contact, with the exponential law on a periodic surface of rms height
/// 0.01.
fn adhesive_step(c: &mut Criterion) {
    let Ok(surface) = SelfAffine::new(2.2, 1.0, 0.01) else { return };
    let surface = SelfAffine { roll_off: Some(4.0 * std::f64::consts::TAU), ..surface };
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    scene.effects.boundary = Boundary::Periodic;
    scene.effects.adhesion = Adhesion::FiniteRange { work: 5e-6, range: 1e-3, law: AdhesionLaw::Exponential };
    let step = |force| Step::new(0.0, Load::force(force));
    let Ok(mut contact) = Bem3d { cells: 128, ..Bem3d::default() }.prepare(&scene, 1) else { return };
    for force in [0.01, 0.012, 0.01] {
        let state = contact.advance(step(force));
        assert!(state.is_ok(), "no state at F = {force}: {:?}", state.err());
    }
    let mut group = c.benchmark_group("two adhesive steps, N = 128, exponential law, 1e-6");
    group.sample_size(10);
    group.bench_function("F = 0.01, 0.012, 0.01", |b| {
        b.iter(|| {
            contact.advance(step(black_box(0.012)))?;
            contact.advance(step(black_box(0.01)))
        });
    });
    group.finish();
}

criterion_group!(benches, kernel, applications, solves, sweep, adhesive_step);
criterion_main!(benches);
