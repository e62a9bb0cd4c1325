//! The two plants of the publication, unswitched and switched, and what an identifier is told of them.

use serde::{Deserialize, Serialize};
use switchid::law::{Given, Model, Term};
use switchid::simulate::{Builtin, Scenario, Stage};

/// Added to every seed: the figures that anything was chosen by have smaller ones.
const FIRST_SEED: u64 = 52_000;

/// Random scenarios that a rapid one takes its laws from begin this far apart.
const SEEDS_OF_A_RAPID_ONE: u64 = 1000;

/// How long the first law of a rapid scenario holds, natural periods.
const SETTLING: f64 = 8.0;

/// Which plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Plant {
    /// m q̈ + c q̇ + k₁ q + k₃ q³ = P sin ωt with (1, 0.3, 4, 2), P = 2, ω = 1.5; its four terms are given.
    Duffing,
    /// L q̈ + α(q² − a)q̇ + q/C = P sin ωt with α = 0.6, a = L = C = 1, P = 1.2, ω = 1.1; the full cubic library of 11
    /// terms is given.
    VanDerPol,
}

impl Plant {
    /// Both.
    pub const ALL: [Plant; 2] = [Plant::Duffing, Plant::VanDerPol];

    /// Its name in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Plant::Duffing => "Duffing",
            Plant::VanDerPol => "van der Pol",
        }
    }

    /// Its name in that of a file.
    pub fn id(self) -> &'static str {
        match self {
            Plant::Duffing => "duffing",
            Plant::VanDerPol => "van-der-pol",
        }
    }

    /// Natural period, s: of the free undamped motion with the amplitude 1 for Duffing, of the free limit cycle for van
    /// der Pol.
    pub fn period(self) -> f64 {
        match self {
            Plant::Duffing => 2.7,
            Plant::VanDerPol => 6.4,
        }
    }

    /// Integral intervals of the publication's figures 4 and 8, s.
    pub fn intervals(self) -> [f64; 5] {
        match self {
            Plant::Duffing => [5.0, 6.0, 8.0, 12.0, 30.0],
            Plant::VanDerPol => [16.0, 20.0, 24.0, 30.0, 40.0],
        }
    }

    /// The terms of its law.
    pub fn terms(self) -> Vec<Term> {
        self.unswitched().terms()
    }

    /// What an identifier is told.
    pub fn model(self) -> Model {
        match self {
            Plant::Duffing => Model::of("Duffing", self.terms().into_iter().map(|term| (term, Given::Fit))),
            Plant::VanDerPol => Model::cubic_library(),
        }
    }

    /// One law for `duration` s, the publication's.
    pub fn single(self, duration: f64, noise: f64, seed: u64) -> Scenario {
        let scenario = self.unswitched().random(FIRST_SEED + seed).with_noise(noise);
        Scenario { duration, ..scenario }
    }

    /// Five to seven laws drawn from the seed, each for 12 to 25 s.
    pub fn switched(self, noise: f64, seed: u64) -> Scenario {
        self.switching().random(FIRST_SEED + seed).with_noise(noise)
    }

    /// A law for eight natural periods, then `switches` others drawn from the seed, each for `spacing` s.
    pub fn rapid(self, spacing: f64, switches: usize, noise: f64, seed: u64) -> Scenario {
        let first = SETTLING * self.period();
        let stage = |(number, stage): (usize, Stage)| {
            let start = if number == 0 { 0.0 } else { first + (number as f64 - 1.0) * spacing };
            Stage { start: to_the_tenth_of_a_millisecond(start), ..stage }
        };
        let stages = self.laws(seed).take(switches + 1).enumerate().map(stage).collect();
        let duration = first + switches as f64 * spacing;
        Scenario { stages, duration, ..self.switched(noise, seed) }
    }

    /// Laws without end, one random scenario after the other.
    fn laws(self, seed: u64) -> impl Iterator<Item = Stage> {
        let seeds = (0..).map(move |more| FIRST_SEED + seed + SEEDS_OF_A_RAPID_ONE * more);
        seeds.flat_map(move |seed| self.switching().random(seed).stages)
    }

    fn unswitched(self) -> Builtin {
        match self {
            Plant::Duffing => Builtin::DuffingNoise,
            Plant::VanDerPol => Builtin::VanDerPolNoise,
        }
    }

    fn switching(self) -> Builtin {
        match self {
            Plant::Duffing => Builtin::DuffingSine,
            Plant::VanDerPol => Builtin::VanDerPolSine,
        }
    }
}

fn to_the_tenth_of_a_millisecond(t: f64) -> f64 {
    (t * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;
    use switchid::simulate::record;

    #[test]
    fn rapid_scenarios_switch_when_and_as_often_as_asked_to_laws_that_differ() {
        for plant in Plant::ALL {
            let spacing = 0.25 * plant.period();
            let scenario = plant.rapid(spacing, 12, 0.01, 3);
            assert_eq!(scenario.stages.len(), 13);
            let gaps = scenario.stages.windows(2).skip(1).map(|pair| pair[1].start - pair[0].start);
            gaps.for_each(|gap| assert!((gap - spacing).abs() < 2e-4, "{gap}"));
            let same = scenario.stages.windows(2).any(|pair| pair[0].coefficients == pair[1].coefficients);
            assert!(!same && record(&scenario).is_ok());
        }
    }

    #[test]
    fn the_natural_periods_are_those_of_the_free_motions() {
        for (plant, start, silence) in [(Plant::Duffing, 1.0, [0.0, 1.0]), (Plant::VanDerPol, 2.0, [1.0, 1.0])] {
            let mut scenario = plant.single(40.0, 0.0, 0);
            scenario.stages[0].amplitude = 0.0;
            scenario.stages[0].coefficients[1] *= silence[0];
            scenario.initial.q = start;
            let readings = record(&scenario).unwrap();
            let up = readings.windows(2).filter(|pair| pair[0].q < 0.0 && pair[1].q >= 0.0);
            let times: Vec<f64> = up.map(|pair| pair[1].t).collect();
            let period = (times[times.len() - 1] - times[1]) / (times.len() - 2) as f64;
            assert!((period / plant.period() - 1.0).abs() < 0.02, "{plant:?}: {period}");
        }
    }
}
