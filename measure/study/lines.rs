//! Lines and axes of the study's figures.

use switchid::report::{Axis, Layer};

/// A line through what was measured, in the order of x; points that are missing interrupt it.
pub fn line(name: &str, points: impl IntoIterator<Item = (f64, Option<f64>)>) -> Layer {
    Layer::Line { name: name.into(), points: places(points) }
}

/// A limit beside it, in grey.
pub fn limit(name: &str, points: impl IntoIterator<Item = (f64, Option<f64>)>) -> Layer {
    Layer::Reference { name: name.into(), points: places(points) }
}

fn places(points: impl IntoIterator<Item = (f64, Option<f64>)>) -> Vec<[f64; 2]> {
    points.into_iter().map(|(x, y)| [x, y.unwrap_or(f64::NAN)]).collect()
}

/// A logarithmic axis over whole decades that hold all positive values.
pub fn decades(label: &str, values: impl IntoIterator<Item = f64>) -> Axis {
    let logs = values.into_iter().filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
    let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let (low, high) = if low > high { (0.0, 1.0) } else { (low.floor(), high.ceil().max(low.floor() + 1.0)) };
    Axis::log(label).over(10_f64.powf(low), 10_f64.powf(high))
}
