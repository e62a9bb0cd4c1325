//! What commands found, as figures.

use super::course::Course;
use super::failing::{Along, MARKED, failing};
use super::input::Input;
use super::looked::Looked;
use super::words::percent;
use crate::data::Opened;
use crate::diagnose::{Candidate, Comparison, Diagnosis, Doubt, Options, Place, Side, compare_posed};
use crate::identify::{Identification, Recording};
use crate::law::{Term, Units};
use crate::report::{Axis, Figure, Layer, MOST, Panel};
use nalgebra::{DMatrix, DVector};

/// Candidates that are drawn through the residual.
const DRAWN: usize = 3;

/// Points of a candidate's curve.
const CURVE: usize = 200;

/// The measured channels over time, a panel each.
fn channels(recording: &Recording, units: Units) -> Vec<Panel> {
    let unit = |channel: &str| match channel {
        "q" => units.displacement(),
        "qd" => units.velocity(),
        _ => units.excitation(),
    };
    let panel = |channel: &'static str| {
        let symbol = unit(channel).map(|unit| unit.symbol).filter(|symbol| symbol != "1");
        let name = if channel == "qd" { "q̇" } else { channel };
        let label = symbol.map_or_else(|| name.to_string(), |symbol| format!("{name}, {symbol}"));
        let layers = vec![broken_line(name, recording, recording.signal(channel)?)];
        Some(Panel { title: String::new(), x: Axis::of("t, s"), y: Axis::of(&label), layers })
    };
    ["q", "qd", "F"].into_iter().filter_map(panel).collect()
}

/// A signal over time; where the recording has a gap nothing is drawn, since nobody has seen what went on.
fn broken_line(name: &str, recording: &Recording, signal: &[f64]) -> Layer {
    let (mut t, mut values) = (Vec::new(), Vec::new());
    for piece in recording.pieces() {
        let after = recording.t()[piece.end - 1];
        t.extend(recording.t()[piece.clone()].iter().copied().chain([after]));
        values.extend(signal[piece].iter().copied().chain([f64::NAN]));
    }
    Layer::line(name, &t, &values)
}

/// How long series are drawn; empty where they are drawn whole.
fn thinned(count: usize) -> String {
    match count > MOST {
        true => {
            format!("Of {count} samples the smallest and the largest of every {} or more are drawn.", 2 * count / MOST)
        }
        false => String::new(),
    }
}

/// A recording with what is conspicuous of it.
pub(super) fn recording(looked: &Looked) -> Figure {
    let recording = &looked.opened.recording;
    let said: Vec<String> =
        looked.remarks.iter().map(|remark| format!("{}: {}.", remark.channel, remark.sentence)).collect();
    let said = if said.is_empty() { "Nothing is conspicuous.".into() } else { said.join(" ") };
    Figure {
        title: recording.source().into(),
        caption: format!("{said} {}", thinned(recording.count())),
        panels: channels(recording, looked.opened.units),
    }
}

/// Motion and excitation with the stages as bands, then every coefficient with its std, alarms marked.
pub(super) fn stages(opened: &Opened, found: &Identification, course: &Course) -> Figure {
    let bands = |named: bool| {
        let band = move |(index, stage): (usize, &crate::identify::Stage)| Layer::Band {
            from: stage.start,
            to: stage.end,
            label: if named && found.stages.len() > 1 { format!("stage {}", index + 1) } else { String::new() },
        };
        found.stages.iter().enumerate().map(band)
    };
    let alarms = || {
        let alarm = |at| Layer::Mark { at, label: String::new() };
        found.stages.iter().filter_map(|stage| stage.detected).map(alarm)
    };
    let mut panels = channels(&opened.recording, opened.units);
    for (index, panel) in panels.iter_mut().enumerate() {
        panel.layers.splice(0..0, bands(index == 0));
        panel.layers.extend(alarms());
    }
    let terms = found.stages.first().map_or(&[][..], |stage| &stage.coefficients);
    let has = |series: &[[f64; 2]]| series.iter().any(|[value, _]| value.is_finite() && *value != 0.0);
    for (coefficient, series) in terms.iter().zip(&course.coefficients).filter(|(_, series)| has(series)) {
        let edge = |(t, [value, std]): (&f64, &[f64; 2])| [*t, value - std, value + std];
        let edges: Vec<[f64; 3]> = course.t.iter().zip(series).map(edge).collect();
        let values: Vec<f64> = series.iter().map(|[value, _]| *value).collect();
        let symbol = Some(coefficient.term.symbol()).filter(|symbol| !symbol.is_empty()).unwrap_or_else(|| "1".into());
        let mut layers: Vec<Layer> = bands(false).collect();
        layers.push(Layer::Area { name: "± std".into(), edges: sober(edges, &values) });
        layers.push(Layer::line("identified", &course.t, &values));
        layers.extend(alarms());
        let label = format!("coefficient of {symbol}");
        panels.push(Panel { title: String::new(), x: Axis::of("t, s"), y: Axis::of(&label), layers });
    }
    let caption = format!(
        "Shaded: stages; red: alarms. Coefficients stand where they are known, each with its std. {}",
        thinned(opened.recording.count())
    );
    Figure { title: format!("{}: stages and their laws", opened.recording.source()), caption, panels }
}

/// Std bands no wider than twice the range of the values: a first guess's does not flatten all that follows.
fn sober(edges: Vec<[f64; 3]>, values: &[f64]) -> Vec<[f64; 3]> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let room = (high - low).max(0.05 * high.abs().max(low.abs()));
    let within = |value: f64| if value.is_finite() { value.clamp(low - room, high + room) } else { f64::NAN };
    edges.into_iter().map(|[t, lower, upper]| [t, within(lower), within(upper)]).collect()
}

/// What a law leaves over of the force: beside the force, and over t, q, q̇ and frequency.
pub(super) fn comparison(found: &Comparison) -> Figure {
    let side = &found.given;
    let places: Vec<&Place> = side.left.iter().flat_map(|left| &left.places).collect();
    let of = |value: fn(&Place) -> f64| places.iter().map(|place| value(place)).collect::<Vec<f64>>();
    let (t, residual) = (of(|place| place.t), of(|place| place.residual));
    let force = label("F", found.units.excitation().map(|unit| unit.symbol));
    let left = label("left over", found.units.excitation().map(|unit| unit.symbol));
    let noise: Vec<[f64; 3]> = places.iter().map(|place| [place.t, -place.noise.sqrt(), place.noise.sqrt()]).collect();
    let noise = noise.into_iter().step_by(places.len().div_ceil(MOST).max(1)).collect();
    let marked = |of: Along| failing(side, &of, &places);
    let measured = Layer::reference("measured", &t, &of(|place| place.force));
    let predicted = Layer::line("the law", &t, &of(|place| place.force + place.residual));
    let time = |label: &str, layers: Vec<Layer>| Panel {
        title: String::new(),
        x: Axis::of("t, s"),
        y: Axis::of(label),
        layers: marked(Along::Time).into_iter().chain(layers).collect(),
    };
    let mut panels = vec![
        time(&force, vec![measured, predicted]),
        time(
            &left,
            vec![
                Layer::Area { name: "std of the noise".into(), edges: noise },
                Layer::line("left over", &t, &residual),
            ],
        ),
    ];
    let [mut over_velocity, mut over_displacement] = over_motion(side, found.units);
    over_velocity.layers.splice(0..0, marked(Along::Velocity));
    over_displacement.layers.splice(0..0, marked(Along::Displacement));
    panels.extend([over_velocity, over_displacement]);
    let spectrum = side.spectrum(found.period);
    let energies = |at: usize| spectrum.iter().map(|row| row[at]).collect::<Vec<f64>>();
    if !spectrum.is_empty() {
        let lines =
            [Layer::line("left over", &energies(0), &energies(1)), Layer::line("force", &energies(0), &energies(2))];
        let layers = marked(Along::Frequency(energies(0))).into_iter().chain(lines).collect();
        panels.push(Panel { title: String::new(), x: Axis::of("frequency, Hz"), y: Axis::log("energy"), layers });
    }
    let said: Vec<String> = side.fails.iter().take(MARKED).map(|fail| found.sentence(fail) + ".").collect();
    Figure {
        title: format!("{}: what the model as given leaves over", found.sources.join(", ")),
        caption: format!("Forces are means over windows of at most {:.3} s. {}", found.window, said.join(" ")),
        panels,
    }
}

fn label(name: &str, unit: Option<String>) -> String {
    unit.filter(|unit| unit != "1").map_or_else(|| name.to_string(), |unit| format!("{name}, {unit}"))
}

/// What is left over, over q and over q̇.
fn over_motion(side: &Side, units: Units) -> [Panel; 2] {
    let places: Vec<&Place> = side.left.iter().flat_map(|left| &left.places).collect();
    let residual: Vec<f64> = places.iter().map(|place| place.residual).collect();
    let left = label("left over", units.excitation().map(|unit| unit.symbol));
    let panel = |name: &str, unit: Option<String>, x: Vec<f64>| Panel {
        title: String::new(),
        x: Axis::of(&label(name, unit)),
        y: Axis::of(&left),
        layers: vec![Layer::points("left over", &x, &residual)],
    };
    let velocity = units.velocity().map(|unit| unit.symbol);
    let displacement = units.displacement().map(|unit| unit.symbol);
    [
        panel("q̇", velocity, places.iter().map(|place| place.qd).collect()),
        panel("q", displacement, places.iter().map(|place| place.q).collect()),
    ]
}

/// What the best numbers of the model leave over, against q̇ and q, with the best candidates drawn through it.
pub(super) fn diagnosis(input: &Input, found: &Diagnosis) -> Figure {
    let recordings: Vec<_> =
        input.recordings().into_iter().map(|recording| (recording, found.base.timing.hold)).collect();
    let options = Options { units: input.units, ..Options::default() };
    let compared = compare_posed(&input.model.freed(), &recordings, None, &options);
    let mut panels = over_motion(&compared.best, input.units);
    let drawn = found.candidates.iter().filter(|candidate| candidate.doubt.is_none()).take(DRAWN);
    let places: Vec<&Place> = compared.best.left.iter().flat_map(|left| &left.places).collect();
    for candidate in drawn {
        let beside = beside(candidate.term, &found.base.terms, &places);
        for (panel, of_velocity) in panels.iter_mut().zip([true, false]) {
            panel.layers.extend(curve(panel, candidate, &beside, of_velocity));
        }
    }
    let error = found.candidates.iter().take(8);
    let bars = error.map(|candidate| {
        let error = candidate.error().after;
        let why = candidate.doubt.map_or_else(String::new, |doubt| format!(": {}", briefly(doubt)));
        (candidate.effect.clone(), 100.0 * error, percent(error) + &why)
    });
    let before = found.errors[1].before;
    let mark = Layer::Mark { at: 100.0 * before, label: format!("without any of them {}", percent(before)) };
    let stairs = ladder("held-out error with the candidate, %", bars.collect(), mark);
    let effect = found.effect.as_deref().unwrap_or("nothing of the catalogue");
    Figure {
        title: format!("{}: what the law leaves over, and {effect} in it", input.named()),
        caption: format!(
            "Left over is Σ θ f − F: what is missing has the other sign and is drawn so, less what the law's own terms take of it. \
             As found, {}.",
            found.left
        ),
        panels: panels.into_iter().chain([stairs]).collect(),
    }
}

/// What the law's own terms take of a candidate along a motion, by least squares: terms with their coefficients.
fn beside(candidate: Term, law: &[Term], places: &[&Place]) -> Vec<(Term, f64)> {
    let own: Vec<Term> = law.iter().copied().filter(|term| term.is_pointwise() && *term != Term::Inertia).collect();
    if !candidate.is_pointwise() || own.is_empty() || places.is_empty() {
        return Vec::new();
    }
    let force = |term: Term, place: &Place| term.force(place.q, place.qd, 0.0);
    let columns = DMatrix::from_fn(places.len(), own.len(), |row, column| force(own[column], places[row]));
    let right = DVector::from_iterator(places.len(), places.iter().map(|place| force(candidate, place)));
    let solution = (columns.transpose() * &columns)
        .pseudo_inverse(f64::EPSILON)
        .map(|inverse| inverse * (columns.transpose() * right));
    solution.map_or_else(|_| Vec::new(), |solution| own.into_iter().zip(solution.iter().copied()).collect())
}

/// −θ f of a candidate over the extent of the panel's points, less what the law takes of it; none where it takes more
/// than q or q̇ of one instant, or does not depend on this one.
fn curve(panel: &Panel, candidate: &Candidate, beside: &[(Term, f64)], of_velocity: bool) -> Option<Layer> {
    let Layer::Points { points, .. } = panel.layers.first()? else { return None };
    let term = candidate.term;
    if !term.is_pointwise() || term == Term::Inertia || !candidate.coefficient.is_finite() {
        return None;
    }
    let low = points.iter().map(|point| point[0]).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|point| point[0]).fold(f64::NEG_INFINITY, f64::max);
    let x: Vec<f64> = (0..=CURVE).map(|at| low + (high - low) * at as f64 / CURVE as f64).collect();
    let at = |term: Term, x: f64| if of_velocity { term.force(0.0, x, 0.0) } else { term.force(x, 0.0, 0.0) };
    let taken = |x: f64| beside.iter().map(|(own, share)| share * at(*own, x)).sum::<f64>();
    let y: Vec<f64> = x.iter().map(|x| -candidate.coefficient * (at(term, *x) - taken(*x))).collect();
    let moves = x.iter().any(|x| at(term, *x) != at(term, low)) && y.iter().all(|value| value.is_finite());
    moves.then(|| Layer::line(&candidate.effect, &x, &y))
}

/// The error falling step by step to the noise floor; `floor` with the length of its windows, s.
pub(super) fn staircase(steps: &[(String, f64)], [floor, window]: [f64; 2]) -> Figure {
    let bars = steps.iter().map(|(title, error)| (title.clone(), 100.0 * error, percent(*error))).collect();
    let mark = Layer::Mark { at: 100.0 * floor, label: format!("noise floor {}", percent(floor)) };
    let panel = ladder("error on held-out data, %", bars, mark);
    let caption = format!("Errors over windows of {window:.3} s, on stretches that no coefficient has seen.");
    Figure { title: "The error as effects join the law".into(), caption, panels: vec![panel] }
}

/// Bars from the left beside a mark.
fn ladder(label: &str, bars: Vec<(String, f64, String)>, mark: Layer) -> Panel {
    let bars: Vec<_> = bars.into_iter().filter(|(_, length, _)| length.is_finite()).collect();
    let at = if let Layer::Mark { at, .. } = mark { Some(at) } else { None };
    let x = Axis::of_bars(label, bars.iter().map(|(_, length, _)| *length).chain(at));
    Panel { title: String::new(), x, y: Axis::default(), layers: vec![Layer::Bars(bars), mark] }
}

/// Why a candidate is not named.
fn briefly(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::Sign => "wrong sign",
        Doubt::Trap => "the law's own terms are it",
        Doubt::Uncertain => "within its std",
        Doubt::Worse => "worse, or leaves all",
        Doubt::Chance => "may be chance",
    }
}

/// The smallest std of every coefficient ÷ its value.
pub(super) fn limits(bars: &[(String, f64, String)]) -> Figure {
    let panel = Panel {
        title: String::new(),
        x: Axis::of_bars("smallest std of a coefficient, % of its value", bars.iter().map(|(_, length, _)| *length)),
        y: Axis::default(),
        layers: vec![Layer::Bars(bars.to_vec())],
    };
    let caption = "The Cramér–Rao bound: no unbiased method errs less, on average over records like this one.".into();
    Figure { title: "What any method could reach".into(), caption, panels: vec![panel] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_drawn_over_a_gap() {
        let t: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k) + if k < 100 { 0.0 } else { 3.0 }).collect();
        let q: Vec<f64> = t.iter().map(|t| t.sin()).collect();
        let recording = Recording::new("gap", t.clone(), Some(q.clone()), None, None).unwrap();
        let Layer::Line { points, .. } = broken_line("q", &recording, &q) else { panic!("no line") };
        let drawn: Vec<&[[f64; 2]]> = points.split(|[_, q]| q.is_nan()).filter(|part| !part.is_empty()).collect();
        let ends: Vec<[f64; 2]> = drawn.iter().map(|part| [part[0][0], part[part.len() - 1][0]]).collect();
        assert_eq!(ends, [[t[0], t[99]], [t[100], t[199]]]);
    }
}
