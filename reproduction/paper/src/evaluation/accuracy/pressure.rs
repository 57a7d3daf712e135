//! The distance of two pressures on different grids.

/// Relative L2 distance `|a - b| / |b|` of two fields, constant on the cells of N x N and M x M grids over
/// one square: exact, by the overlaps of the cells.
///
/// `None` where b vanishes or a field is not a square. Cost O((N + M)^2).
pub(crate) fn distance(a: &[f64], b: &[f64]) -> Option<f64> {
    let (n, m) = (a.len().isqrt(), b.len().isqrt());
    if n * n != a.len() || m * m != b.len() {
        return None;
    }
    let parts = overlaps(n, m);
    let mut sum = 0.0;
    for &(iy, jy, height) in &parts {
        let (a, b) = (&a[iy * n..][..n], &b[jy * m..][..m]);
        let row: f64 = parts.iter().map(|&(ix, jx, width)| width * (a[ix] - b[jx]).powi(2)).sum();
        sum += height * row;
    }
    let norm = b.iter().map(|v| v * v).sum::<f64>() / (m * m) as f64;
    (norm > 0.0).then(|| (sum / norm).sqrt())
}

/// Pieces of [0, 1] on which both grids are constant: (cell of the first, cell of the second, length).
fn overlaps(n: usize, m: usize) -> Vec<(usize, usize, f64)> {
    let mut parts = Vec::with_capacity(n + m);
    let (mut i, mut j, mut start) = (0, 0, 0);
    // In units of 1/(n m): whole numbers, so that ends meet exactly.
    while i < n && j < m {
        let (a, b) = ((i + 1) * m, (j + 1) * n);
        let end = a.min(b);
        parts.push((i, j, (end - start) as f64 / (n * m) as f64));
        start = end;
        i += usize::from(a == end);
        j += usize::from(b == end);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn by_hand() {
        // One cell of 2 against four cells 2, 2, 2, 0: a quarter of the square differs by 2; |b|^2 = 3.
        assert_relative_eq!(distance(&[2.0], &[2.0, 2.0, 2.0, 0.0]).unwrap(), (1.0_f64 / 3.0).sqrt());
        // Thirds and halves: the middle third is shared.
        let lengths: Vec<f64> = overlaps(3, 2).iter().map(|p| p.2).collect();
        assert_relative_eq!(lengths[..], [1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0]);
        let same: Vec<f64> = (0..9).map(f64::from).collect();
        assert!(distance(&same, &same).unwrap().abs() < 1e-15);
        assert_eq!(distance(&[1.0], &[0.0]), None);
        assert_eq!(distance(&[1.0, 2.0], &[1.0]), None);
    }
}
