//! The identified frequency with its std, gaps where it is unknown, against the measured roller's.

use super::measure::{Beam, Mode};
use plotters::prelude::*;
use std::ops::Range;

const SIZE: (u32, u32) = (1000, 420);

/// Every so many samples are drawn.
const STRIDE: usize = 50;

const MEASURED: RGBColor = RGBColor(30, 30, 30);
const IDENTIFIED: RGBColor = RGBColor(46, 100, 158);

type Drawn<T> = Result<T, DrawingAreaErrorKind<std::io::Error>>;

/// The picture as SVG.
pub fn svg(beam: &Beam, modes: &[Option<Mode>]) -> Drawn<String> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let end = beam.t.last().copied().unwrap_or(1.0);
        let mut chart = ChartBuilder::on(&area)
            .margin(12)
            .x_label_area_size(40)
            .y_label_area_size(50)
            .build_cartesian_2d(0.0..end, 22.0..42.0)?;
        chart
            .configure_mesh()
            .x_desc("time, s")
            .y_desc("first bending mode, Hz")
            .light_line_style(TRANSPARENT)
            .draw()?;
        let runs =
            || runs(modes).into_iter().map(|run| run.step_by(STRIDE).filter_map(|k| Some((beam.t[k], modes[k]?))));
        let edge = |side: f64, mode: &Mode| mode.frequency() + side * mode.frequency_std();
        chart.draw_series(runs().map(|run| {
            let run: Vec<(f64, Mode)> = run.collect();
            let upper = run.iter().map(|(t, mode)| (*t, edge(1.0, mode)));
            let lower = run.iter().rev().map(|(t, mode)| (*t, edge(-1.0, mode)));
            Polygon::new(upper.chain(lower).collect::<Vec<_>>(), IDENTIFIED.mix(0.25).filled())
        }))?;
        let measured = (0..beam.t.len()).step_by(STRIDE).map(|k| (beam.t[k], beam.frequency[k]));
        let style = MEASURED.stroke_width(2);
        chart
            .draw_series([PathElement::new(measured.collect::<Vec<_>>(), style)])?
            .label("from the measured roller")
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style));
        let style = IDENTIFIED.stroke_width(2);
        let lines = runs().map(|run| run.map(|(t, mode)| (t, mode.frequency())).collect::<Vec<_>>());
        chart
            .draw_series(lines.map(|line| PathElement::new(line, style)))?
            .label("identified from the strain, ± std")
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style));
        let mut labels = chart.configure_series_labels();
        labels.background_style(WHITE).border_style(MEASURED.mix(0.3));
        labels.position(SeriesLabelPosition::UpperRight).draw()?;
        area.present()?;
    }
    Ok(text)
}

/// The stretches over which a mode is known.
fn runs(modes: &[Option<Mode>]) -> Vec<Range<usize>> {
    let edge = |k: &usize| *k == 0 || modes[*k].is_some() != modes[*k - 1].is_some();
    let mut edges: Vec<usize> = (0..modes.len()).filter(edge).collect();
    edges.push(modes.len());
    edges.windows(2).map(|pair| pair[0]..pair[1]).filter(|run| modes[run.start].is_some()).collect()
}
