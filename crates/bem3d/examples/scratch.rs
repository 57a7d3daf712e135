use bem3d::*;
use contact_model::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let cells: usize = args[1].parse().unwrap();
    let work = 8.842e-6;
    let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 0.15.into() }, 1.0);
    scene.outputs.stiffness = true;
    scene.outputs.stiffness_fixed_area = true;
    scene.outputs.area = true;
    scene.effects.adhesion = match args[2].as_str() {
        "short" => Adhesion::ShortRange { work },
        "dugdale" => Adhesion::FiniteRange { work, range: args[3].parse().unwrap(), law: AdhesionLaw::Dugdale },
        _ => Adhesion::FiniteRange { work, range: args[3].parse().unwrap(), law: AdhesionLaw::Exponential },
    };
    let model = Bem3d { cells, tolerance: 1e-6, ..Bem3d::default() };
    let mut h = Bem3dPath(model).prepare(&scene, 0).unwrap();
    let mut t = 0.0;
    let mut go = |d: f64| { t += 1.0; h.advance(Step::normal(t, Load::Approach(d))).map(|s| s.normal) };
    let mut last: Option<(f64, f64)> = None;
    let mut path: Vec<f64> = (0..8).map(|i| 3.0e-4 + 1.3e-4 * i as f64).collect();
    let down: Vec<f64> = (0..16).map(|i| 1.3333e-3 - 1e-4 * i as f64).collect();
    path.extend(down);
    for d in path {
        match go(d) {
            Ok(s) => {
                let a = 0.0f64; let _ = a;
                // JKR: a from d on the branch
                let mut a = 0.09f64;
                for _ in 0..100 { let f = a*a - (2.0*std::f64::consts::PI*work*a).sqrt() - d; let df = 2.0*a - 0.5*(2.0*std::f64::consts::PI*work/a).sqrt(); a -= f/df; }
                let b = 0.75*(2.0*std::f64::consts::PI*work/a).sqrt()/a;
                let k = 2.0*a*(1.0-b)/(1.0-b/3.0);
                let q = last.map(|(d0,f0)| (s.force-f0)/(d-d0));
                println!("{d:.4e} F {:.4e} k {:?} +- {:?} fixed {:?} jkr {k:.4} 2a {:.4} quot {q:?} apps {}", s.force, s.stiffness, s.report.certificate.quotient_error.or(s.report.certificate.stiffness_error), s.stiffness_fixed_area, 2.0*a, s.report.applications);
                last = Some((d, s.force));
            }
            Err(e) => { println!("{d} {e}"); }
        }
    }
}
