//! Figures as plotly's, for a page that holds its JavaScript.

use super::figure::{Axis, Figure, Layer, Panel};
use plotly::common::{Fill, Line, Marker, Mode, Orientation, Title};
use plotly::layout::{Annotation, AxisType, Layout, Margin, Shape, ShapeLayer, ShapeLine, ShapeType};
use plotly::{Bar, Plot, Scatter, Trace};

/// Colours of curves, as in the SVG.
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"];

/// Height of a panel, and of a bar, pixels.
const PANEL: usize = 300;
const BAR: usize = 34;

/// The figure's panels as parts of a page, each a plot of its own; `id` tells the figures of a page apart. What a plot shows stands
/// beside its place; the page's [`script`] draws it once it comes into view, so that a long page is at hand as soon as a short one.
pub fn html(figure: &Figure, id: &str) -> String {
    let panels = figure.panels.iter().enumerate().map(|(index, panel)| {
        let height = height(panel);
        // a name that ends the element would end it
        let plot = plot(panel, height).to_json().replace("</", "<\\/");
        format!(
            "<div class=\"plot\" id=\"{id}-{index}\" style=\"height:{height}px\">\
             <script type=\"application/json\">{plot}</script></div>\n"
        )
    });
    let caption = if figure.caption.is_empty() {
        String::new()
    } else {
        format!("<p class=\"caption\">{}</p>\n", escaped(&figure.caption))
    };
    format!("<h2>{}</h2>\n{}{caption}", escaped(&figure.title), panels.collect::<String>())
}

/// Draws a plot when it comes into view, and all of them before the page is printed.
const DRAW: &str = r#"<script>
addEventListener("DOMContentLoaded", () => {
  const plots = [...document.querySelectorAll(".plot")];
  const draw = place => {
    const text = place.querySelector("script");
    if (!text) return;
    text.remove();
    const { data, layout } = JSON.parse(text.textContent);
    Plotly.newPlot(place, data, layout, { responsive: true, displaylogo: false });
  };
  const seen = new IntersectionObserver(
    entries => entries.filter(entry => entry.isIntersecting).forEach(entry => draw(entry.target)),
    { rootMargin: "300px" }
  );
  plots.forEach(place => seen.observe(place));
  addEventListener("beforeprint", () => plots.forEach(draw));
});
</script>"#;

/// The JavaScript that draws, as elements of a page.
pub(super) fn script() -> String {
    let all = Plot::offline_js_sources();
    let end = all.find("</script>").map_or(all.len(), |at| at + "</script>".len());
    format!("{}\n{DRAW}", &all[..end])
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

fn plot(panel: &Panel, height: usize) -> Plot {
    let mut plot = Plot::new();
    let mut colours = COLOURS.iter().cycle();
    for layer in &panel.layers {
        let colour = if layer.is_coloured() { colours.next().copied().unwrap_or("#000") } else { "#000" };
        for trace in traces(layer, colour) {
            plot.add_trace(trace);
        }
    }
    let (shapes, notes) = upright_layers(panel);
    let layout = Layout::new()
        .title(Title::with_text(&panel.title))
        .height(height)
        .margin(Margin::new().top(50).bottom(50).right(20).auto_expand(true))
        .show_legend(panel.named() > 1)
        .x_axis(axis(&panel.x))
        .y_axis(axis(&panel.y).auto_margin(true))
        .shapes(shapes)
        .annotations(notes);
    plot.set_layout(layout);
    plot
}

/// What a layer is to plotly; none of one that is a shape.
fn traces(layer: &Layer, colour: &'static str) -> Vec<Box<dyn Trace>> {
    match layer {
        Layer::Line { name, points } => vec![curve(name, points, Mode::Lines, colour)],
        Layer::Points { name, points } => vec![curve(name, points, Mode::Markers, colour)],
        Layer::Area { name, edges } => {
            let parts = edges.split(|edge| edge.iter().any(|value| !value.is_finite()));
            let mut drawn: Vec<Box<dyn Trace>> = Vec::new();
            for part in parts.filter(|part| !part.is_empty()) {
                let edge = |at: usize| part.iter().map(|edge| [edge[0], edge[at]]).collect::<Vec<_>>();
                let name = if drawn.is_empty() { name } else { "" };
                drawn.push(curve("", &edge(1), Mode::Lines, colour));
                drawn.push(curve(name, &edge(2), Mode::Lines, colour).fill(Fill::ToNextY));
            }
            drawn
        }
        Layer::Bars(bars) => {
            let names: Vec<String> = bars.iter().rev().map(|bar| bar.0.clone()).collect();
            let values: Vec<f64> = bars.iter().rev().map(|bar| bar.1).collect();
            let texts: Vec<String> = bars.iter().rev().map(|bar| bar.2.clone()).collect();
            let bar = Bar::new(values, names).orientation(Orientation::Horizontal).text_array(texts);
            vec![bar.marker(Marker::new().color(colour))]
        }
        Layer::Band { .. } | Layer::Mark { .. } => Vec::new(),
    }
}

/// Bands and marks: their shapes, and the words above them.
fn upright_layers(panel: &Panel) -> (Vec<Shape>, Vec<Annotation>) {
    let (mut shapes, mut notes) = (Vec::new(), Vec::new());
    for (shade, layer) in panel.layers.iter().filter(|layer| !layer.is_coloured()).enumerate() {
        match layer {
            Layer::Band { from, to, label } => {
                let opacity = if shade % 2 == 0 { 0.05 } else { 0.11 };
                shapes.push(upright(*from, *to).fill_color("#000").opacity(opacity).layer(ShapeLayer::Below));
                notes.push(note(0.5 * (from + to), label, panel.x.log));
            }
            Layer::Mark { at, label } => {
                shapes.push(upright(*at, *at).line(ShapeLine::new().color("#be3c28").width(1.5)));
                notes.push(note(*at, label, panel.x.log));
            }
            Layer::Line { .. } | Layer::Points { .. } | Layer::Area { .. } | Layer::Bars(_) => {}
        }
    }
    (shapes, notes)
}

fn curve(name: &str, points: &[[f64; 2]], mode: Mode, colour: &'static str) -> Box<Scatter<f64, Option<f64>>> {
    let x = points.iter().map(|point| digits(point[0])).collect();
    let y = points.iter().map(|point| Some(digits(point[1])).filter(|value| value.is_finite())).collect();
    let trace = Scatter::new(x, y).name(name).mode(mode);
    trace
        .line(Line::new().color(colour).width(1.2))
        .marker(Marker::new().color(colour).size(3))
        .show_legend(!name.is_empty())
}

/// Seven digits: more than a screen of any zoom shows of a few thousand points.
fn digits(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

fn axis(axis: &Axis) -> plotly::layout::Axis {
    let kind = if axis.log { AxisType::Log } else { AxisType::Linear };
    let own = plotly::layout::Axis::new().title(Title::with_text(&axis.label));
    if axis.label.is_empty() { own } else { own.type_(kind) }
}

/// A stretch of the x axis from below to above; shapes take values as they are, on a logarithmic axis too.
fn upright(from: f64, to: f64) -> Shape {
    Shape::new().shape_type(ShapeType::Rect).x_ref("x").y_ref("paper").x0(from).x1(to).y0(0.0).y1(1.0)
}

/// A word above the panel; annotations on a logarithmic axis stand at the logarithm.
fn note(at: f64, label: &str, log: bool) -> Annotation {
    let at = if log { at.log10() } else { at };
    Annotation::new().x(at).y(1.0).x_ref("x").y_ref("paper").text(label).show_arrow(false).y_shift(8.0)
}
