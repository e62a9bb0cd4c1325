//! Figures as SVG, drawn by plotters.

use super::bars;
use super::canvas::{Area, WIDTH, said};
use super::curves::{Frame, curves};
use super::figure::{Figure, Layer, Panel};
use plotters::prelude::*;

/// Heights of a panel, of one of no more than two, of a bar, of what is around bars, and of a line of text, pixels.
const PANEL: u32 = 180;
const TALL: u32 = 300;
const BAR: u32 = 44;
const AROUND: u32 = 70;
const TITLE: u32 = 30;

/// Height of the numbers and the label of an axis to the right.
const AXIS: u32 = 28;

const LINE: u32 = 18;

/// Decades of a logarithmic axis up to which it has numbers within a decade, and numbers of a longer one at most.
const SHORT: f64 = 2.5;
const NUMBERS: f64 = 8.0;

/// Characters of a caption's line.
const CAPTION: usize = 110;

/// The picture as SVG text.
///
/// # Errors
/// What the drawing failed on.
pub fn svg(figure: &Figure) -> Result<String, String> {
    let caption = wrapped(&figure.caption);
    let frames: Vec<Frame> = (0..figure.panels.len()).map(|index| frame(&figure.panels, index)).collect();
    let usual = if figure.panels.len() > 2 { PANEL } else { TALL };
    let own = |(panel, frame): (&Panel, &Frame)| height(panel, usual) - if frame.shares { AXIS } else { 0 };
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

fn height(panel: &Panel, usual: u32) -> u32 {
    let bars =
        panel.layers.iter().find_map(|layer| if let Layer::Bars(bars) = layer { Some(bars.len()) } else { None });
    bars.map_or(usual, |count| AROUND + BAR * count as u32)
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
    let log = |from: f64, to: f64| (from..to).log_scale().with_key_points(numbers(from, to));
    match (panel.x.log, panel.y.log) {
        (false, false) => curves(area, panel, from..to, low..high, frame),
        (false, true) => curves(area, panel, from..to, log(low, high), frame),
        (true, false) => curves(area, panel, log(from, to), low..high, frame),
        (true, true) => curves(area, panel, log(from, to), log(low, high), frame),
    }
}

/// Numbers at a logarithmic axis: 1, 2 and 5 of each decade of a short one, every so many decades of a long one.
fn numbers(from: f64, to: f64) -> Vec<f64> {
    let decades = (to / from).log10();
    let (steps, every) =
        if decades < SHORT { (&[1.0, 2.0, 5.0][..], 1) } else { (&[1.0][..], (decades / NUMBERS).ceil() as i32) };
    let powers = (from.log10().floor() as i32..=to.log10().ceil() as i32).filter(|power| power % every == 0);
    let all = powers.flat_map(|power| steps.iter().map(move |step| step * 10_f64.powi(power)));
    // the end of an axis is rarely the number itself
    all.filter(|value| (0.999 * from..=1.001 * to).contains(value)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::figure::Axis;
    use super::*;

    fn drawn(layers: Vec<Layer>) -> String {
        let panel = Panel { x: Axis::of("t, s"), y: Axis::of("q"), layers, ..Panel::default() };
        svg(&Figure { panels: vec![panel], ..Figure::default() }).unwrap()
    }

    /// A step from 0 to 1 between two gaps.
    fn step() -> Vec<[f64; 2]> {
        let value = |at: usize| [f64::NAN, 0.0, 1.0, f64::NAN][at / 500];
        (0..2000).map(|at| [at as f64, value(at)]).collect()
    }

    #[test]
    fn gaps_are_not_drawn_and_level_stretches_by_their_ends() {
        let edges = step().into_iter().map(|[x, y]| [x, y - 0.1, y + 0.1]).collect();
        let text = drawn(vec![
            Layer::Area { name: String::new(), edges },
            Layer::Line { name: String::new(), points: step() },
        ]);
        assert!(!text.contains("points=\"\""), "an element without points");
        let longest = text.lines().filter(|line| line.contains("points=")).map(|line| line.matches(',').count()).max();
        assert!(longest.is_some_and(|count| (4..=10).contains(&count)), "{longest:?} points");
    }

    #[test]
    fn the_legend_stands_where_a_logarithmic_line_does_not() {
        let steep =
            |factor: f64| (0..100).map(|at| 10_f64.powf(0.04 * f64::from(at))).map(|x| [x, factor * x]).collect();
        let named = |name: &str, factor| Layer::Line { name: name.into(), points: steep(factor) };
        let (x, y) = (Axis::log("a, s").over(1.0, 1e4), Axis::log("b").over(1.0, 1e4));
        let panel = Panel { x, y, layers: vec![named("first", 1.0), named("second", 1.5)], ..Panel::default() };
        let text = svg(&Figure { panels: vec![panel], ..Figure::default() }).unwrap();
        let word = text.split("<text").find(|part| part.contains("first")).unwrap();
        let x = word.split(" x=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap().parse::<f64>().unwrap();
        assert!(x < 0.5 * f64::from(WIDTH), "at {x}, over the lines' end");
    }

    #[test]
    fn a_logarithmic_axis_has_numbers_within_a_decade_where_it_is_short() {
        let seen = |from, to| numbers(from, to).into_iter().map(|value| format!("{value:.0e}")).collect::<Vec<_>>();
        assert_eq!(seen(4.0, 22.0), ["5e0", "1e1", "2e1"]);
        assert_eq!(seen(1e-7, 1.0).len(), 8);
        assert_eq!(seen(1e-16, 1e3), ["1e-15", "1e-12", "1e-9", "1e-6", "1e-3", "1e0", "1e3"]);
    }

    #[test]
    fn a_reference_below_a_line_is_seen_beside_it() {
        let [reference, line] = [
            |points| Layer::Reference { name: String::new(), points },
            |points| Layer::Line { name: String::new(), points },
        ];
        assert!(drawn(vec![reference(step()), line(step())]).contains("stroke-width=\"3\""));
        assert!(!drawn(vec![line(step()), reference(step())]).contains("stroke-width=\"3\""));
    }
}
