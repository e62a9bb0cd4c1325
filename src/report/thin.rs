//! Long series as few points that look the same.

/// Most points of a series that are drawn as they are.
pub const MOST: usize = 4000;

/// The series itself, or its first point, the smallest and the largest value of each of half as many bins, in the order
/// in which they come, and its last point. Gaps stay gaps.
pub(super) fn envelope(x: &[f64], y: &[f64]) -> Vec<[f64; 2]> {
    envelope_of(x, y, MOST)
}

/// The same with another number of points at most.
pub(super) fn envelope_of(x: &[f64], y: &[f64], most: usize) -> Vec<[f64; 2]> {
    let count = x.len().min(y.len());
    if count <= most {
        return x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
    }
    let bins = most / 2 - 1;
    let bin = |index: usize| {
        let range = index * count / bins..(index + 1) * count / bins;
        let by_value = |a: &usize, b: &usize| y[*a].total_cmp(&y[*b]);
        let ends = [range.clone().min_by(by_value), range.clone().max_by(by_value)];
        let outermost = [0, count - 1].into_iter().filter(|index| range.contains(index));
        let mut ends: Vec<usize> = ends.into_iter().flatten().chain(outermost).collect();
        ends.sort_unstable();
        ends.dedup();
        ends
    };
    (0..bins).flat_map(bin).map(|at| [x[at], y[at]]).collect()
}

/// Every so many points, so that no more than [`MOST`] are left.
pub(super) fn sampled(x: &[f64], y: &[f64]) -> Vec<[f64; 2]> {
    let stride = x.len().min(y.len()).div_ceil(MOST).max(1);
    x.iter().zip(y).step_by(stride).map(|(x, y)| [*x, *y]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_envelope_keeps_every_extreme() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (0.01 * x).sin()).collect();
        y[54_321] = 9.0;
        y[12_345] = -7.0;
        let points = envelope(&x, &y);
        assert!(points.len() <= MOST);
        assert!(points.contains(&[54_321.0, 9.0]) && points.contains(&[12_345.0, -7.0]));
        assert_eq!([points[0][0], points[points.len() - 1][0]], [0.0, 99_999.0]);
        assert!(points.windows(2).all(|pair| pair[0][0] < pair[1][0]));
        assert_eq!(envelope(&x[..10], &y[..10]).len(), 10);
        assert!(sampled(&x, &y).len() <= MOST);
    }
}
