//! Tangential influence coefficients: displacement of a cell centre under uniform tangential traction on a
//! rectangular cell, and the coupling of normal and tangential displacements.
//!
//! A tangential point force Q along x on a half-space of shear modulus G and Poisson's ratio nu displaces its
//! surface by (Cerruti; K. L. Johnson, Contact Mechanics, 1985, Eq. 3.75 at z = 0)
//!
//! `u_x = Q/(2 pi G) ((1 - nu)/r + nu x^2/r^3),   u_y = Q nu x y/(2 pi G r^3),
//! u_z = Q (1 - 2 nu) x/(4 pi G r^2)` (into the half-space).
//!
//! The traction on the second body is the opposite one, so that the relative displacement of two bodies is the
//! sum of both: with `1/E* = sum (1 - nu)/(2 G)` and `c = E* sum nu/(2 G)` (`c = nu/(1 - nu)` for one body on
//! a rigid one and for bodies that are alike) it is `1/(pi E*)` times the integral of
//!
//! `(1/r) 1 + (c/r^3) ((x^2, x y), (x y, y^2))`
//!
//! over the cell. The normal displacements differ in sign: of the two bodies together
//! `u_z = beta/(pi E*) int x/r^2 q_x + y/r^2 q_y` with Dundurs' second constant
//! `beta = E* ((1 - 2 nu_1)/G_1 - (1 - 2 nu_2)/G_2)/4`, where q acts on the first body; by reciprocity a
//! pressure causes the tangential displacement `u_x = -beta/(pi E*) int x/r^2 p`, towards itself in the body
//! with the larger `(1 - 2 nu)/G`.
//!
//! Integrals over a cell are sums over its corners, `f(e, n) - f(w, n) - f(e, s) + f(w, s)`, of functions whose
//! mixed derivative is the integrand:
//!
//! | integrand | `f(u, v)` | why |
//! |---|---|---|
//! | `x^2/r^3` | `v asinh(u/|v|)` | `y^2/r^3 = d^2 r/dx^2` and the next row, x and y exchanged |
//! | `y^2/r^3` | `u asinh(v/|u|)` | `int r_uu du = u/r`, `int u/r dv = u asinh(v/|u|)` |
//! | `x y/r^3` | `-r` | `x y/r^3 = -d^2 r/dx dy` |
//! | `x/r^2` | `v ln(u^2 + v^2)/2 + u atan(v/u)` | `int u/r^2 du = ln(r^2)/2`, integrated over v |
//!
//! The first two add up to Love's function ([`super::love`]).

use super::love::is_far;

/// The integral of `x^2/r^3` over a cell of sides `stretch` and `1 / stretch`, seen from the centre of
/// another one at the lattice offset (x, y); even in both lags. That of `y^2/r^3` is the same with lags and
/// sides exchanged, to the last bit.
///
/// Accuracy: that of [`super::love::influence`], relative to the sum of both: 4e-12 just inside 64 longer sides,
/// better than 1e-12 elsewhere.
pub fn along_x(x: usize, y: usize, stretch: f64) -> f64 {
    along_y(y, x, stretch.recip())
}

/// The integral of `y^2/r^3`.
pub fn along_y(x: usize, y: usize, stretch: f64) -> f64 {
    let (a, b) = (stretch, stretch.recip());
    let far = is_far(x, y, stretch);
    let (x, y) = (x as f64, y as f64);
    if far { far_along(x * a, y * b, a, b) } else { Corners::new(x, y, a, b).sum(along) }
}

/// The integral of `x y/r^3`, odd in both lags.
///
/// Accuracy: as [`along_x`].
pub fn across(x: usize, y: usize, stretch: f64) -> f64 {
    let (a, b) = (stretch, stretch.recip());
    if x == 0 || y == 0 {
        0.0
    } else if is_far(x, y, stretch) {
        far_across(x as f64 * a, y as f64 * b, a, b)
    } else {
        -Corners::new(x as f64, y as f64, a, b).sum(f64::hypot)
    }
}

/// The integral of `x/r^2` over a cell at the lattice offset (x, y): odd in x, even in y. That of `y/r^2` is
/// the same with lags and sides exchanged.
///
/// Accuracy: relative to its largest value at the same distance, as [`along_x`].
pub fn coupling(x: usize, y: usize, stretch: f64) -> f64 {
    let (a, b) = (stretch, stretch.recip());
    if x == 0 {
        0.0
    } else if is_far(x, y, stretch) {
        far_coupling(x as f64 * a, y as f64 * b, a, b)
    } else {
        near_coupling(x as f64, y as f64, a, b)
    }
}

/// The sum over the corners; the logarithm is that of the square of the distance over its value at the centre,
/// which changes no sum and keeps the logarithms small.
fn near_coupling(x: f64, y: f64, a: f64, b: f64) -> f64 {
    let centre = (x * a).powi(2) + (y * b).powi(2);
    let corner = |u: f64, v: f64| 0.5 * v * ((u * u + v * v) / centre).ln() + u * (v / u).atan();
    Corners::new(x, y, a, b).sum(corner)
}

/// The corners of a cell at an offset, counted in cells of sides a and b; none lies on an axis.
struct Corners {
    east: f64,
    west: f64,
    north: f64,
    south: f64,
}

impl Corners {
    fn new(x: f64, y: f64, a: f64, b: f64) -> Self {
        Self { east: (x + 0.5) * a, west: (x - 0.5) * a, north: (y + 0.5) * b, south: (y - 0.5) * b }
    }

    fn sum(&self, f: impl Fn(f64, f64) -> f64) -> f64 {
        f(self.east, self.north) - f(self.west, self.north) - f(self.east, self.south)
            + f(self.west, self.south)
    }
}

/// The corner function of `v^2/r^3`, whose integral along u and v it is.
fn along(u: f64, v: f64) -> f64 {
    u * (v / u.abs()).asinh()
}

// The far field is the mean over the cell by Taylor's series, `sinh(D/2)/(D/2)` in both directions:
// `f + (a^2 f_xx + b^2 f_yy)/24 + (a^4 f_xxxx + b^4 f_yyyy)/1920 + a^2 b^2 f_xxyy/576`. The derivatives of r
// follow from those along one axis and from `Laplace r = 1/r`, `Laplace^2 r = 1/r^3`, `Laplace^3 r = 9/r^5`.

/// The mean of `y^2/r^3 = d^2 r/dx^2`.
fn far_along(x: f64, y: f64, a: f64, b: f64) -> f64 {
    let r2 = x * x + y * y;
    let (cx, cy, a2, b2) = (x * x / r2, y * y / r2, a * a, b * b);
    // Derivatives along one axis: d^4 r and d^6 r times r^3 and r^5, d^4 (1/r) times r^5.
    let fourth = |c: f64, s: f64| -3.0 * s * (1.0 - 5.0 * c);
    let sixth = |c: f64, s: f64| 45.0 * s * (1.0 - 14.0 * c + 21.0 * c * c);
    let fourth_of_inverse = |c: f64| 3.0 * (35.0 * c * c - 30.0 * c + 3.0);
    let (x4, y4, x6, y6) = (fourth(cx, cy), fourth(cy, cx), sixth(cx, cy), sixth(cy, cx));
    // x^2 y^2 of r; x^4 y^2 and x^2 y^4.
    let mixed = 0.5 * (1.0 - x4 - y4);
    let (x4y2, x2y4) = (fourth_of_inverse(cx) - x6, fourth_of_inverse(cy) - y6);
    let second = (a2 * x4 + b2 * mixed) / 24.0;
    let next = (a2 * a2 * x6 + b2 * b2 * x2y4) / 1920.0 + a2 * b2 * x4y2 / 576.0;
    (cy + (second + next / r2) / r2) / r2.sqrt()
}

/// The mean of `x y/r^3 = -d^2 r/dx dy`.
fn far_across(x: f64, y: f64, a: f64, b: f64) -> f64 {
    let r2 = x * x + y * y;
    let (cx, cy, a2, b2) = (x * x / r2, y * y / r2, a * a, b * b);
    let second = 3.0 * (a2 * (2.0 - 5.0 * cy) + b2 * (2.0 - 5.0 * cx)) / 24.0;
    let fourth = |c: f64, s: f64| 3.0 * (-30.0 + 70.0 * c + 105.0 * s - 315.0 * c * s);
    let (x4, y4) = (fourth(cx, cy), fourth(cy, cx));
    let mixed = 3.0 * (15.0 - 35.0 * cx) - x4;
    let next = (a2 * a2 * x4 + b2 * b2 * y4) / 1920.0 + a2 * b2 * mixed / 576.0;
    x * y / r2 * (1.0 + (second + next / r2) / r2) / r2.sqrt()
}

/// The mean of `x/r^2`, the real part of `1/z`: `1/z + (a^2 - b^2)/(12 z^3) + ((a^4 + b^4)/80 - a^2 b^2/24)/z^5`.
fn far_coupling(x: f64, y: f64, a: f64, b: f64) -> f64 {
    let inverse = rustfft::num_complex::Complex::new(x, y).inv();
    let square = inverse * inverse;
    let (a2, b2) = (a * a, b * b);
    let next = (a2 * a2 + b2 * b2) / 80.0 - a2 * b2 / 24.0;
    (inverse * (square * (square * next + (a2 - b2) / 12.0) + 1.0)).re
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::love::influence_of_rectangle;
    use approx::assert_relative_eq;

    /// Gauss-Legendre's rule of eight points on [-1/2, 1/2].
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];

    fn gauss() -> impl Iterator<Item = (f64, f64)> + Clone {
        NODES.into_iter().flat_map(|(x, w)| [(0.5 * x, 0.5 * w), (-0.5 * x, 0.5 * w)])
    }

    /// The integral of the displacement under a point force over a cell at the distance (x, y), in pieces.
    fn quadrature(at: (usize, usize), stretch: f64, pieces: i32, f: impl Fn(f64, f64) -> f64) -> f64 {
        let nodes = || {
            let width = f64::from(pieces).recip();
            (0..pieces).flat_map(move |i| {
                let middle = (f64::from(i) + 0.5) * width - 0.5;
                gauss().map(move |(x, w)| (middle + width * x, w * width))
            })
        };
        let mut sum = 0.0;
        for (u, wu) in nodes() {
            for (v, wv) in nodes() {
                sum += wu * wv * f((at.0 as f64 + u) * stretch, (at.1 as f64 + v) / stretch);
            }
        }
        sum
    }

    /// The integrals of `x^2/r^3`, `y^2/r^3` and `x y/r^3`.
    fn shear(x: usize, y: usize, stretch: f64) -> [f64; 3] {
        [along_x(x, y, stretch), along_y(x, y, stretch), across(x, y, stretch)]
    }

    #[test]
    fn coefficients_are_integrals_of_the_point_force() {
        for stretch in [1.0, 1.7, 0.4] {
            for at in [(1, 0), (0, 1), (1, 1), (2, 1), (3, 7), (20, 0), (30, 31), (63, 3), (90, 40), (5, 400)]
            {
                let pieces = if at.0 + at.1 < 4 { 30 } else { 4 };
                let of = |f: &dyn Fn(f64, f64) -> f64| quadrature(at, stretch, pieces, f);
                let cube = |x: f64, y: f64| x.hypot(y).powi(3);
                let expected = [
                    of(&|x, y| x * x / cube(x, y)),
                    of(&|x, y| y * y / cube(x, y)),
                    of(&|x, y| x * y / cube(x, y)),
                ];
                let scale = expected[0] + expected[1];
                for (f, e) in shear(at.0, at.1, stretch).into_iter().zip(expected) {
                    assert!((f - e).abs() < 5e-12 * scale, "{stretch} {at:?}: {f} {e}");
                }
                let (found, expected) = (coupling(at.0, at.1, stretch), of(&|x, y| x / (x * x + y * y)));
                let scale = scale.max(expected.abs());
                assert!((found - expected).abs() < 5e-12 * scale, "{stretch} {at:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn under_the_own_cell_the_angle_is_integrated() {
        // In polar coordinates the integrals over a quarter are those of the distance to its boundary.
        for stretch in [1.0, 1.7, 0.4] {
            let (a, b): (f64, f64) = (stretch, stretch.recip());
            let corner = (b / a).atan();
            let integral = |f: fn(f64) -> f64| -> f64 {
                let piece = |from: f64, to: f64, reach: &dyn Fn(f64) -> f64| -> f64 {
                    (0..16)
                        .flat_map(|i| {
                            gauss()
                                .map(move |(x, w)| (from + (to - from) * (f64::from(i) + 0.5 + x) / 16.0, w))
                        })
                        .map(|(t, w)| w * (to - from) / 16.0 * f(t) * reach(t))
                        .sum()
                };
                let side = piece(0.0, corner, &|t: f64| 0.5 * a / t.cos());
                side + piece(corner, std::f64::consts::FRAC_PI_2, &|t: f64| 0.5 * b / t.sin())
            };
            let [xx, yy, xy] = shear(0, 0, stretch);
            assert_relative_eq!(xx, 4.0 * integral(|t| t.cos().powi(2)), max_relative = 1e-13);
            assert_relative_eq!(yy, 4.0 * integral(|t| t.sin().powi(2)), max_relative = 1e-13);
            assert!(xy == 0.0 && coupling(0, 0, stretch) == 0.0);
        }
    }

    #[test]
    fn both_directions_together_are_loves() {
        for stretch in [1.0, 0.6] {
            for at in [(0, 0), (1, 0), (2, 5), (63, 3), (64, 40), (500, 3)] {
                let [xx, yy, xy] = shear(at.0, at.1, stretch);
                assert_relative_eq!(
                    xx + yy,
                    influence_of_rectangle(at.0, at.1, stretch),
                    max_relative = 1e-11
                );
                let turned = shear(at.1, at.0, stretch.recip());
                let close = |a: f64, b: f64| assert!((a - b).abs() <= 1e-14 * (xx + yy), "{at:?}: {a} {b}");
                close(xx, turned[1]);
                close(yy, turned[0]);
                close(xy, turned[2]);
            }
        }
    }

    #[test]
    fn the_far_field_meets_the_closed_form() {
        for stretch in [1.0, 1.5] {
            // In longer sides of a cell.
            for (x, y) in [(64.0, 0.0), (64.0, 20.0), (45.0, 45.0), (3.0, 64.0)] {
                let (a, b): (f64, f64) = (stretch, 1.0 / stretch);
                let (x, y) = (x * a.max(b) / a, y * a.max(b) / b);
                let corners = Corners::new(x, y, a, b);
                let scale = (x * a).hypot(y * b).recip();
                let close = |far: f64, near: f64| assert!((far - near).abs() < 5e-12 * scale, "{far} {near}");
                close(far_along(x * a, y * b, a, b), corners.sum(along));
                close(far_across(x * a, y * b, a, b), -corners.sum(f64::hypot));
                close(far_coupling(x * a, y * b, a, b), near_coupling(x, y, a, b));
            }
        }
    }
}
