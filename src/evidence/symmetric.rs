//! Small symmetric systems in place, on row-major slices of which the lower triangle counts; nothing is allocated.

/// Replaces the lower triangle of the n × n matrix by its Cholesky factor L. A pivot that falls below `tolerance` times its
/// diagonal entry is not positive for what rounding leaves: the row is then replaced by one that fixes its unknown to 0,
/// and `false` is returned.
pub fn cholesky(matrix: &mut [f64], n: usize, tolerance: f64) -> bool {
    let mut definite = true;
    for row in 0..n {
        let diagonal = matrix[row * n + row];
        for column in 0..row {
            let (head, tail) = matrix.split_at_mut(row * n);
            let upper = &head[column * n..column * n + column];
            let sum: f64 = tail[..column].iter().zip(upper).map(|(a, b)| a * b).sum();
            tail[column] = (tail[column] - sum) / head[column * n + column];
        }
        let squares: f64 = matrix[row * n..row * n + row].iter().map(|a| a * a).sum();
        let pivot = diagonal - squares;
        if pivot > tolerance * diagonal && pivot.is_finite() {
            matrix[row * n + row] = pivot.sqrt();
        } else {
            definite = false;
            matrix[row * n..row * n + row].fill(0.0);
            matrix[row * n + row] = f64::INFINITY;
        }
    }
    definite
}

/// Solves L y = b in place.
pub fn forward(factor: &[f64], n: usize, b: &mut [f64]) {
    for row in 0..n {
        let sum: f64 = factor[row * n..row * n + row].iter().zip(&*b).map(|(a, y)| a * y).sum();
        b[row] = (b[row] - sum) / factor[row * n + row];
    }
}

/// Solves Lᵀ x = y in place.
pub fn backward(factor: &[f64], n: usize, y: &mut [f64]) {
    for row in (0..n).rev() {
        y[row] /= factor[row * n + row];
        let value = y[row];
        for column in 0..row {
            y[column] -= factor[row * n + column] * value;
        }
    }
}

/// ln det(L Lᵀ), rows of fixed unknowns left out.
pub fn log_determinant(factor: &[f64], n: usize) -> f64 {
    let pivots = (0..n).map(|row| factor[row * n + row]).filter(|pivot| pivot.is_finite());
    2.0 * pivots.map(f64::ln).sum::<f64>()
}

/// Writes (L Lᵀ)⁻¹ into `inverse`, both triangles.
pub fn invert(factor: &[f64], n: usize, inverse: &mut [f64]) {
    for row in 0..n {
        let column = &mut inverse[row * n..(row + 1) * n];
        column.fill(0.0);
        column[row] = 1.0;
        forward(factor, n, column);
        backward(factor, n, column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATRIX: [f64; 9] = [4.0, 2.0, 0.4, 2.0, 5.0, 1.0, 0.4, 1.0, 3.0];

    #[test]
    fn the_inverse_times_the_matrix_is_one() {
        let mut factor = MATRIX;
        assert!(cholesky(&mut factor, 3, 1e-12));
        let mut inverse = [0.0; 9];
        invert(&factor, 3, &mut inverse);
        for row in 0..3 {
            for column in 0..3 {
                let entry: f64 = (0..3).map(|k| MATRIX[row * 3 + k] * inverse[k * 3 + column]).sum();
                let expected = if row == column { 1.0 } else { 0.0 };
                assert!((entry - expected).abs() < 1e-14, "({row}, {column}) = {entry}");
            }
        }
        let determinant = 4.0 * (15.0 - 1.0) - 2.0 * (6.0 - 0.4) + 0.4 * (2.0 - 2.0);
        assert!((log_determinant(&factor, 3) - f64::ln(determinant)).abs() < 1e-14);
    }

    #[test]
    fn a_collinear_unknown_is_fixed_to_zero() {
        let mut factor = [1.0, 1.0, 1.0, 1.0];
        assert!(!cholesky(&mut factor, 2, 1e-12));
        let mut b = [3.0, 3.0];
        forward(&factor, 2, &mut b);
        backward(&factor, 2, &mut b);
        assert_eq!(b, [3.0, 0.0]);
    }
}
