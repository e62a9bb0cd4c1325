//! Figures as parts of a page: each panel's description, which `figure.js` draws with plotly, whose JavaScript the page
//! holds.

use super::figure::{Figure, Layer, Panel};
use plotly::Plot;

/// Height of a panel, and of a bar, pixels.
const PANEL: usize = 300;
const BAR: usize = 34;

/// What draws a panel of the description; the cross-check's page has it too.
const FIGURE: &str = include_str!("../../harness/switchid_harness/report/assets/figure.js");

/// Draws the panels that stand in the page, those of one figure with one zoom.
const DRAW: &str = r#"
addEventListener("DOMContentLoaded", () => {
  const zooms = {};
  for (const place of document.querySelectorAll(".plot")) {
    const text = place.querySelector("script");
    const zoom = zooms[place.dataset.figure] ??= new Zoom();
    show(place, () => { text.remove(); return JSON.parse(text.textContent); }, zoom);
  }
});
"#;

/// The figure's panels as parts of a page, each a plot of its own; `id` tells the figures of a page apart. What a plot
/// shows stands beside its place; the page's [`script`] draws it once it comes into view, so that a long page is at
/// hand as soon as a short one.
pub fn html(figure: &Figure, id: &str) -> String {
    let panels = figure.panels.iter().enumerate().map(|(index, panel)| {
        // a name that ends the element would end it
        let described = serde_json::to_string(panel).unwrap_or_default().replace("</", "<\\/");
        format!(
            "<div class=\"plot\" id=\"{id}-{index}\" data-figure=\"{id}\" style=\"height:{}px\">\
             <script type=\"application/json\">{described}</script></div>\n",
            height(panel)
        )
    });
    let caption = if figure.caption.is_empty() {
        String::new()
    } else {
        format!("<p class=\"caption\">{}</p>\n", escaped(&figure.caption))
    };
    format!("<h2>{}</h2>\n{}{caption}", escaped(&figure.title), panels.collect::<String>())
}

/// The JavaScript that draws, as elements of a page.
pub(super) fn script() -> String {
    let all = Plot::offline_js_sources();
    let end = all.find("</script>").map_or(all.len(), |at| at + "</script>".len());
    format!("{}\n<script>\n{FIGURE}{DRAW}</script>", &all[..end])
}

/// Text as HTML shows it.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn height(panel: &Panel) -> usize {
    let bars =
        panel.layers.iter().find_map(|layer| if let Layer::Bars(bars) = layer { Some(bars.len()) } else { None });
    bars.map_or(PANEL, |count| 110 + BAR * count)
}
