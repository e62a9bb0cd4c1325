//! The row of a fault: what was seen of its records together.

use crate::watch::Seen;

/// A switch whose limit is above is none that must be seen, s.
const SEEN_WITHIN: f64 = 1.0;

/// The head of the table.
pub const HEAD: &str = "| fault | records | valid and wrong, s a record | worst | dishonest, s a record | worst | false a record | valid again, s, median | 90 % | never | missed | unknown, % | named ÷ limit, median | 90 % | worst | z², median | mean | missing |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|";

/// Figures of the records of one fault.
pub struct Tally<'a> {
    seen: &'a [Seen],
}

impl<'a> Tally<'a> {
    /// Of these records.
    pub fn of(seen: &'a [Seen]) -> Tally<'a> {
        Tally { seen }
    }

    /// Its cells.
    pub fn row(&self) -> String {
        let count = self.seen.len().max(1) as f64;
        let mean = |of: fn(&Seen) -> f64| self.seen.iter().map(of).sum::<f64>() / count;
        let most = |of: fn(&Seen) -> f64| self.seen.iter().map(of).fold(0.0, f64::max);
        let again = Quantiles::of(self.seen.iter().filter(|seen| seen.valid_before).map(|seen| seen.valid_again));
        let must = || self.seen.iter().filter(|seen| seen.limit < SEEN_WITHIN);
        let ratios = must().filter(|seen| seen.named.is_finite()).map(|seen| seen.named / seen.limit);
        let named = Quantiles::of(ratios);
        let known = self.seen.iter().filter(|seen| seen.squares[1] > 0.0);
        let squares = Quantiles::of(known.map(|seen| seen.squares[0] / seen.squares[1]));
        let [valid, unknown] = [0, 1].map(|index| self.seen.iter().map(|seen| seen.valid[index]).sum::<u64>());
        format!(
            "{} | {:.3} | {:.2} | {:.3} | {:.2} | {:.3} | {:.3} | {:.2} | {} of {} | {} of {} | {:.3} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {}",
            self.seen.len(),
            mean(|seen| seen.wrong),
            most(|seen| seen.wrong),
            mean(|seen| seen.dishonest),
            most(|seen| seen.dishonest),
            mean(|seen| f64::from(seen.false_switches)),
            again.at(0.5),
            again.at(0.9),
            again.infinite(),
            again.0.len(),
            must().filter(|seen| seen.named.is_infinite()).count(),
            must().count(),
            100.0 * unknown as f64 / valid.max(1) as f64,
            named.at(0.5),
            named.at(0.9),
            named.at(1.0),
            squares.at(0.5),
            squares.mean(),
            self.seen.iter().filter(|seen| seen.missing).count(),
        )
    }
}

/// Values in their order.
struct Quantiles(Vec<f64>);

impl Quantiles {
    fn of(values: impl Iterator<Item = f64>) -> Quantiles {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        Quantiles(values)
    }

    fn at(&self, part: f64) -> f64 {
        let place = (part * self.0.len() as f64) as usize;
        self.0.get(place.min(self.0.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
    }

    fn mean(&self) -> f64 {
        self.0.iter().sum::<f64>() / self.0.len() as f64
    }

    fn infinite(&self) -> usize {
        self.0.iter().filter(|value| value.is_infinite()).count()
    }
}
