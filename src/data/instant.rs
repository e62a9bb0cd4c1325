//! Dates and clock times: ISO 8601, the German and the American way, MATLAB's `01-May-2024 12:00:00`.

/// Seconds of a day.
pub(super) const DAY: f64 = 86_400.0;

const MONTHS: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];

/// An instant: days since 1970-01-01, where a date is told, and seconds of that day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Instant {
    pub(super) day: Option<i64>,
    pub(super) seconds: f64,
}

impl Instant {
    /// The instant that a cell holds; none where it holds a number or something else.
    pub(super) fn parse(text: &str) -> Option<Instant> {
        let text = text.trim();
        if !text.bytes().next()?.is_ascii_digit() {
            return None;
        }
        let Some((date, clock)) = text.split_once(['T', ' ']) else {
            return match text.contains(':') {
                true => clock(text).map(|seconds| Instant { day: None, seconds }),
                false => date(text).map(|day| Instant { day: Some(day), seconds: 0.0 }),
            };
        };
        if date.contains(':') {
            // 2:05:07.5 PM
            return self::clock(text).map(|seconds| Instant { day: None, seconds });
        }
        Some(Instant { day: Some(self::date(date)?), seconds: self::clock(clock)? })
    }

    /// Seconds since another instant; clock times alone count within one day.
    pub(super) fn since(self, other: Instant) -> f64 {
        let days = self.day.zip(other.day).map_or(0, |(day, from)| day - from);
        days as f64 * DAY + (self.seconds - other.seconds)
    }
}

/// Seconds of `12:34:56.789`, `12:34`, `2:05:07 PM`, with `Z` or `+02:00` behind it.
fn clock(text: &str) -> Option<f64> {
    let (text, offset) = zone(text.trim());
    let upper = text.to_ascii_uppercase();
    let (digits, shift) = match (upper.strip_suffix("AM"), upper.strip_suffix("PM")) {
        (Some(morning), _) => (morning.trim(), Some(0.0)),
        (_, Some(afternoon)) => (afternoon.trim(), Some(12.0)),
        _ => (upper.as_str(), None),
    };
    let mut parts = digits.split(':');
    let hour: f64 = whole(parts.next()?)?;
    let minute: f64 = whole(parts.next()?)?;
    let second: f64 = parts.next().map_or(Some(0.0), |text| text.replace(',', ".").parse().ok())?;
    let hour = shift.map_or(hour, |shift| hour % 12.0 + shift);
    let fits = parts.next().is_none() && hour < 25.0 && minute < 60.0 && (0.0..61.0).contains(&second);
    fits.then_some(hour * 3600.0 + minute * 60.0 + second - offset)
}

/// The text without its time zone, and that zone's seconds ahead of universal time.
fn zone(text: &str) -> (&str, f64) {
    if let Some(rest) = text.strip_suffix(['Z', 'z']) {
        return (rest, 0.0);
    }
    let Some(at) = text.rfind(['+', '-']).filter(|at| *at > 0) else { return (text, 0.0) };
    let sign = if text[at..].starts_with('-') { -1.0 } else { 1.0 };
    let digits: String = text[at + 1..].chars().filter(|c| *c != ':').collect();
    match (whole(digits.get(..2).unwrap_or_default()), whole(digits.get(2..).unwrap_or_default())) {
        (Some(hours), minutes) => (&text[..at], sign * (hours * 3600.0 + minutes.unwrap_or(0.0) * 60.0)),
        _ => (text, 0.0),
    }
}

fn whole(text: &str) -> Option<f64> {
    (!text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())).then(|| text.parse().ok())?
}

/// Days since 1970-01-01 of `2024-05-01`, `01.05.2024`, `1/5/2024`, `01-May-2024`. Where day and month cannot be told
/// apart, a slash stands between month and day, a point between day and month.
fn date(text: &str) -> Option<i64> {
    let mark = ['-', '/', '.'].into_iter().find(|mark| text.contains(*mark))?;
    let parts: Vec<&str> = text.split(mark).collect();
    let [first, second, third] = parts[..] else { return None };
    let month = |text: &str| match whole(text) {
        Some(number) => Some(number as i64),
        None => Some(MONTHS.iter().position(|name| text.to_ascii_lowercase().starts_with(name))? as i64 + 1),
    };
    let number = |text: &str| whole(text).map(|number| number as i64);
    let (year, month, day) = match (first.len(), mark) {
        (4, _) => (number(first)?, month(second)?, number(third)?),
        (_, '/') if number(first)? <= 12 => (number(third)?, number(first)?, number(second)?),
        _ => (number(third)?, month(second)?, number(first)?),
    };
    let year = if year < 100 { year + 2000 } else { year };
    let fits = (1..=12).contains(&month) && (1..=31).contains(&day) && (1900..2200).contains(&year);
    fits.then(|| days(year, month, day))
}

/// Days since 1970-01-01 in the Gregorian calendar, years beginning in March so that the leap day comes last.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let (era, year_of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_counted_in_days() {
        assert_eq!([days(1970, 1, 1), days(2000, 3, 1), days(2024, 2, 29)], [0, 11_017, 19_782]);
        for text in ["2024-02-29", "2024/02/29", "29.02.2024", "2/29/2024", "29/02/2024", "29-Feb-2024"] {
            assert_eq!(date(text), Some(19_782), "{text}");
        }
    }

    #[test]
    fn instants_are_read() {
        for (text, day, seconds) in [
            ("1970-01-02T00:00:01.5Z", Some(1), 1.5),
            ("1970-01-02 02:00:01,5+02:00", Some(1), 1.5),
            ("12:00:00.25", None, 43200.25),
            ("2:05:07 PM", None, 50707.0),
            ("12:05:07 am", None, 307.0),
        ] {
            assert_eq!(Instant::parse(text), Some(Instant { day, seconds }), "{text}");
        }
        for text in ["1.5", "12", "q", "1:2:3:4", "12:99", "2024-13-01", "1-2"] {
            assert_eq!(Instant::parse(text), None, "{text}");
        }
    }
}
