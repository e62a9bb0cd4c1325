//! Panels of curves, points and bands, as SVG.

use super::canvas::{Area, COLOURS, MARK, REFERENCE, WIDTH, said};
use super::figure::{Axis, Layer, Panel};
use super::thin::envelope_of;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Where a legend may stand, with the middle of that corner in shares of the panel's width and height.
const CORNERS: [(SeriesLabelPosition, [f64; 2]); 4] = [
    (SeriesLabelPosition::UpperRight, [0.85, 0.8]),
    (SeriesLabelPosition::UpperLeft, [0.15, 0.8]),
    (SeriesLabelPosition::LowerRight, [0.85, 0.2]),
    (SeriesLabelPosition::LowerLeft, [0.15, 0.2]),
];

/// Half the width and half the height of a corner, as shares of the panel's.
const CORNER: [f64; 2] = [0.15, 0.25];

/// Share of the panel's width that half of a word takes.
const EDGE: f64 = 0.08;

/// Points of a line that a picture shows at most: two for each of its pixels.
const SEEN: usize = 2 * WIDTH as usize;

/// Width of a reference that lines are drawn over, pixels: it is seen on both sides of them.
const BELOW: u32 = 3;

/// How much of its colour an area has.
const FAINT: f64 = 0.25;

/// Points up to which a line shows each of them; `figure.js` has the same.
const FEW: usize = 30;

type Chart<'a, 'b, X, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>;

/// What a panel is drawn with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Whether its axis to the right stands below the next panel.
    pub(super) shares: bool,
    /// Whether its layers' names are told.
    pub(super) legend: bool,
}

/// Draws a panel over these ranges of its axes.
pub(super) fn curves<X, Y>(area: &Area, panel: &Panel, x: X, y: Y, frame: Frame) -> Result<(), String>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let mut builder = ChartBuilder::on(area);
    if !panel.title.is_empty() {
        builder.caption(&panel.title, ("sans-serif", 13));
    }
    builder.margin(8).margin_right(18).x_label_area_size(if frame.shares { 6 } else { 34 }).y_label_area_size(70);
    let mut chart = builder.build_cartesian_2d(x, y).map_err(said)?;
    let [from, to, low, high] = panel.extents();
    let across = |value: &f64| if frame.shares { String::new() } else { tick(*value, to - from, &panel.x) };
    let upwards = |value: &f64| tick(*value, high - low, &panel.y);
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(TRANSPARENT).x_desc(if frame.shares { "" } else { &panel.x.label }).y_desc(&panel.y.label);
    mesh.x_label_formatter(&across).y_label_formatter(&upwards);
    mesh.draw().map_err(said)?;
    bands(&mut chart, panel)?;
    let mut colours = COLOURS.iter().cycle().copied();
    let mut next = colours.next().unwrap_or(BLACK);
    for (index, layer) in panel.layers.iter().enumerate() {
        let is_below = panel.layers[index..].iter().any(Layer::takes_colour);
        let (colour, width) = match layer {
            Layer::Mark { .. } => (MARK, 1),
            Layer::Reference { .. } => (REFERENCE, if is_below { BELOW } else { 1 }),
            _ => (next, 1),
        };
        draw(&mut chart, layer, (colour, width), [low, high])?;
        if layer.takes_colour() {
            next = colours.next().unwrap_or(BLACK);
        }
    }
    if frame.legend { legend(&mut chart, panel) } else { Ok(()) }
}

/// Stretches of the x axis, shaded by turns.
fn bands<X, Y>(chart: &mut Chart<X, Y>, panel: &Panel) -> Result<(), String>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let [left, right, low, high] = panel.extents();
    let rise = high - low;
    let bottom = if panel.y.log { (low - rise).max(f64::MIN_POSITIVE) } else { low - rise };
    let bands = panel.layers.iter().filter_map(|layer| match layer {
        Layer::Band { from, to, label } => Some((*from, *to, label)),
        _ => None,
    });
    for (shade, (from, to, label)) in bands.enumerate() {
        let colour = BLACK.mix(if shade % 2 == 0 { 0.05 } else { 0.11 });
        chart.draw_series([Rectangle::new([(from, bottom), (to, high + rise)], colour.filled())]).map_err(said)?;
        let style = ("sans-serif", 11).into_font().color(&BLACK.mix(0.6));
        // a word in the middle of a stretch at the edge would run out of the panel
        let (place, side) = match (0.5 * (from + to) - left) / (right - left) {
            share if share < EDGE => (from, HPos::Left),
            share if share > 1.0 - EDGE => (to, HPos::Right),
            _ => (0.5 * (from + to), HPos::Center),
        };
        let style = style.pos(Pos::new(side, VPos::Bottom));
        let at = EmptyElement::at((place, high));
        chart.draw_series([at + Text::new(label.clone(), (0, 10), style)]).map_err(said)?;
    }
    Ok(())
}

/// Draws a layer in that colour, lines that wide; a mark from below to above.
fn draw<X, Y>(
    chart: &mut Chart<X, Y>,
    layer: &Layer,
    (colour, width): (RGBColor, u32),
    [low, high]: [f64; 2],
) -> Result<(), String>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let within = |y: f64| y.clamp(low, high);
    let is_finite = |point: &&[f64; 2]| point.iter().all(|value| value.is_finite());
    match layer {
        Layer::Line { points, .. } | Layer::Reference { points, .. } => {
            for part in points.split(|point| !is_finite(&point)).filter(|part| !part.is_empty()) {
                let line = seen(chart, part.iter().map(|[x, y]| (*x, within(*y))));
                if points.len() <= FEW && layer.takes_colour() {
                    chart.draw_series(line.iter().map(|at| Circle::new(*at, 2, colour.filled()))).map_err(said)?;
                }
                chart.draw_series([PathElement::new(line, colour.stroke_width(width))]).map_err(said)?;
            }
        }
        Layer::Points { points, .. } => {
            let dot = |[x, y]: &[f64; 2]| Circle::new((*x, *y), 1, colour.mix(0.5).filled());
            let shown = points.iter().step_by(points.len().div_ceil(WIDTH as usize).max(1)).filter(is_finite);
            chart.draw_series(shown.map(dot)).map_err(said)?;
        }
        Layer::Area { edges, .. } => {
            let parts = edges.split(|edge| edge.iter().any(|value| !value.is_finite()));
            for part in parts.filter(|part| !part.is_empty()) {
                let edges = |at: usize| seen(chart, part.iter().map(|edge| (edge[0], within(edge[at]))));
                let (lower, upper) = (edges(1).into_iter().rev(), edges(2).into_iter());
                let ring: Vec<(f64, f64)> = upper.chain(lower).collect();
                chart.draw_series([Polygon::new(ring, colour.mix(FAINT).filled())]).map_err(said)?;
            }
        }
        Layer::Mark { at, label } => {
            let line = PathElement::new(vec![(*at, low), (*at, high)], colour.stroke_width(1));
            chart.draw_series([line]).map_err(said)?;
            let style = ("sans-serif", 11).into_font().color(&colour);
            let word = EmptyElement::at((*at, high)) + Text::new(label.clone(), (3, 2), style);
            chart.draw_series([word]).map_err(said)?;
        }
        Layer::Band { .. } | Layer::Bars(_) => {}
    }
    let faint = matches!(layer, Layer::Area { .. });
    entry(chart, layer.name(), if faint { colour.mix(FAINT) } else { colour.to_rgba() })
}

/// Points of a line that can be seen: two for each pixel, and of a level stretch its ends.
fn seen<X, Y>(chart: &Chart<X, Y>, points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
    let points: Vec<(f64, f64)> = envelope_of(&x, &y, SEEN).into_iter().map(|[x, y]| (x, y)).collect();
    let pixels: Vec<(i32, i32)> = points.iter().map(|point| chart.backend_coord(point)).collect();
    let is_level = |at: usize| {
        let [before, own, after] = [pixels[at - 1], pixels[at], pixels[at + 1]];
        before.1 == own.1 && own.1 == after.1 && before.0 <= own.0 && own.0 <= after.0
    };
    let is_kept = |at: &usize| *at == 0 || *at + 1 == points.len() || !is_level(*at);
    (0..points.len()).filter(is_kept).map(|at| points[at]).collect()
}

/// An entry of the legend.
fn entry<X, Y>(chart: &mut Chart<X, Y>, name: &str, colour: RGBAColor) -> Result<(), String>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    if name.is_empty() {
        return Ok(());
    }
    let nothing = chart.draw_series(std::iter::empty::<Circle<(f64, f64), i32>>()).map_err(said)?;
    nothing.label(name).legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 14, y)], colour.stroke_width(2)));
    Ok(())
}

/// The names of layers, in the corner in which fewest points lie.
fn legend<'a, 'b: 'a, X, Y>(chart: &mut Chart<'a, 'b, X, Y>, panel: &Panel) -> Result<(), String>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let [from, to, low, high] = panel.extents();
    let points = panel.layers.iter().flat_map(|layer| match layer {
        Layer::Line { points, .. } | Layer::Reference { points, .. } | Layer::Points { points, .. } => {
            points.as_slice()
        }
        _ => &[],
    });
    let shares: Vec<[f64; 2]> =
        points.map(|[x, y]| [share(*x, [from, to], &panel.x), share(*y, [low, high], &panel.y)]).collect();
    let inside =
        |share: &[f64; 2], middle: [f64; 2]| (0..2).all(|axis| (share[axis] - middle[axis]).abs() < CORNER[axis]);
    let hidden = |middle: [f64; 2]| shares.iter().filter(|share| inside(share, middle)).count();
    let emptiest = CORNERS.into_iter().min_by_key(|(_, middle)| hidden(*middle));
    let position = emptiest.map_or(SeriesLabelPosition::UpperRight, |(position, _)| position);
    let mut labels = chart.configure_series_labels();
    let style = labels.background_style(WHITE.mix(0.8)).border_style(BLACK.mix(0.3)).label_font(("sans-serif", 11));
    style.position(position).draw().map_err(said)
}

/// Where on an axis a value stands: 0 at its start, 1 at its end.
fn share(value: f64, [from, to]: [f64; 2], axis: &Axis) -> f64 {
    if axis.log { (value / from).ln() / (to / from).ln() } else { (value - from) / (to - from) }
}

/// A number at an axis, with as many decimals as its range needs.
pub(super) fn tick(value: f64, range: f64, axis: &Axis) -> String {
    let size = if axis.log { value.abs() } else { range.abs() };
    if size == 0.0 || !size.is_finite() {
        return format!("{value}");
    }
    if !(1e-3..1e5).contains(&size) || value.abs() >= 1e6 {
        return if axis.log { format!("{value:.0e}") } else { format!("{value:.2e}") };
    }
    let decimals = (2.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}
