//! What stands in for the channel that is not measured.

/// Writes the slopes of q, central differences over two samples on each side, fewer at the ends; all of one length ≥ 2.
pub fn differentiate(t: &[f64], q: &[f64], qd: &mut [f64]) {
    let last = t.len() - 1;
    for (k, slope) in qd.iter_mut().enumerate() {
        let (from, to) = (k.saturating_sub(2), (k + 2).min(last));
        *slope = (q[to] - q[from]) / (t[to] - t[from]);
    }
}

/// Writes the trapezoidal sum of q̇ from 0: the displacement up to a constant; all of one length ≥ 1.
pub fn integrate(t: &[f64], qd: &[f64], q: &mut [f64]) {
    q[0] = 0.0;
    for k in 1..t.len() {
        q[k] = q[k - 1] + 0.5 * (t[k] - t[k - 1]) * (qd[k] + qd[k - 1]);
    }
}
