//! Hertz's contact, whose stress is known on the axis.

use super::*;

/// The pressure `sqrt(1 - r^2)` on a map of side 2.5, an odd number of cells so that one is on the axis.
fn contact(cells: usize) -> SurfaceLoad {
    let d = 2.5 / cells as f64;
    let place = |i: usize| (i as f64 + 0.5) * d - 1.25;
    // The mean over a cell of 4 x 4 points, so that the edge does not come in steps.
    let mean = |i: usize| {
        let (x, y) = (place(i % cells), place(i / cells));
        let offset = |k: usize| (k as f64 - 1.5) * 0.25 * d;
        let at = |k: usize| {
            let r2 = (x + offset(k % 4)).powi(2) + (y + offset(k / 4)).powi(2);
            (1.0 - r2).max(0.0).sqrt()
        };
        (0..16).map(at).sum::<f64>() / 16.0
    };
    SurfaceLoad::new(Field::new(cells, 2.5, (0..cells * cells).map(mean).collect()).unwrap()).unwrap()
}

/// sigma_r and sigma_z on the axis (K. L. Johnson, Contact Mechanics, Eqs. 3.45).
fn on_axis(z: f64, nu: f64) -> [f64; 2] {
    let share = (1.0 + z * z).recip();
    let angle = if z > 0.0 { z * z.recip().atan() } else { 0.0 };
    [0.5 * share - (1.0 + nu) * (1.0 - angle), -share]
}

#[test]
fn the_stress_on_the_axis_converges_to_the_closed_form() {
    for nu in [0.0, 0.3, 0.5] {
        let error = |cells: usize| {
            let load = contact(cells);
            let points = [0.1, 0.3, 0.5, 1.0, 2.0, 20.0].map(|z| [1.25, 1.25, z]);
            let stress = stress_at_points(&load, StressedBody::new(nu), &points, &never).unwrap();
            let differences = points.iter().zip(stress).map(|([_, _, z], [xx, yy, zz, yz, xz, xy])| {
                let [r, axial] = on_axis(*z, nu);
                assert!(
                    [yz, xz, xy, xx - yy].iter().all(|value| value.abs() < 1e-13),
                    "on the axis of symmetry"
                );
                (xx - r).abs().max((zz - axial).abs())
            });
            differences.fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(25), error(101));
        // The edge of the load, where its slope is infinite, leaves at least the order 3/2: a factor of 8.
        assert!(fine < 3e-4 && fine < coarse / 6.0, "{nu}: {coarse:e} {fine:e}");
    }
}

#[test]
fn the_largest_von_mises_stress_is_that_of_the_textbook() {
    let depths = [0.2, 0.35, 0.5, 0.7, 1.0];
    for (nu, value, depth, factor) in [(0.3, 0.62004, 0.48086, 1.6128), (0.5, 0.53270, 0.54787, 1.8772)] {
        let find = |cells: usize| {
            largest_von_mises(&contact(cells), StressedBody::new(nu), &depths, &never).unwrap()
        };
        let (coarse, fine) = (find(33), find(129));
        assert_eq!(fine.cell, [64, 64]);
        assert!((fine.centre[0] - 1.25).abs() < 1e-15);
        let errors = [coarse, fine].map(|found| (found.value - value).abs());
        assert!(errors[1] < 2e-4 && errors[1] < errors[0] / 5.0, "{nu}: {errors:?}");
        assert!((fine.depth - depth).abs() < 1e-3, "{nu}: {}", fine.depth);
        assert!((fine.factor_until_yield(1.0).unwrap().unwrap() - factor).abs() < 1e-3);
        assert!((von_mises(&fine.stress) - fine.value).abs() < 1e-15);
        // On the axis von Mises and Tresca are the same.
        assert!((tresca(&fine.stress) - fine.value).abs() < 1e-12);
    }
}

#[test]
fn the_depth_is_refined_to_the_maximum_of_the_grid() {
    let load = contact(33);
    let body = StressedBody::new(0.3);
    let found = largest_von_mises(&load, body, &[0.3, 1.0], &never).unwrap();
    let points: Vec<[f64; 3]> = (0..=200).map(|k| [1.25, 1.25, 0.44 + 4e-4 * f64::from(k)]).collect();
    let values = stress_at_points(&load, body, &points, &never).unwrap();
    let largest = values.iter().map(von_mises).fold(0.0, f64::max);
    assert!((found.value - largest).abs() < 1e-7, "{} {largest}", found.value);
    // A single depth, and one on the far side of the maximum, are no bracket.
    assert!((largest_von_mises(&load, body, &[1.0], &never).unwrap().depth - 1.0).abs() <= 0.0);
}
