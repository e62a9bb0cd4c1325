//! Figures as SVG, drawn by plotters.

use super::bars;
use super::canvas::{Area, WIDTH, said};
use super::curves::{Frame, curves};
use super::figure::{Figure, Layer, Panel};
use plotters::prelude::*;

/// Heights of a panel, of a bar, of what is around bars, and of a line of text, pixels.
const PANEL: u32 = 180;
const BAR: u32 = 44;
const AROUND: u32 = 70;
const TITLE: u32 = 30;

/// Height of the numbers and the label of an axis to the right.
const AXIS: u32 = 28;

const LINE: u32 = 18;

/// Characters of a caption's line.
const CAPTION: usize = 110;

/// The picture as SVG text.
///
/// # Errors
/// What the drawing failed on.
pub fn svg(figure: &Figure) -> Result<String, String> {
    let caption = wrapped(&figure.caption);
    let frames: Vec<Frame> = (0..figure.panels.len()).map(|index| frame(&figure.panels, index)).collect();
    let own = |(panel, frame): (&Panel, &Frame)| height(panel) - if frame.shares { AXIS } else { 0 };
    let heights: Vec<u32> = figure.panels.iter().zip(&frames).map(own).collect();
    let title = if figure.title.is_empty() { 0 } else { TITLE };
    let below = LINE * caption.len() as u32 + 8;
    let total = title + heights.iter().sum::<u32>() + below;
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (WIDTH, total)).into_drawing_area();
        area.fill(&WHITE).map_err(said)?;
        let style = ("sans-serif", 16).into_font().color(&BLACK);
        area.draw(&Text::new(figure.title.clone(), (12, 8), style)).map_err(said)?;
        let mut top = title;
        for ((panel, height), frame) in figure.panels.iter().zip(&heights).zip(&frames) {
            let own = area.clone().shrink((0, top), (WIDTH, *height));
            draw(&own, panel, *frame)?;
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

/// What of a panel's surroundings another one shows.
fn frame(panels: &[Panel], index: usize) -> Frame {
    let names = panels[index].names();
    let repeats = index > 0 && names == panels[index - 1].names();
    Frame { shares: shares_axis(&panels[index..]), legend: names.len() > 1 && !repeats }
}

/// Whether the first panel's axis to the right stands below the second one.
fn shares_axis(panels: &[Panel]) -> bool {
    let [first, second, ..] = panels else { return false };
    let has_bars = first.layers.iter().any(|layer| matches!(layer, Layer::Bars(_)));
    !has_bars && first.x == second.x && first.extents()[..2] == second.extents()[..2]
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

fn draw(area: &Area, panel: &Panel, frame: Frame) -> Result<(), String> {
    if let Some(Layer::Bars(bars)) = panel.layers.iter().find(|layer| matches!(layer, Layer::Bars(_))) {
        return bars::bars(area, panel, bars);
    }
    let [from, to, low, high] = panel.extents();
    let margin = if panel.y.log { 0.0 } else { 0.05 * (high - low) };
    let (low, high) = (low - margin, high + margin);
    match (panel.x.log, panel.y.log) {
        (false, false) => curves(area, panel, from..to, low..high, frame),
        (false, true) => curves(area, panel, from..to, (low..high).log_scale(), frame),
        (true, false) => curves(area, panel, (from..to).log_scale(), low..high, frame),
        (true, true) => curves(area, panel, (from..to).log_scale(), (low..high).log_scale(), frame),
    }
}
