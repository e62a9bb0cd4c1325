//! The identified frequency with its std, gaps where it is unknown, against the measured roller's.

use super::measure::{Beam, Mode};
use switchid::report::{Axis, Figure, Layer, Panel, svg};

/// Every so many samples are drawn.
const STRIDE: usize = 50;

/// The picture as SVG.
pub fn picture(beam: &Beam, modes: &[Option<Mode>]) -> Result<String, String> {
    let drawn = || (0..beam.t.len()).step_by(STRIDE);
    let of = |k: usize, value: &dyn Fn(&Mode) -> f64| modes[k].as_ref().map_or(f64::NAN, value);
    let frequency = |mode: &Mode| mode.frequency();
    let edges = |k: usize| {
        let [middle, std] = [of(k, &frequency), of(k, &Mode::frequency_std)];
        [beam.t[k], middle - std, middle + std]
    };
    let layers = vec![
        Layer::Area { name: "± std".into(), edges: drawn().map(edges).collect() },
        Layer::Reference {
            name: "from the measured roller".into(),
            points: drawn().map(|k| [beam.t[k], beam.frequency[k]]).collect(),
        },
        Layer::Line {
            name: "identified from the strain".into(),
            points: drawn().map(|k| [beam.t[k], of(k, &frequency)]).collect(),
        },
    ];
    let y = Axis::of("first bending mode, Hz").over(22.0, 42.0);
    let panel = Panel { title: String::new(), x: Axis::of("t, s"), y, layers };
    svg(&Figure { panels: vec![panel], ..Figure::default() })
}
