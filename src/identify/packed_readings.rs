//! Readings in few bytes: their samples, and what the few have that are not as they should be; for `#[serde(with)]`.

use super::packed;
use super::reading::Reading;
use super::sample::Sample;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

#[derive(Serialize, Deserialize)]
struct Packed {
    #[serde(with = "packed")]
    samples: Vec<Sample>,
    odd: Vec<(usize, [bool; 2], f64)>,
}

/// Writes readings.
///
/// # Errors
/// What the serializer says.
pub fn serialize<S: Serializer>(readings: &[Reading], serializer: S) -> Result<S::Ok, S::Error> {
    let is_odd = |reading: &Reading| reading.faulty != [false; 2] || reading.unseen.to_bits() != 0;
    let odd = readings.iter().enumerate().filter(|(_, reading)| is_odd(reading));
    let odd = odd.map(|(place, reading)| (place, reading.faulty, reading.unseen)).collect();
    Packed { samples: readings.iter().map(|reading| reading.sample).collect(), odd }.serialize(serializer)
}

/// Reads them back.
///
/// # Errors
/// What was not written so.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Reading>, D::Error> {
    let Packed { samples, odd } = Packed::deserialize(deserializer)?;
    let mut readings: Vec<Reading> = samples.into_iter().map(Reading::from).collect();
    for (place, faulty, unseen) in odd {
        let reading = readings.get_mut(place).ok_or_else(|| D::Error::custom("a reading that is not there"))?;
        (reading.faulty, reading.unseen) = (faulty, unseen);
    }
    Ok(readings)
}
