//! Hard cases of the results that are computed from the fields of a state: leakage, paths, stress below the surface, and
//! conduction through a film in the gap.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::Ledger;
use crate::stability::maps::rough_map;
use bem3d::{Bem3d, Film, film_conductance};
use contact_model::{
    Boundary, Conductance, ContactModel, Error, Field, Load, Outputs, Result, Scene, Surface,
};
use interface::stress::{StressedBody, SubsurfaceStress, SurfaceLoad};
use interface::{FlowAxis, leakage, open_gap, percolation};
use std::f64::consts::PI;

pub(super) const CASES: [HardCase; 6] = [
    HardCase {
        name: "gaps over six decades",
        why: "their cubes have a contrast of 1e18, and currents that cancel each other are 1e7 times as large as their sum",
        asserted: "the flow through layers one behind the other and side by side, each with a gap of its own; both bounds enclose it",
        bound: 1e-10,
        solve: six_decades,
    },
    HardCase {
        name: "the last cell closes the way",
        why: "the flow falls from a number to exactly 0, and the equations have no unknown left",
        asserted: "a single cell open in a wall: the flow through it; closed: both bounds, the pressure beyond and the flux are 0",
        bound: 1e-9,
        solve: last_cell,
    },
    HardCase {
        name: "a film of any resistivity",
        why: "the resistances of the film span fourteen decades beside those of the bodies, and are 0 in contact",
        asserted: "without much of a film the conductance that follows from the stiffness; with one that hardly resists that of a bonded square; the bounds \
                   are in order",
        bound: 1e-5,
        solve: any_film,
    },
    HardCase {
        name: "full contact with a film",
        why: "a periodic interface that touches everywhere has no resistance",
        asserted: "an error that says so; with one cell open a conductance far above that of the film alone",
        bound: 0.0,
        solve: full_with_film,
    },
    HardCase {
        name: "stress far below and close to the surface",
        why: "the depth is from a millionth of a cell to a million cells, and closed forms cancel",
        asserted: "below one loaded cell its pressure, and the stress of a point force, sigma_zz = -3 F/(2 pi z^2)",
        bound: 1e-6,
        solve: any_depth,
    },
    HardCase {
        name: "paths through a checkerboard",
        why: "open cells meet at corners only, where the contact leads through, or the fluid, but not both",
        asserted: "no open path, and one of the contact that closes the way; with a whole row open, the opposite (wrong answers)",
        bound: 0.0,
        solve: checkerboard,
    },
];

/// Gaps between 1e-6 and 1, in no order.
fn gaps(count: usize) -> Vec<f64> {
    (0..count).map(|i| 10f64.powf(-6.0 * ((i * 7919 + 13) % 1009) as f64 / 1008.0)).collect()
}

fn six_decades(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let n = effort.pick(48, 500);
    let gaps = gaps(n);
    let behind = Field::new([n, n], [1.0, 1.0], (0..n * n).map(|i| gaps[i % n]).collect())?;
    let resistance: f64 = gaps.iter().map(|g| 1.0 / (n as f64 * g.powi(3))).sum();
    let beside: f64 = gaps.iter().map(|g| g.powi(3) / n as f64).sum();
    for (axis, exact) in [(FlowAxis::X, 1.0 / resistance), (FlowAxis::Y, beside)] {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let found = leakage(&behind, axis, boundary)?;
            ledger.near("flow", found.network.middle(), exact);
            ledger.must(
                found.network.lower <= exact * (1.0 + 1e-14) && exact * (1.0 - 1e-14) <= found.network.upper,
                || format!("{exact:e} is not in {:?}", found.network),
            );
            ledger.enter(found.network.relative_width());
        }
    }
    Ok(())
}

fn last_cell(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let wall = |open: f64| {
        let gap = |i: usize| match (i % 9, i / 9) {
            (4, 4) => open,
            (4, _) => 0.0,
            _ => 1e6,
        };
        Field::new(9, 9.0, (0..81).map(gap).collect())
    };
    // The chambers beside the wall hardly resist.
    let open = leakage(&wall(1.0)?, FlowAxis::X, Boundary::Free)?;
    ledger.near("flow through one cell", open.network.middle(), 1.0);
    let closed = leakage(&wall(0.0)?, FlowAxis::X, Boundary::Free)?;
    ledger.near("no flow", closed.network.upper, 0.0);
    let beyond =
        closed.flow.potential.values().iter().skip(5).step_by(9).fold(0.0_f64, |m, p| m.max(p.abs()));
    ledger.near("pressure beyond", beyond, 0.0);
    let flux = closed.flow.flux.iter().flat_map(Field::values).fold(0.0_f64, |m, q| m.max(q.abs()));
    ledger.near("flux", flux, 0.0);
    Ok(())
}

fn any_film(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(32, 128);
    let mut scene = Scene::new(Surface::Heights(rough_map(2.3, cells, 5)?.into()), 1.0);
    scene.outputs = Outputs { gap: true, pressure: true, ..Outputs::default() };
    scene.outputs.conductance = Conductance::Electrical { first: 1.0, second: 1.0 };
    let model = Bem3d { cells, tolerance: 1e-9, ..Bem3d::default() };
    let state = model.prepare(&scene, 1)?.solve(Load::force(0.001))?;
    let gap = open_gap(&state)?;
    let with = |resistivity: f64| film_conductance(&gap, Film { resistivity, bodies: 2.0 }, Boundary::Free);
    let deepest = gap.values().iter().copied().fold(0.0, f64::max);
    let contact = state.conductance.unwrap_or(0.0);
    ledger.near("contact alone", with(1e9 / deepest)?.middle(), contact);
    let bonded = film_conductance(
        &Field::new(gap.cells(), gap.size(), vec![0.0; gap.values().len()])?,
        Film { resistivity: 1.0, bodies: 2.0 },
        Boundary::Free,
    )?;
    ledger.near("no resistance", with(1e-7 / deepest)?.middle(), bonded.middle());
    let mut before = 0.0;
    for exponent in (-7..=9).rev() {
        let found = with(10f64.powi(exponent) / deepest)?;
        ledger.must(before <= found.lower * (1.0 + 1e-12) && found.lower <= found.upper, || {
            format!("1e{exponent}: {found:?}")
        });
        before = found.lower;
    }
    Ok(())
}

fn full_with_film(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let film = Film { resistivity: 1e3, bodies: 1.0 };
    let gap = |open: f64| {
        let mut values = vec![0.0; 256];
        values[100] = open;
        Field::new(16, 1.0, values)
    };
    let refused = film_conductance(&gap(0.0)?, film, Boundary::Periodic);
    ledger.count(usize::from(!matches!(refused, Err(Error::Domain { .. }))));
    let found = film_conductance(&gap(1.0)?, film, Boundary::Periodic)?;
    ledger.must(found.lower > 1.0 && found.upper >= found.lower, || format!("{found:?}"));
    Ok(())
}

fn any_depth(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let mut pressure = vec![0.0; 25];
    pressure[12] = 2.0;
    let load = SurfaceLoad::new(Field::new(5, 5e-3, pressure)?)?;
    let plan = SubsurfaceStress::new(&load, StressedBody::new(0.3))?;
    for depth in [1e-9, 1e-3, 1e3] {
        let stress = plan.at_depth(depth, &contact_model::never)?.at(2, 2);
        let exact = if depth < 1e-6 {
            -2.0
        } else if depth > 1.0 {
            -3.0 * 2e-6 / (2.0 * PI * depth * depth)
        } else {
            // Below the middle of a square of side 2 a in the depth z = 2 a: Love's closed form.
            let (a, z) = (0.5e-3, 1e-3_f64);
            let far = (2.0 * a * a + z * z).sqrt();
            let shape = (a * a / (z * far)).atan() + a * a * z * far.recip() * 2.0 / (a * a + z * z);
            -2.0 * 2.0 / PI * shape
        };
        ledger.near(&format!("sigma_zz at {depth:e}"), stress[2], exact);
    }
    Ok(())
}

fn checkerboard(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let mut wrong = 0;
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let mut values: Vec<f64> = (0..64).map(|i| f64::from((i % 8 + i / 8) % 2)).collect();
        let board = percolation(&Field::new(8, 1.0, values.clone())?, 0.0, FlowAxis::X, boundary)?;
        wrong += usize::from(board.spans) + usize::from(!board.contact_blocks);
        values[24..32].fill(1.0);
        let row = percolation(&Field::new(8, 1.0, values)?, 0.0, FlowAxis::X, boundary)?;
        wrong += usize::from(!row.spans) + usize::from(row.contact_blocks);
    }
    ledger.count(wrong);
    Ok(())
}
