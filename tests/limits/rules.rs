//! What is refused, and in which words.

use super::record::{DUFFING, both, duffing, law};
use switchid::law::{Effect, Term};
use switchid::limits::{Law, LimitsError, Sensors, Start, bound, detection};

#[test]
fn effects_with_memory_and_numbers_that_are_none_are_refused() {
    let hysteresis = Term::Effect(Effect::prototype("hysteresis").unwrap());
    let error = Law::new(&[(Term::Inertia, 1.0), (hysteresis, 2.0)], &[]).unwrap_err();
    assert!(error.to_string().contains("\"hysteresis\" depends on more than"), "{error}");
    let error =
        law(&DUFFING).changed(&[(Term::Expression(switchid::law::Own::new(0, "x", false, &[])), 1.0)]).unwrap_err();
    assert!(matches!(error, LimitsError::NotPointwise { .. }));
    let error = law(&DUFFING).changed(&[(Term::power(1, 0), f64::NAN)]).unwrap_err();
    assert!(error.to_string().contains("\"q\" is NaN"), "{error}");
}

#[test]
fn sensors_without_noise_and_laws_without_inertia_are_refused() {
    let (law, course) = (law(&DUFFING), [duffing(1.0)]);
    let refused = |law: &Law, sensors: Sensors| bound(law, &course, sensors, Start::Unknown).unwrap_err().to_string();
    assert!(refused(&law, Sensors([Some(0.1), Some(0.0)])).contains("sensor noise of qd is 0"));
    assert!(refused(&law, Sensors([None, None])).contains("neither q nor qd"));
    let massless = law.changed(&[(Term::Inertia, 0.0)]).unwrap();
    assert!(refused(&massless, both(0.1)).contains("no positive inertia"));
    assert!(matches!(detection(&law, &massless, &course, both(0.1), 16.0), Err(LimitsError::NoInertia { .. })));
}
