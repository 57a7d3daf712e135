use super::super::potentials::{KERNELS, combine};
use super::*;
use std::f64::consts::PI;

/// Sums of some tens of logarithms and angles of up to about ten.
const ROUNDING: f64 = 2e-14;
/// What an integral by adaptive quadrature is good to.
const QUADRATURE: f64 = 1e-12;

const RATIOS: [f64; 4] = [0.0, 0.25, 0.3, 0.5];

/// Boussinesq's stress under a unit force, with cylindrical components turned to Cartesian ones (K. L.
/// Johnson, Contact Mechanics, Eqs. 3.20), and Cerruti's under a unit traction along x (Eqs. 3.75 and 3.76):
/// traction along x, along y, pressure.
fn textbook([x, y, z]: [f64; 3], nu: f64) -> [[f64; 6]; 3] {
    let rho = (x * x + y * y + z * z).sqrt();
    let r2 = x * x + y * y;
    let (radial, hoop) = (
        (1.0 - 2.0 * nu) * (1.0 - z / rho) / r2 - 3.0 * z * r2 / rho.powi(5),
        -(1.0 - 2.0 * nu) * ((1.0 - z / rho) / r2 - z / rho.powi(3)),
    );
    let shear = -3.0 * z * z / rho.powi(5);
    let pressure = [
        (radial * x * x + hoop * y * y) / r2,
        (radial * y * y + hoop * x * x) / r2,
        -3.0 * z.powi(3) / rho.powi(5),
        shear * y,
        shear * x,
        (radial - hoop) * x * y / r2,
    ];
    let along_x = |x: f64, y: f64| {
        let s = rho + z;
        let rest = |direct: f64, product: f64| {
            let (second, third) = (rho.powi(3) * s * s, rho * rho * s.powi(3));
            (1.0 - 2.0 * nu) * (direct + product / second + 2.0 * product / third)
        };
        let (square, cube) = (rho * s * s, rho.powi(3));
        let five = rho.powi(5);
        [
            -3.0 * x.powi(3) / five + rest(x / cube - 3.0 * x / square, x.powi(3)),
            -3.0 * x * y * y / five + rest(x / cube - x / square, x * y * y),
            -3.0 * x * z * z / five,
            -3.0 * x * y * z / five,
            -3.0 * x * x * z / five,
            -3.0 * x * x * y / five + rest(-y / square, x * x * y),
        ]
    };
    let [yy, xx, zz, xz, yz, xy] = along_x(y, x);
    let all = [along_x(x, y), [xx, yy, zz, yz, xz, xy], pressure];
    all.map(|stress| stress.map(|component| component / (2.0 * PI)))
}

fn stress_of(potentials: &Potentials, nu: f64) -> [[f64; 6]; 3] {
    let kernels = potentials.kernels(nu);
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|load| combine(&kernels, load))
}

fn largest_difference(a: [[f64; 6]; 3], b: [[f64; 6]; 3]) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).fold(0.0, |d: f64, (a, b)| d.max((a - b).abs()))
}

/// The integral of the textbook's solutions over a rectangle `[west, east, south, north]` around the point.
fn integral(gauss: &Gauss<16>, [w, e, s, n]: [f64; 4], z: f64, nu: f64) -> [[f64; 6]; 3] {
    let mut sum = [[0.0; 6]; 3];
    for (y, height) in gauss.on(s, n) {
        for (x, width) in gauss.on(w, e) {
            let stress = textbook([x, y, z], nu);
            for (sum, stress) in sum.as_flattened_mut().iter_mut().zip(stress.as_flattened()) {
                *sum += width * height * stress;
            }
        }
    }
    sum
}

/// Bisects rectangles until their sides are shorter than the distance of the point, where the rule is exact.
fn adaptive(gauss: &Gauss<16>, [w, e, s, n]: [f64; 4], z: f64, nu: f64) -> [[f64; 6]; 3] {
    let (mx, my) = (f64::midpoint(w, e), f64::midpoint(s, n));
    let near = [0.0_f64.clamp(w, e), 0.0_f64.clamp(s, n), z];
    if length(near) > (e - w).max(n - s) {
        return integral(gauss, [w, e, s, n], z, nu);
    }
    let parts = if e - w > n - s { [[w, mx, s, n], [mx, e, s, n]] } else { [[w, e, s, my], [w, e, my, n]] };
    let [mut a, b] = parts.map(|part| adaptive(gauss, part, z, nu));
    for (a, b) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
        *a += b;
    }
    a
}

const PLACES: [[f64; 3]; 8] = [
    [0.1, -0.2, 0.5],
    [0.3, 0.7, 0.05],
    [-1.2, 0.4, 0.3],
    [2.0, 3.0, 1.0],
    [-0.5, 0.5, 0.2],
    [0.0, 0.0, 2.0],
    [4.0, -1.0, 0.01],
    [-7.0, 2.5, 6.0],
];

#[test]
fn point_forces_are_those_of_the_textbook() {
    for nu in RATIOS {
        for place in PLACES.into_iter().filter(|[x, y, _]| x.hypot(*y) > 0.0) {
            let difference = largest_difference(stress_of(&point(place), nu), textbook(place, nu));
            assert!(difference * length(place).powi(2) < ROUNDING, "{nu} {place:?}: {difference}");
        }
    }
}

#[test]
fn cells_are_integrals_of_boussinesq_and_cerruti() {
    let gauss = Gauss::new();
    for [a, b] in [[1.0, 1.0], [2.0, 0.5], [0.3, 1.0 / 0.3]] {
        let cell = RectangularCell::new([a, b]);
        for nu in RATIOS {
            for [x, y, z] in PLACES {
                // One rounding off the axis, on which the textbook divides by 0.
                let [x, y] = [x + 1e-9, y + 1e-9];
                let around = [x - 0.5 * a, x + 0.5 * a, y - 0.5 * b, y + 0.5 * b];
                let expected = adaptive(&gauss, around, z, nu);
                let difference = largest_difference(stress_of(&cell.closed_form([x, y, z]), nu), expected);
                assert!(difference < QUADRATURE, "{a} x {b}, {nu}, {x} {y} {z}: {difference}");
            }
        }
    }
}

#[test]
fn far_away_every_rule_is_exact() {
    let sixteen = Gauss::<16>::new();
    let cell = RectangularCell::new([1.0, 1.0]);
    let directions = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0], [0.36, 0.48, 0.8]];
    for direction in directions {
        for distance in [8.0, 8.01, 12.0, 24.01, 50.0, 100.1, 400.0, 1500.1, 1e4, 1e7, 1e15, 1e40] {
            let place = direction.map(|along| along * distance);
            let difference = largest_difference(
                stress_of(&cell.potentials(place), 0.3),
                stress_of(&cell.quadrature(&sixteen, place), 0.3),
            );
            let relative = difference * distance * distance;
            assert!(relative < 1e-13, "{direction:?} {distance}: {relative:e}");
        }
        // The closed form itself, before it is left.
        for distance in [2.5, 4.0, 7.99] {
            let place = direction.map(|along| along * distance);
            let difference = largest_difference(
                stress_of(&cell.potentials(place), 0.3),
                stress_of(&cell.quadrature(&sixteen, place), 0.3),
            );
            let relative = difference * distance * distance;
            assert!(relative < 1e-13, "{direction:?} {distance}: {relative:e}");
        }
    }
}

#[test]
fn oblong_cells_lose_no_digits_at_any_distance() {
    let sixteen = Gauss::<16>::new();
    let cell = RectangularCell::new([100.0, 0.01]);
    // Rows of small squares, each by a rule that is exact there.
    let part = RectangularCell::new([0.1, 0.01]);
    for place in [[0.0, 0.0, 1.0], [3.0, 0.2, 0.0], [49.0, 1.0, 2.0], [60.0, 0.0, 0.0], [0.0, 300.0, 4.0]] {
        let mut expected = Potentials::default();
        for i in 0..1000 {
            let x = place[0] - 0.1 * (f64::from(i) - 499.5);
            expected.add(1.0, &part.quadrature(&sixteen, [x, place[1], place[2]]));
        }
        let expected = stress_of(&expected, 0.3);
        let largest =
            expected.as_flattened().iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let difference = largest_difference(stress_of(&cell.potentials(place), 0.3), expected);
        assert!(difference < 1e-13 * largest, "{place:?}: {difference:e} of {largest:e}");
    }
}

#[test]
fn values_at_the_surface_are_finite_and_those_of_the_load() {
    let cell = RectangularCell::new([2.0, 0.5]);
    for (x, y, share) in [
        (0.0, 0.0, 1.0),
        (0.9, 0.2, 1.0),
        (1.0, 0.1, 0.5),
        (0.3, -0.25, 0.5),
        (-1.0, 0.25, 0.25),
        (1.1, 0.0, 0.0),
        (1.0, 0.6, 0.0),
        (40.0, 3.0, 0.0),
    ] {
        let [along_x, along_y, pressure] = stress_of(&cell.potentials([x, y, 0.0]), 0.3);
        assert!([along_x, along_y, pressure].as_flattened().iter().all(|value| value.is_finite()));
        let expected = [
            [along_x[2], along_x[3], along_x[4] + share],
            [along_y[2], along_y[3] + share, along_y[4]],
            [pressure[2] + share, pressure[3], pressure[4]],
        ];
        let largest =
            expected.as_flattened().iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        assert!(largest < ROUNDING, "{x} {y}: {largest}");
    }
    // Love (1929), at the centre of a uniform square: -(1 + 2 nu)/2 p.
    let square = stress_of(&RectangularCell::new([1.0, 1.0]).potentials([0.0; 3]), 0.3);
    assert!((square[2][0] + 0.8).abs() < ROUNDING && (square[2][1] + 0.8).abs() < ROUNDING);
}

#[test]
fn the_stress_below_is_continuous_to_the_surface() {
    let cell = RectangularCell::new([1.3, 1.0 / 1.3]);
    for place in [[0.0, 0.0], [0.5, -0.3], [0.9, 0.1], [7.0, 9.0], [30.0, 0.0]] {
        let at = |z: f64| stress_of(&cell.potentials([place[0], place[1], z]), 0.3);
        for z in [1e-13, 1e-99, 1e-101, 1e-310] {
            let difference = largest_difference(at(z), at(0.0));
            assert!(difference < 40.0 * z + ROUNDING, "{place:?} {z}: {difference}");
        }
    }
}

#[test]
fn a_strip_is_a_long_rectangle() {
    // The ends are so far away that their share of the stress, about the width over the length, is rounding.
    let long = RectangularCell::new([2e15, 0.8]);
    for nu in RATIOS {
        for (y, z) in [(0.0, 0.0), (0.1, 0.3), (0.8, 0.0), (1.6, 2.0), (8.0, 0.5), (5.0, 10.0)] {
            let rectangle = stress_of(&long.closed_form([0.0, y, z]), nu);
            let difference = largest_difference(stress_of(&strip(y, z, 0.8), nu), rectangle);
            assert!(difference < 1e-13, "{nu} {y} {z}: {difference:e}");
        }
    }
}

/// Central differences of sixth order.
fn derivative(function: impl Fn(f64) -> f64, step: f64) -> f64 {
    let odd = |k: f64| function(k * step) - function(-k * step);
    (45.0 * odd(1.0) - 9.0 * odd(2.0) + odd(3.0)) / (60.0 * step)
}

#[test]
fn the_stress_is_in_equilibrium() {
    /// Rounding over the step.
    const DIFFERENCES: f64 = 1e-10;
    /// Rows of the tensor among xx, yy, zz, yz, xz, xy.
    const ROWS: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];
    let cell = RectangularCell::new([1.3, 1.0 / 1.3]);
    for nu in RATIOS {
        for [x, y, z] in [[0.2, 0.1, 0.4], [1.0, -0.7, 0.9], [3.0, 8.0, 2.0], [20.0, 11.0, 9.0]] {
            for load in 0..3 {
                for row in ROWS {
                    let along = |axis: usize| {
                        let at = |shift: f64| {
                            let mut place = [x, y, z];
                            place[axis] += shift;
                            stress_of(&cell.potentials(place), nu)[load][row[axis]]
                        };
                        derivative(at, 1e-2 * z)
                    };
                    let force: f64 = (0..3).map(along).sum();
                    assert!(force.abs() < DIFFERENCES, "{nu} {x} {y} {z}: {load} {row:?}: {force}");
                }
            }
        }
    }
}

#[test]
fn every_influence_function_has_its_parity() {
    let cell = RectangularCell::new([1.3, 1.0 / 1.3]);
    for [x, y, z] in [[0.2, 0.1, 0.0], [0.2, 0.1, 0.4], [12.0, 31.0, 2.0]] {
        let at = |sign_x: f64, sign_y: f64| cell.potentials([sign_x * x, sign_y * y, z]).kernels(0.3);
        let (here, west, south) = (at(1.0, 1.0), at(-1.0, 1.0), at(1.0, -1.0));
        for kernel in 0..KERNELS {
            let [odd_x, odd_y] = super::super::potentials::ODD[kernel];
            let sign = |odd: bool| if odd { -1.0 } else { 1.0 };
            assert!((here[kernel] - sign(odd_x) * west[kernel]).abs() < ROUNDING, "{kernel}");
            assert!((here[kernel] - sign(odd_y) * south[kernel]).abs() < ROUNDING, "{kernel}");
        }
    }
}
