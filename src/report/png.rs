//! Figures as PNG: the SVG, made of dots by resvg with the system's fonts.

use super::figure::Figure;
use super::svg::svg;
use resvg::{tiny_skia, usvg};

/// Dots per pixel of the SVG: sharp on a screen of twice the usual density, and in print.
const SCALE: f32 = 2.0;

/// The picture's bytes.
///
/// # Errors
/// What the drawing failed on.
pub fn png(figure: &Figure) -> Result<Vec<u8>, String> {
    let mut options = usvg::Options { font_family: "DejaVu Sans".into(), ..usvg::Options::default() };
    let fonts = options.fontdb_mut();
    fonts.load_system_fonts();
    let family = fonts.faces().find_map(|face| face.families.first().map(|(name, _)| name.clone()));
    let has = |name: &str| fonts.faces().any(|face| face.families.iter().any(|(family, _)| family == name));
    let known =
        ["DejaVu Sans", "Arial", "Helvetica", "Liberation Sans", "Noto Sans"].into_iter().find(|name| has(name));
    if let Some(family) = known.map(String::from).or(family) {
        fonts.set_sans_serif_family(family);
    }
    let tree = usvg::Tree::from_str(&svg(figure)?, &options).map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size();
    let scaled = |length: u32| (length as f32 * SCALE) as u32;
    let mut pixels = tiny_skia::Pixmap::new(scaled(size.width()), scaled(size.height())).ok_or("it has no extent")?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| error.to_string())
}
