//! The Cramér–Rao bound against closed forms and differences of motions.

use super::friction::{self, Block};
use super::record::{DUFFING, both, course, duffing, law, of, part, with_inertia_known};
use nalgebra::{DMatrix, Matrix3, Vector3};
use switchid::law::{Effect, State, Term};
use switchid::limits::{Law, Sensors, Start, bound};

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found} for {expected}");
}

/// FACTS: limit of e by length of record, σ = 0.1; e grows as σ².
#[test]
fn the_duffing_plant_has_the_limits_known_from_the_prototype() {
    let law = law(&DUFFING);
    for (seconds, std, expected) in
        [(5.0, 0.1, 1.03e-4), (12.0, 0.1, 2.76e-5), (30.0, 0.1, 1.76e-5), (12.0, 0.01, 2.76e-7)]
    {
        let found = of(&law, &duffing(seconds), both(std)).relative_error.unwrap();
        assert_near(found, expected, 0.01, &format!("{seconds} s at {std}"));
    }
}

/// FACTS: 0.8, 1.25 and 2.0 s with the state at the start known; here the median over starts along the motion.
#[test]
fn the_shortest_record_grows_with_noise() {
    let law = law(&DUFFING);
    let whole = duffing(30.0);
    let shortest = |start: usize, std: f64| {
        let course = [part(&whole, start..start + 8001)];
        bound(&law, &course, both(std), Start::Known).unwrap().shortest_record.unwrap()
    };
    let median = |std: f64| {
        let mut found: Vec<f64> = (0..21).map(|start| shortest(1000 * start, std)).collect();
        found.sort_by(f64::total_cmp);
        found[10]
    };
    for (std, expected) in [(1e-3, 0.8), (1e-2, 1.25), (1e-1, 2.0)] {
        let found = median(std);
        assert!((0.7..1.4).contains(&(found / expected)), "{found} for {expected} at {std}");
    }
}

#[test]
fn a_record_must_be_longer_where_its_initial_state_is_unknown() {
    let (law, course) = (law(&DUFFING), [duffing(12.0)]);
    let bound = |start: Start| bound(&law, &course, both(0.01), start).unwrap();
    let (known, unknown) = (bound(Start::Known), bound(Start::Unknown));
    assert!(known.relative_error < unknown.relative_error);
    assert!(known.shortest_record < unknown.shortest_record);
}

#[test]
fn a_shorter_record_than_the_shortest_does_not_settle_and_the_shortest_does() {
    let law = law(&DUFFING);
    let shortest = of(&law, &duffing(12.0), both(0.01)).shortest_record.unwrap();
    let error = |seconds: f64| of(&law, &duffing(seconds), both(0.01)).relative_error.unwrap();
    assert!(error(shortest) < 0.05_f64.powi(2) && error(0.97 * shortest) > 0.05_f64.powi(2));
    assert_eq!(of(&law, &duffing(0.9 * shortest), both(0.01)).shortest_record, None);
}

/// m q̈ = F: q = q₀ + v₀ t + F t²/2m, a regression on 1, t, t².
#[test]
fn a_mass_under_a_constant_force_has_the_std_of_a_parabola() {
    let (mass, force, std, dt, count) = (2.0, 3.0, 0.01, 0.02, 150);
    let law = law(&[(Term::Inertia, mass)]);
    let course = course(&law, State { q: 0.4, qd: -1.0 }, dt, count, |_| force);
    let found = of(&law, &course, Sensors([Some(std), None])).std[0].unwrap();
    let information: Matrix3<f64> = (0..=count)
        .map(|k| k as f64 * dt)
        .map(|t| Vector3::new(1.0, t, 0.5 * t * t))
        .map(|row| row * row.transpose() / (std * std))
        .sum();
    let acceleration = information.try_inverse().unwrap()[(2, 2)].sqrt();
    assert_near(found, acceleration * mass * mass / force, 1e-3, "std of the mass");
}

/// The motion's slopes by differences: (initial state, coefficients) → every reading; the Schur complement by one
/// inverse.
fn by_differences(unknowns: &[f64], std: [f64; 2], motion: impl Fn(&[f64]) -> Vec<State>) -> Vec<f64> {
    let slope = |index: usize| {
        let moved = |by: f64| {
            let mut unknowns = unknowns.to_vec();
            unknowns[index] += by;
            motion(&unknowns)
        };
        let eps = 1e-5;
        let pairs = moved(eps).into_iter().zip(moved(-eps));
        let difference =
            |(a, b): (State, State)| [(a.q - b.q) / std[0], (a.qd - b.qd) / std[1]].map(|d| d / (2.0 * eps));
        pairs.flat_map(difference).collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = (0..unknowns.len()).map(slope).collect();
    let slopes = DMatrix::from_fn(columns[0].len(), columns.len(), |row, column| columns[column][row]);
    let covariance = (slopes.transpose() * slopes).try_inverse().unwrap();
    (2..unknowns.len()).map(|index| covariance[(index, index)].sqrt()).collect()
}

#[test]
fn the_std_are_those_of_differences_of_whole_motions() {
    let pairs = [
        (Term::Inertia, 1.3),
        (Term::power(0, 1), 0.3),
        (Term::power(1, 0), 4.0),
        (Term::Effect(Effect::PositionDependentInertia), 0.4),
        (Term::Effect(Effect::QuadraticDamping), 0.2),
    ];
    let terms = pairs.map(|(term, _)| term);
    let motion = |unknowns: &[f64]| {
        let pairs: Vec<(Term, f64)> = terms.into_iter().zip(unknowns[2..].iter().copied()).collect();
        course(&law(&pairs), State { q: unknowns[0], qd: unknowns[1] }, 0.02, 400, |t| 2.0 * (1.5 * t).sin() + t).states
    };
    let unknowns: Vec<f64> = [0.8, -0.3].into_iter().chain(pairs.map(|(_, value)| value)).collect();
    let expected = by_differences(&unknowns, [0.02, 0.05], motion);
    let law = law(&pairs);
    let course = course(&law, State { q: 0.8, qd: -0.3 }, 0.02, 400, |t| 2.0 * (1.5 * t).sin() + t);
    let found = of(&law, &course, Sensors([Some(0.02), Some(0.05)]));
    for (index, (found, expected)) in found.std.iter().zip(expected).enumerate() {
        assert_near(found.unwrap(), expected, 2e-3, &terms[index].name());
    }
}

/// Through its reversals: a block on a spring with dry friction has a motion in closed form.
#[test]
fn dry_friction_has_the_std_of_the_exact_motion_through_its_reversals() {
    let block = Block { stiffness: 4.0, friction: 1.2 };
    let (start, dt, count) = (State { q: 3.0, qd: 0.3 }, 5e-3, 1400);
    let motion = |unknowns: &[f64]| {
        let start = State { q: unknowns[0], qd: unknowns[1] };
        Block { stiffness: unknowns[2], friction: unknowns[3] }.motion(start, dt, count)
    };
    let expected = by_differences(&[start.q, start.qd, block.stiffness, block.friction], [0.01, 0.02], motion);
    let law = friction::law(&block);
    let course = friction::course(&block, start, dt, count);
    let found = of(&law, &course, Sensors([Some(0.01), Some(0.02)]));
    assert!(course.states.windows(2).filter(|pair| pair[0].qd * pair[1].qd < 0.0).count() >= 4);
    for (found, expected) in found.std.iter().zip(expected) {
        assert_near(found.unwrap(), expected, 0.02, "std");
    }
}

/// A block that has come to rest: its velocity tells nothing more.
#[test]
fn a_block_that_sticks_tells_nothing_more_by_its_velocity() {
    let law = with_inertia_known(&[(Term::Inertia, 1.0), (Term::Effect(Effect::CoulombFriction), 0.5)]);
    let velocity = |t: f64| (1.0 - 0.5 * t).max(0.0);
    let displacement = |t: f64| if t < 2.0 { t - 0.25 * t * t } else { 1.0 };
    let std = |count: usize| {
        let mut course = course(&law, State { q: 0.0, qd: 1.0 }, 0.01, count, |_| 0.0);
        for (state, t) in course.states.iter_mut().zip(&course.t) {
            *state = State { q: displacement(*t), qd: velocity(*t) };
        }
        of(&law, &course, Sensors([None, Some(0.01)])).std[0].unwrap()
    };
    let (short, resting, long) = (std(150), std(210), std(2000));
    assert!(resting < 0.9 * short, "{resting} after {short}");
    assert_near(long, resting, 1e-9, "std at rest");
}

/// Sensitivities to the initial state grow as e^(2t) here, to e^240, and shrink as e^(−300 t) there.
#[test]
fn unstable_and_stiff_laws_have_finite_limits_on_long_records() {
    for (damping, stiffness, seconds) in [(0.0, -4.0, 120.0), (300.0, 2.0, 40.0)] {
        let pairs = [(Term::Inertia, 1.0), (Term::power(0, 1), damping), (Term::power(1, 0), stiffness)];
        let law = law(&pairs);
        let std = |seconds: f64| {
            let count = (seconds / 0.01).round() as usize;
            let mut course = course(&law, State::default(), 0.01, count, |t| 2.0 * (1.5 * t).sin());
            // the bounded motion: an unstable one is held there, as by a controller
            for (state, t) in course.states.iter_mut().zip(&course.t) {
                *state =
                    State { q: (1.5 * t).sin() + (2.7 * t).sin(), qd: 1.5 * (1.5 * t).cos() + 2.7 * (2.7 * t).cos() };
            }
            of(&law, &course, both(0.01)).std.iter().map(|std| std.unwrap()).collect::<Vec<f64>>()
        };
        for (half, whole) in std(0.5 * seconds).into_iter().zip(std(seconds)) {
            assert!(whole > 0.0 && whole < half, "{whole} after {half}");
        }
    }
}

#[test]
fn what_is_known_makes_the_rest_better_known() {
    let all = of(&law(&DUFFING), &duffing(8.0), both(0.05));
    let fewer = of(&Law::new(&DUFFING, &[1, 3]).unwrap(), &duffing(8.0), both(0.05));
    assert!(fewer.std[0] < all.std[1] && fewer.std[1] < all.std[3]);
}

/// Sliding one way only, dry friction and a constant force are the same.
#[test]
fn terms_that_a_record_cannot_tell_apart_are_named_and_have_no_std() {
    let friction = Term::Effect(Effect::CoulombFriction);
    let law = law(&[(Term::Inertia, 1.0), (Term::power(0, 1), 0.4), (friction, 0.2), (Term::power(0, 0), 0.1)]);
    let course = course(&law, State { q: 0.0, qd: 1.0 }, 0.01, 800, |t| 2.0 + (1.5 * t).sin());
    assert!(course.states.iter().all(|state| state.qd > 0.0));
    let found = of(&law, &course, both(0.01));
    assert_eq!(found.open, [[friction, Term::power(0, 0)]]);
    assert_eq!((found.relative_error, found.shortest_record), (None, None));
    assert!(found.std[0].is_some() && found.std[1].is_some() && found.std[2..] == [None, None]);
}

/// The same record in other units of time and length: relative std stay.
#[test]
fn relative_std_do_not_depend_on_units() {
    let relative = |time: f64, length: f64| {
        let scales = [time * time / length, time / length, 1.0 / length, length.powi(-3)];
        let pairs: Vec<(Term, f64)> =
            DUFFING.iter().zip(scales).map(|((term, value), scale)| (*term, value * scale)).collect();
        let law = law(&pairs);
        let start = State { q: 0.5 * length, qd: 0.2 * length / time };
        let course = course(&law, start, 0.01 * time, 900, |t| 2.0 * (1.5 * t / time).sin());
        let found = of(&law, &course, Sensors([Some(0.03 * length), Some(0.05 * length / time)]));
        found.std.iter().zip(&pairs).map(|(std, (_, value))| std.unwrap() / value).collect::<Vec<f64>>()
    };
    for (index, (found, expected)) in relative(1e-3, 1e-6).into_iter().zip(relative(1.0, 1.0)).enumerate() {
        assert_near(found, expected, 1e-6, &DUFFING[index].0.name());
    }
}

/// Two halves with an initial state of their own each know less than the whole, and more than either.
#[test]
fn a_gap_costs_the_state_behind_it() {
    let law = law(&DUFFING);
    let whole = duffing(10.0);
    let halves = [part(&whole, 0..5001), part(&whole, 5000..10001)];
    let error = |courses: &[_]| bound(&law, courses, both(0.05), Start::Unknown).unwrap().relative_error.unwrap();
    let (one, two) = (error(std::slice::from_ref(&whole)), error(&halves));
    assert!(one < two && two < error(&halves[..1]) && two < error(&halves[1..]), "{one} {two}");
}
