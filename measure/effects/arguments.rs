//! The command line of the benchmark, and the settings that it asks for.

use super::benchmark::{Outside, Secret, Sensors, Setting, pair};
use clap::Parser;
use switchid::law::Catalogue;

/// Hidden effects: which are found, and what is said of those that are not.
#[derive(Clone, Debug, Parser)]
pub struct Arguments {
    /// Seed of all draws
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Draws of every effect at every strength and noise
    #[arg(long, default_value_t = 4)]
    pub draws: u64,
    /// Only the draw of this number
    #[arg(long)]
    pub only: Option<u64>,
    /// What measures the motion: ideal sensors, or an encoder, filtered differences, a late F, lost samples and a
    /// disturbance
    #[arg(long, value_enum, default_value_t)]
    pub sensors: Sensors,
    /// Std of the noise ÷ std of each channel [default: 0.001,0.005,0.01,0.02,0.05,0.1 for ideal sensors, else 0]
    #[arg(long, value_delimiter = ',')]
    pub noise: Vec<f64>,
    /// RMS of the hidden force ÷ RMS of the excitation
    #[arg(long, value_delimiter = ',', default_values_t = [0.05, 0.1, 0.2])]
    pub strength: Vec<f64>,
    /// By which part the linear stiffness rises on the way: a record that switches and lacks an effect
    #[arg(long, default_value_t = 0.0)]
    pub switch: f64,
    /// Only problems with this in their name: an effect id, "a+b", "nothing", "outside", "pairs", "single", "rigs"
    #[arg(long, default_value = "")]
    pub effect: String,
    /// Samples of a record
    #[arg(long, default_value_t = 5000)]
    pub samples: usize,
    /// One draw, one strength, three noises where none is given, short records
    #[arg(long)]
    pub quick: bool,
    /// Problems at a time
    #[arg(long, default_value_t = 2)]
    pub threads: usize,
    /// Print every visible problem that was not answered right
    #[arg(long)]
    pub misses: bool,
    /// Print every problem
    #[arg(long)]
    pub all: bool,
}

/// Effects that a complete model may have besides its linear or cubic law.
const COMPLETE: [&str; 16] = [
    "coulomb_friction",
    "quadratic_damping",
    "stribeck_friction",
    "dead_zone_stiffness",
    "one_sided_stop",
    "hysteresis",
    "hidden_resonator",
    "excitation_delay",
    "presliding_friction",
    "friction_with_backlash",
    "asymmetric_damping",
    "load_dependent_friction",
    "position_dependent_friction",
    "cogging",
    "relaxation",
    "actuator_lag",
];

/// What a problem is of, for choosing among them; "rigs" are the single effects of real drives, joints and dampers.
const GROUPS: [&str; 5] = ["single", "pairs", "nothing", "outside", "rigs"];

/// The effects of [`GROUPS`]' last.
const RIGS: [&str; 8] = [
    "presliding_friction",
    "friction_with_backlash",
    "asymmetric_damping",
    "load_dependent_friction",
    "position_dependent_friction",
    "cogging",
    "relaxation",
    "actuator_lag",
];

impl Arguments {
    /// Every setting that is asked for.
    pub fn settings(&self) -> Vec<Setting> {
        let mut settings = Vec::new();
        for &strength in &self.strengths() {
            for &noise in &self.noises() {
                for draw in self.numbers() {
                    let secrets = self.secrets(draw).into_iter();
                    settings.extend(secrets.map(|secret| Setting {
                        secret,
                        strength,
                        noise,
                        sensors: self.sensors,
                        switch: self.switch,
                        samples: if self.quick { 2500 } else { self.samples },
                        seed: self.seed,
                        draw,
                    }));
                }
            }
        }
        settings
    }

    fn strengths(&self) -> Vec<f64> {
        if self.quick { vec![0.1] } else { self.strength.clone() }
    }

    fn noises(&self) -> Vec<f64> {
        match (self.sensors, self.quick) {
            _ if !self.noise.is_empty() => self.noise.clone(),
            (Sensors::Slow | Sensors::Fast, _) => vec![0.0],
            (Sensors::Ideal, true) => vec![0.001, 0.01, 0.05],
            (Sensors::Ideal, false) => vec![0.001, 0.005, 0.01, 0.02, 0.05, 0.1],
        }
    }

    fn numbers(&self) -> Vec<u64> {
        let draws = if self.quick { 1 } else { self.draws };
        self.only.map_or_else(|| (0..draws).collect(), |only| vec![only])
    }

    /// Every problem that is asked for, as many pairs as single effects.
    fn secrets(&self, draw: u64) -> Vec<Secret> {
        let ids = || Catalogue::ENTRIES.iter().map(|entry| entry.id);
        let single: Vec<Secret> = ids().map(|id| Secret::Missing(vec![id.into()])).collect();
        let pairs = (0..ids().count() as u64).map(|number| pair(self.seed, draw, number)).collect();
        let complete = COMPLETE.iter().map(|id| Secret::Complete(Some((*id).into())));
        let complete = [Secret::Complete(None)].into_iter().chain(complete).collect();
        let outside = Outside::ALL.map(Secret::Outside).to_vec();
        let rigs = RIGS.map(|id| Secret::Missing(vec![id.into()])).to_vec();
        let groups: [Vec<Secret>; 5] = [single, pairs, complete, outside, rigs];
        if let Some((one, other)) = self.effect.split_once('+') {
            return vec![Secret::Missing(vec![one.trim().into(), other.trim().into()])];
        }
        let all = GROUPS.into_iter().zip(groups);
        let exact = Catalogue::find(&self.effect).is_some();
        let named = |secret: &Secret| {
            if exact { secret.name() == self.effect } else { secret.name().contains(&self.effect) }
        };
        let chosen = |group: &str, secret: &Secret| match group {
            "pairs" => self.effect.is_empty() || self.effect == group,
            "rigs" => self.effect == group,
            _ => self.effect.is_empty() || self.effect == group || named(secret),
        };
        let wanted = all.flat_map(|(group, secrets)| secrets.into_iter().filter(move |secret| chosen(group, secret)));
        wanted.collect()
    }
}
