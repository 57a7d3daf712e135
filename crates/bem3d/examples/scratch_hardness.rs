use bem3d::*;
use std::time::Instant;
fn main() {
    let n: usize = std::env::args().nth(1).map_or(257, |s| s.parse().unwrap());
    let periodic = std::env::args().nth(2).is_some_and(|s| s == "p");
    let tolerance: f64 = std::env::args().nth(3).map_or(1e-6, |s| s.parse().unwrap());
    let mut s = SelfAffine::new(2.2, 1.0, 1.0).unwrap();
    s.roll_off = Some(2.0 * std::f64::consts::PI * 4.0);
    let model = Bem3d { cells: n, tolerance, ..Bem3d::default() };
    let mut scene = Scene::new(Surface::SelfAffine(s), 1.0);
    scene.outputs.area = true;
    if periodic { scene.effects.boundary = Boundary::Periodic; }
    let map = surface_gen::height_map(&scene.surface, model.grid(1.0.into()), 3).unwrap();
    let (c, h, dx) = (n, map.heights(), 1.0 / n as f64);
    let g = ((0..c * c).map(|i| { let (x, y) = (i % c, i / c); let a = h[y * c + (x + 1) % c] - h[i]; let b = h[(y + 1) % c * c + x] - h[i]; (a * a + b * b) / dx / dx }).sum::<f64>() / (c * c) as f64).sqrt();
    println!("rms gradient {g}");
    let only = |i: usize| std::env::args().nth(i).map(|s| s.parse::<f64>().unwrap());
    for hard in only(5).map_or(vec![f64::INFINITY, 1.0, 0.5, 0.2, 0.05, 0.01], |h| vec![h]) {
        // in units of E* g
        let mut scene = scene.clone();
        if hard.is_finite() { scene.effects.hardness = Hardness::Limit { pressure: hard * g }; }
        let mut c = model.prepare(&scene, 3).unwrap();
        for mean in only(6).map_or(vec![0.001, 0.009, 0.03, 0.1, 0.19, 0.1999], |h| vec![h]) {
            if std::env::args().nth(4).is_some() { c = model.prepare(&scene, 3).unwrap(); }
            let t = Instant::now();
            match c.solve(Load::Force(mean * g)) {
                Ok(s) => println!("ps {hard:6} p {mean:6} area {:.4} plastic {:.4} k {:.4e} ({:?}) apps {} its {} {:.2}s {}", s.area.unwrap(), s.plastic.map_or(0.0, |p| p.area), s.stiffness.unwrap_or(f64::NAN), s.report.certificate.stiffness_error, s.report.applications, s.report.iterations, t.elapsed().as_secs_f64(), s.report.strategy),
                Err(e) => println!("ps {hard} p {mean}: {e} {:.2}s", t.elapsed().as_secs_f64()),
            }
        }
    }
}
