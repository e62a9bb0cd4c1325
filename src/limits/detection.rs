//! How soon a known change of the law can be seen.
//!
//! From the switch on, the state there known, the motion under the new law leaves that under the old one. The
//! log-likelihood ratio of the two laws is on average Σ|old − new|²/(2σ²) over the readings since; it decides once it
//! passes ln(false alarm interval ÷ sample time) (Lorden, *Annals of Mathematical Statistics* 42 (1971), 1897, for the
//! delay that no procedure beats).

use super::course::{Course, Sensors};
use super::error::LimitsError;
use super::law::Law;

/// Instants at which the switch is tried: enough for a median, whose own scatter is then 1.25 ÷ √200 of theirs.
pub(super) const STARTS: usize = 200;

/// Share of the record over which these lie: what follows, as much again, is left for seeing the switch.
pub(super) const SHARE: f64 = 0.5;

/// Delays of a change, s; `None` where the record ends before it is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection {
    /// Of a switch at the record's start, s.
    pub at_start: Option<f64>,
    /// Of switches at many instants of its first half: the median, s.
    pub median: Option<f64>,
    /// The smallest of those, s.
    pub smallest: Option<f64>,
    /// The largest of those, s.
    pub largest: Option<f64>,
    /// How many instants were tried.
    pub tried: usize,
    /// At how many of them the switch is seen before the record ends.
    pub seen: usize,
}

/// The log-likelihood ratio that decides, nats: ln(false alarm interval ÷ sample time), both in s.
pub fn level(false_alarm_interval: f64, sample_time: f64) -> f64 {
    (false_alarm_interval / sample_time).ln().max(0.0)
}

/// How soon a change from one law to another is seen; `level` in nats.
///
/// # Errors
/// [`LimitsError`] for a law without positive inertia, for sensors without noise.
pub fn detection(
    old: &Law,
    new: &Law,
    courses: &[Course],
    sensors: Sensors,
    level: f64,
) -> Result<Detection, LimitsError> {
    sensors.check()?;
    old.check(courses)?;
    new.check(courses)?;
    let total: usize = courses.iter().map(|course| course.drives.len()).sum();
    let stride = (SHARE * total as f64 / STARTS as f64).ceil().max(1.0) as usize;
    let starts = starts(courses).take((SHARE * total as f64).ceil() as usize).step_by(stride);
    let search = Search { old, new, sensors, level };
    let delays: Vec<Option<f64>> = starts.map(|(course, k)| search.delay(course, k)).collect();
    Ok(Detection::of(&delays))
}

/// Every sample that another follows.
fn starts(courses: &[Course]) -> impl Iterator<Item = (&Course, usize)> {
    courses.iter().flat_map(|course| (0..course.drives.len()).map(move |k| (course, k)))
}

impl Detection {
    pub(super) fn of(delays: &[Option<f64>]) -> Detection {
        let mut sorted: Vec<f64> = delays.iter().map(|delay| delay.unwrap_or(f64::INFINITY)).collect();
        sorted.sort_by(f64::total_cmp);
        let finite = |delay: Option<&f64>| delay.copied().filter(|delay| delay.is_finite());
        Detection {
            at_start: delays.first().copied().flatten(),
            median: finite(sorted.get(sorted.len() / 2)),
            smallest: finite(sorted.first()),
            largest: finite(sorted.last()),
            tried: delays.len(),
            seen: delays.iter().flatten().count(),
        }
    }
}

struct Search<'a> {
    old: &'a Law,
    new: &'a Law,
    sensors: Sensors,
    level: f64,
}

impl Search<'_> {
    /// Time from a switch at sample `start` of the course until it is seen, s.
    fn delay(&self, course: &Course, start: usize) -> Option<f64> {
        let laws = [self.old.motion(), self.new.motion()];
        let mut states = [course.states[start]; 2];
        let mut evidence = 0.0;
        for k in start..course.drives.len() {
            states = [0, 1].map(|law| course.advanced(&laws[law], states[law], k));
            let [old, new] = states;
            for (std, distance) in self.sensors.0.into_iter().zip([old.q - new.q, old.qd - new.qd]) {
                evidence += std.map_or(0.0, |std| 0.5 * (distance / std).powi(2));
            }
            // a motion beyond all numbers is not the other one either
            if !evidence.is_finite() || evidence > self.level {
                return Some(course.t[k + 1] - course.t[start]);
            }
        }
        None
    }
}
