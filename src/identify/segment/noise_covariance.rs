//! Sensor noise follows the innovations, process noise the likelihood.

use super::state::Segment;
use crate::estimation::{Channel, Filter, Noise, RIVALS, TWENTY_TO_ONE, Track, white_acceleration};
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use crate::identify::window::Window;

/// Variance of an innovation ÷ that of its sensor from which on the law's own error counts: it is then as large as the
/// sensor's.
const PROCESS_SHARE: f64 = 2.0;

/// The same where the state is known from the last 30 samples alone: an innovation's variance is its sensor's times 1 +
/// 1/30.
const FORGETTING: f64 = 1.0 + 1.0 / 30.0;

/// Samples after which an innovation's variance stays as it is: what the state that a run begins from adds to it is by
/// then less than half of what that is.
const STEADY: usize = 256;

/// Nothing tells a process noise from none under which the state is remembered for ten times the longest window,
/// samples.
const LIFETIME: f64 = 1e7;

/// Overdispersion of a record that its law does not explain: twice what is no chance for one coefficient; chance does
/// not bring it to any of a dozen.
pub(super) const UNEXPLAINED: f64 = 5.0;

/// Overdispersion that is no chance: with 16 blocks it is 1 ± 0.35 for one coefficient of the right law, so that this
/// is four stds.
const LASTING: f64 = 2.5;

/// Noise levels that move by less than this part have come to rest, whatever a level out of reach promises: a record of
/// 1000 samples tells a variance to 4.5 %. On EMPS a level out of reach kept the law from settling
/// (docs/decisions/prediction-error-method.md).
const AT_REST: f64 = 0.05;

impl Segment {
    /// Takes the noise levels of the next run from the one that has just closed.
    pub(super) fn follow_noise(&mut self, problem: &Problem, settings: &Settings, track: &Track, window: &Window) {
        let before = self.noise;
        self.follow_sensors(settings, track);
        let factor = self.process_factor(track);
        self.noise.process = (self.noise.process * factor).max(self.process_floor(problem, settings, window));
        if self.has_come_to_rest(&before) {
            self.fit.gain = self.fit.gain.min(0.0);
        }
    }

    /// What the run says of the law's own error, under the noise levels that it ran with.
    pub(super) fn tell_error(&mut self, problem: &Problem, settings: &Settings, track: &Track, window: &Window) {
        let scatter = self.scatter(problem, track.count, window.pace());
        let overdispersion = self.run.sandwich.overdispersion(&self.run.filter_run.information);
        let errs = self.gains(track)[0] <= -TWENTY_TO_ONE
            && self.noise.process >= 2.0 * self.process_floor(problem, settings, window);
        self.fit.overdispersion = if overdispersion > LASTING { overdispersion } else { 1.0 };
        self.fit.process_matters = scatter > PROCESS_SHARE;
        self.fit.explains = scatter < FORGETTING && overdispersion < UNEXPLAINED && !errs;
    }

    /// Geometric mean of an innovation's variance ÷ that of its sensor, of the channel where it is larger, over a run
    /// of so many innovations by channel, one every `dt` s, on which nothing but the process noise acts: what the
    /// excitation did unseen is no error of the law's.
    fn scatter(&self, problem: &Problem, counts: [f64; 2], dt: f64) -> f64 {
        let Noise { sensor: [q, qd], process } = self.noise;
        let measured = problem.channels.of_motion();
        let begins = [if measured[0] { q } else { qd * dt * dt }, if measured[1] { qd } else { q / (dt * dt) }];
        let mut filter = Filter::begin([0.0; 2], begins);
        let (mut last, mut sum) = ([0.0; 2], [0.0; 2]);
        for number in 0..STEADY {
            filter.predict(|[q, qd]| [q + dt * qd, qd], &white_acceleration(process, dt));
            for channel in Channel::ALL.into_iter().filter(|channel| measured[*channel as usize]) {
                let (index, variance) = (channel as usize, self.noise.sensor[channel as usize]);
                last[index] = (filter.update(channel, 0.0, variance).variance / variance).ln();
                sum[index] += if (number as f64) < counts[index] { last[index] } else { 0.0 };
            }
        }
        let steady = counts.map(|count| (count - STEADY as f64).max(0.0));
        let mean = |channel: usize| (sum[channel] + steady[channel] * last[channel]) / counts[channel].max(1.0);
        mean(0).max(mean(1)).exp()
    }

    /// Sensor variances that are not given follow the innovations.
    fn follow_sensors(&mut self, settings: &Settings, track: &Track) {
        let given = settings.given_noise();
        for channel in Channel::ALL {
            let index = channel as usize;
            let floor = Noise::floor(self.run.largest[index]);
            self.noise.sensor[index] = match given[index] {
                None => {
                    let (count, known) = (track.count[index], self.known.weight);
                    let seen = count * self.noise.sensor[index] * track.scale(channel);
                    ((seen + known * self.known.noise[index]) / (count + known).max(1.0)).max(floor)
                }
                Some(variance) => variance,
            };
        }
    }

    /// What less and more process noise would add to the log-likelihood.
    fn gains(&self, track: &Track) -> [f64; 2] {
        self.run.filter_run.rivals.log_likelihoods().map(|rival| rival - track.log_likelihood())
    }

    /// By which factor the process noise goes where the likelihood wants it.
    fn process_factor(&mut self, track: &Track) -> f64 {
        let [less, more] = self.gains(track);
        self.fit.gain = less.max(more);
        self.fit.likelihood = track.log_likelihood() / track.total().max(1.0);
        let ratio = match (less >= more, less > -0.1, more > 0.1) {
            (true, true, _) => RIVALS[0],
            (false, _, true) => RIVALS[1],
            _ => 1.0,
        };
        ratio * (track.squares[0] + track.squares[1]) / track.total().max(1.0)
    }

    fn has_come_to_rest(&self, before: &Noise) -> bool {
        let rests = |new: f64, old: f64| (new / old - 1.0).abs() <= AT_REST;
        let mut sensors = self.noise.sensor.iter().zip(before.sensor);
        rests(self.noise.process, before.process) && sensors.all(|(new, old)| rests(*new, old))
    }

    /// Least intensity of process noise: what the excitation's own noise makes, or too little to tell from none.
    fn process_floor(&self, problem: &Problem, settings: &Settings, window: &Window) -> f64 {
        let force = settings.noise_excitation / self.all[problem.inertia];
        force * force * settings.sample_time + self.unforgetting(problem, self.mean_interval(window))
    }

    /// Time from sample to sample of the record, s.
    fn mean_interval(&self, window: &Window) -> f64 {
        let [first, last] = [self.start, self.run.next - 1].map(|number| window.sample(number).t);
        (last - first) / (self.run.next - 1 - self.start).max(1) as f64
    }

    /// Intensity of process noise below which the state is remembered for [`LIFETIME`] samples.
    fn unforgetting(&self, problem: &Problem, dt: f64) -> f64 {
        let [q, qd] = self.noise.sensor;
        match problem.channels.qd {
            true => qd / (LIFETIME.powi(2) * dt),
            false => q / (LIFETIME.powi(4) * dt.powi(3)),
        }
    }
}
