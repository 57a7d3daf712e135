//! Numbers of a stress that do not depend on the axes.

/// Von Mises' equivalent stress, `sqrt(((xx - yy)^2 + (yy - zz)^2 + (zz - xx)^2)/2 + 3 (yz^2 + xz^2 +
/// xy^2))`.
///
/// The components are xx, yy, zz, yz, xz, xy. There is no overflow on the way; a result beyond 1e308 is
/// infinite.
///
/// ```
/// // Uniaxial tension, pure shear, and a hydrostatic pressure.
/// use interface::stress::von_mises;
/// assert_eq!(von_mises(&[2.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 2.0);
/// assert!((von_mises(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0]) - 3.0_f64.sqrt()).abs() < 1e-15);
/// assert_eq!(von_mises(&[-1e300, -1e300, -1e300, 0.0, 0.0, 0.0]), 0.0);
/// ```
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    let Some((scale, [xx, yy, zz, yz, xz, xy])) = scaled(stress) else { return 0.0 };
    let (a, b, c) = (xx - yy, yy - zz, zz - xx);
    scale * (0.5 * (a * a + b * b + c * c) + 3.0 * (yz * yz + xz * xz + xy * xy)).sqrt()
}

/// The principal stresses, from the largest tension to the largest compression. Exact to rounding of the
/// largest one; source: Jacobi's method.
///
/// ```
/// use interface::stress::principal_stresses;
/// assert_eq!(principal_stresses(&[-3.0, 0.0, 0.0, 0.0, 0.0, 0.0]), [0.0, 0.0, -3.0]);
/// let shear = principal_stresses(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
/// assert!((shear[0] - 2.0).abs() < 1e-15 && (shear[2] + 2.0).abs() < 1e-15);
/// ```
pub fn principal_stresses(stress: &[f64; 6]) -> [f64; 3] {
    /// Cyclic sweeps. Convergence is quadratic, and five suffice for any matrix of this size.
    const SWEEPS: usize = 8;
    let Some((scale, [xx, yy, zz, yz, xz, xy])) = scaled(stress) else { return [0.0; 3] };
    let mut s = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    for _ in 0..SWEEPS {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            if s[i][j].abs() <= f64::MIN_POSITIVE {
                continue;
            }
            let cotangent = (s[j][j] - s[i][i]) / (2.0 * s[i][j]);
            let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
            let cosine = tangent.hypot(1.0).recip();
            let sine = tangent * cosine;
            let (shift, k) = (tangent * s[i][j], 3 - i - j);
            (s[i][i], s[j][j]) = (s[i][i] - shift, s[j][j] + shift);
            let (at_i, at_j) = (s[i][k], s[j][k]);
            (s[i][j], s[j][i]) = (0.0, 0.0);
            s[i][k] = cosine * at_i - sine * at_j;
            s[j][k] = sine * at_i + cosine * at_j;
            (s[k][i], s[k][j]) = (s[i][k], s[j][k]);
        }
    }
    let mut principal = [s[0][0], s[1][1], s[2][2]].map(|value| scale * value);
    principal.sort_by(|a, b| b.total_cmp(a));
    principal
}

/// Tresca's equivalent stress: the difference of the largest and the smallest principal stress, twice the
/// largest shear stress.
///
/// ```
/// assert_eq!(interface::stress::tresca(&[0.0, 0.0, -2.0, 0.0, 0.0, 0.0]), 2.0);
/// ```
pub fn tresca(stress: &[f64; 6]) -> f64 {
    let [largest, _, smallest] = principal_stresses(stress);
    largest - smallest
}

/// The largest component in size, and all over it; `None` where all are 0.
fn scaled(stress: &[f64; 6]) -> Option<(f64, [f64; 6])> {
    let scale = stress.iter().fold(0.0, |largest: f64, component| largest.max(component.abs()));
    (scale > 0.0).then(|| (scale, stress.map(|component| component / scale)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    /// Some tens of roundings of numbers of about 1.
    const ROUNDING: f64 = 1e-14;

    proptest! {
        #[test]
        fn invariants_agree_with_each_other(stress in prop::array::uniform6(-1.0..1.0)) {
            let [a, b, c] = principal_stresses(&stress);
            prop_assert!(a >= b && b >= c);
            prop_assert!((a + b + c - stress[0] - stress[1] - stress[2]).abs() < ROUNDING);
            let [xx, yy, zz, yz, xz, xy] = stress;
            let third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
            prop_assert!((a * b * c - third).abs() < ROUNDING);
            let mises = von_mises(&stress);
            prop_assert!((mises - von_mises(&[a, b, c, 0.0, 0.0, 0.0])).abs() < ROUNDING);
            // Tresca's hexagon lies inside of the ellipse of von Mises.
            prop_assert!(tresca(&stress) >= mises * (1.0 - ROUNDING));
            prop_assert!(tresca(&stress) <= mises * (2.0 / 3.0_f64.sqrt() + ROUNDING));
        }
    }

    #[test]
    fn no_unit_overflows_or_underflows() {
        for scale in [1e-300, 1.0, 1e300] {
            let stress = [1.0, -2.0, 0.5, 0.3, -0.7, 0.2].map(|component| component * scale);
            // (9 + 6.25 + 0.25)/2 + 3 (0.09 + 0.49 + 0.04) = 9.61.
            assert_relative_eq!(von_mises(&stress) / scale, 3.1, max_relative = ROUNDING);
            let [a, _, c] = principal_stresses(&stress);
            assert_relative_eq!(tresca(&stress), a - c);
        }
        assert!(von_mises(&[0.0; 6]) <= 0.0 && tresca(&[0.0; 6]) <= 0.0);
    }
}
