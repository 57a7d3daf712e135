//! The rule for the rough line and the foundation that are equivalent to a rough square or rectangle (Eqs. 14
//! to 18).
//!
//! The line has the length `L_1D = 2 L / sqrt(pi)`, its springs the stiffness E* per length, and its spectrum
//! is `C_1D(q) = pi q C_2D(q)`. A line of full length in contact then has the stiffness of a circle of the
//! square's area, and the same variance as the surface when both are summed over the same band of continuous
//! wavenumbers.

use std::f64::consts::PI;

/// `C_1D = pi q C_2D(q)` (Eq. 17), the two-sided spectrum of the line at wavenumber `q >= 0` (length^3).
///
/// Two-sided: `h_rms^2` is the integral of `C_1D` over negative and positive `q`, twice that over positive
/// ones.
///
/// ```
/// // C_2D = 4 at q = 0.5.
/// assert!((mdr1d::rule::line_spectrum(0.5, 4.0) - 6.283185307).abs() < 1e-9);
/// ```
pub fn line_spectrum(wavenumber: f64, surface_spectrum: f64) -> f64 {
    PI * wavenumber * surface_spectrum
}

/// `B_1D = sqrt((2 pi / L_1D) C_1D)` (Eq. 15), the amplitude of one mode of the two-sided sum of Eq. 14 (a
/// length).
///
/// Differs from the printed form `sqrt(2 pi / L) C_1D`, which is not a length: the square root covers the
/// spectrum too. With `phi(-q) = -phi(q)` the modes `q` and `-q` add up to one wave of amplitude `2 B_1D` and
/// variance `2 B_1D^2`.
///
/// ```
/// // A line of length 2 pi with C_1D = 9.
/// assert!((mdr1d::rule::mode_amplitude(9.0, std::f64::consts::TAU) - 3.0).abs() < 1e-12);
/// ```
pub fn mode_amplitude(line_spectrum: f64, length: f64) -> f64 {
    (2.0 * PI / length * line_spectrum).sqrt()
}

/// Stiffness of the foundation per length, which is E* (Eq. 16); the springs are independent of each other.
///
/// ```
/// assert_eq!(mdr1d::rule::foundation_stiffness(70e9), 70e9);
/// ```
pub fn foundation_stiffness(contact_modulus: f64) -> f64 {
    contact_modulus
}

/// `E* L_1D = (2 / sqrt(pi)) E* L`: the stiffness of the line in full contact, its plateau (Eqs. 16 and 18).
///
/// `side` is `L = sqrt(Lx Ly)`. It is the stiffness of a rigid circle of the same area; a rigid square is 2.1
/// % stiffer (1.152298 E* L).
///
/// ```
/// assert!((mdr1d::rule::full_contact_stiffness(1.0, 1.0) - 1.128379167).abs() < 1e-9);
/// ```
pub fn full_contact_stiffness(contact_modulus: f64, side: f64) -> f64 {
    foundation_stiffness(contact_modulus) * contact_model::line_length(side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// C_2D of a self-affine surface with H = 0.7 and constant 1.
    fn surface_spectrum(q: f64) -> f64 {
        q.powf(-2.0 * 1.7)
    }

    #[test]
    fn the_line_has_the_variance_of_the_surface_on_one_band() {
        // Plane: int C_2D 2 pi q dq. Line: 2 int C_1D dq. Trapezoids on a logarithmic grid; both integrals on
        // the same one.
        let grid: Vec<f64> = (0..=4000).map(|i| (f64::from(i) * 1e-3).exp()).collect();
        let integral = |f: &dyn Fn(f64) -> f64| -> f64 {
            grid.windows(2).map(|q| (q[1] - q[0]) * (f(q[0]) + f(q[1])) / 2.0).sum()
        };
        let plane = integral(&|q| 2.0 * PI * q * surface_spectrum(q));
        let line = 2.0 * integral(&|q| line_spectrum(q, surface_spectrum(q)));
        assert_relative_eq!(line, plane, max_relative = 1e-14);
        // Closed form of the same: 2 pi int q^-2.4 dq from 1 to e^4. The trapezoids of width 1e-3 are good to
        // 1e-6.
        let exact = 2.0 * PI / 1.4 * (1.0 - (-4.0_f64 * 1.4).exp());
        assert_relative_eq!(line, exact, max_relative = 1e-6);
    }

    #[test]
    fn the_modes_add_up_to_the_spectrum() {
        // 2 sum B^2 over positive modes is the Riemann sum of 2 int C_1D dq with dq = 2 pi / L_1D.
        let length = contact_model::line_length(3.0);
        let step = 2.0 * PI / length;
        let modes = (1..=100).map(|m| f64::from(m) * step);
        let variance: f64 = modes
            .clone()
            .map(|q| 2.0 * mode_amplitude(line_spectrum(q, surface_spectrum(q)), length).powi(2))
            .sum();
        let riemann: f64 = modes.map(|q| 2.0 * line_spectrum(q, surface_spectrum(q)) * step).sum();
        assert_relative_eq!(variance, riemann, max_relative = 1e-14);
    }

    #[test]
    fn the_line_is_as_long_as_the_circle_of_equal_area_is_wide() {
        let side = 1.7;
        let length = contact_model::line_length(side);
        assert_relative_eq!(PI / 4.0 * length * length, side * side, max_relative = 1e-15);
        // Circle of that area: k = 2 E* a.
        assert_relative_eq!(
            full_contact_stiffness(3.0, side),
            2.0 * 3.0 * length / 2.0,
            max_relative = 1e-15
        );
    }
}
