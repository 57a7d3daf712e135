//! Solves that are checked by the reference implementation.

use crate::stability::ledger::{Ledger, approach, pressure, stiffness};
use crate::stability::maps::scene;
use crate::stability::plain::{PlainSum, relaxed};
use bem3d::{Bem3d, Method};
use contact_model::{
    Boundary, ContactModel, ContactState, HeightMap, Load, NormalLoad, PreparedContact, Result, Scene, Status,
};
use std::cell::Cell;

/// Tolerance of the solves.
pub(crate) const TOLERANCE: f64 = 1e-10;
/// Bound of the difference between two solves of one state at [`TOLERANCE`]: certificates measure gaps in rms
/// heights, and approaches here are down to a thousandth of that.
pub(crate) const SAME: f64 = 1e-7;
/// Largest error of the approach, in tolerances times the rms height (`Bem3d::tolerance`).
const LEFT_OPEN: f64 = 10.0;
/// Largest residual of the reference implementation as a multiple of the tolerance, as its sums round
/// differently.
const WITNESS: f64 = 2.0;
/// Rounding of sums over a few thousand cells, relative to the largest term.
const ROUNDING: f64 = 1e-12;
/// The witness sums over pairs on grids up to this size, and eliminates sets up to that.
const LARGEST_GRID: usize = 129;
const LARGEST_SET: usize = 220;
/// Elimination of a set of that size.
const ELIMINATED: f64 = 1e-9;

/// The solver that the cases test.
pub(crate) fn tight() -> Bem3d {
    Bem3d { tolerance: TOLERANCE, ..Bem3d::default() }
}

/// A scene of a map with all outputs that the reference implementation checks.
pub(crate) fn watched(map: &HeightMap) -> Scene {
    let mut scene = scene(map.clone());
    (scene.outputs.area, scene.outputs.pressure) = (true, true);
    scene
}

/// The scene of [`watched`] with periodic boundaries.
pub(crate) fn watched_periodic(map: &HeightMap) -> Scene {
    let mut scene = watched(map);
    scene.effects.boundary = Boundary::Periodic;
    scene
}

/// A stop function that requests a stop after this number of calls.
pub(crate) fn stop_after(patience: usize) -> impl Fn() -> bool {
    let asked = Cell::new(0_usize);
    move || asked.replace(asked.get() + 1) >= patience
}

/// Cells under pressure and the forces on them.
pub(crate) fn forces(state: &ContactState, map: &HeightMap) -> Result<Vec<(usize, f64)>> {
    let area = map.dx() * map.dy();
    let force = |(i, p): (usize, &f64)| (*p > 0.0).then_some((i, p * area));
    Ok(pressure(state)?.iter().enumerate().filter_map(force).collect())
}

/// Cells under pressure.
pub(crate) fn contact_set(state: &ContactState) -> Result<Vec<usize>> {
    let pressure = pressure(state)?;
    Ok((0..pressure.len()).filter(|&i| pressure[i] > 0.0).collect())
}

/// Solves one load from a cold start and checks the state by the reference implementation.
pub(crate) fn press(ledger: &mut Ledger, map: &HeightMap, load: Load) -> Result<ContactState> {
    press_by(ledger, &tight(), map, load)
}

/// The same by another method.
pub(crate) fn press_by(
    ledger: &mut Ledger,
    model: &Bem3d,
    map: &HeightMap,
    load: Load,
) -> Result<ContactState> {
    let mut contact = model.prepare(&watched(map), 0)?;
    press_again(ledger, &mut *contact, model.tolerance, map, load)
}

/// The same with a contact that may have solved other loads before; it must have been prepared with
/// [`watched`].
pub(crate) fn press_again(
    ledger: &mut Ledger,
    contact: &mut dyn PreparedContact,
    tolerance: f64,
    map: &HeightMap,
    load: Load,
) -> Result<ContactState> {
    let state = contact.solve(load)?;
    witness(ledger, map, load, tolerance, &state)?;
    Ok(state)
}

/// Solves one load by factorisation and by iteration and checks each; the two must agree.
pub(crate) fn press_both(ledger: &mut Ledger, map: &HeightMap, load: Load) -> Result<ContactState> {
    let one = press(ledger, map, load)?;
    let other = press_by(ledger, &Bem3d { method: Method::Iterative, ..tight() }, map, load)?;
    // What the certificate leaves open in d, in rms heights; and that in F.
    let k = stiffness(&one)?;
    let gap = LEFT_OPEN * TOLERANCE * surface_gen::rms_height(map.heights());
    let off = [
        (approach(&one)? - approach(&other)?).abs() / (SAME * approach(&one)? + gap),
        (one.force - other.force).abs() / (SAME * one.force + gap * k),
        (k / stiffness(&other)? - 1.0).abs() / SAME,
    ];
    ledger.must(off.iter().all(|d| *d <= 1.0), || {
        format!("{load:?}: d, F, k by factors and by iteration differ by {off:?} of what is allowed")
    });
    let cells = [&one, &other].map(|s| s.report.contact_cells);
    ledger.must(cells[0] == cells[1], || format!("{load:?}: contact cells {cells:?}"));
    Ok(one)
}

/// Checks a state of modulus 1 against the contact conditions, by plain sums.
pub(crate) fn witness(
    ledger: &mut Ledger,
    map: &HeightMap,
    load: Load,
    tolerance: f64,
    state: &ContactState,
) -> Result<()> {
    let report = &state.report;
    ledger.must(report.status == Status::Converged && report.certificate.meets(tolerance), || {
        format!("{load:?}: {:?}, {}", report.status, report.certificate)
    });
    let (p, d, k) = (pressure(state)?, approach(state)?, stiffness(state)?);
    let forces = forces(state, map)?;
    ledger.must(p.iter().all(|p| *p >= 0.0 && p.is_finite()), || format!("{load:?}: a pull"));
    ledger.must(report.contact_cells == Some(forces.len()), || {
        format!("{load:?}: {:?} contact cells, {} with pressure", report.contact_cells, forces.len())
    });
    let sum: f64 = forces.iter().map(|(_, f)| f).sum();
    let asked = match load.normal {
        NormalLoad::Force(force) => force,
        _ => state.force,
    };
    for (name, force) in [("force", state.force), ("requested force", asked)] {
        let off = (sum / force - 1.0).abs();
        ledger.must(off <= tolerance.max(ROUNDING), || {
            format!("{load:?}: {name} {force}, sum of pressures {sum}")
        });
    }
    if map.heights().len() > LARGEST_GRID * LARGEST_GRID {
        return Ok(());
    }
    let plain = PlainSum::of(map);
    let u = plain.displacement(&forces);
    let highest = map.highest();
    let rms = surface_gen::rms_height(map.heights());
    let unit = if rms > 0.0 { rms } else { d };
    let slack = WITNESS * tolerance * unit + ROUNDING * d;
    let gap = |i: usize| u[i] + (highest - map.heights()[i]) - d;
    let lowest = (0..u.len()).map(gap).fold(f64::INFINITY, f64::min);
    ledger.must(lowest >= -slack, || format!("{load:?}: a cell penetrates by {}", -lowest / unit));
    // Shares of the force first: their products with gaps neither overflow nor vanish.
    let open: f64 = forces.iter().map(|&(i, f)| f / sum * (gap(i) / unit).abs()).sum();
    ledger.must(open <= slack / unit, || format!("{load:?}: pressure over gaps of {open}"));
    if forces.len() <= LARGEST_SET {
        let contact: Vec<usize> = forces.iter().map(|(i, _)| *i).collect();
        let exact = plain.stiffness(&contact);
        ledger.must((k / exact - 1.0).abs() <= ELIMINATED, || {
            format!("{load:?}: k {k} beside {exact} of the same set by elimination")
        });
    }
    Ok(())
}

/// Compares a state at an approach with that of relaxation: the contact set has to be equal, and the
/// deviations of force and stiffness are recorded.
pub(crate) fn against_relaxation(ledger: &mut Ledger, map: &HeightMap, d: f64) -> Result<()> {
    let state = press_both(ledger, map, Load::approach(d))?;
    let slow = relaxed(map, d);
    let found = contact_set(&state)?;
    ledger.must(found == slow.contact, || {
        format!("d {d}: {} cells in contact, {} by relaxation", found.len(), slow.contact.len())
    });
    ledger.near("force beside relaxation", state.force, slow.force);
    if slow.contact.len() <= LARGEST_SET {
        ledger.near(
            "stiffness beside elimination",
            stiffness(&state)?,
            PlainSum::of(map).stiffness(&slow.contact),
        );
    }
    Ok(())
}
