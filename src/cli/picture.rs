//! Pictures as SVG: the error falling step by step to the noise floor.

use super::error::CommandError;
use super::output::Written;
use super::words::percent;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// Width of the picture, pixels: what a page of text shows unscaled.
const WIDTH: u32 = 760;

/// Height of one step, pixels: a bar and its title.
const STEP: u32 = 44;

/// Height of axis and margins, pixels.
const AROUND: u32 = 70;

/// Ratio between the ends of the axis at most: a floor far below is named at the left end.
const DECADES: f64 = 1e3;

const BAR: RGBColor = RGBColor(46, 100, 158);
const FLOOR: RGBColor = RGBColor(190, 60, 40);

/// A picture to be drawn into a file.
pub(super) struct Picture<'a>(Written<'a>);

impl<'a> Picture<'a> {
    /// A picture for that file.
    ///
    /// # Errors
    /// [`CommandError::Exists`] unless `overwrite`.
    pub(super) fn open(path: &'a Path, overwrite: bool) -> Result<Picture<'a>, CommandError> {
        Written::check(path, overwrite).map(Picture)
    }

    /// Bars on a logarithmic axis, one for each step with its title and its held-out error; the noise
    /// floor is a line.
    ///
    /// # Errors
    /// [`CommandError::Draw`] says what the drawing failed on; what writing says.
    pub(super) fn staircase(self, stairs: &[(String, f64)], floor: f64) -> Result<(), CommandError> {
        let mut text = String::new();
        draw(&mut text, stairs, floor).map_err(|reason| CommandError::Draw { file: "the staircase".into(), reason })?;
        self.0.write(&text)
    }
}

fn draw(text: &mut String, stairs: &[(String, f64)], floor: f64) -> Result<(), String> {
    let said = |error: &dyn std::fmt::Display| error.to_string();
    let height = AROUND + STEP * stairs.len() as u32;
    let area = SVGBackend::with_string(text, (WIDTH, height)).into_drawing_area();
    area.fill(&WHITE).map_err(|error| said(&error))?;
    let errors = || stairs.iter().map(|(_, error)| 100.0 * error).chain([100.0 * floor]).filter(|error| *error > 0.0);
    let highest = 2.0 * errors().fold(0.0, f64::max);
    let range = (0.5 * errors().fold(f64::INFINITY, f64::min)).max(highest / DECADES)..highest;
    let count = stairs.len() as f64;
    let mut chart = ChartBuilder::on(&area)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(220)
        .build_cartesian_2d(range.clone().log_scale(), 0.0..count)
        .map_err(|error| said(&error))?;
    let left = range.start;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .disable_y_axis()
        .y_labels(0)
        .x_desc("error on held-out data, %")
        .light_line_style(TRANSPARENT)
        .draw()
        .map_err(|error| said(&error))?;
    let bars = stairs.iter().enumerate().map(|(index, (_, error))| {
        let top = count - index as f64;
        Rectangle::new([(left, top - 0.2), (100.0 * error, top - 0.8)], BAR.filled())
    });
    chart.draw_series(bars).map_err(|error| said(&error))?;
    let (line, name) = match 100.0 * floor {
        below if below < left => (left, format!("← noise floor {}", percent(floor))),
        within => (within, format!("noise floor {}", percent(floor))),
    };
    chart
        .draw_series([PathElement::new(vec![(line, 0.0), (line, count)], FLOOR.stroke_width(2))])
        .map_err(|error| said(&error))?;
    let labels = stairs.iter().enumerate().flat_map(|(index, (title, error))| {
        let middle = count - index as f64 - 0.5;
        let style = |position: HPos| ("sans-serif", 14).into_font().color(&BLACK).pos(Pos::new(position, VPos::Center));
        [
            EmptyElement::at((left, middle)) + Text::new(title.clone(), (-8, 0), style(HPos::Right)),
            EmptyElement::at((100.0 * error, middle)) + Text::new(percent(*error), (6, 0), style(HPos::Left)),
        ]
    });
    chart.draw_series(labels).map_err(|error| said(&error))?;
    let style = ("sans-serif", 12).into_font().color(&FLOOR);
    let floor_label = EmptyElement::at((line, count)) + Text::new(name, (4, -6), style);
    chart.draw_series([floor_label]).map_err(|error| said(&error))?;
    area.present().map_err(|error| said(&error))
}
