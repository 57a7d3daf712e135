//! The kernel and one cold solve of each strategy.

use bem3d::{Bem3d, love};
use contact_model::{ContactModel, Load, Scene, SelfAffine, Surface};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn kernel(c: &mut Criterion) {
    c.bench_function("kernel, 256 x 256 lags", |b| {
        b.iter(|| (0..256).map(|y| (0..256).map(|x| love::influence(x, y)).sum::<f64>()).sum::<f64>());
    });
}

/// Forces that end in a factored set, in direct sums and in transforms at N = 257, D_f = 2.4.
fn solves(c: &mut Criterion) {
    let Ok(surface) = SelfAffine::new(2.4, 1.0, 1.0) else { return };
    let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    let mut group = c.benchmark_group("cold solve with stiffness, N = 257, D_f = 2.4, 1e-6");
    group.sample_size(10);
    for force in [1e-3, 3e-2, 1.0, 20.0] {
        group.bench_with_input(BenchmarkId::new("force_bar", force), &force, |b, &force| {
            b.iter(|| {
                let contact = Bem3d::default().prepare(&scene, 1);
                contact.and_then(|mut contact| contact.solve(Load::Force(black_box(force))))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, kernel, solves);
criterion_main!(benches);
