//! What a figure shows, in data coordinates. Its JSON form, which `figure.js` draws, has the same names:
//! `docs/figure-description.md`.

use super::thin;
use serde::{Serialize, Serializer};

/// Length of the longest bar ÷ that of the shortest one up to which both are seen on one linear axis.
const SEEN: f64 = 20.0;

/// A figure: panels one below the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figure {
    /// Its title.
    pub title: String,
    /// What is to be known of it, below.
    pub caption: String,
    /// Its panels, from the top.
    pub panels: Vec<Panel>,
}

/// A panel: layers over a pair of axes, the first one lowest.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Panel {
    /// Its title.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// What is drawn.
    pub layers: Vec<Layer>,
}

/// An axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Whether it is logarithmic.
    pub log: bool,
    /// What it shows; all that there is where none is given.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis.
    pub fn of(label: &str) -> Axis {
        Axis { label: label.into(), ..Axis::default() }
    }

    /// A logarithmic axis.
    pub fn log(label: &str) -> Axis {
        Axis { label: label.into(), log: true, range: None }
    }

    /// The axis over that range.
    #[must_use]
    pub fn over(self, from: f64, to: f64) -> Axis {
        Axis { range: Some([from, to]), ..self }
    }

    /// An axis for bars of these lengths: from zero, where the shortest of them is to be seen beside the longest.
    pub fn of_bars(label: &str, lengths: impl Iterator<Item = f64>) -> Axis {
        let [least, most] =
            lengths.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], length| [least.min(length), most.max(length)]);
        Axis { label: label.into(), log: least > 0.0 && most > SEEN * least, range: None }
    }
}

/// What a panel draws.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Layer {
    /// A line through points.
    Line {
        /// Its name in the legend.
        name: String,
        /// Its points; a NaN interrupts it.
        #[serde(serialize_with = "in_seven_digits")]
        points: Vec<[f64; 2]>,
    },
    /// A line in dark grey: what was measured or is true, beside what was found.
    Reference {
        /// Its name in the legend.
        name: String,
        /// Its points; a NaN interrupts it.
        #[serde(serialize_with = "in_seven_digits")]
        points: Vec<[f64; 2]>,
    },
    /// Points.
    Points {
        /// Their name in the legend.
        name: String,
        /// The points.
        #[serde(serialize_with = "in_seven_digits")]
        points: Vec<[f64; 2]>,
    },
    /// The area between two curves, in the colour of the next line: x, lower, upper.
    Area {
        /// Its name in the legend.
        name: String,
        /// Its edges; a NaN interrupts it.
        #[serde(serialize_with = "in_seven_digits")]
        edges: Vec<[f64; 3]>,
    },
    /// Named bars from the left, one below the other, each with its text.
    Bars(Vec<(String, f64, String)>),
    /// A stretch of the x axis.
    Band {
        /// Where it begins.
        from: f64,
        /// Where it ends.
        to: f64,
        /// What it is; empty for a plain one.
        label: String,
    },
    /// An instant, or a value on the x axis.
    Mark {
        /// Where.
        at: f64,
        /// What it is.
        label: String,
    },
}

/// Points of seven digits each: more than a screen of any zoom shows of a few thousand. What is not finite is null.
fn in_seven_digits<S: Serializer, const N: usize>(points: &[[f64; N]], serializer: S) -> Result<S::Ok, S::Error> {
    let short =
        |value: f64| Some(value).filter(|value| value.is_finite()).and_then(|own| format!("{own:.6e}").parse().ok());
    serializer.collect_seq(points.iter().map(|point| point.map(short).to_vec() as Vec<Option<f64>>))
}

impl Layer {
    /// A line; of more than [`thin::MOST`] points the smallest and the largest of each bin.
    pub fn line(name: &str, x: &[f64], y: &[f64]) -> Layer {
        Layer::Line { name: name.into(), points: thin::envelope(x, y) }
    }

    /// A line that is the reference; thinned as [`Layer::line`].
    pub fn reference(name: &str, x: &[f64], y: &[f64]) -> Layer {
        Layer::Reference { name: name.into(), points: thin::envelope(x, y) }
    }

    /// Points; of more than [`thin::MOST`] every so many.
    pub fn points(name: &str, x: &[f64], y: &[f64]) -> Layer {
        Layer::Points { name: name.into(), points: thin::sampled(x, y) }
    }
}

#[cfg(feature = "pictures")]
impl Layer {
    /// Whether the next line has the next colour.
    pub(super) fn takes_colour(&self) -> bool {
        matches!(self, Layer::Line { .. } | Layer::Points { .. } | Layer::Bars(_))
    }

    /// Its name in the legend; empty where it has none.
    pub(super) fn name(&self) -> &str {
        match self {
            Layer::Line { name, .. }
            | Layer::Reference { name, .. }
            | Layer::Points { name, .. }
            | Layer::Area { name, .. } => name,
            Layer::Bars(_) | Layer::Band { .. } | Layer::Mark { .. } => "",
        }
    }
}

#[cfg(feature = "pictures")]
impl Panel {
    /// Names of its layers: one needs no legend.
    pub(super) fn names(&self) -> Vec<&str> {
        self.layers.iter().map(Layer::name).filter(|name| !name.is_empty()).collect()
    }

    /// The extents of what is drawn: x from, to, y from, to; finite and not empty.
    pub(super) fn extents(&self) -> [f64; 4] {
        let mut extents = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        let mut take = |x: f64, y: Option<f64>| {
            if x.is_finite() && (!self.x.log || x > 0.0) {
                extents[0] = extents[0].min(x);
                extents[1] = extents[1].max(x);
            }
            if let Some(y) = y.filter(|y| y.is_finite() && (!self.y.log || *y > 0.0)) {
                extents[2] = extents[2].min(y);
                extents[3] = extents[3].max(y);
            }
        };
        for layer in &self.layers {
            match layer {
                Layer::Line { points, .. } | Layer::Reference { points, .. } | Layer::Points { points, .. } => {
                    points.iter().for_each(|[x, y]| take(*x, Some(*y)));
                }
                Layer::Area { edges, .. } => edges.iter().for_each(|[x, low, high]| {
                    take(*x, Some(*low));
                    take(*x, Some(*high));
                }),
                Layer::Bars(bars) => bars.iter().for_each(|(_, value, _)| take(*value, None)),
                Layer::Band { from, to, .. } => [from, to].into_iter().for_each(|x| take(*x, None)),
                Layer::Mark { at, .. } => take(*at, None),
            }
        }
        let [from, to] = self.x.range.unwrap_or_else(|| widened(extents[0], extents[1], self.x.log));
        let [low, high] = self.y.range.unwrap_or_else(|| widened(extents[2], extents[3], self.y.log));
        [from, to, low, high]
    }
}

/// A range that is not empty, a little wider than its content upwards and downwards.
#[cfg(feature = "pictures")]
fn widened(from: f64, to: f64, log: bool) -> [f64; 2] {
    match (from <= to, log) {
        (false, true) => [0.1, 1.0],
        (false, false) => [0.0, 1.0],
        (true, true) => [from * 0.8, to * 1.25],
        (true, false) if from == to => {
            [from - 1.0_f64.min(from.abs().max(1e-12)), to + 1.0_f64.min(to.abs().max(1e-12))]
        }
        (true, false) => [from, to],
    }
}
