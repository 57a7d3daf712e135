//! Attraction across open gaps.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, known, largest, pressure};
use crate::stability::maps::{map, rough_map};
use crate::stability::plain::PlainSum;
use crate::stability::press::watched;
use crate::stability::slide::{MU, VectorField, alike, rubbed, tangential, vectors};
use bem3d::Bem3d;
use contact_model::{
    Adhesion, AdhesionLaw, Boundary, ContactModel, ContactState, Error, Hardness, HeightMap, Load,
    PreparedContact, Result, Scene, Step, Tangential,
};

/// Tolerance of the solves.
pub(super) const TOLERANCE: f64 = 1e-8;

pub(super) const CASES: [HardCase; 6] = [
    HardCase {
        name: "a plateau snaps in",
        why: "all its cells become unstable at once: an iteration that starts too far in, or overshoots, finds the other branch",
        asserted: "traction and gap of every cell by plain sums; closed on the way back where it was open on the way in; the loop costs energy",
        bound: 1e-6,
        solve: plateau,
    },
    HardCase {
        name: "a single summit with attraction",
        why: "one cell touches and all others attract: the net force changes its sign while the contact does not",
        asserted: "traction and gap of every cell by plain sums; one contact cell from pull to push",
        bound: 1e-6,
        solve: summit,
    },
    HardCase {
        name: "attraction that closes everything",
        why: "without any force a rough surface is in full contact, nearly all of it in tension at the hollows",
        asserted: "traction and gap of every cell by plain sums; every cell in contact at F = 0",
        bound: 1e-6,
        solve: everything,
    },
    HardCase {
        name: "a range below a cell",
        why: "a cell alone would snap: states would be those of the grid",
        asserted: "refused with the size of a cell that resolves the range, and taken with that size (cases that differ)",
        bound: 0.0,
        solve: below_a_cell,
    },
    HardCase {
        name: "periodic full contact in tension",
        why: "nothing but the attraction holds the bodies, and the kernel has no constant",
        asserted: "full contact from push to pull; the pressure changes by dF/A at every cell (of the largest pressure)",
        bound: 1e-6,
        solve: tension,
    },
    HardCase {
        name: "a plateau that snaps in, flows and is dragged",
        why: "three effects at once: cells jump from open to the hardness in one step, slip under a pull, and fit each other on the way out",
        asserted: "by plain sums over the indented surface: the law of every open cell, closed cells between zero and the hardness with the peak of the attraction, Coulomb's limit of the contact pressure, and all of it in sliding",
        bound: 1e-6,
        solve: three,
    },
];

/// A scene with an attraction, without the stiffness.
pub(super) fn attracted_by(map: &HeightMap, adhesion: Adhesion) -> Scene {
    let mut scene = watched(map);
    scene.outputs.stiffness = false;
    scene.effects.adhesion = adhesion;
    scene
}

fn attracted(map: &HeightMap, work: f64, range: f64) -> Scene {
    attracted_by(map, Adhesion::FiniteRange { work, range, law: AdhesionLaw::Exponential })
}

/// Asserts that a state meets its tolerance and is stable.
pub(super) fn meets_and_is_stable(ledger: &mut Ledger, state: &ContactState) {
    ledger.meets(state, TOLERANCE);
    let stability = state.adhesive.map_or(f64::NAN, |adhesive| adhesive.stability);
    ledger.must(stability > 0.0, || format!("stability {stability}"));
}

pub(super) fn path(scene: &Scene) -> Result<Box<dyn PreparedContact>> {
    Bem3d { tolerance: TOLERANCE, ..Bem3d::default() }.prepare(scene, 0)
}

pub(super) fn go(history: &mut dyn PreparedContact, load: Load) -> Result<ContactState> {
    history.advance(Step::new(0.0, load))
}

/// The residual of a state with free boundaries, by plain sums: for open cells the difference between the
/// traction and the law of the gap, for closed ones a negative contact pressure, both over work/range.
fn conditions(
    ledger: &mut Ledger,
    map: &HeightMap,
    (work, range): (f64, f64),
    state: &ContactState,
) -> Result<()> {
    meets_and_is_stable(ledger, state);
    let (p, d) = (pressure(state)?, approach(state)?);
    let cell = map.dx() * map.dy();
    let forces: Vec<(usize, f64)> = p.iter().enumerate().map(|(i, p)| (i, p * cell)).collect();
    let u = PlainSum::of(map).displacement(&forces);
    for (i, (p, u)) in p.iter().zip(&u).enumerate() {
        let gap = u + map.highest() - map.heights()[i] - d;
        ledger.enter((-gap / range).max(0.0));
        let law = work / range * (-gap.max(0.0) / range).exp();
        let contact = p + law;
        // Where there is contact pressure there is no gap.
        ledger.enter((-contact / (work / range)).max(0.0));
        ledger.enter((contact * range / work).min(gap.max(0.0) / range).max(0.0));
    }
    Ok(())
}

fn plateau(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(32, 64);
    let middle = |i: usize| (cells / 4..3 * cells / 4).contains(&i);
    let map = map(cells, 1.0, |x, y| if middle(x) && middle(y) { 0.0 } else { -1.0 })?;
    let (work, range) = (0.05, 0.1);
    let mut history = path(&attracted(&map, work, range))?;
    let steps: Vec<f64> = (0..=24).map(|i| -0.24 + 0.01 * f64::from(i)).collect();
    let mut states = Vec::new();
    for &d in steps.iter().chain(steps.iter().rev().skip(1)) {
        let state = go(history.as_mut(), Load::approach(d))?;
        conditions(ledger, &map, (work, range), &state)?;
        states.push(state);
    }
    let half = steps.len() - 1;
    let differ = (0..half).filter(|&i| states[i].area != states[2 * half - i].area).count();
    ledger.must(differ > 0, || "both branches have the same contact everywhere".into());
    let work_of = |pair: &[ContactState]| -> Result<f64> {
        Ok(0.5 * (pair[0].force + pair[1].force) * (approach(&pair[1])? - approach(&pair[0])?))
    };
    let loop_work = states.windows(2).map(work_of).sum::<Result<f64>>()?;
    ledger.must(loop_work > 0.0, || format!("the loop gives {loop_work}"));
    Ok(())
}

fn summit(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(17, 33);
    let map = map(cells, 1.0, |x, y| if (x, y) == (cells / 2, cells / 2) { 0.0 } else { -0.3 })?;
    let (work, range) = (0.02, 0.2);
    let mut history = path(&attracted(&map, work, range))?;
    for d in [0.0, 0.02, 0.05, 0.1, 0.05, 0.0] {
        let state = go(history.as_mut(), Load::approach(d))?;
        conditions(ledger, &map, (work, range), &state)?;
        if d > 0.0 {
            ledger.contact_cells(&state, 1);
        }
    }
    Ok(())
}

fn everything(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(32, 48);
    let map = rough_map(2.2, cells, 2)?.scaled(1.0, 0.02)?;
    let (work, range) = (0.5, 0.5);
    let mut history = path(&attracted(&map, work, range))?;
    for force in [0.0, 0.1, 0.0] {
        let state = go(history.as_mut(), Load::force(force))?;
        conditions(ledger, &map, (work, range), &state)?;
        ledger.contact_cells(&state, cells * cells);
    }
    Ok(())
}

fn below_a_cell(ledger: &mut Ledger, _: Effort) -> Result<()> {
    // The cell that a message allows is taken, and a coarser one refused.
    let flat = |cells: usize| map(cells, 1.0, |_, _| 0.0);
    let (work, range) = (0.02, 0.02);
    let allowed = match path(&attracted(&flat(8)?, work, range)).map(|_| ()) {
        Err(Error::OutOfRange { name, value, max, .. }) => {
            ledger.must(name == bem3d::UNRESOLVED_RANGE && (value - 0.125).abs() < 1e-12, || {
                format!("{name} {value}")
            });
            max
        }
        other => {
            ledger.must(false, || format!("a range below a cell: {:?}", other.is_ok()));
            return Ok(());
        }
    };
    let cells = (1.0 / allowed).ceil() as usize + 1;
    ledger.count(usize::from(path(&attracted(&flat(cells)?, work, range)).is_err()));
    ledger.count(usize::from(path(&attracted(&flat(cells * 9 / 10)?, work, range)).is_ok()));
    Ok(())
}

fn tension(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(24, 64);
    let map = rough_map(2.2, cells, 2)?.scaled(1.0, 0.02)?;
    let mut scene = attracted(&map, 0.5, 0.5);
    scene.effects.boundary = Boundary::Periodic;
    let mut history = path(&scene)?;
    let mut last: Option<(f64, Vec<f64>)> = None;
    for force in [0.5, 0.2, -0.1, -0.3] {
        let state = go(history.as_mut(), Load::force(force))?;
        ledger.meets(&state, TOLERANCE);
        ledger.contact_cells(&state, cells * cells);
        let p = pressure(&state)?.to_vec();
        if let Some((before, pressures)) = &last {
            let largest = largest(&p);
            for (p, old) in p.iter().zip(pressures) {
                ledger.enter((p - old - (force - before)).abs() / largest);
            }
        }
        last = Some((force, p));
    }
    Ok(())
}

/// Net pressures between the law of the gap and the hardness, over the surface as it is indented now, and tractions
/// within what friction holds of the contact pressure.
fn three(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(32, 48);
    let middle = |i: usize| (cells / 4..3 * cells / 4).contains(&i);
    // A plateau with a slope, so that it does not flow everywhere at once.
    let map =
        map(cells, 1.0, |x, y| if middle(x) && middle(y) { -0.05 * x as f64 / cells as f64 } else { -1.0 })?;
    let (work, range, hardness) = (0.05, 0.1, 0.6);
    let mut scene = attracted(&map, work, range);
    let rubbed = rubbed(&map, alike(0.3), MU);
    (scene.pair, scene.effects.friction) = (rubbed.pair, rubbed.effects.friction);
    scene.effects.hardness = Hardness::Limit { pressure: hardness };
    (scene.outputs.traction, scene.outputs.plastic_depth, scene.outputs.gap) = (true, true, true);
    let mut history = path(&scene)?;
    let cell = map.dx() * map.dy();
    let peak = work / range;
    let loads = [
        (-0.2, 0.0),
        (-0.05, 0.0),
        (0.05, 0.01),
        (0.2, 0.02),
        (0.2, 2.0),
        (0.1, 2.0),
        (0.02, 1.9),
        (-0.05, 0.0),
    ];
    for (d, moved) in loads {
        let load = Load::approach(d).with_tangential(Tangential::Displacement([moved, 0.0]));
        let state = go(history.as_mut(), load)?;
        meets_and_is_stable(ledger, &state);
        let net = pressure(&state)?;
        let forces: Vec<(usize, f64)> = net.iter().enumerate().map(|(i, p)| (i, p * cell)).collect();
        let u = PlainSum::of(&map).displacement(&forces);
        let depth = state.fields.as_ref().and_then(|fields| fields.plastic_depth.as_ref());
        let depth = depth.map_or(&[][..], |depth| depth.values());
        let tractions = vectors(&state, VectorField::Traction)?;
        let (mut held, mut borne) = (0.0, 0.0);
        for i in 0..net.len() {
            let gap = u[i] + map.highest() - map.heights()[i] + depth[i] - d;
            ledger.enter((-gap / range).max(0.0));
            ledger.enter(((net[i] - hardness) / hardness).max(0.0));
            let contact = net[i] + peak * (-gap.max(0.0) / range).exp();
            ledger.enter((-contact / peak).max(0.0));
            ledger.enter((contact / peak).min(gap.max(0.0) / range).max(0.0));
            let limit = MU * if gap < 1e-6 * range { contact.max(0.0) } else { 0.0 };
            let [x, y] = tractions[i];
            ledger.enter(((x.hypot(y) - limit) / (MU * peak)).max(0.0));
            held += limit * cell;
            borne += x.hypot(y) * cell;
        }
        // Dragged by twice the side all of it slides.
        if moved > 1.9 && held > 0.0 {
            ledger.near("friction in sliding", borne, held);
            ledger.near("sliding force", known("sliding force", tangential(&state)?.sliding_force)?, held);
        }
    }
    Ok(())
}
