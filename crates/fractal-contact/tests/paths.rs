//! Paths whose pieces prescribe another quantity than the piece before: each state has the load that a
//! division from the reached state gives, and is the state of the model under steps that are written out.

use contact_model::{ContactState, Load, Status, Step, Tangential};
use fractal_contact::scenes::{Options, Plan, SceneFile, run};
use runs::{CsvFile, Silent};

/// The states of a path, as a scene has them: the numbers of a column by model, surface and state.
struct PathColumns {
    scene: SceneFile,
    file: CsvFile,
}

impl PathColumns {
    fn of(text: &str) -> Self {
        let scene =
            SceneFile::parse("scene.toml".as_ref(), text.into()).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let dir = tempfile::tempdir().unwrap();
        let options = Options { out: dir.path().into(), threads: 2, fresh: false };
        // Its small solves follow the path as well.
        let plan = Plan::calibrated(&scene).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let outcome = run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap();
        let file = CsvFile::read(&dir.path().join("results.csv")).unwrap();
        assert!(outcome.failed == 0 && outcome.states == outcome.requested, "{outcome:?}\n{text}");
        Self { scene, file }
    }

    /// A column of a model on a surface, by state.
    fn column(&self, model: &str, surface: usize, name: &str) -> Vec<f64> {
        let values = self.file.numbers(name).unwrap_or_else(|e| panic!("{name}: {e}"));
        let rows = self.file.texts("model").unwrap().into_iter().zip(self.file.numbers("surface").unwrap());
        let of = rows.zip(values).filter(|((m, s), _)| *m == model && *s == Some(surface as f64));
        of.map(|(_, value)| value.unwrap_or_else(|| panic!("{name} of {model} is empty"))).collect()
    }

    /// Compares every state of a model on a surface with the model itself under steps that are written out:
    /// `step` makes each from the number of its state and the states before it. The columns are the same to
    /// the bit.
    fn assert_is(
        &self,
        model: usize,
        surface: usize,
        step: &dyn Fn(usize, &[ContactState]) -> Step,
    ) -> Vec<ContactState> {
        let (numerics, seed) = (&self.scene.models[model], self.scene.seed(surface));
        let physics = self.scene.scene(numerics, seed).unwrap();
        let mut contact = numerics.model().prepare(&physics, seed).unwrap();
        let mut states = Vec::new();
        for i in 0..self.scene.request.count() {
            let state =
                contact.advance(step(i, &states)).unwrap_or_else(|e| panic!("{} {i}: {e}", numerics.name()));
            assert_eq!(state.report.status, Status::Converged);
            states.push(state);
        }
        let compare = |name: &str, get: &dyn Fn(&ContactState) -> Option<f64>| {
            if !states.iter().all(|state| get(state).is_some()) || self.file.numbers(name).is_err() {
                return;
            }
            let found = self.column(numerics.name(), surface, name);
            assert_eq!(found.len(), states.len());
            for (i, (found, state)) in found.iter().zip(&states).enumerate() {
                let expected = get(state).unwrap();
                assert!(
                    found.to_bits() == expected.to_bits(),
                    "{} {name} {i}: {found:e}, {expected:e}",
                    numerics.name()
                );
            }
        };
        compare("force", &|s| Some(s.force));
        compare("approach", &|s| s.approach);
        compare("mean_gap", &|s| s.mean_gap);
        compare("area", &|s| s.area);
        compare("tangential_force", &|s| Some(s.tangential?.force[0]));
        compare("tangential_displacement", &|s| Some(s.tangential?.displacement[0]));
        compare("dissipated", &|s| Some(s.tangential?.dissipated));
        states
    }
}

/// Part `i` of `n` equal ones.
fn part(from: f64, to: f64, i: usize, n: usize) -> f64 {
    if i == n { to } else { from + (to - from) * (i as f64 / n as f64) }
}

fn shift(state: &ContactState) -> f64 {
    state.tangential.unwrap().displacement[0]
}

fn sheared(state: &ContactState) -> f64 {
    state.tangential.unwrap().force[0]
}

/// Part `i` of `n` of the way to a displacement along x. The one reached has the rounding of a solve along y.
fn shifted(from: &ContactState, to: f64, i: usize, n: usize) -> Tangential {
    let [x, y] = from.tangential.unwrap().displacement;
    Tangential::Displacement([part(x, to, i, n), part(y, 0.0, i, n)])
}

/// The same of a tangential force.
fn pushed(from: &ContactState, to: f64, i: usize, n: usize) -> Tangential {
    let [x, y] = from.tangential.unwrap().force;
    Tangential::Force([part(x, to, i, n), part(y, 0.0, i, n)])
}

const BALL: &str = "[scene]\nunits = \"none\"\nmodels = MODELS\nbodies = [{ young = 1, poisson = 0.3 }, \"rigid\"]\n\
    [scene.body]\nkind = \"sphere\"\nradius = 1\nside = 1\n[effects]\nfriction = { coefficient = 0.3, coupling = \"none\" }\n";
const MODELS: [&str; 4] = ["bem3d", "equivalent", "mdr1d_partial_slip", "cattaneo_mindlin"];

fn ball(models: &[&str], path: &str) -> PathColumns {
    let mut text = BALL.replace("MODELS", &format!("{models:?}"));
    for model in models {
        match *model {
            "bem3d" => text += "[models.bem3d]\ncells = 17\n",
            "equivalent" => text += "[models.equivalent]\ncells = 33\n",
            _ => {}
        }
    }
    PathColumns::of(&(text + path))
}

/// To and fro between tangential force and displacement. The increments of friction are four in the piece
/// that an undivided one made one of.
#[test]
fn friction_goes_on_from_the_displacement_and_from_the_force_reached() {
    let path = "[[scene.path]]\nforce = 0.02\n[[scene.path]]\ntangential_force = 0.005\nstates = 4\n\
        [[scene.path]]\ntangential_displacement = -0.002\nstates = 4\n\
        [[scene.path]]\ntangential_force = 0.001\nstates = 3\n";
    let solved = ball(&MODELS, path);
    let mut reached = Vec::new();
    for (model, name) in MODELS.into_iter().enumerate() {
        let states = solved.assert_is(model, 0, &|i, before| {
            Step::new(
                0.0,
                Load::force(0.02).with_tangential(match i {
                    0 => Tangential::default(),
                    1..=4 => Tangential::force_along_x(part(0.0, 0.005, i, 4)),
                    5..=8 => shifted(&before[4], -0.002, i - 4, 4),
                    _ => pushed(&before[8], 0.001, i - 8, 3),
                }),
            )
        });
        // No two rows are the same, and the prescribed ends are met exactly.
        assert!(states.windows(2).all(|pair| (shift(&pair[0]) - shift(&pair[1])).abs() > 0.0), "{name}");
        let ends = [sheared(&states[4]), shift(&states[8]), sheared(&states[11])];
        assert!((ends[0] - 0.005).abs() < 1e-8 && (ends[2] - 0.001).abs() < 1e-8, "{name}: {ends:?}");
        assert!(ends[1].to_bits() == (-0.002f64).to_bits(), "{name}: {ends:?}");
        // The displacement turns at once, so that all contacts stick first: energy is lost in each increment.
        let lost: Vec<f64> = states.iter().map(|state| state.tangential.unwrap().dissipated).collect();
        assert!(lost[4..9].windows(2).all(|pair| pair[1] > pair[0]), "{name}: {lost:?}");
        reached.push(shift(&states[4]));
    }
    // Each model has begun at its own displacement: closed form and springs agree, boundary elements have an
    // error of their cells.
    assert!((reached[2] / reached[3] - 1.0).abs() < 1e-6, "{reached:?}");
    assert!((reached[0] / reached[3] - 1.0).abs() > 1e-4, "{reached:?}");
}

/// The normal load to and fro, before there is a tangential load.
#[test]
fn an_elastic_contact_goes_on_from_the_approach_and_from_the_force_reached() {
    let path = "[[scene.path]]\nforce = 0.02\n[[scene.path]]\napproach = 0.01\nstates = 3\n\
        [[scene.path]]\nforce = 0.03\nstates = 4\n[[scene.path]]\napproach = 0\nstates = 2\n";
    let solved = ball(&MODELS, path);
    for (model, name) in MODELS.into_iter().enumerate() {
        let states = solved.assert_is(model, 0, &|i, before| {
            Step::new(
                0.0,
                match i {
                    0 => Load::force(0.02),
                    1..=3 => Load::approach(part(before[0].approach.unwrap(), 0.01, i, 3)),
                    4..=7 => Load::force(part(before[3].force, 0.03, i - 3, 4)),
                    _ => Load::approach(part(before[7].approach.unwrap(), 0.0, i - 7, 2)),
                },
            )
        });
        // Hertz: F = 4/3 E* sqrt(R) d^(3/2); the cells of the coarsest model leave some per cent.
        let modulus = 1.0 / (1.0 - 0.09);
        for state in &states[..8] {
            let hertz = 4.0 / 3.0 * modulus * state.approach.unwrap().powf(1.5);
            assert!((state.force / hertz - 1.0).abs() < 0.1, "{name}: {} {hertz}", state.force);
        }
        assert_eq!((states[9].force, states[9].approach), (0.0, Some(0.0)), "{name}");
    }
}

/// Both quantities change at once: the piece goes straight in the new ones.
#[test]
fn normal_and_tangential_load_may_change_together() {
    let path = "[[scene.path]]\nforce = 0.02\n[[scene.path]]\ntangential_force = 0.005\nstates = 2\n\
        [[scene.path]]\napproach = 0.06\ntangential_displacement = 0.001\nstates = 3\n\
        [[scene.path]]\nforce = 0.03\ntangential_force = -0.004\nstates = 3\n";
    let solved = ball(&MODELS[..3], path);
    for model in 0..3 {
        solved.assert_is(model, 0, &|i, before| match i {
            0..=2 => {
                let tangential = Tangential::force_along_x(part(0.0, 0.005, i, 2));
                Step::new(0.0, Load::force(0.02).with_tangential(tangential))
            }
            3..=5 => {
                let (from, i) = (&before[2], i - 2);
                let tangential = shifted(from, 0.001, i, 3);
                let approach = part(from.approach.unwrap(), 0.06, i, 3);
                Step::new(0.0, Load::approach(approach).with_tangential(tangential))
            }
            _ => {
                let (from, i) = (&before[5], i - 5);
                let tangential = pushed(from, -0.004, i, 3);
                Step::new(0.0, Load::force(part(from.force, 0.03, i, 3)).with_tangential(tangential))
            }
        });
    }
}

const ROUGH: &str = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nmodulus = 1\n\
    [scene.surface]\nkind = \"self_affine\"\nside = 1\nhurst = 0.8\nrms_height = 0.02\n[sampling]\nseed = 3\n\
    surfaces = 2\n[models.bem3d]\ncells = 32\n";

/// Each surface begins at its own state.
#[test]
fn a_plastic_contact_is_drawn_off_from_the_approach_reached() {
    let path = "[[scene.path]]\nforce = 0.005\nstates = 2\n[[scene.path]]\napproach = 0.03\nstates = 3\n\
        [[scene.path]]\nforce = 0.008\nstates = 3\n";
    let solved =
        PathColumns::of(&format!("{ROUGH}[effects]\nhardness = 0.05\n[outputs]\narea = true\n{path}"));
    let starts = [0, 1].map(|surface| {
        let states = solved.assert_is(0, surface, &|i, before| {
            Step::new(
                0.0,
                match i {
                    0 | 1 => Load::force(part(0.0, 0.005, i + 1, 2)),
                    2..=4 => Load::approach(part(before[1].approach.unwrap(), 0.03, i - 1, 3)),
                    _ => Load::force(part(before[4].force, 0.008, i - 4, 3)),
                },
            )
        });
        assert!(states[5].force > states[4].force && states[7].plastic.unwrap().volume > 0.0);
        states[1].approach.unwrap()
    });
    assert!((starts[0] - starts[1]).abs() > 1e-4, "{starts:?}");
}

/// The ball is drawn off in six states, and pressed by a force again.
#[test]
fn an_adhesive_contact_is_drawn_off_from_the_approach_reached() {
    for adhesion in [
        "{ work = 0.002 }",
        "{ work = 0.002, range = 0.02, law = \"dugdale\" }",
        "{ work = 0.002, range = 0.02, law = \"exponential\" }",
    ] {
        let text = format!(
            "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nmodulus = 1\n[scene.body]\nkind = \"sphere\"\nradius = 1\nside = 1\n\
             [effects]\nadhesion = {adhesion}\n[outputs]\narea = true\n[models.bem3d]\ncells = 64\n\
             [[scene.path]]\nforce = 0.003\n[[scene.path]]\napproach = 0\nstates = 6\n[[scene.path]]\nforce = 0.001\nstates = 2\n"
        );
        let solved = PathColumns::of(&text);
        let states = solved.assert_is(0, 0, &|i, before| {
            Step::new(
                0.0,
                match i {
                    0 => Load::force(0.003),
                    1..=6 => Load::approach(part(before[0].approach.unwrap(), 0.0, i, 6)),
                    _ => Load::force(part(before[6].force, 0.001, i - 6, 2)),
                },
            )
        });
        let approaches: Vec<f64> = states[..7].iter().map(|state| state.approach.unwrap()).collect();
        for (i, approach) in approaches.iter().enumerate() {
            let expected = approaches[0] * (6 - i) as f64 / 6.0;
            assert!((approach - expected).abs() < 1e-15, "{adhesion}: {approaches:?}");
        }
        assert!(states[..7].windows(2).all(|pair| pair[1].force < pair[0].force), "{adhesion}");
    }
}

/// A mean gap that a piece begins at is known although it is no output, and costs no column.
#[test]
fn a_periodic_contact_goes_on_from_the_mean_gap_reached() {
    let path = "[[scene.path]]\nmean_pressure = 0.002\n[[scene.path]]\nmean_gap = 0.03\nstates = 4\n\
        [[scene.path]]\nmean_pressure = 0.01\nstates = 3\n";
    for effect in ["hardness = 0.3", "adhesion = { work = 1e-4, range = 0.01, law = \"exponential\" }"] {
        let text = |outputs: &str| {
            format!(
                "{ROUGH}[effects]\nboundary = \"periodic\"\n{effect}\n[outputs]\narea = true\n{outputs}{path}"
            )
        };
        let solved = PathColumns::of(&text("mean_gap = true\n"));
        let states = solved.assert_is(0, 1, &|i, before| {
            Step::new(
                0.0,
                match i {
                    0 => Load::force(0.002),
                    1..=4 => Load::mean_gap(part(before[0].mean_gap.unwrap(), 0.03, i, 4)),
                    _ => Load::force(part(before[4].force, 0.01, i - 4, 3)),
                },
            )
        });
        // Met to the tolerance, in rms heights.
        let gap = |i: usize| states[i].mean_gap.unwrap();
        assert!((1..=4).all(|i| (gap(i) - part(gap(0), 0.03, i, 4)).abs() < 1e-7), "{effect}: {}", gap(0));
        let silent = PathColumns::of(&text(""));
        assert!(silent.file.numbers("mean_gap").is_err());
        for name in ["force", "area"] {
            assert_eq!(silent.column("bem3d", 0, name), solved.column("bem3d", 0, name), "{effect}");
        }
    }
}

/// A step of a viscoelastic contact is exact however long it is, so that a division changes nothing at its
/// end.
#[test]
fn a_relaxing_contact_ends_where_an_undivided_piece_does() {
    let text = |states: usize| {
        format!(
            "[scene]\nunits = \"none\"\nmodels = [\"mdr1d_viscoelastic\", \"equivalent\"]\ncontact_modulus = 1\n\
             [scene.body]\nkind = \"sphere\"\nradius = 1\nside = 1\n[models.equivalent]\ncells = 33\n\
             [effects]\nrheology = {{ kind = \"standard_solid\", weight = 2.0, time = 1 }}\n\
             [[scene.path]]\ntime = 1\nforce = 0.01\n[[scene.path]]\ntime = 2\napproach = 0.06\nstates = {states}\n\
             [[scene.path]]\ntime = 3\nforce = 0.08\nstates = {states}\n"
        )
    };
    let (once, divided) = (PathColumns::of(&text(1)), PathColumns::of(&text(4)));
    for (model, name, tolerance) in [(0, "mdr1d_viscoelastic", 1e-9), (1, "equivalent", 1e-3)] {
        let states = divided.assert_is(model, 0, &|i, before| {
            let normal = match i {
                0 => Load::force(0.01),
                1..=4 => Load::approach(part(before[0].approach.unwrap(), 0.06, i, 4)),
                _ => Load::force(part(before[4].force, 0.08, i - 4, 4)),
            };
            Step::new(1.0 + 0.25 * i as f64, normal)
        });
        let force = once.column(name, 0, "force");
        let approach = once.column(name, 0, "approach");
        assert!(
            (states[4].force / force[1] - 1.0).abs() < tolerance,
            "{name}: {} {}",
            states[4].force,
            force[1]
        );
        let last = states[8].approach.unwrap();
        assert!(last > 0.06, "{name}: {last}");
        // Between force and approach the way differs: straight in the force.
        assert!((last / approach[2] - 1.0).abs() < 10.0 * tolerance, "{name}: {last} {}", approach[2]);
    }
}

/// A path of forces meets zero exactly, and states of small forces converge.
#[test]
fn a_path_of_forces_crosses_zero() {
    let text = |path: &str| {
        format!(
            "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nmodulus = 1\n{path}[scene.surface]\nkind = \"self_affine\"\n\
             side = 1\nhurst = 0.8\nrms_height = 0.05\nroll_off_wavelength = 0.5\nshortest_wavelength = 0.25\n\
             [effects]\nboundary = \"periodic\"\nadhesion = {{ work = 0.05, range = 0.2 }}\n[models.bem3d]\ncells = 16\n\
             [sampling]\nseed = 1\n"
        )
    };
    let solved =
        PathColumns::of(&text("[[scene.path]]\nforce = 0.3\n[[scene.path]]\nforce = -0.1\nstates = 4\n"));
    let states = solved.assert_is(0, 0, &|i, _| {
        let forces = [0.3, 0.3 - 0.4 * 0.25, 0.3 - 0.4 * 0.5, 0.0, -0.1];
        Step::new(0.0, Load::force(forces[i]))
    });
    assert!(states[3].force.abs() < 1e-6, "{:e}", states[3].force);
    // Far below the rounding of both forces, at it, and far below their tolerance.
    for small in ["5.551115123125783e-17", "-1e-300", "1e-13", "-1e-9", "1e-5"] {
        let path = format!(
            "[[scene.path]]\nforce = 0.3\n[[scene.path]]\nforce = {small}\n[[scene.path]]\nforce = -0.1\n"
        );
        let solved = PathColumns::of(&text(&path));
        let found = solved.column("bem3d", 0, "force")[1];
        assert!((found - small.parse::<f64>().unwrap()).abs() < 1e-6, "{small}: {found:e}");
    }
}

/// Under a force of zero the two forces of pressure and attraction leave their rounding, which is no load that
/// has changed.
#[test]
fn a_force_of_zero_that_is_held_stays_on_its_branch() {
    let text = "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nmodulus = 1\n[scene.body]\nkind = \"sphere\"\nradius = 1\nside = 1\n\
        [effects]\nadhesion = { work = 0.002, range = 0.05, law = \"exponential\" }\n[models.bem3d]\ncells = CELLS\ntolerance = 1e-12\n\
        [[scene.path]]\nforce = 0.003\n[[scene.path]]\nforce = 0\n[[scene.path]]\nforce = 0\nstates = 3\n";
    for cells in ["48", "64", "96"] {
        let solved = PathColumns::of(&text.replace("CELLS", cells));
        assert_eq!(solved.file.texts("branch").unwrap()[1..], ["withdrawal"; 4], "{cells} cells");
    }
}

/// Pressing a rough contact with full coupling displaces it although no tangential force acts: a prescribed
/// displacement begins there, and not at zero.
#[test]
fn a_coupled_contact_is_displaced_from_where_pressing_has_left_it() {
    let text = format!(
        "{}[effects]\nfriction = {{ coefficient = 0.3, coupling = \"full\" }}\n[[scene.path]]\nforce = 0.01\n\
         [[scene.path]]\ntangential_displacement = 0.004\nstates = 4\n",
        ROUGH
            .replace("modulus = 1", "bodies = [{ young = 1, poisson = 0.1 }, \"rigid\"]")
            .replace("surfaces = 2", "surfaces = 1")
            .replace("cells = 32", "cells = 16")
    );
    let states = PathColumns::of(&text).assert_is(0, 0, &|i, before| {
        let tangential = if i == 0 { Tangential::default() } else { shifted(&before[0], 0.004, i, 4) };
        Step::new(0.0, Load::force(0.01).with_tangential(tangential))
    });
    assert!(shift(&states[0]).abs() > 1e-5 && sheared(&states[0]).abs() <= 0.0, "{:?}", states[0].tangential);
}

/// No error of the grid is estimated along a path, and a note says so; under loads one by one there is none.
#[test]
fn an_error_of_the_grid_that_is_not_estimated_is_a_note() {
    let notes = |load: &str, path: &str| {
        let text = format!(
            "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1\n{load}\n{path}\n[scene.body]\n\
             kind = \"sphere\"\nradius = 1\nside = 0.5\n[models.bem3d]\ncells = 33\n[effects]\n\
             adhesion = {{ work = 1e-4 }}\n[outputs]\narea = true\ngrid_error = true\n"
        );
        let scene = SceneFile::parse("scene.toml".as_ref(), text).unwrap_or_else(|e| panic!("{e}"));
        let plan = Plan::new(&scene).unwrap();
        plan.notes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let of_path = notes("", "[[scene.path]]\nforce = 1e-3");
    assert!(of_path.contains("the error of the grid is not estimated along a path"), "{of_path}");
    // A pull as a mean pressure is a load as one by its force is.
    for load in ["force = -1e-5", "mean_pressure = -1e-5"] {
        assert!(!notes(load, "").contains("is not estimated"), "{load}");
    }
}

/// The energy of each cycle is what the dissipated energy grows by in it, in the table and on the console.
#[test]
fn each_cycle_has_its_energy() {
    let piece = |end: f64| format!("[[scene.path]]\ntangential_displacement = {end}\nstates = 3\n");
    let to_and_fro: String = [2e-3, -2e-3, 2e-3, -2e-3, 2e-3].map(piece).concat();
    let text = BALL.replace("MODELS", "[\"bem3d\", \"cattaneo_mindlin\"]")
        + "[models.bem3d]\ncells = 17\n[[scene.path]]\nforce = 0.05\n"
        + &to_and_fro;
    let scene = SceneFile::parse("scene.toml".as_ref(), text).unwrap_or_else(|e| panic!("{e}"));
    let dir = tempfile::tempdir().unwrap();
    let options = Options { out: dir.path().into(), threads: 2, fresh: false };
    let plan = Plan::new(&scene).unwrap();
    let outcome = run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap();
    let [states, cycles] =
        ["results.csv", "cycles.csv"].map(|file| CsvFile::read(&dir.path().join(file)).unwrap());
    assert_eq!(cycles.texts("model").unwrap(), ["bem3d", "bem3d", "cattaneo_mindlin", "cattaneo_mindlin"]);
    let dissipated = states.numbers("dissipated").unwrap();
    let of_cycles = cycles.numbers("dissipated").unwrap();
    let [first, last] = ["first_state", "last_state"].map(|column| cycles.numbers(column).unwrap());
    for (row, energy) in of_cycles.iter().enumerate() {
        let at = |state: Option<f64>| dissipated[16 * (row / 2) + state.unwrap() as usize].unwrap();
        assert_eq!([first[row], last[row]], [[Some(3.0), Some(9.0)], [Some(9.0), Some(15.0)]][row % 2]);
        assert!((energy.unwrap() - (at(last[row]) - at(first[row]))).abs() <= 1e-12 * at(last[row]));
    }
    // The closed loop of a sphere repeats itself.
    assert!((of_cycles[2].unwrap() / of_cycles[3].unwrap() - 1.0).abs() < 1e-9, "{of_cycles:?}");
    assert!(outcome.summary.contains("cycle 2, states 9 to 15: dissipated "), "{}", outcome.summary);
}
