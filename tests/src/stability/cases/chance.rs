//! Repeated solves of the same problem.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::Ledger;
use crate::stability::maps::{rough, rough_map};
use crate::stability::press::{tight, watched};
use bem3d::Bem3d;
use contact_model::{ContactModel, ContactState, Error, Load, Result, Scene, Surface};
use mdr1d::Mdr1d;
use rayon::prelude::*;

pub(super) const CASES: [HardCase; 2] = [
    HardCase {
        name: "repeated runs",
        why: "hash order, uninitialised scratch or a plan chosen by a clock change last digits",
        asserted: "F, d, k and p of three runs bit for bit, prepared anew and remembered (numbers that differ)",
        bound: 0.0,
        solve: repeated,
    },
    HardCase {
        name: "1, 2 and 4 threads",
        why: "sums in the order in which threads finish",
        asserted: "F, d, k and p of an ensemble, 3D and 1D, bit for bit for any number of threads (numbers that differ)",
        bound: 0.0,
        solve: threads,
    },
];

fn repeated(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let map = rough_map(2.4, effort.pick(65, 257), 1)?;
    let loads = [1e-4, 1e-2, 1.0, 20.0].map(Load::force);
    let sweep = || -> Result<Vec<ContactState>> {
        let mut contact = tight().prepare(&watched(&map), 0)?;
        loads.iter().map(|&load| contact.solve(load)).collect()
    };
    let first = sweep()?;
    for _ in 0..2 {
        for (a, b) in first.iter().zip(&sweep()?) {
            ledger.same_bits("again", a, b);
            ledger.must(a.report == b.report, || format!("reports {:?} and {:?}", a.report, b.report));
        }
    }
    Ok(())
}

fn threads(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let surfaces = effort.pick(4_u64, 12);
    let bem = Bem3d { cells: effort.pick(65, 129), ..tight() };
    let mdr = Mdr1d::default();
    let ensemble = |threads: usize| -> Result<Vec<ContactState>> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|_| Error::domain("threads", threads as f64, "threads that the system grants"))?;
        let one = |seed: u64| -> Result<Vec<ContactState>> {
            let mut scene = Scene::new(Surface::SelfAffine(rough(2.0 + 0.25 * (seed % 5) as f64)?), 1.0);
            scene.outputs.pressure = true;
            let mut contact = bem.prepare(&scene, seed)?;
            let mut states: Vec<ContactState> =
                [1e-2, 1.0, 20.0].iter().map(|&f| contact.solve(Load::force(f))).collect::<Result<_>>()?;
            scene.outputs.pressure = false;
            let mut line = mdr.prepare(&scene, seed)?;
            states.push(line.solve(Load::force(0.1))?);
            Ok(states)
        };
        let all: Result<Vec<Vec<ContactState>>> =
            pool.install(|| (0..surfaces).into_par_iter().map(one).collect());
        Ok(all?.concat())
    };
    let alone = ensemble(1)?;
    for threads in [2, 4] {
        for (a, b) in alone.iter().zip(&ensemble(threads)?) {
            ledger.same_bits("on more threads", a, b);
        }
    }
    Ok(())
}
