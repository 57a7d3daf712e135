//! Potentials of a uniform load on a rectangular cell, on an endless strip, and of a force on a point.

use super::potentials::Potentials;
use numerics::gauss::Gauss;

/// Smallest depth, in sides of a cell, that a logarithm sees. A traction that jumps at the edge of a cell
/// causes an infinite stress on this edge; this keeps it finite.
const SMALLEST_DEPTH: f64 = 1e-12;
/// Depths below this, in sides of a cell, are taken as 0: their squares leave the range of f64.
const SURFACE: f64 = 1e-100;

/// Distances, in longer sides of the cell, from which on a rule with 6, 4, 3 and 2 points a side replaces the
/// closed form. Of a kernel that falls as 1/r^2 the rule of n points leaves about `(2n + 1)! (n!)^4/((2n + 1)
/// (2n)!^3) r^-2n` of its own value, which is 1e-14 or less at these distances, and the closed form loses
/// `r^2` of its digits.
const RULES_FROM: [f64; 4] = [8.0, 24.0, 100.0, 1500.0];

/// A cell of sides a and b, in any unit of length. Positions are measured from its centre.
#[derive(Debug, Clone, Copy)]
pub struct RectangularCell {
    a: f64,
    b: f64,
    six: Gauss<6>,
    four: Gauss<4>,
    three: Gauss<3>,
    two: Gauss<2>,
}

impl RectangularCell {
    pub fn new([a, b]: [f64; 2]) -> Self {
        Self { a, b, six: Gauss::new(), four: Gauss::new(), three: Gauss::new(), two: Gauss::new() }
    }

    /// The potentials at a point whose depth is not negative. The error is about 1e-15 of the largest stress
    /// under the cell, and 1e-13 of the stress at the same distance.
    pub fn potentials(&self, at: [f64; 3]) -> Potentials {
        let distance = length(at) / self.a.max(self.b);
        let rule = RULES_FROM.iter().filter(|from| distance >= **from).count();
        match rule {
            0 if self.is_long_from(at) => self.halves(at),
            0 => self.closed_form(at),
            1 => self.quadrature(&self.six, at),
            2 => self.quadrature(&self.four, at),
            3 => self.quadrature(&self.three, at),
            _ => self.quadrature(&self.two, at),
        }
    }

    /// Whether the cell is oblong and the point so far from its edge, in shorter sides, that a rule would
    /// hold if the cell were a square. The closed form, made for the longer side, then loses digits in the
    /// shorter one.
    fn is_long_from(&self, [x, y, z]: [f64; 3]) -> bool {
        let outside = |along: f64, side: f64| (along.abs() - 0.5 * side).max(0.0);
        let clear = length([outside(x, self.a), outside(y, self.b), z]);
        self.a.max(self.b) > 2.0 * self.a.min(self.b) && clear > RULES_FROM[0] * self.a.min(self.b)
    }

    /// The sum over the two halves of the longer side.
    fn halves(&self, [x, y, z]: [f64; 3]) -> Potentials {
        let (half, [shift_x, shift_y]) = if self.a > self.b {
            (Self { a: 0.5 * self.a, ..*self }, [0.25 * self.a, 0.0])
        } else {
            (Self { b: 0.5 * self.b, ..*self }, [0.0, 0.25 * self.b])
        };
        let mut sum = half.potentials([x - shift_x, y - shift_y, z]);
        sum.add(1.0, &half.potentials([x + shift_x, y + shift_y, z]));
        sum
    }

    /// The sum over the corners of functions whose mixed derivative is the integrand.
    pub fn closed_form(&self, [x, y, z]: [f64; 3]) -> Potentials {
        let (east, west) = (x + 0.5 * self.a, x - 0.5 * self.a);
        let (north, south) = (y + 0.5 * self.b, y - 0.5 * self.b);
        let mut sum = corner(east, north, z);
        sum.add(-1.0, &corner(west, north, z));
        sum.add(-1.0, &corner(east, south, z));
        sum.add(1.0, &corner(west, south, z));
        sum
    }

    /// The integral of the potentials of point forces by a rule of Gauss.
    pub fn quadrature<const POINTS: usize>(&self, rule: &Gauss<POINTS>, [x, y, z]: [f64; 3]) -> Potentials {
        let mut sum = Potentials::default();
        for (north, height) in rule.on(y - 0.5 * self.b, y + 0.5 * self.b) {
            for (east, width) in rule.on(x - 0.5 * self.a, x + 0.5 * self.a) {
                sum.add(width * height, &point([east, north, z]));
            }
        }
        sum
    }
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

/// The potentials of a unit force at the origin, at another point with z >= 0. No two terms cancel in it.
pub fn point(at: [f64; 3]) -> Potentials {
    let r = length(at);
    let [l, m, n] = at.map(|along| along / r);
    let t = (1.0 + n).recip();
    let (t2, t3) = (t * t, t * t * t);
    let (second, third) = ((2.0 + n) * t2, (8.0 + n * (9.0 + 3.0 * n)) * t3);
    let fourth = (3.0 + n) * t3;
    let normalised = [
        -l,
        -m,
        -n,
        t - l * l * second,
        t - m * m * second,
        -l * m * second,
        n * (3.0 * l * l - 1.0),
        n * (3.0 * m * m - 1.0),
        3.0 * l * m * n,
        3.0 * l * n * n,
        3.0 * m * n * n,
        n * m * (l * l * third - second),
        n * l * (m * m * third - second),
        m * (t2 - l * l * fourth),
        l * (t2 - m * m * fourth),
    ];
    Potentials(normalised.map(|derivative| derivative / r / r))
}

/// The functions whose mixed derivatives are the potentials of a point force, but for functions of x or of y
/// alone, which no sum over corners keeps. They are chosen such that no two terms cancel in any of them.
fn corner(x: f64, y: f64, z: f64) -> Potentials {
    let z = if z < SURFACE { 0.0 } else { z };
    let r = length([x, y, z]);
    let deep = z.max(SMALLEST_DEPTH);
    let product = x * y;
    let mut derivatives = [
        (y / x.hypot(deep)).asinh(),
        (x / y.hypot(deep)).asinh(),
        -product.atan2(z * r),
        product.atan2(x * x + z * (z + r)),
        product.atan2(y * y + z * (z + r)),
        (length([x, y, deep]) + deep).ln(),
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ];
    if z > 0.0 {
        let (across_x, across_y) = (z / r / (x * x + z * z), z / r / (y * y + z * z));
        let below = z / r / (r + z);
        derivatives[6] = -product * across_x;
        derivatives[7] = -product * across_y;
        derivatives[8] = z / r;
        derivatives[9] = -y * z * across_x;
        derivatives[10] = -x * z * across_y;
        derivatives[11] = x * below;
        derivatives[12] = y * below;
    }
    if r > 0.0 {
        derivatives[13] = -x / (r + z);
        derivatives[14] = -y / (r + z);
    }
    Potentials(derivatives)
}

/// The potentials under a unit load on a strip of width b that is endless along x, at the distance y from its
/// middle: plane strain, and antiplane shear of a traction along x. The potential of an endless strip is
/// infinite; what is the same everywhere is left out of it, and no stress depends on that.
///
/// The differences between the edges are written without cancellation, so that they are exact to rounding far
/// away.
pub fn strip(y: f64, z: f64, b: f64) -> Potentials {
    let (north, south) = (y + 0.5 * b, y - 0.5 * b);
    let z = if z < SURFACE { 0.0 } else { z };
    let square = |edge: f64| edge * edge + z.max(SMALLEST_DEPTH).powi(2);
    let both = square(north) * square(south);
    let mut derivatives = [0.0; 15];
    let logarithm = (2.0 * y * b / square(south)).ln_1p();
    let angle = (z * b).atan2(z * z + north * south);
    derivatives[1] = -logarithm;
    derivatives[2] = -2.0 * angle;
    derivatives[4] = 2.0 * angle;
    derivatives[7] = -2.0 * z * b * (z * z - north * south) / both;
    derivatives[10] = 4.0 * z * z * b * y / both;
    Potentials(derivatives)
}

#[cfg(test)]
mod tests;
