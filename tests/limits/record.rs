//! Records without noise, the law's own motion.

use switchid::law::{Drive, State, Term};
use switchid::limits::{Bound, Course, Law, Sensors, Start, bound};

/// m q̈ + c q̇ + k1 q + k3 q³ = F.
pub const DUFFING: [(Term, f64); 4] =
    [(Term::Inertia, 1.0), (Term::power(0, 1), 0.3), (Term::power(1, 0), 4.0), (Term::power(3, 0), 2.0)];

/// Every coefficient of the law sought.
pub fn law(pairs: &[(Term, f64)]) -> Law {
    Law::new(pairs, &(0..pairs.len()).collect::<Vec<_>>()).unwrap()
}

/// The first term's coefficient known, the others sought.
pub fn with_inertia_known(pairs: &[(Term, f64)]) -> Law {
    Law::new(pairs, &(1..pairs.len()).collect::<Vec<_>>()).unwrap()
}

/// The law's own motion from `start` over `count` intervals under an excitation that is straight between samples.
pub fn course(law: &Law, start: State, dt: f64, count: usize, excitation: impl Fn(f64) -> f64) -> Course {
    let t: Vec<f64> = (0..=count).map(|k| k as f64 * dt).collect();
    let drives = t.windows(2).map(|pair| Drive::Line(excitation(pair[0]), excitation(pair[1]))).collect();
    let motion = switchid::law::Motion::new(law.terms(), law.coefficients());
    Course::own(&motion, start, t, drives)
}

/// FACTS' plant from q = 0.5, 1 kHz.
pub fn duffing(seconds: f64) -> Course {
    course(&law(&DUFFING), State { q: 0.5, qd: 0.0 }, 1e-3, (seconds * 1e3).round() as usize, |t| 2.0 * (1.5 * t).sin())
}

pub fn both(std: f64) -> Sensors {
    Sensors([Some(std), Some(std)])
}

pub fn of(law: &Law, course: &Course, sensors: Sensors) -> Bound {
    bound(law, std::slice::from_ref(course), sensors, Start::Unknown).unwrap()
}

/// The samples of a range.
pub fn part(whole: &Course, range: std::ops::Range<usize>) -> Course {
    Course {
        t: whole.t[range.clone()].to_vec(),
        drives: whole.drives[range.start..range.end - 1].to_vec(),
        states: whole.states[range].to_vec(),
    }
}
