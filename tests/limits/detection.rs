//! How soon a known change is seen.

use super::record::{DUFFING, both, course, duffing, law};
use switchid::law::{State, Term};
use switchid::limits::{Sensors, detection, level};

/// FACTS, evidence of 16 nats: median delay at σ = 0.01 and 0.1, over instants that hang on the motion.
#[test]
fn duffing_switches_are_seen_as_soon_as_the_prototype_saw_them() {
    let (damping, linear, cubic) = ((Term::power(0, 1), 0.6), (Term::power(1, 0), 5.0), (Term::power(3, 0), 4.0));
    let old = law(&DUFFING);
    let course = [duffing(40.0)];
    for (change, expected) in [
        (&[damping][..], [0.053, 0.286]),
        (&[linear], [0.033, 0.156]),
        (&[cubic], [0.049, 0.228]),
        (&[damping, linear, cubic], [0.023, 0.110]),
    ] {
        let new = old.changed(change).unwrap();
        for (std, expected) in [0.01, 0.1].into_iter().zip(expected) {
            let found = detection(&old, &new, &course, both(std), 16.0).unwrap();
            let median = found.median.unwrap();
            assert!((0.8..1.35).contains(&(median / expected)), "{change:?} at {std}: {median} for {expected}");
            assert!(found.smallest.unwrap() < median && median < found.largest.unwrap());
            assert_eq!(found.seen, found.tried);
        }
    }
}

/// A free mass under a new constant force: Δq = d t²/2m, Δq̇ = d t/m.
#[test]
fn a_free_mass_is_seen_to_accelerate_when_the_sums_of_its_parabola_say_so() {
    let (mass, force, dt, std) = (2.0, 0.5, 0.01, [0.02, 0.03]);
    let old = law(&[(Term::Inertia, mass)]);
    let new = old.changed(&[(Term::power(0, 0), force)]).unwrap();
    let course = [course(&old, State { q: 0.3, qd: 0.1 }, dt, 400, |_| 0.0)];
    for level in [2.0, 12.0, 30.0] {
        let mut evidence = 0.0;
        let expected = (1..).map(|k| f64::from(k) * dt).find(|t| {
            let apart = [0.5 * force * t * t / mass / std[0], force * t / mass / std[1]];
            evidence += 0.5 * (apart[0].powi(2) + apart[1].powi(2));
            evidence > level
        });
        let found = detection(&old, &new, &course, Sensors(std.map(Some)), level).unwrap();
        assert!((found.at_start.unwrap() - expected.unwrap()).abs() < 1e-9, "{found:?} for {expected:?}");
    }
}

#[test]
fn a_change_too_small_for_the_record_is_not_seen() {
    let old = law(&DUFFING);
    let new = old.changed(&[(Term::power(0, 1), 0.300001)]).unwrap();
    let found = detection(&old, &new, &[duffing(5.0)], both(0.1), level(1e6, 1e-3)).unwrap();
    assert_eq!((found.at_start, found.median, found.largest, found.seen), (None, None, None, 0));
    assert!(found.tried > 100);
}

#[test]
fn the_level_is_the_logarithm_of_samples_between_false_alarms() {
    assert!((level(1e6, 1e-3) - 9.0 * 10f64.ln()).abs() < 1e-12);
    assert_eq!(level(1e-6, 1e-3), 0.0);
}
