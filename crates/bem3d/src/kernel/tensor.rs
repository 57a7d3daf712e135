//! How the entries of a kernel act on the components of a traction.

use crate::real::Real;
use rustfft::num_complex::Complex;

/// The entries of a kernel at one wave, which act on the spectra of N components of a traction.
pub trait Tensor<T: Real, const N: usize>: Copy + Send + Sync {
    /// The spectra of the displacements.
    fn displacements(self, tractions: [Complex<T>; N]) -> [Complex<T>; N];

    /// The entries at the wave with the other sign along y.
    fn mirrored(self) -> Self;
}

/// The entries of a kernel that is a symmetric matrix with N rows, at one wave or at one lag. An entry off the
/// diagonal is odd in both directions.
pub trait Symmetric<T: Real, const N: usize>: Tensor<T, N> {
    /// A row of the matrix.
    fn row(self, i: usize) -> [T; N];
}

/// The entries of a symmetric matrix in double precision.
pub trait Invertible: Sized {
    /// The inverse matrix. Where the smallest eigenvalue is below `floor`, all are raised by what is missing: a
    /// rounding error must not turn a sign.
    fn inverse(self, floor: f64) -> Self;
}

/// Normal displacement under a pressure.
impl<T: Real> Tensor<T, 1> for [T; 1] {
    fn displacements(self, [p]: [Complex<T>; 1]) -> [Complex<T>; 1] {
        [p * self[0]]
    }

    fn mirrored(self) -> Self {
        self
    }
}

impl<T: Real> Symmetric<T, 1> for [T; 1] {
    fn row(self, _: usize) -> [T; 1] {
        self
    }
}

impl Invertible for [f64; 1] {
    fn inverse(self, floor: f64) -> Self {
        [1.0 / self[0].max(floor)]
    }
}

/// Tangential displacements under tangential tractions: `[xx, yy, xy]`.
impl<T: Real> Tensor<T, 2> for [T; 3] {
    fn displacements(self, [x, y]: [Complex<T>; 2]) -> [Complex<T>; 2] {
        let [xx, yy, xy] = self;
        [x * xx + y * xy, x * xy + y * yy]
    }

    fn mirrored(self) -> Self {
        let [xx, yy, xy] = self;
        [xx, yy, T::default() - xy]
    }
}

impl<T: Real> Symmetric<T, 2> for [T; 3] {
    fn row(self, i: usize) -> [T; 2] {
        let [xx, yy, xy] = self;
        if i == 0 { [xx, xy] } else { [xy, yy] }
    }
}

impl Invertible for [f64; 3] {
    fn inverse(self, floor: f64) -> Self {
        let [xx, yy, xy] = self;
        let smallest = f64::midpoint(xx, yy) - (0.5 * (xx - yy)).hypot(xy);
        let raised = (floor - smallest).max(0.0);
        let (xx, yy) = (xx + raised, yy + raised);
        let determinant = xx * yy - xy * xy;
        [yy / determinant, xx / determinant, -xy / determinant]
    }
}

/// Normal displacement under tangential tractions and tangential displacements under a pressure, of the
/// components `(p, q_x, q_y)`: the entries are `-i` times the sums of `f sin`, and the matrix is antisymmetric.
impl<T: Real> Tensor<T, 3> for [T; 2] {
    fn displacements(self, [p, qx, qy]: [Complex<T>; 3]) -> [Complex<T>; 3] {
        let [x, y] = self;
        let turned = |z: Complex<T>| Complex::new(z.im, T::default() - z.re);
        let pressed = turned(p);
        let pressed = Complex::new(T::default() - pressed.re, T::default() - pressed.im);
        [turned(qx * x + qy * y), pressed * x, pressed * y]
    }

    fn mirrored(self) -> Self {
        let [x, y] = self;
        [x, T::default() - y]
    }
}
