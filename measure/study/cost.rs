//! Cost against the number of terms: time ratios, each measured against the smallest library in turns on one core.

use super::Failure;
use super::figure::{Claim, Figure, Picture, Section, table};
use super::follow::sample;
use super::lines::{limit, line};
use super::plant::Plant;
use super::statistics::{factor, median};
use serde::{Deserialize, Serialize};
use std::time::Instant;
use switchid::identify::{Identifier, Method, Sample, Settings};
use switchid::law::{Given, Model, Term};
use switchid::report::{Axis, Panel};
use switchid::simulate::record;

/// Libraries, by the highest degree of their monomials in q and q̇; 0 stands for the true terms alone.
const DEGREES: [u8; 4] = [0, 3, 4, 5];

/// Sensor noise, and length of the record, s.
const NOISE: f64 = 0.01;
const LENGTH: f64 = 20.0;

/// First window of the published method, s.
const INTERVAL: f64 = 16.0;

/// How often each library takes its turn.
const TURNS: usize = 5;

/// Coordinates for which terms are counted.
const COORDINATES: [u64; 4] = [1, 2, 3, 5];

/// Three coordinates are costly where they cost more than this many times one.
const COSTLY: f64 = 10.0;

/// Cost against terms.
pub struct Cost;

/// All libraries, in turns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    noise: f64,
}

/// Times of one library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Times {
    terms: usize,
    /// Ours: mean of all steps of the record, µs; one value a turn.
    ours: Vec<f64>,
    /// Published: the steps until its first law from 16 s, µs in all; one value a turn.
    published: Vec<f64>,
}

impl Figure for Cost {
    const NAME: &'static str = "cost";
    const ALONE: bool = true;
    type Point = Point;
    type Outcome = Vec<Times>;

    fn points(_seeds: u64) -> Vec<Point> {
        vec![Point { noise: NOISE }]
    }

    fn measure(point: &Point) -> Result<Vec<Times>, Failure> {
        let readings = record(&Plant::VanDerPol.single(LENGTH, point.noise, 0))?;
        let samples: Vec<Sample> = readings.iter().map(sample).collect();
        let models = DEGREES.map(library);
        let mut times: Vec<Times> = models.iter().map(Times::begin).collect();
        for _ in 0..TURNS {
            for (model, times) in models.iter().zip(&mut times) {
                times.ours.push(ours(model, &samples)?);
                times.published.push(published(model, &samples)?);
            }
        }
        Ok(times)
    }

    fn section(measured: &[(Point, Vec<Times>)]) -> Result<Section, Failure> {
        let times = measured.first().map(|(_, times)| times.as_slice()).ok_or("cost was not measured")?;
        let text = format!(
            "Van der Pol, {LENGTH} s, σ = {NOISE}; libraries of all monomials in q and q̇ up to a degree, the smallest has the true terms alone. They take turns, \
             {TURNS} each; medians of the ratios of one turn. Ours is a step while nothing switches, the published method a whole identification from {INTERVAL} s.\n\n{}\n\
             With n coordinates the full cubic library has a monomial of degree 3 or less in 2n variables for every one of n equations:\n\n{}",
            times_table(times),
            table(&["coordinates", "terms"], COORDINATES.map(|n| vec![n.to_string(), cubic(n).to_string()]))
        );
        Ok(Section {
            title: "Cost against the number of terms",
            text,
            pictures: vec![picture(times)],
            claims: vec![grows(times)],
        })
    }
}

impl Times {
    fn begin(model: &Model) -> Times {
        Times { terms: model.terms.len(), ours: Vec::new(), published: Vec::new() }
    }

    /// Median of its times against those of the same turn of the smallest library.
    fn ratio(&self, smallest: &Times, of: fn(&Times) -> &[f64]) -> Option<f64> {
        let ratios: Vec<f64> = of(self).iter().zip(of(smallest)).map(|(own, other)| own / other).collect();
        median(&ratios)
    }
}

const OURS: fn(&Times) -> &[f64] = |times| &times.ours;
const PUBLISHED: fn(&Times) -> &[f64] = |times| &times.published;

fn library(degree: u8) -> Model {
    let true_terms = Plant::VanDerPol.terms().into_iter().map(|term| (term, Given::Fit));
    let powers = (0..=degree).flat_map(|sum| (0..=sum).map(move |qd| Term::power(sum - qd, qd)));
    let maybe = powers.map(|term| (term, Given::Maybe));
    match degree {
        0 => Model::of("true terms", true_terms),
        _ => Model::of("library", [(Term::Inertia, Given::Fit)].into_iter().chain(maybe)),
    }
}

/// Terms of the full cubic library, inertia aside.
fn cubic(coordinates: u64) -> u64 {
    let variables = 2 * coordinates;
    coordinates * (variables + 1) * (variables + 2) * (variables + 3) / 6
}

fn ours(model: &Model, samples: &[Sample]) -> Result<f64, Failure> {
    let mut identifier = Identifier::new(model, Settings::default())?;
    let began = Instant::now();
    samples.iter().try_for_each(|sample| identifier.step(*sample))?;
    Ok(began.elapsed().as_secs_f64() * 1e6 / samples.len() as f64)
}

fn published(model: &Model, samples: &[Sample]) -> Result<f64, Failure> {
    let settings = Settings { method: Method::Publication, initial_window: INTERVAL, ..Settings::default() };
    let mut identifier = Identifier::new(model, settings)?;
    let began = Instant::now();
    for sample in samples {
        identifier.step(*sample)?;
        if identifier.output().identified_time.is_some() {
            break;
        }
    }
    Ok(began.elapsed().as_secs_f64() * 1e6)
}

fn times_table(times: &[Times]) -> String {
    let row = |own: &Times| {
        let [ours, published] = [OURS, PUBLISHED].map(|of| factor(own.ratio(&times[0], of)));
        vec![
            own.terms.to_string(),
            factor(median(&own.ours)),
            ours,
            factor(median(&own.published).map(|time| time / 1e3)),
            published,
        ]
    };
    let head = ["terms", "ours, µs a step", "÷ smallest", "published, ms an identification", "÷ smallest"];
    table(&head, times.iter().map(row))
}

fn picture(times: &[Times]) -> Picture {
    let measured = |name: &str, of: fn(&Times) -> &[f64]| {
        line(name, times.iter().map(|own| (own.terms as f64, own.ratio(&times[0], of))))
    };
    let proportional = times.iter().map(|own| (own.terms as f64, Some(own.terms as f64 / times[0].terms as f64)));
    let square = proportional.clone().map(|(terms, ratio)| (terms, ratio.map(|ratio: f64| ratio * ratio)));
    let panel = Panel {
        title: "time against that of the true terms alone".into(),
        x: Axis::log("terms").over(4.0, 22.0),
        y: Axis::log("time ÷ time with 4 terms").over(1.0, 50.0),
        layers: vec![
            measured("ours, a step", OURS),
            measured("published, an identification", PUBLISHED),
            line("as their square", square),
            limit("as the terms", proportional),
        ],
    };
    Picture { name: "cost".into(), caption: "Cost against the number of terms".into(), panels: vec![panel] }
}

/// Power of the number of terms with which time grows, from the cubic library to the largest.
fn exponent(times: &[Times], of: fn(&Times) -> &[f64]) -> Option<f64> {
    let largest = times.last()?;
    let cubic = times.iter().find(|own| own.terms == library(3).terms.len())?;
    Some(largest.ratio(cubic, of)?.ln() / (largest.terms as f64 / cubic.terms as f64).ln())
}

/// Cost of so many coordinates against one, as time grows with the terms of an equation.
fn of_coordinates(coordinates: u64, exponent: f64) -> f64 {
    let per_equation = (cubic(coordinates) / coordinates) as f64 / cubic(1) as f64;
    coordinates as f64 * per_equation.powf(exponent)
}

fn grows(times: &[Times]) -> Claim {
    let cost = |of, coordinates| exponent(times, of).map(|exponent| of_coordinates(coordinates, exponent));
    let costly = |of| cost(of, 3).is_some_and(|cost| cost > COSTLY);
    let words = |of| {
        let [three, five] = [3, 5].map(|coordinates| factor(cost(of, coordinates)));
        format!(
            "terms^{}, so {three} and {five} times the cost of one coordinate with 3 and 5",
            factor(exponent(times, of))
        )
    };
    Claim {
        claim: "the library's growth with n makes it costly",
        published: costly(PUBLISHED),
        ours: costly(OURS),
        evidence: format!(
            "n = 1, 2, 3, 5 coordinates have {} cubic terms; measured from 11 to {} terms of one equation, time goes as {} (published), {} (ours)",
            COORDINATES.map(|n| cubic(n).to_string()).join(", "),
            times.last().map_or(0, |largest| largest.terms),
            words(PUBLISHED),
            words(OURS),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_grow_by_degree_and_with_the_coordinates() {
        assert_eq!(DEGREES.map(|degree| library(degree).terms.len()), [4, 11, 16, 22]);
        assert_eq!([cubic(1), cubic(2)], [10, 70]);
    }

    #[test]
    fn ratios_are_taken_turn_by_turn() {
        let times = |ours: [f64; 3]| Times { terms: 4, ours: ours.to_vec(), published: vec![1.0] };
        let (smallest, other) = (times([1.0, 100.0, 1.0]), times([2.0, 200.0, 4.0]));
        assert_eq!(other.ratio(&smallest, OURS), Some(2.0));
    }

    #[test]
    fn the_exponent_is_that_of_the_upper_half() {
        let times = |terms: usize, time: f64| Times { terms, ours: vec![time], published: Vec::new() };
        let all = [times(4, 9.0), times(11, 10.0), times(22, 40.0)];
        assert!((exponent(&all, OURS).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(exponent(&all, PUBLISHED), None);
        assert_eq!(of_coordinates(2, 1.0), 7.0);
    }
}
