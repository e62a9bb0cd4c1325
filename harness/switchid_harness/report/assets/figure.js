"use strict";
/* Draws panels of the figure description (docs/figure-description.md) with plotly. The page of `switchid report` and
   the cross-check's page both hold it. */

const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"];
const FEW = 30; // points up to which a line shows each of them
const REFERENCE = "#505050", MARK = "#be3c28", RULE = "#e3e6ea", ZERO = "#c8cdd4";
const BELOW = 3.5; // width of a reference that lines are drawn over: it is seen on both sides of them
const BUTTONS = ["zoom2d", "pan2d", "resetScale2d", "toImage"];

const column = (points, at) => points.map((point) => point[at]);

function curve(layer, mode, colour, width = 1.2) {
  const { name, points } = layer;
  return { x: column(points, 0), y: column(points, 1), name, mode, showlegend: name !== "", line: { color: colour, width }, marker: { color: colour, size: 3 } };
}

/* The stretches of an area between its gaps: each a lower edge, and an upper one that fills down to it. */
function area({ name, edges }, colour) {
  const stretches = [[]];
  for (const edge of edges) {
    if (edge.every(Number.isFinite)) stretches[stretches.length - 1].push(edge);
    else stretches.push([]);
  }
  return stretches.filter((edges) => edges.length).flatMap((edges, k) => {
    const side = (at) => ({ x: column(edges, 0), y: column(edges, at), mode: "lines", line: { color: colour, width: 0 }, hoverinfo: "skip" });
    const named = k === 0 && name !== "";
    return [{ ...side(1), showlegend: false }, { ...side(2), name, showlegend: named, fill: "tonexty", fillcolor: colour + "40" }];
  });
}

function bars(rows, colour) {
  const all = [...rows].reverse();
  return { type: "bar", orientation: "h", x: column(all, 1), y: column(all, 0), text: column(all, 2), textposition: "outside", cliponaxis: false, marker: { color: colour }, showlegend: false };
}

/* Whether the layer has a colour of its own: the next one has the next. */
const takesColour = (layer) => Boolean(layer.line || layer.points || layer.bars);

/* What plotly draws over the axes, in the description's order. */
function traces(layers) {
  let next = 0;
  const drawn = [];
  for (const [k, layer] of layers.entries()) {
    const colour = COLOURS[next % COLOURS.length];
    if (layer.line) drawn.push(curve(layer.line, layer.line.points.length > FEW ? "lines" : "lines+markers", colour));
    if (layer.points) drawn.push(curve(layer.points, "markers", colour));
    if (layer.reference) drawn.push(curve(layer.reference, "lines", REFERENCE + "b0", layers.slice(k).some(takesColour) ? BELOW : 1.2));
    if (layer.area) drawn.push(...area(layer.area, colour));
    if (layer.bars) drawn.push(bars(layer.bars, colour));
    if (takesColour(layer)) next += 1;
  }
  return drawn;
}

/* Bands and marks: a shape each, and its word, above the panel or, where the legend stands there, within. Words on a
   logarithmic axis stand at the logarithm. */
function upright(panel, hasLegend) {
  const shapes = [], words = [];
  const shape = (from, to, style) => shapes.push({ type: "rect", xref: "x", yref: "paper", x0: from, x1: to, y0: 0, y1: 1, ...style });
  const word = (at, text) => text && words.push({ x: panel.x.log ? Math.log10(at) : at, y: 1, xref: "x", yref: "paper", yanchor: hasLegend ? "top" : "bottom", text, showarrow: false, font: { size: 11 }, bgcolor: hasLegend ? "#ffffffa0" : undefined });
  panel.layers.filter((layer) => layer.band || layer.mark).forEach(({ band, mark }, k) => {
    if (band) {
      shape(band.from, band.to, { fillcolor: "#000", opacity: k % 2 ? 0.11 : 0.05, layer: "below", line: { width: 0 } });
      word((band.from + band.to) / 2, band.label);
    } else {
      shape(mark.at, mark.at, { line: { color: MARK, width: 1.5 } });
      word(mark.at, mark.label);
    }
  });
  return { shapes, annotations: words };
}

function axis({ label, log, range }) {
  const shown = range && { range: log ? range.map(Math.log10) : range };
  // an axis without a label has names in place of numbers
  const rules = { gridcolor: RULE, zerolinecolor: ZERO };
  return { title: { text: label, standoff: 5 }, ...rules, ...(label && { type: log ? "log" : "linear", exponentformat: log ? "power" : "none", ...(log && range && range[1] < 100 * range[0] && { dtick: "D2" }) }), ...shown };
}

function layout(panel, height) {
  const named = panel.layers.filter((layer) => ["line", "reference", "points", "area"].some((kind) => layer[kind]?.name));
  const hasLegend = named.length > 1;
  return {
    title: { text: panel.title, font: { size: 15 }, x: 0, xref: "paper", xanchor: "left" },
    height,
    // behind the longest bar stands its text
    margin: { t: panel.title ? 56 : 34, b: 46, r: panel.layers.some((layer) => layer.bars) ? 70 : 20 },
    showlegend: hasLegend,
    legend: { orientation: "h", traceorder: "normal", x: 0, xanchor: "left", y: 1.02, yanchor: "bottom", font: { size: 11 }, bgcolor: "#ffffffc0" },
    xaxis: axis(panel.x),
    yaxis: { ...axis(panel.y), automargin: true },
    ...upright(panel, hasLegend),
  };
}

/* One zoom for all panels with the same axis to the right: a stretch chosen in one is shown by the others. */
class Zoom {
  constructor() { this.places = []; this.ranges = {}; this.busy = false; }

  add(place, label) {
    this.places.push([place, label]);
    if (this.ranges[label]) Plotly.relayout(place, { "xaxis.range": this.ranges[label] });
    place.on("plotly_relayout", (change) => {
      const range = change["xaxis.range"] || (change["xaxis.range[0]"] !== undefined && [change["xaxis.range[0]"], change["xaxis.range[1]"]]);
      if (range) this.show(label, [...range], place);
      else if (change["xaxis.autorange"]) this.show(label, null, place);
    });
  }

  /* Shows a stretch, or everything, in all panels of that axis but the one it was chosen in. */
  async show(label, range, chosen) {
    if (this.busy || !label) return;
    this.busy = true;
    this.ranges[label] = range;
    const others = this.places.filter(([place, own]) => own === label && place !== chosen);
    await Promise.all(others.map(([place]) => Plotly.relayout(place, range ? { "xaxis.range": range } : { "xaxis.autorange": true })));
    this.busy = false;
  }
}

const waiting = new Map();

function draw(place) {
  const begin = waiting.get(place);
  waiting.delete(place);
  if (begin) begin();
}

const seen = new IntersectionObserver((entries) => entries.filter((entry) => entry.isIntersecting).forEach((entry) => { seen.unobserve(entry.target); draw(entry.target); }), { rootMargin: "300px" });

/* Draws a panel into its place once that comes into view; all of them before the page is printed. */
function show(place, panel, zoom) {
  waiting.set(place, () => {
    const described = panel();
    Plotly.newPlot(place, traces(described.layers), layout(described, place.clientHeight), { responsive: true, displaylogo: false, modeBarButtons: [BUTTONS] });
    zoom.add(place, described.x.label);
  });
  seen.observe(place);
}

addEventListener("beforeprint", () => [...waiting.keys()].forEach(draw));
