//! Line charts as small SVG: panels side by side, each axis linear or logarithmic, ticks where they are asked for.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, ValueFormatter};
use plotters::prelude::*;
use std::ops::Range;

const PANEL: (u32, u32) = (430, 360);

/// By position: dark to light within a family of intervals; the first two also tell ours (blue) from published (red).
const COLOURS: [RGBColor; 6] = [
    RGBColor(31, 90, 155),
    RGBColor(196, 62, 44),
    RGBColor(46, 139, 87),
    RGBColor(190, 130, 20),
    RGBColor(120, 80, 160),
    RGBColor(110, 110, 110),
];

/// One axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// What it measures, with its unit.
    pub label: String,
    /// Where its ticks are; it reaches from the first to the last.
    pub ticks: Vec<f64>,
    /// Whether it is logarithmic.
    pub log: bool,
}

impl Axis {
    /// A logarithmic axis with these ticks.
    pub fn log(label: &str, ticks: &[f64]) -> Axis {
        Axis { label: label.into(), ticks: ticks.to_vec(), log: true }
    }

    /// A linear axis with these ticks.
    pub fn linear(label: &str, ticks: &[f64]) -> Axis {
        Axis { label: label.into(), ticks: ticks.to_vec(), log: false }
    }

    /// A logarithmic axis over whole decades that hold all positive values.
    pub fn decades(label: &str, values: impl IntoIterator<Item = f64>) -> Axis {
        let logs = values.into_iter().filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low.floor(), high.ceil().max(low.floor() + 1.0)) };
        let step = (((high - low) / 8.0).ceil() as i32).max(1);
        let ticks = (low as i32..=high as i32 + step - 1).step_by(step as usize).map(|power| 10_f64.powi(power));
        Axis { label: label.into(), ticks: ticks.collect(), log: true }
    }

    fn place(&self, value: f64) -> f64 {
        if self.log { value.max(f64::MIN_POSITIVE).log10() } else { value }
    }

    fn within(&self, value: f64) -> f64 {
        value.clamp(self.range().start, self.range().end)
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let [from, to, at] = [self.range().start, self.range().end, *value].map(|value| self.place(value));
        limit.0 + (f64::from(limit.1 - limit.0) * (at - from) / (to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        let end = |tick: Option<&f64>| tick.copied().unwrap_or_default();
        end(self.ticks.first())..end(self.ticks.last())
    }
}

impl ValueFormatter<f64> for Axis {
    fn format(value: &f64) -> String {
        match value.abs() {
            size if size > 0.0 && !(1e-3..1e4).contains(&size) => format!("{value:.0e}"),
            _ => value.to_string(),
        }
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Measured points, joined.
    Marked,
    /// Computed: thin, without points.
    Thin,
}

/// One line.
#[derive(Clone, Debug)]
pub struct Line {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// Number of its colour.
    pub colour: usize,
    /// How it is drawn.
    pub kind: Kind,
    /// Its points in the order of x; what lies outside the axes is drawn at their ends.
    pub points: Vec<(f64, f64)>,
}

impl Line {
    /// A line of points of which some may be missing.
    pub fn new(name: &str, colour: usize, kind: Kind, points: impl IntoIterator<Item = (f64, Option<f64>)>) -> Line {
        let known = points.into_iter().filter_map(|(x, y)| Some((x, y?))).filter(|(_, y)| y.is_finite());
        Line { name: name.into(), colour, kind, points: known.collect() }
    }
}

/// One chart.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Its title.
    pub title: String,
    /// Horizontally.
    pub x: Axis,
    /// Vertically.
    pub y: Axis,
    /// Where the legend stands.
    pub legend: SeriesLabelPosition,
    /// Its lines.
    pub lines: Vec<Line>,
}

/// Draws panels side by side.
///
/// # Errors
/// What the drawing failed on, in words.
pub fn draw(panels: &[Panel]) -> Result<String, String> {
    let mut text = String::new();
    {
        let size = (PANEL.0 * panels.len() as u32, PANEL.1);
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        let drawn = area.fill(&WHITE).and_then(|()| {
            let places = area.split_evenly((1, panels.len()));
            panels.iter().zip(&places).try_for_each(|(panel, place)| draw_panel(panel, place))
        });
        drawn.and_then(|()| area.present()).map_err(|error| error.to_string())?;
    }
    Ok(text)
}

type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;
type Place<'a> = DrawingArea<SVGBackend<'a>, Shift>;

fn draw_panel(panel: &Panel, place: &Place) -> Drawn {
    let mut chart = ChartBuilder::on(place)
        .margin(10)
        .caption(&panel.title, ("sans-serif", 15))
        .x_label_area_size(38)
        .y_label_area_size(58)
        .build_cartesian_2d(panel.x.clone(), panel.y.clone())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc(&panel.x.label)
        .y_desc(&panel.y.label)
        .draw()?;
    for line in &panel.lines {
        let colour = COLOURS[line.colour % COLOURS.len()];
        let style = colour.stroke_width(if line.kind == Kind::Thin { 1 } else { 2 });
        let drawn = chart.draw_series([PathElement::new(places(panel, line), style)])?;
        if !line.name.is_empty() {
            drawn.label(&line.name).legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], style));
        }
        if line.kind == Kind::Marked {
            chart.draw_series(places(panel, line).into_iter().map(|at| Circle::new(at, 3, colour.filled())))?;
        }
    }
    let mut legend = chart.configure_series_labels();
    let legend = legend.position(panel.legend.clone()).label_font(("sans-serif", 12)).margin(4).legend_area_size(20);
    legend.background_style(WHITE.mix(0.8)).border_style(BLACK.mix(0.2)).draw()
}

/// The line's points on the panel's axes.
fn places(panel: &Panel, line: &Line) -> Vec<(f64, f64)> {
    line.points.iter().map(|(x, y)| (panel.x.within(*x), panel.y.within(*y))).collect()
}
