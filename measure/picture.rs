//! The README's picture: a switching record, the coefficients identified from it beside the true ones, and the alarms.
//!
//! The identifier sees the model and the noisy record alone; the truth is drawn beside what it found.

use std::path::PathBuf;
use switchid::data::open_model;
use switchid::identify::{Identifier, Sample, Settings};
use switchid::law::Term;
use switchid::report::{Axis, Figure, Layer, Panel, svg};
use switchid::simulate::{Builtin, Reading, Scenario, Stage, record};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Std of the sensors' noise on q and q̇.
const NOISE: f64 = 0.01;

/// Every so many samples are drawn.
const STRIDE: usize = 40;

/// Space above and below the true values of a coefficient, as a share of their range.
const SPACE: f64 = 0.35;

/// Space above the motion for the alarms' words and below it, as shares of its greatest value.
const AROUND_MOTION: [f64; 2] = [0.1, 0.35];

/// What was identified, sample by sample drawn, and when switches were noticed.
#[derive(Default)]
struct Course {
    t: Vec<f64>,
    /// Value and std of each of the model's terms; NaN where it is not known.
    coefficients: Vec<(Term, Vec<[f64; 2]>)>,
    alarms: Vec<f64>,
}

fn main() -> Result<(), Failure> {
    let path = std::env::args().nth(1).map_or_else(|| PathBuf::from("docs/switching.svg"), PathBuf::from);
    let scenario = Builtin::DuffingSine.scenario().with_noise(NOISE);
    let readings = record(&scenario)?;
    let course = follow(&readings)?;
    let panels =
        [motion(&readings)].into_iter().chain(scenario.terms.iter().map(|term| coefficient(*term, &scenario, &course)));
    let mut panels: Vec<Panel> = panels.collect();
    panels[0].layers.extend(alarms(&scenario, &course.alarms, true));
    for panel in &mut panels[1..] {
        panel.layers.extend(alarms(&scenario, &course.alarms, false));
    }
    let caption =
        "Shaded: stages. Red: alarms, with their delays. A coefficient stands where it is known, with its std.";
    Ok(std::fs::write(path, svg(&Figure { panels, caption: caption.into(), ..Figure::default() })?)?)
}

fn follow(readings: &[Reading]) -> Result<Course, Failure> {
    let model = open_model(&PathBuf::from("docs/duffing.toml"))?;
    let mut identifier = Identifier::new(&model, Settings::default())?;
    let mut course = Course::default();
    for (index, reading) in readings.iter().enumerate() {
        identifier.step(Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation })?;
        let output = identifier.output();
        if course.alarms.len() < output.switch_count as usize {
            course.alarms.extend(output.detection_time);
        }
        if index % STRIDE == 0 {
            course.push(reading.t, &identifier);
        }
    }
    Ok(course)
}

impl Course {
    fn push(&mut self, t: f64, identifier: &Identifier) {
        let known = identifier.coefficients();
        if self.coefficients.is_empty() {
            self.coefficients = known.iter().map(|coefficient| (coefficient.term, Vec::new())).collect();
        }
        self.t.push(t);
        for ((_, series), coefficient) in self.coefficients.iter_mut().zip(known) {
            series.push(coefficient.std.map_or([f64::NAN; 2], |std| [coefficient.value, std]));
        }
    }
}

fn motion(readings: &[Reading]) -> Panel {
    let (t, q): (Vec<f64>, Vec<f64>) = readings.iter().step_by(STRIDE).map(|reading| (reading.t, reading.q)).unzip();
    let most = q.iter().fold(0.0, |most: f64, q| most.max(q.abs()));
    let [below, above] = AROUND_MOTION.map(|share| most * (1.0 + share));
    panel("q", vec![Layer::reference("measured", &t, &q)], Some([-below, above]))
}

fn panel(label: &str, layers: Vec<Layer>, range: Option<[f64; 2]>) -> Panel {
    Panel { title: String::new(), x: Axis::of("t, s"), y: Axis { range, ..Axis::of(label) }, layers }
}

/// The stages' bands, and the alarms with the delay of each where it is `told`; before the first switch it is false.
fn alarms(scenario: &Scenario, alarms: &[f64], told: bool) -> Vec<Layer> {
    let ends = scenario.stages.iter().skip(1).map(|stage| stage.start).chain([scenario.duration]);
    let band = |(stage, to): (&Stage, f64)| Layer::Band { from: stage.start, to, label: String::new() };
    let label = |at: f64| match scenario.stage_at(at) {
        _ if !told => String::new(),
        0 => "false".into(),
        stage => format!("+{:.0} ms", 1e3 * (at - scenario.stages[stage].start)),
    };
    let marks = alarms.iter().map(|at| Layer::Mark { at: *at, label: label(*at) });
    scenario.stages.iter().zip(ends).map(band).chain(marks).collect()
}

/// One coefficient: true in grey, identified with its std.
fn coefficient(term: Term, scenario: &Scenario, course: &Course) -> Panel {
    let index = scenario.terms.iter().position(|own| *own == term).unwrap_or_default();
    let ends = scenario.stages.iter().skip(1).map(|stage| stage.start).chain([scenario.duration]);
    let steps = scenario.stages.iter().zip(ends).flat_map(|(stage, end)| {
        let value = stage.coefficients[index];
        [[stage.start, value], [end, value]]
    });
    let truth: Vec<[f64; 2]> = steps.collect();
    let (low, high) = truth
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [_, value]| (low.min(*value), high.max(*value)));
    let space = SPACE * if high > low { high - low } else { 1.0 };
    let found = course.coefficients.iter().find(|(own, _)| *own == term).map_or(&[][..], |(_, series)| series);
    let values: Vec<f64> = found.iter().map(|[value, _]| *value).collect();
    let edge = |(t, [value, std]): (&f64, &[f64; 2])| [*t, value - std, value + std];
    let layers = vec![
        Layer::Area { name: "± std".into(), edges: course.t.iter().zip(found).map(edge).collect() },
        Layer::Reference { name: "true".into(), points: truth },
        Layer::line("identified", &course.t, &values),
    ];
    panel(&format!("coefficient of {}", term.symbol()), layers, Some([low - space, high + space]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_alarm_is_marked_with_its_delay() {
        let scenario = Builtin::DuffingSine.scenario();
        let switch = scenario.stages[1].start;
        let layers = alarms(&scenario, &[0.5 * switch, switch + 0.25], true);
        let bands = layers.iter().filter(|layer| matches!(layer, Layer::Band { .. })).count();
        let marks: Vec<&str> = layers
            .iter()
            .filter_map(|layer| if let Layer::Mark { label, .. } = layer { Some(label.as_str()) } else { None })
            .collect();
        assert_eq!((bands, marks), (scenario.stages.len(), vec!["false", "+250 ms"]));
    }

    #[test]
    fn a_coefficient_that_is_not_known_is_a_gap_beside_the_true_one() {
        let scenario = Builtin::DuffingSine.scenario();
        let term = scenario.terms[0];
        let known = vec![[f64::NAN; 2], [1.1, 0.2]];
        let course = Course { t: vec![0.0, 1.0], coefficients: vec![(term, known)], alarms: Vec::new() };
        let layers = coefficient(term, &scenario, &course).layers;
        let [Layer::Area { edges, .. }, Layer::Reference { points: truth, .. }, Layer::Line { points, .. }] =
            &layers[..]
        else {
            panic!("{layers:?}")
        };
        assert!(edges[0][1].is_nan() && points[0][1].is_nan());
        assert!((edges[1][1] - 0.9).abs() < 1e-12 && (edges[1][2] - 1.3).abs() < 1e-12 && points[1] == [1.0, 1.1]);
        assert_eq!(truth.len(), 2 * scenario.stages.len());
    }
}
