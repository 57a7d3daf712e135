//! Bodies with exact solutions: every model is compared with every problem that it accepts.

use analytic::{FlatPunch, Hertz, PowerLaw, PowerLawBody};
use bem3d::Bem3d;
use contact_model::ContactModel;
use mdr1d::Mdr1d;
use tests::{Deviation, PrescribedQuantity, deviation, order, problems};

/// Closed forms: a few roundings, times 1/n = 2 for the power n = 1/2.
const CLOSED_FORM: f64 = 1e-12;
/// The one-dimensional method is exact for round bodies; its kappa_n comes from another formula than that of
/// the theory.
const ONE_DIMENSION: f64 = 1e-10;

/// Grids of the orders of convergence, odd so that the apex is a cell centre.
const GRIDS: [usize; 3] = [65, 129, 257];

/// The expected convergence of a discretisation.
struct ExpectedConvergence {
    names: &'static [&'static str],
    /// Order of the response (force or approach), of the stiffness and of the area.
    response: std::ops::Range<f64>,
    stiffness: std::ops::Range<f64>,
    area: std::ops::Range<f64>,
    /// Largest errors on the finest grid, in the same order.
    finest: [f64; 3],
}

/// Measured, then rounded up by about two.
const TABLE: [ExpectedConvergence; 3] = [
    // The contact edge is a staircase, off by a fraction of a cell: area and stiffness are of first order,
    // better where the steps average out along the edge (3/2), hence noisy. The force at given approach is
    // stationary in the contact set, so its error is of second order in the same fraction.
    ExpectedConvergence {
        names: &["sphere", "cone", "power law n = 1/2", "power law n = 3"],
        response: 1.7..2.3,
        stiffness: 0.9..1.8,
        area: 0.8..1.6,
        finest: [2.5e-5, 1e-3, 5e-3],
    },
    // A punch's pressure grows like 1/sqrt(distance) at its edge, which cells resolve to first order; force,
    // approach and stiffness are the same number. The round edge adds its staircase.
    ExpectedConvergence {
        names: &["flat circle"],
        response: 0.8..1.4,
        stiffness: 0.8..1.4,
        area: 0.8..2.0,
        finest: [3e-3, 3e-3, 1e-3],
    },
    // No staircase: first order without noise, k_N = k (1 - 0.35/N + ...). The area is exact.
    ExpectedConvergence {
        names: &["flat square"],
        response: 0.97..1.01,
        stiffness: 0.97..1.01,
        area: 0.0..0.0,
        finest: [1.4e-3, 1.4e-3, CLOSED_FORM],
    },
];

#[test]
fn boundary_elements_converge_with_their_order() {
    for problem in problems().unwrap() {
        let expected = TABLE.iter().find(|row| row.names.contains(&problem.name)).unwrap();
        for prescribed in [PrescribedQuantity::Approach, PrescribedQuantity::Force] {
            let found: Vec<(usize, Deviation)> = (GRIDS.iter())
                .map(|&cells| {
                    let model = Bem3d { cells, tolerance: 1e-8, ..Bem3d::default() };
                    (cells, deviation(&model, &problem, prescribed).unwrap().unwrap())
                })
                .collect();
            for (what, pick, band, finest) in [
                (
                    "response",
                    (|d| d.response) as fn(&Deviation) -> f64,
                    &expected.response,
                    expected.finest[0],
                ),
                ("stiffness", |d| d.stiffness, &expected.stiffness, expected.finest[1]),
                ("area", |d| d.area, &expected.area, expected.finest[2]),
            ] {
                let errors: Vec<_> = found.iter().map(|(n, d)| (*n, pick(d))).collect();
                let place = format!("{}, {prescribed:?}, {what}: {errors:?}", problem.name);
                assert!(errors[2].1 <= finest, "{place}");
                if !band.is_empty() {
                    let order = order(&errors).unwrap();
                    assert!(band.contains(&order), "order {order}, {place}");
                }
            }
        }
    }
}

/// Which model accepts which problem, and how exact it is there.
#[test]
fn exact_models_are_exact_where_they_accept() {
    let round: &[&str] = &["sphere", "cone", "power law n = 1/2", "power law n = 3"];
    let models: [(&dyn ContactModel, &[&str], f64); 5] = [
        (&Mdr1d::default(), &[round, &["flat circle"]].concat(), ONE_DIMENSION),
        (&Hertz, &["sphere"], CLOSED_FORM),
        (&PowerLawBody, round, CLOSED_FORM),
        (&FlatPunch, &["flat circle", "flat square"], CLOSED_FORM),
        (&PowerLaw, &[], 0.0),
    ];
    for (model, accepted, tolerance) in models {
        for problem in problems().unwrap() {
            for prescribed in [PrescribedQuantity::Approach, PrescribedQuantity::Force] {
                let found = deviation(model, &problem, prescribed).unwrap();
                let place = format!("{} on the {}: {found:?}", model.name(), problem.name);
                assert_eq!(found.is_some(), accepted.contains(&problem.name), "{place}");
                if let Some(found) = found {
                    let worst = found.response.max(found.stiffness).max(found.area);
                    assert!(worst <= tolerance, "{place}");
                }
            }
        }
    }
}

/// Hertz's results as printed numbers: E* = R = 1, F = 1e-3.
#[test]
fn hertz_has_its_printed_numbers() {
    use contact_model::{Load, Scene, Surface};
    let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 0.25.into() }, 1.0);
    // Second and first order at 92 cells across the contact (see TABLE).
    let model = Bem3d { cells: 127, tolerance: 1e-8, ..Bem3d::default() };
    let state = model.prepare(&scene, 0).unwrap().solve(Load::force(1e-3)).unwrap();
    approx::assert_relative_eq!(state.approach.unwrap(), 0.008_254_818_122, max_relative = 5e-5);
    approx::assert_relative_eq!(state.stiffness.unwrap(), 2.0 * 0.090_856_029_642, max_relative = 3e-3);
}
