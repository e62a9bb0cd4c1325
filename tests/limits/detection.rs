//! How soon a change is seen.
use super::record::{DUFFING, both, duffing, law};
use switchid::law::Term;
use switchid::limits::detection;
#[test]
fn y() {
    let old = law(&DUFFING);
    let course = [duffing(40.0)];
    for change in [
        vec![(Term::power(0, 1), 0.6)],
        vec![(Term::power(1, 0), 5.0)],
        vec![(Term::power(3, 0), 4.0)],
        vec![(Term::power(0, 1), 0.6), (Term::power(1, 0), 5.0), (Term::power(3, 0), 4.0)],
    ] {
        for sigma in [0.01, 0.1] {
            eprintln!(
                "{change:?} {sigma} {:?}",
                detection(&old, &old.changed(&change).unwrap(), &course, both(sigma), 16.0)
            );
        }
    }
}
