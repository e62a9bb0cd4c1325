//! Panels of named bars, as SVG.

use super::canvas::{Area, COLOURS, MARK, WIDTH, said};
use super::curves::tick;
use super::figure::{Layer, Panel};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Numbers at the axis below bars, at most.
const LABELS: usize = 5;

/// Width of the bars' names, of what is around the panel, and of a character behind a bar at most, pixels.
const NAMES: u32 = 220;
const MARGIN: u32 = 12;
const CHARACTER: f64 = 8.0;

/// Distance of a bar's text from the bar, pixels.
const APART: i32 = 6;

/// Named bars with their values; marks are lines through all of them.
pub(super) fn bars(area: &Area, panel: &Panel, bars: &[(String, f64, String)]) -> Result<(), String> {
    let [from, to, ..] = panel.extents();
    let left = if panel.x.log { (0.5 * from).max(to * 1e-3) } else { from.min(0.0) };
    let place = |value: f64| if panel.x.log { (value / left).ln() } else { value - left };
    let room = f64::from(WIDTH - NAMES - 2 * MARGIN);
    // the end of the axis leaves room for the longest text behind the longest bar or mark
    let longest = bars.iter().map(|(.., text)| text.chars().count()).max().unwrap_or(0);
    let taken = (CHARACTER * (longest + 1) as f64 / room).min(0.8);
    let end = place(to) / (1.0 - taken);
    let [from, to] = [left, if panel.x.log { left * end.exp() } else { left + end }];
    match panel.x.log {
        true => draw(area, panel, bars, (from..to).log_scale(), left),
        false => draw(area, panel, bars, from..to, left),
    }
}

fn draw<X>(
    area: &DrawingArea<SVGBackend, Shift>,
    panel: &Panel,
    bars: &[(String, f64, String)],
    x: X,
    left: f64,
) -> Result<(), String>
where
    X: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
{
    let count = bars.len() as f64;
    let mut builder = ChartBuilder::on(area);
    builder.margin(MARGIN).x_label_area_size(40).y_label_area_size(NAMES);
    let mut chart = builder.build_cartesian_2d(x, 0.0..count).map_err(said)?;
    // beyond the longest bar the axis only makes room for words
    let largest = panel.extents()[1];
    let formatted = |value: &f64| if *value > largest { String::new() } else { tick(*value, *value, &panel.x) };
    let mut mesh = chart.configure_mesh();
    mesh.disable_y_mesh().disable_y_axis().y_labels(0).x_desc(&panel.x.label).light_line_style(TRANSPARENT);
    mesh.x_labels(LABELS).x_label_formatter(&formatted);
    mesh.draw().map_err(said)?;
    let boxes = bars.iter().enumerate().map(|(index, (_, value, _))| {
        let top = count - index as f64;
        Rectangle::new([(left, top - 0.2), (*value, top - 0.8)], COLOURS[0].filled())
    });
    chart.draw_series(boxes).map_err(said)?;
    let mut marks = Vec::new();
    for layer in &panel.layers {
        let Layer::Mark { at, label } = layer else { continue };
        let (line, name) = if *at < left { (left, format!("← {label}")) } else { (*at, label.clone()) };
        let path = PathElement::new(vec![(line, 0.0), (line, count)], MARK.stroke_width(2));
        chart.draw_series([path]).map_err(said)?;
        let at = chart.backend_coord(&(line, 0.0)).0;
        let (side, shift) = if at > (NAMES + WIDTH) as i32 / 2 { (HPos::Right, -4) } else { (HPos::Left, 4) };
        let style = ("sans-serif", 12).into_font().color(&MARK).pos(Pos::new(side, VPos::Center));
        chart.draw_series([EmptyElement::at((line, count)) + Text::new(name, (shift, -4), style)]).map_err(said)?;
        marks.push(at);
    }
    let end = |value: f64| chart.backend_coord(&(value, 0.0)).0;
    let shifts: Vec<i32> = bars.iter().map(|(_, value, text)| behind(end(*value), text, &marks)).collect();
    let labels = bars.iter().zip(shifts).enumerate().flat_map(|(index, ((title, value, text), shift))| {
        let middle = count - index as f64 - 0.5;
        let style = |position: HPos| ("sans-serif", 14).into_font().color(&BLACK).pos(Pos::new(position, VPos::Center));
        [
            EmptyElement::at((left, middle)) + Text::new(title.clone(), (-8, 0), style(HPos::Right)),
            EmptyElement::at((*value, middle)) + Text::new(text.clone(), (shift, 0), style(HPos::Left)),
        ]
    });
    chart.draw_series(labels).map_err(said)?;
    Ok(())
}

/// How far behind the end of a bar its text begins, so that no mark runs through it, pixels.
fn behind(end: i32, text: &str, marks: &[i32]) -> i32 {
    let width = (CHARACTER * text.chars().count() as f64) as i32;
    let crossing = marks.iter().filter(|mark| (end..end + APART + width).contains(*mark)).max();
    crossing.map_or(APART, |mark| mark - end + APART)
}
