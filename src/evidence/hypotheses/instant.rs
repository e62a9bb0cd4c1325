//! How well the hypotheses together know the instant of a switch.
//!
//! The evidence e of a hypothesis is the log-likelihood ratio of all data under "the law switched at its start" to that
//! under "it did not". With every instant as likely beforehand, the density of the instant is exp(e), taken as linear
//! between neighbouring starts.

use super::bank::Bank;

impl Bank {
    /// Root mean square of the distance between the switch and `instant`, s; `time` is that of a sample, `now` that of
    /// the last one.
    pub fn distance_of_switch(&self, instant: f64, now: f64, time: impl Fn(u64) -> f64) -> Option<f64> {
        let live = &self.hypotheses[..self.count];
        let most = live.iter().map(|hypothesis| hypothesis.evidence).max_by(f64::total_cmp)?;
        let (mut sum, mut squares) = (0.0, 0.0);
        for (index, hypothesis) in live.iter().enumerate() {
            let here = time(hypothesis.start);
            let before = index.checked_sub(1).map_or(here, |index| time(live[index].start));
            let after = live.get(index + 1).map_or(now, |next| time(next.start));
            let density = (hypothesis.evidence - most).exp();
            let [mass, square] = hat(here - instant, here - before, after - here);
            sum += density * mass;
            squares += density * square;
        }
        (sum > 0.0).then(|| (squares / sum).sqrt())
    }
}

/// Integral, and second moment about 0, of the hat that is 1 at `x` and falls to 0 over `left` and `right` of it.
fn hat(x: f64, left: f64, right: f64) -> [f64; 2] {
    let mass = (left + right) / 2.0;
    let moment = (right * right - left * left) / 6.0;
    let square = (right.powi(3) + left.powi(3)) / 12.0;
    [mass, square + 2.0 * x * moment + x * x * mass]
}

#[cfg(test)]
mod tests {
    use super::hat;

    #[test]
    fn the_moments_of_a_hat_are_its_integrals() {
        let (x, left, right) = (1.7, 0.4, 0.9);
        let (mut mass, mut square) = (0.0, 0.0);
        let cells = 10_000;
        for k in 0..cells {
            let t = -left + (left + right) * (f64::from(k) + 0.5) / f64::from(cells);
            let height = if t < 0.0 { 1.0 + t / left } else { 1.0 - t / right };
            mass += height * (left + right) / f64::from(cells);
            square += height * (x + t).powi(2) * (left + right) / f64::from(cells);
        }
        let [found_mass, found_square] = hat(x, left, right);
        assert!((found_mass - mass).abs() < 1e-6 && (found_square - square).abs() < 1e-6);
    }
}
