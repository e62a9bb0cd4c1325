//! One weak equation from one interval of samples.

use super::variation::Variation;
use crate::law::{Expression, Hold, Monomial, Motion, State, Term, raised};
use serde::{Deserialize, Serialize};

/// Samples of one interval [T₁, T₂]; all slices are of one length ≥ 3.
#[derive(Clone, Copy, Debug)]
pub struct Section<'a> {
    /// Time, s.
    pub t: &'a [f64],
    /// Displacement, m.
    pub q: &'a [f64],
    /// Velocity, m/s.
    pub qd: &'a [f64],
    /// Whether the velocity is measured; where it is an estimate, as few integrals as possible use it.
    pub qd_measured: bool,
    /// Excitation, N.
    pub excitation: &'a [f64],
    /// What the excitation did between samples.
    pub hold: Hold,
}

/// Computes weak equations for a set of terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The integral of each term against φ, SI units times s.
    pub terms: Vec<f64>,
    /// What white sensor noise of std 1 on each sample of (q, q̇) adds to the variance of each term's integral.
    pub noise: Vec<[f64; 2]>,
    /// The integral of the excitation against φ, N s.
    pub excitation: f64,
    /// ∫ φ² dt, s.
    pub norm: f64,
    /// What the same noise adds to the variance of the residual of the law that the row was formed about.
    pub residual_noise: [f64; 2],
    /// Its covariance of that residual with each term's integral: the bias of least squares (errors in variables).
    pub shared_noise: Vec<[f64; 2]>,
    /// The integrands' derivatives by (q, q̇) of one sample.
    gradients: Vec<[f64; 2]>,
}

impl Row {
    /// Room for `n` terms.
    pub fn new(n: usize) -> Row {
        let pairs = || vec![[0.0; 2]; n];
        Row {
            terms: vec![0.0; n],
            noise: pairs(),
            excitation: 0.0,
            norm: 0.0,
            residual_noise: [0.0; 2],
            shared_noise: pairs(),
            gradients: pairs(),
        }
    }

    /// Integrates over the section. Trapezoidal in the terms, which for an integrand that vanishes smoothly at both
    /// ends is of second order where the excitation jumps at samples and far better where it is smooth; exact in a held
    /// or linear excitation, trapezoidal (spectrally accurate) in a band-limited one.
    ///
    /// Where the law has coefficients, also the noise of its residual.
    pub fn integrate(&mut self, section: &Section, variation: Variation, law: &Motion) {
        self.clear();
        let (start, end) = (section.t[0], section.t[section.t.len() - 1]);
        let length = end - start;
        let mut before = [0.0; 3];
        for k in 0..section.t.len() {
            let [value, slope, curvature] = variation.at((section.t[k] - start) / length);
            let at = [value, slope / length, curvature / (length * length)];
            let weight = half_widths(section.t, k);
            let phi = at.map(|derivative| weight * derivative);
            self.norm += phi[0] * value;
            self.add_sample(section, k, phi, law);
            if !law.coefficients.is_empty() {
                self.add_residual_noise(law.coefficients);
            }
            self.excitation += match section.hold {
                Hold::BandLimited => section.excitation[k] * phi[0],
                _ if k == 0 => 0.0,
                _ => held_excitation(section, k, [before, at]),
            };
            before = at;
        }
    }

    fn clear(&mut self) {
        self.terms.fill(0.0);
        self.noise.fill([0.0; 2]);
        self.shared_noise.fill([0.0; 2]);
        (self.excitation, self.norm, self.residual_noise) = (0.0, 0.0, [0.0; 2]);
    }

    fn add_sample(&mut self, section: &Section, k: usize, phi: [f64; 3], law: &Motion) {
        let sums = self.terms.iter_mut().zip(&mut self.noise).zip(&mut self.gradients);
        for (((sum, noise), gradient), term) in sums.zip(law.terms) {
            *sum += integrand(*term, law.own, section, k, phi);
            *gradient = sensitivity(*term, law.own, section, k, phi);
            noise[0] += gradient[0] * gradient[0];
            noise[1] += gradient[1] * gradient[1];
        }
    }

    fn add_residual_noise(&mut self, law: &[f64]) {
        for channel in 0..2 {
            let of_law: f64 = self.gradients.iter().zip(law).map(|(gradient, value)| value * gradient[channel]).sum();
            self.residual_noise[channel] += of_law * of_law;
            for (shared, gradient) in self.shared_noise.iter_mut().zip(&self.gradients) {
                shared[channel] += gradient[channel] * of_law;
            }
        }
    }
}

/// Half the distance between the neighbours of sample k.
fn half_widths(t: &[f64], k: usize) -> f64 {
    0.5 * (t[(k + 1).min(t.len() - 1)] - t[k.saturating_sub(1)])
}

/// The term's integrand at sample k; `phi` is the weighted variation with its derivatives.
#[inline]
fn integrand(term: Term, own: &[Expression], section: &Section, k: usize, phi: [f64; 3]) -> f64 {
    let (q, qd) = (section.q[k], section.qd[k]);
    match term {
        Term::Inertia if section.qd_measured => -qd * phi[1],
        Term::Inertia => q * phi[2],
        Term::Monomial(Monomial { q: power, qd: 1, excitation: 0 }) => {
            let next = power + 1;
            -raised(q, next) / f64::from(next) * phi[1]
        }
        // (q² q̇)' − q q̇² : the first part is integrated by parts
        Term::Effect(_) if term.mass(1.0) != 0.0 => {
            -term.mass(q) * qd * phi[1] + (term.force(q, qd, section.excitation[k]) - 2.0 * q * qd * qd) * phi[0]
        }
        _ => term.force_of(own, State { q, qd }, section.excitation[k]) * phi[0],
    }
}

/// The integrand's derivatives by the measured (q, q̇) of sample k; an estimated velocity counts as exact.
#[inline]
fn sensitivity(term: Term, own: &[Expression], section: &Section, k: usize, phi: [f64; 3]) -> [f64; 2] {
    let (q, qd) = (section.q[k], section.qd[k]);
    match term {
        Term::Inertia if section.qd_measured => [0.0, phi[1]],
        Term::Inertia => [phi[2], 0.0],
        Term::Monomial(Monomial { q: power, qd: 1, excitation: 0 }) => [raised(q, power) * phi[1], 0.0],
        _ => {
            let (by_q, by_qd) = term.gradient_of(own, State { q, qd }, section.excitation[k]);
            [by_q * phi[0], if section.qd_measured { by_qd * phi[0] } else { 0.0 }]
        }
    }
}

/// ∫ F φ dt over the interval that ends at sample k, from φ, φ' and φ'' at its ends: exact where φ is a polynomial of
/// degree 5 there (its Hermite interpolation).
#[inline]
fn held_excitation(section: &Section, k: usize, [from, to]: [[f64; 3]; 2]) -> f64 {
    let h = section.t[k] - section.t[k - 1];
    let [first, last] = [section.excitation[k - 1], section.excitation[k]];
    let integral = h * (0.5 * (from[0] + to[0]) + h * (0.1 * (from[1] - to[1]) + h * (from[2] + to[2]) / 120.0));
    if section.hold == Hold::Zero {
        return first * integral;
    }
    // ∫ φ x dt with x from 0 to 1 over the interval
    let values = from[0] / 7.0 + to[0] * (5.0 / 14.0);
    let slopes = from[1] * (4.0 / 105.0) - to[1] * (13.0 / 210.0);
    let moment = h * (values + h * (slopes + h * (from[2] / 280.0 + to[2] / 210.0)));
    first * integral + (last - first) * moment
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Motion, State};

    const TERMS: [Term; 4] = [Term::Inertia, Term::power(0, 1), Term::power(1, 0), Term::power(2, 0)];
    const COEFFICIENTS: [f64; 4] = [1.3, 0.4, 3.0, 0.8];

    /// The largest violation of the law's weak form over two variations, for `n` samples in 2 s of an asymmetric
    /// motion.
    fn violation(n: usize, hold: Hold) -> f64 {
        let dt = 2.0 / n as f64;
        let force = |k: usize| (1.7 * k as f64 * dt + 0.3).sin() + 0.5 * (k as f64 * dt).powi(2);
        let motion = Motion::new(&TERMS, &COEFFICIENTS);
        let mut state = State { q: 0.4, qd: 0.9 };
        let (mut t, mut q, mut qd, mut excitation) = (vec![], vec![], vec![], vec![]);
        for k in 0..=n {
            t.push(k as f64 * dt);
            q.push(state.q);
            qd.push(state.qd);
            excitation.push(force(k));
            for part in 0..8 {
                let at =
                    |x: f64| if hold == Hold::Zero { force(k) } else { force(k) + x / 8.0 * (force(k + 1) - force(k)) };
                state = motion.step_linear(state, dt / 8.0, at(f64::from(part)), at(f64::from(part) + 1.0));
            }
        }
        let section = Section { t: &t, q: &q, qd: &qd, qd_measured: true, excitation: &excitation, hold };
        let mut row = Row::new(4);
        let residual = |variation| {
            row.integrate(&section, variation, &Motion::new(&TERMS, &[]));
            let left: f64 = row.terms.iter().zip(COEFFICIENTS).map(|(term, coefficient)| term * coefficient).sum();
            (left - row.excitation).abs()
        };
        [Variation::Polynomial { power: 5 }, Variation::Sine { mode: 3 }].map(residual).into_iter().fold(0.0, f64::max)
    }

    #[test]
    fn the_true_law_satisfies_its_weak_form_with_order_two_or_better() {
        for hold in [Hold::Zero, Hold::Linear] {
            for n in [50, 100, 200] {
                let order = (violation(n, hold) / violation(2 * n, hold)).log2();
                assert!(order > 1.9, "{hold}: order {order} from {n} samples");
            }
        }
    }

    #[test]
    fn an_excitation_held_or_linear_is_integrated_exactly() {
        // ∫ (4 s (1 − s))² ds = 8 ÷ 15, at equal and at unequal distances between samples
        let t = [0.0, 0.3, 0.5, 1.1, 1.9, 2.0];
        let [ramp, zeros] = [t, [0.0; 6]];
        let variation = Variation::Polynomial { power: 2 };
        let mut row = Row::new(0);
        let mut integral = |excitation: &[f64], hold| {
            let section = Section { t: &t, q: &zeros, qd: &zeros, qd_measured: true, excitation, hold };
            row.integrate(&section, variation, &Motion::new(&[], &[]));
            row.excitation
        };
        let whole = 2.0 * 8.0 / 15.0;
        assert!((integral(&[1.0; 6], Hold::Zero) - whole).abs() < 1e-14);
        assert!((integral(&ramp, Hold::Linear) - whole).abs() < 1e-14);
        // a step holds what is behind it
        let step = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let held = integral(&step, Hold::Zero);
        let s: f64 = 1.1 / 2.0;
        let before = 16.0 * (s.powi(3) / 3.0 - s.powi(4) / 2.0 + s.powi(5) / 5.0);
        assert!((held - (whole - 2.0 * before)).abs() < 1e-14, "{held}");
    }

    #[test]
    fn a_constant_times_the_slope_of_the_variation_integrates_to_zero() {
        let t: Vec<f64> = (0..=300).map(|k| 0.01 * f64::from(k)).collect();
        let [ones, zeros] = [vec![1.0; 301], vec![0.0; 301]];
        let section = Section { t: &t, q: &zeros, qd: &ones, qd_measured: true, excitation: &zeros, hold: Hold::Zero };
        let mut row = Row::new(1);
        row.integrate(&section, Variation::Polynomial { power: 4 }, &Motion::new(&[Term::Inertia], &[]));
        assert!(row.terms[0].abs() < 1e-12, "{}", row.terms[0]);
    }
}
