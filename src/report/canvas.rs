//! What all panels are drawn on.

use plotters::coord::Shift;
use plotters::prelude::*;

/// Width of a picture, pixels: what a page of text shows unscaled.
pub(super) const WIDTH: u32 = 760;

/// Colours of curves (Okabe and Ito, told apart by everybody), and of marks; `figure.js` has the same.
pub(super) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];
pub(super) const MARK: RGBColor = RGBColor(190, 60, 40);

/// Colour of what was measured or is true.
pub(super) const REFERENCE: RGBColor = RGBColor(80, 80, 80);

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// What the drawing failed on.
pub(super) fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}
