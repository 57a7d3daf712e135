//! Maps that repeat themselves, as free maps with many copies.

use super::*;

/// What extrapolation to infinitely many copies leaves.
const EXTRAPOLATED: f64 = 3e-5;
/// The same of copies along one axis, of which there are more.
const ALONG_A_LINE: f64 = 5e-6;

const CELLS: [usize; 2] = [4, 3];
const SIZE: [f64; 2] = [2.0, 1.5];

/// The load with `copies` copies along each axis.
fn repeated(load: &SurfaceLoad, copies: [usize; 2]) -> SurfaceLoad {
    let [columns, rows] = [0, 1].map(|axis| copies[axis] * CELLS[axis]);
    changed(load, |_, field| {
        let values = (0..columns * rows).map(|i| field.at(i % columns % CELLS[0], i / columns % CELLS[1]));
        let size = [0, 1].map(|axis| copies[axis] as f64 * SIZE[axis]);
        Field::new([columns, rows], size, values.collect()).unwrap()
    })
}

/// The stress in the middle copy, without that of the mean load on all copies.
fn without_mean(load: &SurfaceLoad, copies: [usize; 2], nu: f64, depth: f64) -> Vec<[f64; 6]> {
    let mean = changed(load, |_, field| {
        let mean = field.values().iter().sum::<f64>() / 12.0;
        Field::new(CELLS, SIZE, field.values().iter().map(|value| value - mean).collect()).unwrap()
    });
    let middle = [0, 1].map(|axis| (copies[axis] / 2) as f64 * SIZE[axis]);
    let places: Vec<[f64; 3]> =
        centres(load, depth).into_iter().map(|[x, y, z]| [x + middle[0], y + middle[1], z]).collect();
    stress_at_points(&repeated(&mean, copies), StressedBody::new(nu), &places, &never).unwrap()
}

/// The value at infinitely many copies of the polynomial in `1/copies` through all values.
fn extrapolated(values: &[Vec<[f64; 6]>], copies: &[usize]) -> Vec<[f64; 6]> {
    let h: Vec<f64> = copies.iter().map(|&count| (count as f64).recip()).collect();
    let lagrange = |i: usize| (0..h.len()).filter(|j| *j != i).map(|j| h[j] / (h[j] - h[i])).product::<f64>();
    let weights: Vec<f64> = (0..h.len()).map(lagrange).collect();
    let sum = |cell: usize, component: usize| {
        values.iter().zip(&weights).map(|(values, weight)| weight * values[cell][component]).sum()
    };
    (0..12).map(|cell| std::array::from_fn(|component| sum(cell, component))).collect()
}

#[test]
fn a_periodic_map_is_a_free_one_with_many_copies() {
    let load = full_load(CELLS, SIZE, 7);
    let mean = changed(&load, |_, field| {
        Field::new(CELLS, SIZE, vec![field.values().iter().sum::<f64>() / 12.0; 12]).unwrap()
    });
    for nu in [0.0, 0.45] {
        for depth in [0.0, 0.2, 0.9] {
            let body = StressedBody { boundary: Boundary::Periodic, ..StressedBody::new(nu) };
            let of_mean = at_depth(&mean, body, depth);
            let varying: Vec<[f64; 6]> = at_depth(&load, body, depth)
                .into_iter()
                .zip(of_mean)
                .map(|(all, mean)| std::array::from_fn(|i| all[i] - mean[i]))
                .collect();
            // The tractions of a copy have a dipole, whose lateral stress falls as r^-3: N copies a side
            // leave 1/N.
            let copies = [7, 13, 25, 41];
            let sums = copies.map(|count| without_mean(&load, [count; 2], nu, depth));
            let errors = sums.each_ref().map(|sum| relative_difference(&varying, sum));
            let ratio = errors[2] / errors[3];
            assert!((1.5..1.8).contains(&ratio), "{nu} {depth}: {errors:?}");
            let error = relative_difference(&varying, &extrapolated(&sums, &copies));
            assert!(error < EXTRAPOLATED, "{nu} {depth}: {error:e}");
        }
    }
}

#[test]
fn a_map_that_repeats_itself_along_a_line_is_a_free_one_with_many_copies() {
    let load = full_load(CELLS, SIZE, 9);
    for boundary in [Boundary::PeriodicAlongX, Boundary::PeriodicAlongY] {
        let axis = usize::from(boundary == Boundary::PeriodicAlongY);
        // The mean along the line, which the strips of plane strain are.
        let mean = changed(&load, |_, field| {
            let values = (0..12).map(|i| {
                let (ix, iy) = (i % 4, i / 4);
                if axis == 0 {
                    (0..4).map(|ix| field.at(ix, iy)).sum::<f64>() / 4.0
                } else {
                    (0..3).map(|iy| field.at(ix, iy)).sum::<f64>() / 3.0
                }
            });
            Field::new(CELLS, SIZE, values.collect()).unwrap()
        });
        let varying = changed(&load, |part, field| {
            let mean = [mean.pressure(), &mean.traction().unwrap()[0], &mean.traction().unwrap()[1]][part];
            let values = field.values().iter().zip(mean.values()).map(|(all, mean)| all - mean);
            Field::new(CELLS, SIZE, values.collect()).unwrap()
        });
        for nu in [0.0, 0.3, 0.5] {
            for depth in [0.0, 0.05, 0.9] {
                let body = StressedBody { boundary, ..StressedBody::new(nu) };
                let expected = at_depth(&varying, body, depth);
                let copies = [21, 41, 81, 161];
                let sums = copies.map(|count| {
                    let mut copies = [1, 1];
                    copies[axis] = count;
                    let middle = [0, 1].map(|axis| (copies[axis] / 2) as f64 * SIZE[axis]);
                    let places: Vec<[f64; 3]> = centres(&load, depth)
                        .into_iter()
                        .map(|[x, y, z]| [x + middle[0], y + middle[1], z])
                        .collect();
                    stress_at_points(&repeated(&varying, copies), StressedBody::new(nu), &places, &never)
                        .unwrap()
                });
                let errors = sums.each_ref().map(|sum| relative_difference(&expected, sum));
                // N copies of a dipole leave N^-2, and (161/81)^2 = 4.0.
                let ratio = errors[2] / errors[3];
                assert!((3.3..8.0).contains(&ratio), "{boundary:?} {nu} {depth}: {errors:?}");
                let error = relative_difference(&expected, &extrapolated(&sums, &copies));
                assert!(error < ALONG_A_LINE, "{boundary:?} {nu} {depth}: {error:e}");
            }
        }
    }
}

#[test]
fn the_mean_along_a_line_is_plane_strain() {
    // A band of uniform pressure of width 2 b: K. L. Johnson, Contact Mechanics, Eqs. 2.30 and 2.31.
    let values = (0..40 * 3).map(|i| f64::from((15..25).contains(&(i / 3)))).collect();
    let load = SurfaceLoad::new(Field::new([3, 40], [0.3, 4.0], values).unwrap()).unwrap();
    let nu = 0.3;
    let body = StressedBody { boundary: Boundary::PeriodicAlongX, ..StressedBody::new(nu) };
    for z in [0.0, 0.2, 3.0] {
        for (i, stress) in at_depth(&load, body, z).into_iter().enumerate() {
            let y = 0.1 * ((i / 3) as f64 + 0.5) - 2.0;
            let angle = |edge: f64| z.atan2(y - edge);
            let (first, second) = (angle(-0.5), angle(0.5));
            let spread = 2.0 * (second - first);
            let sines = (2.0 * second).sin() - (2.0 * first).sin();
            let cosines = (2.0 * first).cos() - (2.0 * second).cos();
            let normal = [-(spread + sines) / (2.0 * PI), -(spread - sines) / (2.0 * PI)];
            let expected =
                [nu * (normal[0] + normal[1]), normal[0], normal[1], -cosines / (2.0 * PI), 0.0, 0.0];
            for (found, expected) in stress.into_iter().zip(expected) {
                assert!((found - expected).abs() < TRANSFORM, "{y} {z}: {stress:?} {expected:?}");
            }
        }
    }
}
