use super::record::{DUFFING, both, course, law, of};
use switchid::law::State;
#[test]
fn x() {
    let law = law(&DUFFING);
    for q in [0.0, 0.1, 0.5, 1.0, 1.5, 2.0] {
        for (s, sigma) in [(5.0, 0.1), (12.0, 0.1), (30.0, 0.1)] {
            let c = course(&law, State { q, qd: 0.0 }, 1e-3, (s * 1e3) as usize, |t| 2.0 * (1.5 * t).sin());
            let b = of(&law, &c, both(sigma));
            eprintln!("{q} {s} {sigma} {:?} {:?}", b.relative_error, b.shortest_record);
        }
    }
}
