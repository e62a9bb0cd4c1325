//! Where an energy is concentrated: the interval of bins that stands out most against what it would hold were the
//! energy spread evenly.
//!
//! A scan statistic (Kulldorff, Communications in Statistics 26 (1997), 1481): with the share p of the energy in a
//! region and the share b of the time spent there, its score is N (p ln(p/b) + (1 − p) ln((1 − p)/(1 − b))), N the
//! number of independent places.

/// Bins with less energy across which a region goes on.
const BRIDGED: usize = 2;

/// Share of the energy that a region must hold, and how many times its share of the baseline.
const SHARE: f64 = 0.25;
/// … at least, since it was sought among all regions.
const CONTRAST: f64 = 1.3;

/// Bins over one quantity: the energy in each, and what it is measured against.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bins {
    /// Energy, ≥ 0.
    pub energy: Vec<f64>,
    /// Time spent, or whatever else the energy would be proportional to, ≥ 0.
    pub baseline: Vec<f64>,
}

/// A region that stands out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// First bin.
    pub from: usize,
    /// One past the last bin.
    pub to: usize,
    /// Share of the energy.
    pub share: f64,
    /// Share of the baseline.
    pub baseline: f64,
    /// Evidence per independent place, nats, as far as it counts.
    pub divergence: f64,
}

impl Peak {
    /// Whether it holds much of the energy, and much more of it than of the baseline. The widest region of much
    /// evidence may not, where one within it does.
    pub fn stands_out(&self) -> bool {
        self.share > SHARE && self.share > CONTRAST * self.baseline
    }
}

/// p ln(p/b) + (1 − p) ln((1 − p)/(1 − b)); 0 where the region holds no more than its share.
pub fn divergence(share: f64, baseline: f64) -> f64 {
    if share <= baseline || baseline <= 0.0 {
        return 0.0;
    }
    let rest = if share < 1.0 { (1.0 - share) * ((1.0 - share) / (1.0 - baseline)).ln() } else { 0.0 };
    share * (share / baseline).ln() + rest
}

impl Bins {
    /// Empty bins.
    pub fn new(count: usize) -> Bins {
        Bins { energy: vec![0.0; count], baseline: vec![0.0; count] }
    }

    /// Adds to a bin.
    pub fn add(&mut self, bin: usize, energy: f64, baseline: f64) {
        if let (Some(sum), Some(base)) = (self.energy.get_mut(bin), self.baseline.get_mut(bin)) {
            *sum += energy;
            *base += baseline;
        }
    }

    /// The interval of bins that stands out most; none where all is even. An interval that is closed at both ends was
    /// sought among many more than one that is open: its divergence counts `closed` times.
    pub fn peak(&self, closed: f64) -> Option<Peak> {
        let (sums, count) = (Sums::of(self), self.energy.len());
        if sums.whole.iter().any(|whole| *whole <= 0.0) {
            return None;
        }
        let intervals = (0..count).flat_map(|from| (from + 1..=count).map(move |to| (from, to)));
        let peaks = intervals.map(|(from, to)| {
            let [share, baseline] = sums.shares(from, to);
            let counts = if from > 0 && to < count { closed } else { 1.0 };
            Peak { from, to, share, baseline, divergence: counts * divergence(share, baseline) }
        });
        let best = peaks.filter(Peak::stands_out).max_by(|a, b| a.divergence.total_cmp(&b.divergence));
        best.filter(|peak| peak.divergence > 0.0)
    }

    /// The region with the bins beside it that hold that part of its energy per baseline, and more of it than the rest
    /// does; its evidence stays.
    pub fn widened(&self, peak: &Peak, part: f64) -> Peak {
        let sums = Sums::of(self);
        let ([all, whole], count) = (sums.whole, self.energy.len());
        let rest = (1.0 - peak.share) * all / ((1.0 - peak.baseline) * whole).max(f64::MIN_POSITIVE);
        let least = rest.max(part * peak.share * all / (peak.baseline * whole));
        let lasts = |bin: &usize| self.energy[*bin] > least * self.baseline[*bin];
        let (mut from, mut to) = (peak.from, peak.to);
        while let Some(bin) = (from.saturating_sub(BRIDGED + 1)..from).find(lasts) {
            from = bin;
        }
        while let Some(bin) = (to..count.min(to + BRIDGED + 1)).rfind(lasts) {
            to = bin + 1;
        }
        let [share, baseline] = sums.shares(from, to);
        Peak { from, to, share, baseline, divergence: peak.divergence }
    }
}

/// Energy and baseline of all bins before each.
struct Sums {
    before: [Vec<f64>; 2],
    /// Of all bins.
    whole: [f64; 2],
}

impl Sums {
    fn of(bins: &Bins) -> Sums {
        let before = [&bins.energy, &bins.baseline].map(|values| {
            let sums = values.iter().scan(0.0, |sum, value| {
                *sum += value;
                Some(*sum)
            });
            std::iter::once(0.0).chain(sums).collect::<Vec<f64>>()
        });
        let whole = before.each_ref().map(|sums| sums[bins.energy.len()]);
        Sums { before, whole }
    }

    /// Shares of the energy and of the baseline in the bins from one to before another.
    fn shares(&self, from: usize, to: usize) -> [f64; 2] {
        [0, 1].map(|of| (self.before[of][to] - self.before[of][from]) / self.whole[of])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bins_that_hold_the_energy_are_found() {
        let mut bins = Bins::new(10);
        (0..10).for_each(|bin| bins.add(bin, if (3..5).contains(&bin) { 4.0 } else { 0.25 }, 1.0));
        let peak = bins.peak(1.0).unwrap();
        assert_eq!((peak.from, peak.to), (3, 5));
        assert!((peak.share - 0.8).abs() < 1e-12 && (peak.baseline - 0.2).abs() < 1e-12);
    }

    #[test]
    fn the_peak_is_sought_among_what_stands_out() {
        let bins = Bins { energy: vec![0.40, 0.39, 0.21], baseline: vec![0.30, 0.32, 0.38] };
        assert!(divergence(0.79, 0.62) > divergence(0.40, 0.30));
        assert_eq!(bins.peak(1.0).map(|peak| (peak.from, peak.to)), Some((0, 1)));
    }

    #[test]
    fn a_region_reaches_as_far_as_its_energy_lasts() {
        let energy = vec![0.3, 0.0, 0.01, 0.0, 4.0, 5.0, 0.5, 0.01, 0.3, 0.02, 0.0, 0.0];
        let bins = Bins { baseline: vec![1.0; energy.len()], energy };
        let peak = bins.peak(1.0).unwrap();
        assert_eq!((peak.from, peak.to), (4, 6));
        let widened = bins.widened(&peak, 0.05);
        assert_eq!((widened.from, widened.to), (4, 9));
        assert!(widened.share > peak.share && widened.divergence == peak.divergence);
    }

    #[test]
    fn even_energy_stands_out_nowhere() {
        let mut bins = Bins::new(7);
        (0..7).for_each(|bin| bins.add(bin, 2.0 * (1.0 + bin as f64), 1.0 + bin as f64));
        assert!(bins.peak(1.0).is_none_or(|peak| peak.divergence < 1e-12));
    }
}
