//! Figures: described once, drawn as SVG, PNG or HTML.
//!
//! A [`Figure`] is panels of layers in data coordinates; who draws knows nothing of laws, who describes nothing of
//! pixels. SVG is drawn by plotters, PNG by resvg from it, HTML by plotly with its JavaScript in the page.

#[cfg(feature = "pictures")]
mod bars;
#[cfg(feature = "pictures")]
mod canvas;
#[cfg(feature = "pictures")]
mod curves;
mod figure;
#[cfg(feature = "pictures")]
mod html;
#[cfg(feature = "pictures")]
mod page;
#[cfg(feature = "pictures")]
mod png;
#[cfg(feature = "pictures")]
mod svg;
mod thin;

pub use figure::{Axis, Figure, Layer, Panel};
#[cfg(feature = "pictures")]
pub use page::{Block, page};
#[cfg(feature = "pictures")]
pub use png::png;
#[cfg(feature = "pictures")]
pub use svg::svg;
pub use thin::MOST;
