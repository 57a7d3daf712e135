//! Layers, contacts along a line, and histories in time.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, pressure};
use crate::stability::maps::rough_map;
use bem3d::Bem3d;
use contact_model::{
    Boundary, ContactModel, HeightMap, Layer, LayerBase, Load, Outputs, PronySeries, Relaxing, Result,
    Rheology, Scene, Step, Surface,
};
use mdr1d::Viscoelastic;
use std::f64::consts::PI;

pub(super) const CASES: [HardCase; 6] = [
    HardCase {
        name: "a thin incompressible layer",
        why: "the surface bulges beside the load, contact reaches beyond the undeformed intersection, and the kernel nearly vanishes for long waves",
        asserted: "force of a ball by the closed form of a thin layer, F = pi E* a^6/(128 R h^3), up to h over a",
        bound: 0.1,
        solve: thin_layer,
    },
    HardCase {
        name: "a coating a hundred times as hard as its base",
        why: "it is a plate on a soft bed: contact and gaps alternate around each summit, and the kernel changes its sign",
        asserted: "the certificate; the force under a larger approach is larger; no gap is negative (over the height)",
        bound: 1e-6,
        solve: |ledger, effort| hard_coating(ledger, effort, (100.0, [0.01, 0.05])),
    },
    HardCase {
        name: "a coating ten thousand times as hard as its base, thinner than a cell",
        why: "the iteration over contact sets alternates, and an interior-point method has to find the set",
        asserted: "the certificate; the force under a larger approach is larger; no gap is negative (over the height)",
        bound: 1e-6,
        solve: |ledger, effort| hard_coating(ledger, effort, (1e4, [0.002, 0.006])),
    },
    HardCase {
        name: "a strip of two rows",
        why: "the map is a thousand times as long along the line as across, and the logarithm of the mean is all that acts",
        asserted: "both rows carry the same pressure everywhere, that of a profile of two cells",
        bound: 1e-9,
        solve: strip,
    },
    HardCase {
        name: "a rubber that is ten thousand times as stiff in no time",
        why: "its relaxation times span nine decades, most of them far longer or far shorter than a step of time",
        asserted: "mean gap at each decade of the time beside the elastic contact under the force that creep makes of it (over the rms height)",
        bound: 5e-3,
        solve: stiff_rubber,
    },
    HardCase {
        name: "a contact that is lost and met again",
        why: "the surface recovers while nothing touches it, and the contact begins anew in its own indentation",
        asserted: "no force in between; force after it beside steps of time a tenth as long in error",
        bound: 2e-3,
        solve: met_again,
    },
];

fn thin_layer(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let (cells, thickness) = effort.pick((129, 0.02), (513, 0.01));
    let (radius, depth): (f64, f64) = (1.0, 0.04);
    let mut scene = Scene::new(Surface::Sphere { radius, size: 1.0.into() }, 4.0 / 3.0);
    let layer = Layer { thickness, young: 1.0, poisson: 0.5, base: LayerBase::Rigid };
    scene.effects.layer = Some(layer);
    scene.outputs = Outputs { area: true, ..Outputs::default() };
    let model = Bem3d { cells, tolerance: 1e-7, ..Bem3d::default() };
    let state = model.prepare(&scene, 0)?.solve(Load::approach(depth))?;
    ledger.meets(&state, 1e-7);
    let a = (4.0 * radius * depth).sqrt();
    let expected = PI * scene.contact_modulus * a.powi(6) / (128.0 * radius * thickness.powi(3));
    ledger.near("force", state.force, expected);
    ledger.near("radius", (state.area.unwrap_or(0.0) / PI).sqrt(), a);
    Ok(())
}

fn hard_coating(ledger: &mut Ledger, effort: Effort, (ratio, thicknesses): (f64, [f64; 2])) -> Result<()> {
    let map = rough_map(2.2, effort.pick(65, 129), 3)?;
    for thickness in thicknesses {
        let mut scene = Scene::new(Surface::Heights(map.clone().into()), ratio);
        let base = LayerBase::HalfSpace { young: 1.0, poisson: 0.0 };
        scene.effects.layer = Some(Layer { thickness, young: ratio, poisson: 0.0, base });
        scene.outputs = Outputs { gap: true, ..Outputs::default() };
        let mut contact = Bem3d { tolerance: 1e-7, ..Bem3d::default() }.prepare(&scene, 0)?;
        let height = contact.normalisation().height.unwrap_or(1.0);
        let mut before = 0.0;
        for share in [0.5, 1.0, 2.0] {
            let state = contact.solve(Load::approach(share * height))?;
            ledger.meets(&state, 1e-7);
            ledger.must(state.force > before, || format!("{} after {before}", state.force));
            before = state.force;
            let least = state.gap().map_or(f64::NAN, |gap| gap.values().iter().copied().fold(0.0, f64::min));
            ledger.enter(-least / height);
        }
    }
    Ok(())
}

fn strip(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let columns = effort.pick(400, 2000);
    let mut scene = Scene::new(
        Surface::Heights(HeightMap::new([columns, 2], [columns as f64, 2.0], vec![0.0; 2 * columns])?.into()),
        1.0,
    );
    scene.effects.boundary = Boundary::PeriodicAlongX;
    scene.outputs = Outputs { pressure: true, ..Outputs::default() };
    let state =
        Bem3d { tolerance: 1e-10, ..Bem3d::default() }.prepare(&scene, 0)?.solve(Load::force(1e-3))?;
    ledger.contact_cells(&state, 2 * columns);
    let area = scene.surface.size().area();
    for p in pressure(&state)? {
        ledger.near("pressure", *p, 1e-3 / area);
    }
    Ok(())
}

/// Ten arms over nine decades, together 9999 times as stiff as what remains.
fn rubber() -> Result<Rheology> {
    let arms: Vec<Relaxing> = (0..10).map(|k| Relaxing { weight: 999.9, time: 10_f64.powi(k - 4) }).collect();
    Ok(Rheology::Prony(PronySeries::new(&arms)?))
}

fn stiff_rubber(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.2, effort.pick(64, 128), 5)?;
    let mut scene = Scene::new(Surface::Heights(map.into()), 1.0);
    scene.effects.boundary = Boundary::Periodic;
    scene.outputs = Outputs { mean_gap: true, ..Outputs::default() };
    let mut elastic = Bem3d { tolerance: 1e-8, ..Bem3d::default() }.prepare(&scene, 0)?;
    scene.effects.rheology = rubber()?;
    let mut contact = Bem3d { tolerance: 1e-8, ..Bem3d::default() }.prepare(&scene, 0)?;
    // The creep of the material, by a punch whose contact is known.
    let mut punch = Scene::new(Surface::FlatCircle { radius: 0.5, size: 2.0.into() }, 1.0);
    (punch.effects.rheology, punch.outputs) = (scene.effects.rheology, Outputs::default());
    let mut punch = Viscoelastic.prepare(&punch, 0)?;
    let height = contact.normalisation().height.unwrap_or(1.0);
    let force = contact.normalisation().force(0.3)?;
    for time in [0.0, 1e-3, 0.1, 10.0, 1e3, 1e5, 1e9] {
        let creep = approach(&punch.advance(Step::new(time, Load::force(1.0)))?)?;
        let state = contact.advance(Step::new(time, Load::force(force)))?;
        let expected = elastic.solve(Load::force(force * creep))?;
        let [found, expected] = [&state, &expected].map(|state| state.mean_gap.unwrap_or(f64::NAN));
        ledger.enter((found - expected).abs() / height);
    }
    Ok(())
}

fn met_again(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let force = |time_tolerance: f64, ledger: &mut Ledger| -> Result<f64> {
        let cells = effort.pick(33, 65);
        let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
        let arm = Relaxing { weight: 5.0, time: 1.0 };
        scene.effects.rheology = Rheology::StandardSolid { arm };
        scene.outputs = Outputs::default();
        let model = Bem3d { cells, tolerance: 1e-8, time_tolerance, ..Bem3d::default() };
        let mut contact = model.prepare(&scene, 0)?;
        let mut step = |time: f64, depth: f64| contact.advance(Step::new(time, Load::approach(depth)));
        step(1.0, 0.02)?;
        let parted = step(1.2, 0.0)?;
        ledger.must(parted.force.abs() <= 0.0, || format!("a force of {} without contact", parted.force));
        step(1.5, 0.0)?;
        Ok(step(2.0, 0.02)?.force)
    };
    let (found, fine) = (force(1e-3, ledger)?, force(1e-4, ledger)?);
    ledger.near("force", found, fine);
    Ok(())
}
