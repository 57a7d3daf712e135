//! Love's kernel: displacement of a cell centre under uniform pressure on a square cell.

/// Beyond this distance (in cells) the far-field series is used.
///
/// The closed form is a second difference of terms of size r and loses r^2 of its digits; the series loses r^-6.
/// Here the closed form is good to 4e-12 of the kernel's own value (1e-14 of that at the origin) and the series to 2e-13.
const FAR: f64 = 64.0;

/// Displacement at the lattice offset (x, y), in cells, of a unit cell that carries unit pressure, times pi E* / h_c.
///
/// `I = f(x+1/2, y+1/2) - f(x-1/2, y+1/2) - f(x+1/2, y-1/2) + f(x-1/2, y-1/2)` with
/// `f(u, v) = v asinh(u/|v|) + u asinh(v/|u|)`; dimensionless, symmetric in both signs and in the exchange of x and y.
/// So `u_i = (h_c / (pi E*)) sum_j I(i - j) p_j`.
///
/// Relative accuracy 1e-13 within 8 cells, 4e-12 at worst (just inside 64 cells), 2e-13 beyond; absolute 5e-14 everywhere. Source: Love (1929), Phil. Trans. R. Soc. A 228, 377; the far field is the
/// multipole expansion of the uniform square.
///
/// ```
/// // Own centre: 4 ln(1 + sqrt 2).
/// assert!((bem3d::love::influence(0, 0) - 4.0 * (1.0 + 2f64.sqrt()).ln()).abs() < 1e-14);
/// ```
pub fn influence(x: usize, y: usize) -> f64 {
    // Ordered arguments make the symmetry exact to the last bit.
    let (x, y) = (x.max(y) as f64, x.min(y) as f64);
    if x * x + y * y > FAR * FAR { far_field(x, y) } else { closed_form(x, y) }
}

fn closed_form(x: f64, y: f64) -> f64 {
    corner(x + 0.5, y + 0.5) - corner(x - 0.5, y + 0.5) - corner(x + 0.5, y - 0.5) + corner(x - 0.5, y - 0.5)
}

/// `f(u, v)`; half-integer arguments are never 0.
fn corner(u: f64, v: f64) -> f64 {
    v * (u / v.abs()).asinh() + u * (v / u.abs()).asinh()
}

/// The mean of 1/r over the cell, by Taylor's series: `sinh(D/2)/(D/2)` in both directions applied to 1/r, to fourth order.
fn far_field(x: f64, y: f64) -> f64 {
    let r2 = x * x + y * y;
    let r = r2.sqrt();
    // d^4/dx^4 (1/r) = 24 P_4(x/r) / r^5; the mixed derivative follows from Laplace^2 (1/r) = 9 / r^5.
    let legendre4 = |c2: f64| (35.0 * c2 * c2 - 30.0 * c2 + 3.0) / 8.0;
    let fourth = 24.0 * (legendre4(x * x / r2) + legendre4(y * y / r2));
    let mixed = (9.0 - fourth) / 2.0;
    (1.0 + (1.0 / 24.0 + (fourth / 1920.0 + mixed / 576.0) / r2) / r2) / r
}

/// The smallest eigenvalue of the kernel on the infinite lattice, a lower bound for every contact set.
///
/// It is the lattice symbol at the checkerboard wave, `sum I(x, y) (-1)^(x + y)`: no principal submatrix of a symmetric matrix
/// has a smaller eigenvalue. By Poisson's sum it is `(32/pi^2) sum_ab (-1)^(a+b) / (m n sqrt(m^2 + n^2))` over
/// `m = 2a + 1, n = 2b + 1`, which a test repeats.
pub const SMALLEST_EIGENVALUE: f64 = 1.824_301;

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
        for y in [0.0, 20.0, 45.0, 64.0] {
            // Loss of the closed form here: r^2 x 1.1e-16 x a few.
            assert_relative_eq!(closed_form(64.0, y), far_field(64.0, y), max_relative = 3e-12);
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
}
