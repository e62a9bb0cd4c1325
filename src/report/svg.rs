//! Figures as SVG, drawn by plotters.

use super::figure::{Axis, Figure, Layer, Panel};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Width of a picture, pixels: what a page of text shows unscaled.
const WIDTH: u32 = 760;

/// Heights of a panel, of a bar, of what is around bars, and of a line of text, pixels.
const PANEL: u32 = 180;
const BAR: u32 = 44;
const AROUND: u32 = 70;
const TITLE: u32 = 30;

/// Numbers at a logarithmic axis below bars, at most.
const LABELS: usize = 4;

const LINE: u32 = 18;

/// Characters of a caption's line.
const CAPTION: usize = 110;

/// Colours of curves (Okabe and Ito, told apart by everybody), of bands, and of marks.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];
const MARK: RGBColor = RGBColor(190, 60, 40);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The picture as SVG text.
///
/// # Errors
/// What the drawing failed on.
pub fn svg(figure: &Figure) -> Result<String, String> {
    let caption = wrapped(&figure.caption);
    let heights: Vec<u32> = figure.panels.iter().map(height).collect();
    let below = LINE * caption.len() as u32 + 8;
    let total = TITLE + heights.iter().sum::<u32>() + below;
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, total)).into_drawing_area();
        area.fill(&WHITE).map_err(said)?;
        let style = ("sans-serif", 16).into_font().color(&BLACK);
        area.draw(&Text::new(figure.title.clone(), (12, 8), style)).map_err(said)?;
        let mut top = TITLE;
        for (panel, height) in figure.panels.iter().zip(&heights) {
            let own = area.clone().shrink((0, top), (WIDTH, *height));
            draw(&own, panel)?;
            top += height;
        }
        for (index, line) in caption.into_iter().enumerate() {
            let style = ("sans-serif", 12).into_font().color(&BLACK.mix(0.7));
            area.draw(&Text::new(line, (12, (top + 4 + LINE * index as u32) as i32), style)).map_err(said)?;
        }
        area.present().map_err(said)?;
    }
    Ok(text)
}

fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn height(panel: &Panel) -> u32 {
    let bars =
        panel.layers.iter().find_map(|layer| if let Layer::Bars(bars) = layer { Some(bars.len()) } else { None });
    bars.map_or(PANEL, |count| AROUND + BAR * count as u32)
}

fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < CAPTION => *line += &format!(" {word}"),
            _ => lines.push(word.into()),
        }
    }
    lines
}

fn draw(area: &Area, panel: &Panel) -> Result<(), String> {
    if let Some(Layer::Bars(bars)) = panel.layers.iter().find(|layer| matches!(layer, Layer::Bars(_))) {
        return staircase(area, panel, bars);
    }
    let [from, to, low, high] = panel.extents();
    let margin = if panel.y.log { 0.0 } else { 0.05 * (high - low) };
    let (low, high) = (low - margin, high + margin);
    match (panel.x.log, panel.y.log) {
        (false, false) => curves(area, panel, from..to, low..high),
        (false, true) => curves(area, panel, from..to, (low..high).log_scale()),
        (true, false) => curves(area, panel, (from..to).log_scale(), low..high),
        (true, true) => curves(area, panel, (from..to).log_scale(), (low..high).log_scale()),
    }
}

fn curves<X, Y>(area: &Area, panel: &Panel, x: X, y: Y) -> Result<(), String>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let [from, to, low, high] = panel.extents();
    let mut builder = ChartBuilder::on(area);
    if !panel.title.is_empty() {
        builder.caption(&panel.title, ("sans-serif", 13));
    }
    let mut chart = builder
        .margin(8)
        .margin_right(18)
        .x_label_area_size(34)
        .y_label_area_size(70)
        .build_cartesian_2d(x, y)
        .map_err(said)?;
    let [span, rise] = [to - from, high - low];
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc(&panel.x.label)
        .y_desc(&panel.y.label)
        .x_label_formatter(&|value| tick(*value, span, &panel.x))
        .y_label_formatter(&|value| tick(*value, rise, &panel.y))
        .draw()
        .map_err(said)?;
    let mut shade = 0;
    for layer in &panel.layers {
        if let Layer::Band { from, to, label } = layer {
            let colour = BLACK.mix(if shade % 2 == 0 { 0.05 } else { 0.11 });
            shade += 1;
            let (low, high) = (low - rise, high + rise);
            let bottom = if panel.y.log { low.max(f64::MIN_POSITIVE) } else { low };
            chart.draw_series([Rectangle::new([(*from, bottom), (*to, high)], colour.filled())]).map_err(said)?;
            let style = ("sans-serif", 11).into_font().color(&BLACK.mix(0.6));
            let at = EmptyElement::at((0.5 * (from + to), panel.extents()[3]));
            let style = style.pos(Pos::new(HPos::Center, VPos::Bottom));
            chart.draw_series([at + Text::new(label.clone(), (0, 10), style)]).map_err(said)?;
        }
    }
    let mut colours = COLOURS.iter().cycle();
    for layer in &panel.layers {
        let mut next = || colours.next().copied().unwrap_or(BLACK);
        match layer {
            Layer::Line { name, points } => {
                let colour = next();
                for part in points.split(|point| point.iter().any(|value| !value.is_finite())) {
                    let line = part.iter().map(|[x, y]| (*x, *y)).collect::<Vec<_>>();
                    chart.draw_series([PathElement::new(line, colour.stroke_width(1))]).map_err(said)?;
                }
                legend(&mut chart, name, colour)?;
            }
            Layer::Points { name, points } => {
                let colour = next();
                let finite = points.iter().filter(|point| point.iter().all(|value| value.is_finite()));
                let dots = finite.map(|[x, y]| Circle::new((*x, *y), 1, colour.mix(0.5).filled()));
                chart.draw_series(dots).map_err(said)?;
                legend(&mut chart, name, colour)?;
            }
            Layer::Area { name, edges } => {
                let colour = next();
                let upper = edges.iter().map(|[x, _, high]| (*x, *high));
                let lower = edges.iter().rev().map(|[x, low, _]| (*x, *low));
                let ring: Vec<(f64, f64)> = upper.chain(lower).collect();
                chart.draw_series([Polygon::new(ring, colour.mix(0.25).filled())]).map_err(said)?;
                legend(&mut chart, name, colour)?;
            }
            Layer::Mark { at, label } => {
                let line = PathElement::new(vec![(*at, low), (*at, high)], MARK.stroke_width(1));
                chart.draw_series([line]).map_err(said)?;
                let style = ("sans-serif", 11).into_font().color(&MARK);
                let at = EmptyElement::at((*at, high));
                chart.draw_series([at + Text::new(label.clone(), (3, 2), style)]).map_err(said)?;
            }
            Layer::Band { .. } | Layer::Bars(_) => {}
        }
    }
    let named = |layer: &&Layer| match layer {
        Layer::Line { name, .. } | Layer::Points { name, .. } | Layer::Area { name, .. } => !name.is_empty(),
        _ => false,
    };
    if panel.layers.iter().filter(named).count() > 1 {
        let mut labels = chart.configure_series_labels();
        let style = labels.background_style(WHITE.mix(0.8)).border_style(BLACK.mix(0.3)).label_font(("sans-serif", 11));
        style.position(SeriesLabelPosition::UpperRight).draw().map_err(said)?;
    }
    Ok(())
}

/// An entry of the legend.
fn legend<X: Ranged<ValueType = f64>, Y: Ranged<ValueType = f64>>(
    chart: &mut ChartContext<SVGBackend, Cartesian2d<X, Y>>,
    name: &str,
    colour: RGBColor,
) -> Result<(), String> {
    if name.is_empty() {
        return Ok(());
    }
    let nothing = chart.draw_series(std::iter::empty::<Circle<(f64, f64), i32>>()).map_err(said)?;
    nothing.label(name).legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 14, y)], colour.stroke_width(2)));
    Ok(())
}

/// A number at an axis, with as many decimals as its range needs.
fn tick(value: f64, range: f64, axis: &Axis) -> String {
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

/// Named bars with their values, on a logarithmic axis or not; marks are lines through all of them.
fn staircase(area: &Area, panel: &Panel, bars: &[(String, f64, String)]) -> Result<(), String> {
    let [from, to, ..] = panel.extents();
    let count = bars.len() as f64;
    match panel.x.log {
        true => {
            stairs(area, panel, bars, ((0.5 * from).max(to * 1e-3)..2.0 * to).log_scale(), (0.5 * from).max(to * 1e-3))
        }
        false => stairs(area, panel, bars, from.min(0.0)..1.25 * to, 0.0),
    }
    .map_err(|reason| format!("{reason} ({count} bars)"))
}

fn stairs<X>(area: &Area, panel: &Panel, bars: &[(String, f64, String)], x: X, left: f64) -> Result<(), String>
where
    X: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
{
    let count = bars.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(220)
        .build_cartesian_2d(x, 0.0..count)
        .map_err(said)?;
    let formatted = |value: &f64| tick(*value, *value, &panel.x);
    let mut mesh = chart.configure_mesh();
    mesh.disable_y_mesh().disable_y_axis().y_labels(0).x_desc(&panel.x.label).light_line_style(TRANSPARENT);
    mesh.x_labels(LABELS).x_label_formatter(&formatted);
    mesh.draw().map_err(said)?;
    let boxes = bars.iter().enumerate().map(|(index, (_, value, _))| {
        let top = count - index as f64;
        Rectangle::new([(left, top - 0.2), (*value, top - 0.8)], COLOURS[0].filled())
    });
    chart.draw_series(boxes).map_err(said)?;
    for layer in &panel.layers {
        if let Layer::Mark { at, label } = layer {
            let (line, name) = if *at < left { (left, format!("← {label}")) } else { (*at, label.clone()) };
            let path = PathElement::new(vec![(line, 0.0), (line, count)], MARK.stroke_width(2));
            chart.draw_series([path]).map_err(said)?;
            let style = ("sans-serif", 12).into_font().color(&MARK);
            chart.draw_series([EmptyElement::at((line, count)) + Text::new(name, (4, -6), style)]).map_err(said)?;
        }
    }
    let labels = bars.iter().enumerate().flat_map(|(index, (title, value, text))| {
        let middle = count - index as f64 - 0.5;
        let style = |position: HPos| ("sans-serif", 14).into_font().color(&BLACK).pos(Pos::new(position, VPos::Center));
        [
            EmptyElement::at((left, middle)) + Text::new(title.clone(), (-8, 0), style(HPos::Right)),
            EmptyElement::at((*value, middle)) + Text::new(text.clone(), (6, 0), style(HPos::Left)),
        ]
    });
    chart.draw_series(labels).map_err(said)?;
    Ok(())
}
