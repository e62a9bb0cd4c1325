//! The Cramér–Rao bound.

use super::record::{DUFFING, both, course, duffing, law, of};
#[test]
fn x() {
    let law = law(&DUFFING);
    for (s, sigma) in [(5.0, 0.1), (12.0, 0.1), (30.0, 0.1), (12.0, 0.01),(12.0,0.001)] {
        let b = of(&law, &duffing(s), both(sigma));
        eprintln!("{s} {sigma} {:?}", b);
    }
}
