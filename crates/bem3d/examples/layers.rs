//! What a layer costs beside a half-space: `cargo run --release -p bem3d --example layers -- [CELLS [PART]]`.
//!
//! A self-affine surface (H = 0.8, roll-off at a quarter of the side) is pressed on layers of three thicknesses,
//! counted in sides of a cell, on all bases. The mean pressures are multiples of the root mean square of the
//! pressure variations in full contact, which each body has for itself. On a periodic half-space 1 to 98 % of
//! the map touch under them. Each load is a cold start to the tolerance 1e-6 without a stiffness, on one
//! thread. The time is that of the same load on the half-space of the layer's material; tables and symbols are
//! made before.
//!
//! Each line has the largest residual, the applications of the kernel, the share of them that the fall-back has
//! taken, and the ratio of the times. Lines of sums follow. With a PART only the bodies are solved whose name
//! contains it.

use bem3d::{
    Bem3d, Boundary, ContactModel, ContactState, Error, HeightMap, Layer, LayerBase, Load, Outputs, Scene,
    SelfAffine, Surface,
};
use rayon::ThreadPoolBuilder;
use std::sync::Arc;
use std::time::Instant;

/// Mean pressures over the root mean square of the variations in full contact.
const LOADS: [f64; 4] = [0.012, 0.3, 1.0, 2.4];
const TOLERANCE: f64 = 1e-6;
/// Sides of a cell.
const THICKNESSES: [f64; 3] = [0.3, 3.0, 30.0];

fn bodies() -> Vec<(String, Option<(f64, LayerBase)>)> {
    let mut bodies = vec![
        ("half-space".to_owned(), None),
        ("rigid, nu 0.3".to_owned(), Some((0.3, LayerBase::Rigid))),
        ("rigid, nu 0.5".to_owned(), Some((0.5, LayerBase::Rigid))),
        ("slipping, nu 0.3".to_owned(), Some((0.3, LayerBase::Slipping))),
    ];
    for exponent in [-4, -2, -1, 1, 2, 3, 4] {
        let base = LayerBase::HalfSpace { young: 10_f64.powi(-exponent), poisson: 0.3 };
        bodies.push((format!("coating 1e{exponent}"), Some((0.3, base))));
    }
    bodies
}

fn scene(map: &Arc<HeightMap>, layer: Option<Layer>, boundary: Boundary) -> Scene {
    let modulus = layer.map_or(1.0, |layer| layer.modulus());
    let mut scene = Scene::new(Surface::Heights(Arc::clone(map)), modulus);
    (scene.effects.layer, scene.effects.boundary) = (layer, boundary);
    scene.outputs = Outputs { area: true, pressure: true, ..Outputs::default() };
    scene.outputs.stiffness = false;
    scene
}

fn model() -> Bem3d {
    Bem3d { tolerance: TOLERANCE, ..Bem3d::default() }
}

fn solved(result: Result<ContactState, Error>) -> Result<ContactState, Error> {
    match result {
        Err(Error::NotConverged { best }) => Ok(*best),
        other => other,
    }
}

/// The root mean square of the pressure variations in full contact.
fn variation(map: &Arc<HeightMap>, layer: Option<Layer>) -> Result<f64, Error> {
    let scene = scene(map, layer, Boundary::Periodic);
    let cells = map.heights().len();
    let mut pressure = 1e-3;
    loop {
        let state = solved(model().prepare(&scene, 0)?.solve(Load::force(pressure)))?;
        if state.report.contact_cells == Some(cells) {
            let p = state.pressure().map_or(&[][..], |field| field.values());
            return Ok((p.iter().map(|p| (p - pressure).powi(2)).sum::<f64>() / cells as f64).sqrt());
        }
        pressure *= 10.0;
    }
}

/// The work of a load.
struct LayerCost {
    applications: usize,
    fall_back: usize,
    seconds: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let cells = arguments.first().and_then(|cells| cells.parse().ok()).unwrap_or(128);
    let part = arguments.get(1).cloned().unwrap_or_default();
    let one = ThreadPoolBuilder::new().num_threads(1).build()?;
    one.install(|| table(cells, &part))?;
    Ok(())
}

fn table(cells: usize, part: &str) -> Result<(), Error> {
    let mut surface = SelfAffine::new(2.2, 1.0, 0.01)?;
    surface.roll_off = Some(4.0 * std::f64::consts::TAU);
    let map = Arc::new(surface_gen::self_affine_map(&surface, cells, 3)?);
    let mut times = Vec::new();
    for (name, body) in bodies() {
        if body.is_some() && !name.contains(part) {
            continue;
        }
        let mut of_body: Vec<LayerCost> = Vec::new();
        let (mut loads, mut used, mut failed) = (0, 0, 0);
        for thickness in THICKNESSES {
            let layer = body.map(|(poisson, base)| Layer {
                thickness: thickness / cells as f64,
                young: 1.0 - poisson * poisson,
                poisson,
                base,
            });
            let variation = variation(&map, layer)?;
            for boundary in [Boundary::Free, Boundary::Periodic] {
                let scene = scene(&map, layer, boundary);
                // Tables are made, and kept as long as this contact is.
                let mut kept = model().prepare(&scene, 0)?;
                solved(kept.solve(Load::force(variation)))?;
                for (i, share) in LOADS.into_iter().enumerate() {
                    let mut contact = model().prepare(&scene, 0)?;
                    let start = Instant::now();
                    let state = solved(contact.solve(Load::force(share * variation)))?;
                    let seconds = start.elapsed().as_secs_f64();
                    let report = &state.report;
                    let fall_back = report
                        .strategy
                        .split("; ")
                        .find_map(|part| part.strip_suffix(" steps of the fall-back"));
                    let fall_back = fall_back.and_then(|steps| steps.parse().ok()).unwrap_or(0);
                    let at = (boundary == Boundary::Periodic, i);
                    let beside = if body.is_none() {
                        times.push((at, seconds));
                        1.0
                    } else {
                        seconds
                            / times.iter().find(|(of, _)| *of == at).map_or(f64::NAN, |(_, seconds)| *seconds)
                    };
                    let residual = report.certificate.duality_gap.max(report.certificate.penetration);
                    println!(
                        "{name:18} h {thickness:4} cells {:8} p {share:5} A {:6.2} % {:16} {residual:7.1e} \
                         applications {:5} fall-back {:3.0} % time x {beside:6.2} ({seconds:.3} s)",
                        if at.0 { "periodic" } else { "free" },
                        100.0 * state.area.unwrap_or(0.0),
                        report.status.as_str(),
                        report.applications,
                        100.0 * fall_back as f64 / report.applications as f64,
                    );
                    loads += 1;
                    used += usize::from(fall_back > 0);
                    failed += usize::from(report.status != bem3d::Status::Converged);
                    of_body.push(LayerCost { applications: report.applications, fall_back, seconds: beside });
                }
            }
            if body.is_none() {
                break;
            }
        }
        let applications: usize = of_body.iter().map(|cost| cost.applications).sum();
        let fall_back: usize = of_body.iter().map(|cost| cost.fall_back).sum();
        let mut ratios: Vec<f64> = of_body.iter().map(|cost| cost.seconds).collect();
        ratios.sort_by(f64::total_cmp);
        println!(
            "SUM {name:18} loads {loads} not converged {failed} with fall-back {used}, {:.0} % of the applications; \
             time x median {:.1} largest {:.1}",
            100.0 * fall_back as f64 / applications as f64,
            ratios[ratios.len() / 2],
            ratios[ratios.len() - 1],
        );
    }
    Ok(())
}
