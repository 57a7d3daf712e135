//! Linear least squares of a few unknowns.

/// Most unknowns.
pub(super) const MOST: usize = 6;

/// A pivot of the scaled normal matrix below this is 0: the squares of coordinates that are one line to 1e-5
/// of their range.
const SINGULAR: f64 = 1e-10;

/// Normal equations that grow by one point after another.
#[derive(Debug, Clone)]
pub(super) struct NormalEquations {
    unknowns: usize,
    /// The lower triangle.
    matrix: [[f64; MOST]; MOST],
    right: [f64; MOST],
}

impl NormalEquations {
    pub(super) fn new(unknowns: usize) -> Self {
        Self { unknowns, matrix: [[0.0; MOST]; MOST], right: [0.0; MOST] }
    }

    /// A point: the functions at its place, and its value.
    pub(super) fn add(&mut self, basis: &[f64; MOST], value: f64) {
        for i in 0..self.unknowns {
            self.right[i] += basis[i] * value;
            for j in 0..=i {
                self.matrix[i][j] += basis[i] * basis[j];
            }
        }
    }

    /// The points of other equations.
    pub(super) fn add_all(&mut self, other: &Self) {
        for i in 0..self.unknowns {
            self.right[i] += other.right[i];
            for j in 0..=i {
                self.matrix[i][j] += other.matrix[i][j];
            }
        }
    }

    /// The coefficients; `None` where the points do not determine them.
    pub(super) fn solve(mut self) -> Option<[f64; MOST]> {
        cholesky(&mut self.matrix, self.right, self.unknowns)
    }
}

/// Cholesky's factorisation of the scaled matrix, of which the lower triangle is given; `None` where it is
/// singular.
fn cholesky(matrix: &mut [[f64; MOST]; MOST], mut right: [f64; MOST], n: usize) -> Option<[f64; MOST]> {
    let mut scale = [0.0; MOST];
    for i in 0..n {
        if matrix[i][i] <= 0.0 {
            return None;
        }
        scale[i] = matrix[i][i].sqrt().recip();
    }
    for i in 0..n {
        right[i] *= scale[i];
        for j in 0..=i {
            let known: f64 = matrix[i][..j].iter().zip(&matrix[j][..j]).map(|(a, b)| a * b).sum();
            let sum = matrix[i][j] * scale[i] * scale[j] - known;
            if i > j {
                matrix[i][j] = sum / matrix[j][j];
            } else if sum > SINGULAR {
                matrix[i][i] = sum.sqrt();
            } else {
                return None;
            }
        }
    }
    for i in 0..n {
        for k in 0..i {
            right[i] -= matrix[i][k] * right[k];
        }
        right[i] /= matrix[i][i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            right[i] -= matrix[k][i] * right[k];
        }
        right[i] /= matrix[i][i];
    }
    for i in 0..n {
        right[i] *= scale[i];
    }
    Some(right)
}
