//! Whether a sensor came back from an outage with an offset, and what is left of one that was found: one unknown beside
//! the law, in closed form.
//!
//! With an offset u of a channel the filter of the law in use expects z u more of it, z being carried from sample to
//! sample as any sensitivity is. Its innovations ε of variance s then have the score g = Σ r ε ÷ s and the information
//! I = Σ r² ÷ s, r being what is expected more of the reading itself; against a prior of variance V the offset has
//! ½ g² V ÷ (1 + I V) − ½ ln(1 + I V) nats.

use crate::estimation::{Channel, Filter, Innovation, IntervalMap, gains, times};
use serde::{Deserialize, Serialize};

/// An offset not found within this time after the outage is none that it brought, s.
const WITHIN: f64 = 5.0;

/// The offset of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Offset {
    /// z.
    sensitivity: [f64; 2],
    information: f64,
    score: f64,
    /// V.
    variance: f64,
}

/// The offsets that the last outage may have brought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AfterOutage {
    offsets: [Offset; 2],
    /// Time since the outage, s; `None` where there was none of late.
    since: Option<f64>,
    /// Time since the outage from which what is left of an offset that was found is taken off, s.
    due: f64,
    /// What has been taken off since the outage, and of which channel.
    taken: Option<(Channel, f64)>,
}

/// A channel that came back with an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Returned {
    /// The channel.
    pub channel: Channel,
    /// The offset, or what is left of it.
    pub offset: f64,
    /// What it does to the state that the filter has, and its variance.
    sensitivity: [f64; 2],
    variance: f64,
    /// Log-odds against no offset, and the log-likelihood against one of the other channel, nats.
    pub evidence: f64,
    pub against_other: f64,
    /// Time since the outage, s.
    pub since: f64,
}

impl Offset {
    fn take(&mut self, channel: Channel, map: &IntervalMap, innovations: &[Option<Innovation>; 2]) {
        self.sensitivity = times(&map.transition, self.sensitivity);
        for (read, gain) in Channel::ALL.into_iter().zip(gains(innovations)) {
            let Some(innovation) = &innovations[read as usize] else { continue };
            let row = self.sensitivity[read as usize] + if read == channel { 1.0 } else { 0.0 };
            self.information += row * row * innovation.precision;
            self.score += row * innovation.residual * innovation.precision;
            self.sensitivity.iter_mut().zip(gain).for_each(|(entry, gain)| *entry -= gain * row);
        }
    }

    /// Log-likelihood of the offset against none, nats.
    fn evidence(&self) -> f64 {
        let told = 1.0 + self.information * self.variance;
        0.5 * (self.score * self.score * self.variance / told - told.ln())
    }
}

impl Returned {
    /// The filter without the offset.
    pub fn without(&self, mut filter: Filter) -> Filter {
        let z = self.sensitivity;
        for row in 0..2 {
            filter.mean[row] += z[row] * self.offset;
            for column in 0..2 {
                filter.covariance[row][column] += z[row] * z[column] * self.variance;
            }
        }
        filter
    }
}

impl AfterOutage {
    /// An outage ends with this sample; `size` is what an offset may be by channel, std.
    pub fn begin(&mut self, size: [f64; 2], map: &IntervalMap, innovations: &[Option<Innovation>; 2]) {
        self.offsets = size.map(|size| Offset { variance: size * size, ..Offset::default() });
        (self.since, self.due, self.taken) = (Some(0.0), f64::INFINITY, None);
        if innovations.iter().all(|innovation| innovation.is_none()) {
            // the motion was not followed over the outage: its state is what was read
            for (channel, offset) in self.offsets.iter_mut().enumerate() {
                offset.sensitivity[channel] = -1.0;
            }
            return;
        }
        self.read(map, innovations);
    }

    /// An offset of the channel was found without an outage and taken off: this variance of it is left.
    pub fn follow(&mut self, channel: Channel, variance: f64) {
        self.offsets = [Offset::default(); 2];
        self.offsets[channel as usize].variance = variance;
        (self.since, self.due, self.taken) = (Some(0.0), 0.0, Some((channel, 0.0)));
    }

    /// Nothing is asked any more.
    pub fn end(&mut self) {
        self.since = None;
    }

    /// Whether it is asked.
    pub fn is_open(&self) -> bool {
        self.since.is_some()
    }

    /// Takes what the law in use makes of a sample, `dt` s after the last one.
    pub fn take(&mut self, dt: f64, map: &IntervalMap, innovations: &[Option<Innovation>; 2]) {
        self.read(map, innovations);
        self.since = self.since.map(|since| since + dt).filter(|since| *since < WITHIN);
    }

    fn read(&mut self, map: &IntervalMap, innovations: &[Option<Innovation>; 2]) {
        for (channel, offset) in Channel::ALL.into_iter().zip(&mut self.offsets) {
            offset.take(channel, map, innovations);
        }
    }

    /// Whether it is time to take off what is left of an offset.
    pub fn is_due(&self) -> bool {
        self.since.is_some_and(|since| since >= self.due)
    }

    /// Whether an offset has been taken off since the outage.
    pub fn is_found(&self) -> bool {
        self.taken.is_some()
    }

    /// The offset has been taken off the readings since the outage, and the filter goes on without it.
    pub fn correct(&mut self, returned: &Returned) {
        let Returned { channel, offset, .. } = *returned;
        let before = self.taken.map_or(0.0, |(_, taken)| taken);
        (self.taken, self.due) = (Some((channel, before + offset)), 2.0 * returned.since);
        let corrected = &mut self.offsets[channel as usize];
        corrected.score -= corrected.information * offset;
    }

    /// The likelier of the offsets; what is left of one that has been taken off.
    pub fn likeliest(&self) -> Option<Returned> {
        let since = self.since?;
        let [q, qd] = self.offsets.map(|offset| offset.evidence());
        let likelier = if q > qd { Channel::Q } else { Channel::Qd };
        let (channel, taken) = self.taken.unwrap_or((likelier, 0.0));
        let Offset { sensitivity, information, score, variance } = self.offsets[channel as usize];
        let left = variance / (1.0 + information * variance);
        let offset = left * (score - taken / variance);
        let evidence = match self.taken {
            Some(_) => 0.5 * offset * offset / left,
            None => q.max(qd),
        };
        let against_other = (q - qd).abs();
        Some(Returned { channel, offset, sensitivity, variance: left, evidence, against_other, since })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A particle at rest, read with std 1 in both channels, whose q comes back off by `off`.
    fn returned(off: f64) -> AfterOutage {
        let map = IntervalMap { transition: [[1.0, 0.01], [0.0, 1.0]], input: Vec::new(), push: [0.0; 2] };
        let mut filter: Filter = Filter::begin([0.0; 2], [1e-4, 1e-6]);
        let mut after = AfterOutage::default();
        for index in 0..300 {
            filter.predict(|change| times(&map.transition, change), &[[0.0; 2]; 2]);
            let noise = if index % 2 == 0 { 1.0 } else { -1.0 };
            let innovations = [(Channel::Q, off + noise), (Channel::Qd, -noise)];
            let innovations = innovations.map(|(channel, read)| Some(filter.update(channel, read, 1.0)));
            match index {
                0 => after.begin([10.0; 2], &map, &innovations),
                _ => after.take(0.01, &map, &innovations),
            }
        }
        after
    }

    #[test]
    fn an_offset_of_one_channel_is_found_and_none_is_not() {
        let found = returned(2.0).likeliest().unwrap();
        assert_eq!(found.channel, Channel::Q);
        assert!((found.offset - 2.0).abs() < 0.2 && found.evidence > 100.0, "{found:?}");
        assert!(returned(0.0).likeliest().unwrap().evidence < 0.0);
    }

    #[test]
    fn what_has_been_taken_off_is_not_found_again() {
        let mut after = returned(2.0);
        let found = after.likeliest().unwrap();
        after.correct(&found);
        let left = after.likeliest().unwrap();
        assert!(left.offset.abs() < 1e-9 && left.evidence < 1e-9, "{left:?}");
    }
}
