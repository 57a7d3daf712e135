use super::super::potentials::combine;
use super::*;
use contact_model::never;

/// Some tens of roundings of numbers of about 1.
const ROUNDING: f64 = 1e-14;

/// Whether xx, yy, zz, yz, xz, xy are odd along x, and along y, under a pressure.
const ODD_OF_PRESSURE: [[bool; 2]; 6] =
    [[false, false], [false, false], [false, false], [false, true], [true, false], [true, true]];

/// The stress at a point under a wave of a traction along x, along y or a pressure, which is
/// `cos(kx x + ky y)` at the surface.
fn stress_at(load: usize, k: [f64; 2], nu: f64, [x, y, z]: [f64; 3]) -> [f64; 6] {
    let kernels = wave(k, z).kernels(nu);
    let phase = k[0] * x + k[1] * y;
    let unit = std::array::from_fn(|axis| f64::from(u8::from(axis == load)));
    let values = combine(&kernels, unit);
    // The parity of a component under a traction is that under a pressure, turned along the axis of the
    // traction.
    std::array::from_fn(|component| {
        let mut odd = ODD_OF_PRESSURE[component];
        if load < 2 {
            odd[load] = !odd[load];
        }
        values[component]
            * match (odd[0], odd[1]) {
                (false, false) => phase.cos(),
                (true, true) => -phase.cos(),
                _ => -phase.sin(),
            }
    })
}

const WAVES: [[f64; 2]; 5] = [[1.0, 0.0], [0.0, 2.0], [0.6, 0.8], [-1.3, 0.4], [2.0, 2.0]];

#[test]
fn a_plane_wave_has_the_closed_form_of_the_textbook() {
    // K. L. Johnson, Contact Mechanics, section 13.2.
    let (q, nu) = (1.7_f64, 0.3);
    for z in [0.0_f64, 0.3, 1.0, 5.0] {
        let fall = (-q * z).exp();
        let [xx, yy, zz, yz, xz, xy] = stress_at(2, [q, 0.0], nu, [0.0, 0.0, z]);
        let expected = [-(1.0 - q * z) * fall, -2.0 * nu * fall, -(1.0 + q * z) * fall];
        assert!((xx - expected[0]).abs() < ROUNDING && (yy - expected[1]).abs() < ROUNDING);
        assert!((zz - expected[2]).abs() < ROUNDING);
        assert!([yz, xz, xy].iter().all(|shear| shear.abs() < ROUNDING));
        // A quarter of the wave further the shear stress is largest, z q exp(-q z).
        let quarter = std::f64::consts::FRAC_PI_2 / q;
        let xz = stress_at(2, [q, 0.0], nu, [quarter, 0.0, z])[4];
        assert!((xz.abs() - q * z * fall).abs() < ROUNDING);
        // Under the traction cos(q x) along x: 2 sin(q x) at the surface.
        let xx = stress_at(0, [q, 0.0], nu, [quarter, 0.0, z])[0];
        assert!((xx.abs() - (2.0 - q * z).abs() * fall).abs() < ROUNDING);
    }
}

#[test]
fn tractions_at_the_surface_are_those_of_the_load() {
    for k in WAVES {
        for nu in [0.0, 0.3, 0.5] {
            for load in 0..3 {
                let [x, y] = [0.3, -0.8];
                let [_, _, zz, yz, xz, _] = stress_at(load, k, nu, [x, y, 0.0]);
                let amplitude = (k[0] * x + k[1] * y).cos();
                let expected = [0, 1, 2].map(|axis| if axis == load { -amplitude } else { 0.0 });
                for (found, expected) in [xz, yz, zz].into_iter().zip(expected) {
                    assert!((found - expected).abs() < ROUNDING, "{k:?} {nu} {load}");
                }
            }
        }
    }
}

#[test]
fn waves_obey_equilibrium_and_compatibility() {
    /// Differences of sixth order with a step of 0.01, and their rounding.
    const FIRST: f64 = 1e-10;
    const SECOND: f64 = 1e-8;
    const STEP: f64 = 0.01;
    const INDEX: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];
    const FIRST_WEIGHTS: [(f64, f64); 6] =
        [(-3.0, -1.0 / 60.0), (-2.0, 0.15), (-1.0, -0.75), (1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)];
    const SECOND_WEIGHTS: [(f64, f64); 7] = [
        (-3.0, 1.0 / 90.0),
        (-2.0, -0.15),
        (-1.0, 1.5),
        (0.0, -49.0 / 18.0),
        (1.0, 1.5),
        (2.0, -0.15),
        (3.0, 1.0 / 90.0),
    ];
    let place = [0.4, -0.3, 0.7];
    let moved = |axis: usize, steps: f64, from: [f64; 3]| {
        let mut to = from;
        to[axis] += STEP * steps;
        to
    };
    for k in WAVES {
        for nu in [0.0, 0.3, 0.5] {
            for load in 0..3 {
                let stress = |place: [f64; 3]| stress_at(load, k, nu, place);
                let trace = |place: [f64; 3]| stress(place)[..3].iter().sum::<f64>();
                for (i, row) in INDEX.iter().enumerate() {
                    let along = |j: usize| -> f64 {
                        FIRST_WEIGHTS
                            .iter()
                            .map(|(s, w)| w / STEP * stress(moved(j, *s, place))[row[j]])
                            .sum()
                    };
                    let force: f64 = (0..3).map(along).sum();
                    assert!(force.abs() < FIRST, "{k:?} {nu} {load}: {force}");
                    for (j, &component) in row.iter().enumerate() {
                        // Beltrami and Michell.
                        let laplacian: f64 = (0..3)
                            .flat_map(|axis| SECOND_WEIGHTS.map(|(s, w)| (axis, s, w)))
                            .map(|(axis, s, w)| w / STEP.powi(2) * stress(moved(axis, s, place))[component])
                            .sum();
                        let curvature: f64 = if i == j {
                            let term = |(s, w): (f64, f64)| w / STEP.powi(2) * trace(moved(i, s, place));
                            SECOND_WEIGHTS.into_iter().map(term).sum()
                        } else {
                            let pairs = FIRST_WEIGHTS.iter().flat_map(|a| FIRST_WEIGHTS.map(|b| (*a, b)));
                            let term = |((s, v), (t, w)): ((f64, f64), (f64, f64))| {
                                v * w / STEP.powi(2) * trace(moved(j, t, moved(i, s, place)))
                            };
                            pairs.map(term).sum()
                        };
                        let rest = laplacian + curvature / (1.0 + nu);
                        assert!(rest.abs() < SECOND, "{k:?} {nu} {load} {i} {j}: {rest}");
                    }
                }
            }
        }
    }
}

#[test]
fn alternating_sums_of_the_textbook() {
    let sum: f64 = alternating_weights().iter().enumerate().map(|(m, w)| w / (m as f64 + 1.0)).sum();
    assert!((sum - 2.0_f64.ln()).abs() < ROUNDING);
}

/// The plain sum over `|m|, |n| <= terms`.
fn plain(cells: &CellWaves, k: [f64; 2], z: f64, terms: i32) -> [f64; KERNELS] {
    let mut sum = Potentials::default();
    for m in -terms..=terms {
        for n in -terms..=terms {
            let sign = if (m + n) % 2 == 0 { 1.0 } else { -1.0 };
            let alias = [0, 1].map(|axis| k[axis] + 2.0 * PI * f64::from([m, n][axis]) / cells.sides[axis]);
            let ratio = |axis: usize| if [m, n][axis] == 0 { 1.0 } else { k[axis] / alias[axis] };
            if (m, n) != (0, 0) {
                sum.add(sign * ratio(0) * ratio(1), &wave(alias, z));
            }
        }
    }
    sum.kernels(cells.poisson)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs()))
}

#[test]
fn accelerated_sums_of_aliases_are_plain_sums() {
    for sides in [[1.0, 1.0], [1.7, 1.0 / 1.7], [5.0, 0.2]] {
        let cells = CellWaves::new(sides, 0.3);
        let longest: f64 = sides[0].max(sides[1]);
        for share in [[0.0, 0.4], [0.01, 0.02], [0.5, 0.0], [1.0, 1.0], [0.3, 1.0], [0.9, 0.7]] {
            let k = [PI * share[0] / sides[0], PI * share[1] / sides[1]];
            for z in [0.1, 0.3, 1.0, 4.0] {
                let terms = (37.0 * longest / (2.0 * PI * z * longest.min(1.0))).ceil() as i32 + 1;
                let difference = largest_difference(&cells.other_aliases(k, z), &plain(&cells, k, z, terms));
                assert!(difference < 5.0 * ROUNDING, "{sides:?} {share:?} {z}: {difference:e}");
            }
        }
    }
}

#[test]
fn at_the_surface_the_aliases_of_normal_and_shear_stress_are_those_of_a_single_cell() {
    // There sigma_zz = -p, so that the sum over all aliases is -1.
    let cells = CellWaves::new([1.3, 1.0 / 1.3], 0.3);
    for share in [[0.2, 0.4], [1.0, 1.0], [0.0, 0.7]] {
        let k = [PI * share[0] / cells.sides[0], PI * share[1] / cells.sides[1]];
        let (itself, others) = (wave(k, 0.0).kernels(0.3), cells.other_aliases(k, 0.0));
        for kernel in [2, 9, 14] {
            let sum = cells.mean_over_cell(k) * (itself[kernel] + others[kernel]);
            assert!((sum + 1.0).abs() < 5.0 * ROUNDING, "{share:?} {kernel}: {sum}");
        }
    }
}

#[test]
fn interpolated_aliases_are_those_of_each_wave() {
    for (sides, points) in
        [([1.0, 1.0], [100, 96]), ([1.7, 1.0 / 1.7], [60, 300]), ([100.0, 0.01], [256, 64])]
    {
        let cells = CellWaves::new(sides, 0.3);
        let along = |axis: usize| -> Vec<f64> {
            (0..=points[axis] / 2)
                .map(|m| 2.0 * PI * m as f64 / (points[axis] as f64 * sides[axis]))
                .collect()
        };
        let waves = [along(0), along(1)];
        for z in [0.0, 0.02, 0.5, 3.0] {
            let aliases = cells.aliases([&waves[0], &waves[1]], z, KERNELS, &never).unwrap().unwrap();
            for mx in [0, 1, 7, points[0] / 2] {
                let mut found = vec![0.0; waves[1].len() * KERNELS];
                aliases.add(mx, &mut found);
                for my in [0, 1, 13, points[1] / 2] {
                    let expected = cells.other_aliases([waves[0][mx], waves[1][my]], z);
                    let difference = largest_difference(&found[my * KERNELS..][..KERNELS], &expected);
                    assert!(difference < 20.0 * ROUNDING, "{sides:?} {z} {mx} {my}: {difference:e}");
                }
            }
        }
        assert!(cells.aliases([&waves[0], &waves[1]], 1e6, KERNELS, &never).unwrap().is_none());
    }
}
