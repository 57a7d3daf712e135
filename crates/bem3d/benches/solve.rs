//! The kernel, each operator, and one cold solve of each strategy.

use bem3d::{Bem3d, Method, benchmarks, love};
use contact_model::{ContactModel, Load, Scene, SelfAffine, Surface};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn kernel(c: &mut Criterion) {
    c.bench_function("kernel, 256 x 256 lags", |b| {
        b.iter(|| (0..256).map(|y| (0..256).map(|x| love::influence(x, y)).sum::<f64>()).sum::<f64>());
    });
}

/// One application between all cells of a pattern on 512 x 512: one cell in 400 for sums and the two-level operator, all for transforms.
fn applications(c: &mut Criterion) {
    let side = 512;
    let mut group = c.benchmark_group("one application, N = 512");
    group.sample_size(20);
    for (name, step) in [("direct", 400), ("two levels", 400), ("f32", 1), ("f64", 1), ("inverse", 1)] {
        let Some(mut apply) = benchmarks::timed(name, side, step) else { continue };
        group.bench_function(format!("{name}, one cell in {step}"), |b| b.iter(&mut apply));
    }
    group.bench_function("factor of 1000 cells", |b| b.iter(|| benchmarks::factor(side, 1000)));
    group.finish();
}

/// Forces that end in a factored set, in scattered and in dense contact at N = 257, D_f = 2.4, and the same on a single level.
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
                    contact.and_then(|mut contact| contact.solve(Load::Force(black_box(force))))
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, kernel, applications, solves);
criterion_main!(benches);
