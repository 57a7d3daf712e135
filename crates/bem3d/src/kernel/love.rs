//! Love's influence coefficients: displacement of a cell centre under uniform pressure on a rectangular cell.

use super::alternating::alternating_weights;
use std::f64::consts::PI;

/// Beyond this distance, in longer sides of a cell, the far-field series is used.
///
/// The closed form is a second difference of terms of size r and loses r^2 of its digits; the series loses
/// r^-6. Here the closed form is good to 4e-12 of the kernel's own value (1e-14 of that at the origin) and
/// the series to 2e-13.
const FAR: f64 = 64.0;

/// Displacement at the lattice offset (x, y), in cells, of a square cell that carries unit pressure, times pi
/// E* / h_c.
///
/// `I = f(x+1/2, y+1/2) - f(x-1/2, y+1/2) - f(x+1/2, y-1/2) + f(x-1/2, y-1/2)` with
/// `f(u, v) = v asinh(u/|v|) + u asinh(v/|u|)`; dimensionless, symmetric in both signs and in the exchange of
/// x and y. So `u_i = (h_c / (pi E*)) sum_j I(i - j) p_j`.
///
/// Relative accuracy 1e-13 within 8 cells, 4e-12 at worst (just inside 64 cells), 2e-13 beyond; absolute
/// 5e-14 everywhere. Source: Love (1929), Phil. Trans. R. Soc. A 228, 377; the far field is the multipole
/// expansion of the uniform square.
///
/// ```
/// // Own centre: 4 ln(1 + sqrt 2).
/// assert!((bem3d::love::influence(0, 0) - 4.0 * (1.0 + 2f64.sqrt()).ln()).abs() < 1e-14);
/// ```
pub fn influence(x: usize, y: usize) -> f64 {
    influence_of_rectangle(x, y, 1.0)
}

/// The same for cells of sides `a = stretch` and `b = 1 / stretch`, in units of `c = sqrt(dx dy)`:
/// `u_i = (c / (pi E*)) sum_j I(i - j) p_j`.
///
/// ```
/// // Exchanging the sides of the cell exchanges x and y.
/// let (one, two) = (bem3d::love::influence_of_rectangle(3, 1, 2.0), bem3d::love::influence_of_rectangle(1, 3, 0.5));
/// assert!((one - two).abs() < 1e-14);
/// ```
pub fn influence_of_rectangle(x: usize, y: usize, stretch: f64) -> f64 {
    if is_far(x, y, stretch) { far_field(x, y, stretch) } else { closed_form(x, y, stretch) }
}

/// The same at the lags `(0 .., y)`, without a branch in the loop over those that are far.
pub fn influence_row(y: usize, stretch: f64, row: &mut [f64]) {
    let near = (0..row.len()).take_while(|&x| !is_far(x, y, stretch)).count();
    let (close, far) = row.split_at_mut(near);
    for (x, value) in close.iter_mut().enumerate() {
        *value = closed_form(x, y, stretch);
    }
    for (x, value) in far.iter_mut().enumerate() {
        *value = far_field(near + x, y, stretch);
    }
}

pub(super) fn is_far(x: usize, y: usize, stretch: f64) -> bool {
    let [(x, a), (y, b)] = ordered(x, y, stretch);
    (x * a).powi(2) + (y * b).powi(2) > (FAR * a.max(b)).powi(2)
}

/// The larger lag with the side of the cell along it, then the other: ordered, the symmetry is exact to the
/// last bit.
fn ordered(x: usize, y: usize, stretch: f64) -> [(f64, f64); 2] {
    let (x, y) = ((x as f64, stretch), (y as f64, stretch.recip()));
    if x.0 >= y.0 { [x, y] } else { [y, x] }
}

/// The second difference of Love's solution.
fn closed_form(x: usize, y: usize, stretch: f64) -> f64 {
    let [(x, a), (y, b)] = ordered(x, y, stretch);
    let (east, west, north, south) = ((x + 0.5) * a, (x - 0.5) * a, (y + 0.5) * b, (y - 0.5) * b);
    corner(east, north) - corner(west, north) - corner(east, south) + corner(west, south)
}

/// `f(u, v)`; half-integer arguments are never 0.
fn corner(u: f64, v: f64) -> f64 {
    v * (u / v.abs()).asinh() + u * (v / u.abs()).asinh()
}

/// The mean of 1/r over the cell, by Taylor's series: `sinh(D/2)/(D/2)` in both directions applied to 1/r, to
/// fourth order.
fn far_field(x: usize, y: usize, stretch: f64) -> f64 {
    let [(x, a), (y, b)] = ordered(x, y, stretch);
    let (x, y) = (x * a, y * b);
    let r2 = x * x + y * y;
    let (a2, b2) = (a * a, b * b);
    // d^2/dx^2 (1/r) = (3 c^2 - 1) / r^3 with c = x/r; d^4/dx^4 (1/r) = 24 P_4(c) / r^5; the mixed derivative
    // follows from Laplace^2 (1/r) = 9 / r^5.
    let second = |c2: f64| 3.0 * c2 - 1.0;
    let fourth = |c2: f64| 3.0 * (35.0 * c2 * c2 - 30.0 * c2 + 3.0);
    let (x4, y4) = (fourth(x * x / r2), fourth(y * y / r2));
    let mixed = (9.0 - x4 - y4) / 2.0;
    let quadrupole = (a2 * second(x * x / r2) + b2 * second(y * y / r2)) / 24.0;
    let next = (a2 * a2 * x4 + b2 * b2 * y4) / 1920.0 + a2 * b2 * mixed / 576.0;
    (1.0 + (quadrupole + next / r2) / r2) / r2.sqrt()
}

/// The smallest eigenvalue of the kernel of square cells on the infinite lattice, a lower bound for every
/// contact set.
///
/// It is the lattice symbol at the checkerboard wave, `sum I(x, y) (-1)^(x + y)`: no principal submatrix of a
/// symmetric matrix has a smaller eigenvalue.
pub const SMALLEST_EIGENVALUE: f64 = 1.824_301;

/// The same for cells of sides `stretch` and `1 / stretch`.
///
/// By Poisson's sum it is `(32/pi^2) sum_ab (-1)^(a+b) / (m n sqrt((m / stretch)^2 + (n stretch)^2))` over
/// `m = 2a + 1, n = 2b + 1`.
pub fn smallest_eigenvalue(stretch: f64) -> f64 {
    if stretch.to_bits() == 1f64.to_bits() {
        return SMALLEST_EIGENVALUE;
    }
    let weights = alternating_weights();
    let odd = |k: usize| (2 * k + 1) as f64;
    let row = |b: usize| -> f64 {
        let term = |(a, w): (usize, &f64)| w / (odd(a) * (odd(a) / stretch).hypot(odd(b) * stretch));
        weights.iter().enumerate().map(term).sum::<f64>() / odd(b)
    };
    32.0 / PI.powi(2) * weights.iter().enumerate().map(|(b, w)| w * row(b)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Values of 40-digit arithmetic.
    const TABLE: [(usize, usize, f64); 8] = [
        (0, 0, 3.525_494_348_078_17),
        (1, 0, 1.038_049_735_904_76),
        (1, 1, 0.724_697_438_134_33),
        (2, 0, 0.505_091_983_075_117),
        (2, 1, 0.451_088_988_349_22),
        (3, 0, 0.334_861_370_214_3),
        (10, 0, 0.100_041_630_166_904),
        (10, 10, 0.070_725_435_312_116_5),
    ];

    #[test]
    fn tabulated_values() {
        for (x, y, value) in TABLE {
            assert_relative_eq!(influence(x, y), value, max_relative = 2e-13);
            assert_relative_eq!(influence(y, x), value, max_relative = 2e-13);
        }
    }

    #[test]
    fn far_field_meets_the_closed_form() {
        for y in [0, 20, 45, 64] {
            // Loss of the closed form here: r^2 x 1.1e-16 x a few.
            assert_relative_eq!(closed_form(64, y, 1.0), far_field(64, y, 1.0), max_relative = 3e-12);
        }
    }

    #[test]
    fn a_row_is_its_values_to_the_last_bit() {
        for stretch in [1.0, 0.4, 3.0] {
            for y in [0, 1, 50, 64, 65, 500] {
                let mut row = vec![f64::NAN; 300];
                influence_row(y, stretch, &mut row);
                for (x, value) in row.into_iter().enumerate() {
                    assert_eq!(
                        value.to_bits(),
                        influence_of_rectangle(x, y, stretch).to_bits(),
                        "({x}, {y})"
                    );
                }
            }
        }
    }

    #[test]
    fn far_values_of_40_digit_arithmetic() {
        for (x, y, value) in [
            (64, 0, 0.015_625_158_942_323_859),
            (64, 3, 0.015_608_020_519_585_132),
            (50, 45, 0.014_866_019_821_968_9),
            (65, 1, 0.015_382_946_708_273_773),
            (1000, 10, 0.000_999_950_045_410_101_3),
            (1000, 1000, 0.000_707_106_795_917_941_4),
            (16384, 5000, 5.837_725_981_587_807e-5),
            (1_000_000, 0, 1.000_000_000_000_041_7e-6),
            (1_000_000, 999_999, 7.071_071_347_400_412e-7),
        ] {
            assert_relative_eq!(influence(x, y), value, max_relative = 4e-13);
        }
    }

    #[test]
    fn smallest_eigenvalue_is_the_checkerboard_sum() {
        let sum = |terms: i32| -> f64 {
            let odd = |a: i32| f64::from(2 * a + 1);
            let sign = |a: i32| if a % 2 == 0 { 1.0 } else { -1.0 };
            let term = |a: i32, b: i32| sign(a + b) / (odd(a) * odd(b) * odd(a).hypot(odd(b)));
            let all: f64 = (0..terms).flat_map(|a| (0..terms).map(move |b| term(a, b))).sum();
            all * 32.0 / std::f64::consts::PI.powi(2)
        };
        // Alternating: the mean of two neighbours is far closer than either.
        assert_relative_eq!(f64::midpoint(sum(200), sum(201)), SMALLEST_EIGENVALUE, max_relative = 1e-6);
    }

    #[test]
    fn a_rectangle_is_three_squares() {
        // Sides 3 : 1; the closed form, just beyond its end, and far away.
        let stretch = 3f64.sqrt();
        for (x, y) in
            [(0, 0), (1, 0), (0, 1), (2, 3), (5, 1), (63, 20), (64, 1), (0, 193), (70, 300), (3000, 17)]
        {
            let squares: f64 = (-1..=1_isize).map(|k| influence((3 * x + k).unsigned_abs(), y)).sum();
            let x = x.unsigned_abs();
            assert_relative_eq!(
                influence_of_rectangle(x, y, stretch),
                squares / stretch,
                max_relative = 2e-11
            );
            let turned = influence_of_rectangle(y, x, stretch.recip());
            assert_relative_eq!(turned, squares / stretch, max_relative = 2e-11);
        }
    }

    #[test]
    fn the_smallest_eigenvalue_of_oblong_cells_is_their_checkerboard_sum() {
        assert_relative_eq!(smallest_eigenvalue(1.0 + 1e-12), SMALLEST_EIGENVALUE, max_relative = 1e-6);
        assert_relative_eq!(smallest_eigenvalue(2.0), smallest_eigenvalue(0.5), max_relative = 1e-12);
        let stretch = 1.7;
        let sum = |n: usize| -> f64 {
            let copies = |x: usize| if x == 0 { 1.0 } else { 2.0 };
            // Means of neighbouring partial sums, twice in each direction.
            let weight = |x: usize| [1.0, 1.0, 0.75, 0.25][(x + 3).saturating_sub(n).min(3)];
            let term = |x: usize, y: usize| {
                let sign = if (x + y).is_multiple_of(2) { 1.0 } else { -1.0 };
                sign * copies(x) * copies(y) * weight(x) * weight(y) * influence_of_rectangle(x, y, stretch)
            };
            (0..=n).flat_map(|x| (0..=n).map(move |y| term(x, y))).sum()
        };
        assert_relative_eq!(sum(200), smallest_eigenvalue(stretch), max_relative = 1e-5);
    }
}
