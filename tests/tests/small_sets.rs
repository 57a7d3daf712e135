//! Sets of cells with known stiffness: full squares, two cells, two circles.

use approx::assert_relative_eq;
use bem3d::{Bem3d, Method};
use contact_model::{ContactModel, HeightMap, Load, Scene, Surface};
use tests::{map, scene};

/// The printed digits.
const PRINTED: f64 = 6e-10;
/// The extrapolation of k_N is good to a few units of its seventh digit.
const FORMULA: f64 = 1e-6;

fn stiffness(model: &Bem3d, scene: &Scene, approach: f64) -> f64 {
    model.prepare(scene, 0).unwrap().solve(Load::approach(approach)).unwrap().stiffness.unwrap()
}

fn square(cells: usize, method: Method) -> f64 {
    let model = Bem3d { cells, tolerance: 1e-10, method, ..Bem3d::default() };
    stiffness(&model, &Scene::new(Surface::Flat { size: 1.0.into() }, 1.0), 1.0)
}

#[test]
fn full_contact_of_n_times_n_cells() {
    for (cells, k) in [
        (1, 0.891_106_989),
        (2, 0.993_186_221),
        (3, 1.040_161_425),
        (4, 1.065_467_232),
        (8, 1.106_498_258),
        (16, 1.128_630_66),
        (32, 1.140_213_49),
        (64, 1.146_173_10),
        (96, 1.148_191_67),
    ] {
        for method in [Method::Auto, Method::Iterative] {
            // Half a unit of the last printed digit, 5e-9 from 16 cells on.
            let printed = if cells < 16 { PRINTED } else { 6e-9 };
            assert_relative_eq!(square(cells, method), k, max_relative = printed);
        }
    }
}

#[test]
fn full_contact_between_the_table_and_the_continuum() {
    let n = 128.0_f64;
    let formula = 1.152_298_5 - 0.402_5 / n + 0.12 / n.powf(1.59);
    assert_relative_eq!(square(128, Method::Auto), formula, max_relative = FORMULA);
}

/// The plateau of a correct N x N code in the normalisation of the paper, which lies above its 1.
#[test]
fn plateaus_in_the_units_of_the_paper() {
    for (cells, plateau) in [(129, 1.00642), (257, 1.00775)] {
        let k_bar = square(cells, Method::Auto) / contact_model::PAPER_STIFFNESS_FACTOR;
        // Half a unit of the last printed digit.
        assert_relative_eq!(k_bar, plateau, epsilon = 5e-6);
    }
}

/// A map with height 0 on the cells that `face` selects, and lower by one side elsewhere.
fn faces(cells: usize, side: f64, face: impl Fn(usize, usize) -> bool) -> HeightMap {
    map(cells, side, |x, y| if face(x, y) { 0.0 } else { -side }).unwrap()
}

#[test]
fn two_cells() {
    for (cells, first) in [(2, (0, 0)), (3, (1, 1)), (7, (2, 4)), (64, (0, 61))] {
        for (dx, dy, k) in [(1, 0, 1.376_821_433_419), (0, 1, 1.376_821_433_419), (1, 1, 1.478_329_831_506)] {
            let (x0, y0) = first;
            let pair = [(x0, y0), (x0 + dx, y0 + dy)];
            if pair[1].0 >= cells || pair[1].1 >= cells {
                continue;
            }
            let map = faces(cells, 1.0, |x, y| pair.contains(&(x, y)));
            let cell = map.dx();
            let scene = scene(map);
            for method in [Method::Auto, Method::Iterative] {
                let model = Bem3d { tolerance: 1e-12, method, ..Bem3d::default() };
                // Twelve printed digits.
                assert_relative_eq!(stiffness(&model, &scene, 1e-3), k * cell, max_relative = 1e-12);
            }
        }
    }
}

/// Two circles of radius 1, centres 4 apart: k = 3.4436977378 E* a.
const TWO_CIRCLES: f64 = 3.443_697_737_8;
/// Sides of the square in radii. The error for one side depends on the position of the round edge relative to
/// the cells; the mean does not.
const SIDES: [f64; 8] = [6.13, 6.29, 6.41, 6.57, 6.71, 6.83, 6.97, 7.11];

/// Mean relative error of k over [`SIDES`].
fn two_circles(cells: usize) -> f64 {
    let error = |side: f64| {
        let centre = |i: usize| (i as f64 + 0.5) * side / cells as f64 - 0.5 * side;
        let round = |x, y| (f64::abs(centre(x)) - 2.0).powi(2) + f64::powi(centre(y), 2) <= 1.0;
        let model = Bem3d { tolerance: 1e-7, ..Bem3d::default() };
        stiffness(&model, &scene(faces(cells, side, round)), 1e-3) / TWO_CIRCLES - 1.0
    };
    SIDES.map(error).iter().sum::<f64>() / SIDES.len() as f64
}

#[test]
fn two_circles_converge() {
    // First order: the edge singularity (see `exact_bodies`).
    let errors = [48, 96, 192].map(|cells| (cells, two_circles(cells)));
    let order = tests::order(&errors).unwrap();
    assert!((0.7..1.4).contains(&order), "order {order}: {errors:?}");
    // Without its first order the error is that of the staircase: a third of what it was.
    let extrapolated = 2.0 * errors[2].1 - errors[1].1;
    assert!(extrapolated.abs() < 2e-3, "{extrapolated:.2e} after {errors:?}");
}
