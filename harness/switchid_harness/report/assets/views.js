/* The publication's views of one run. */

const OURS = "#1f5fbf", PUBLISHED = "#d9730d", OBSERVED = "#98a2b3", TRUTH = "#101828";
const METHODS = [["default", "ours", OURS], ["publication", "published", PUBLISHED]];
const STATUS = [null, ["acquiring", "#98a2b3"], ["tracking", "#58b07f"], ["switch suspected", "#f0b429"], ["re-identifying", "#7f6bd1"]];
const BASES = { qdd: "q̈", qd: "q̇" };

function termMarkup(term) {
  if (term === "const") return "constant";
  const parts = [];
  for (const part of term.split("_")) {
    if (/^\d+$/.test(part)) parts.push(`${parts.pop()}<sup>${part}</sup>`);
    else parts.push(`<i>${BASES[part] || part}</i>`);
  }
  return `coefficient of <span class="term">${parts.join("\u200a")}</span>`;
}

/* What all time charts of a run share. */
class View {
  constructor(run) {
    this.time = run.traces.t;
    this.stages = run.stages;
    this.end = run.end;
    this.range = [0, run.end];
    this.at = this.from = null;
    this.charts = [];
    this.pending = false;
    this.stale = new Set();
  }

  add(chart) { this.charts.push(chart); this.stale.add(chart); }
  whole() { this.range = [0, this.end]; this.redraw(); }
  point(at, from) { this.at = at; this.from = from; this.redraw(); }

  zoom(a, b) {
    this.from = null;
    const [lo, hi] = [Math.min(a, b), Math.max(a, b)];
    if (hi - lo > (this.range[1] - this.range[0]) / 200) this.range = [lo, hi];
    this.redraw();
  }

  redraw() {
    this.charts.forEach((chart) => this.stale.add(chart));
    this.schedule();
  }

  schedule() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      for (const chart of this.stale) if (chart.near) { chart.draw(); this.stale.delete(chart); }
    });
  }
}

function marksOf(run, methods) {
  return METHODS.filter(([id]) => methods.includes(id)).flatMap(([id, , color]) => [
    ...run.alarms[id].detected.filter((time) => time !== null).map((time) => ({ time, color })),
    ...run.alarms[id].false.map((time) => ({ time, color, wrong: true })),
  ]);
}

function truthTrace(run, term) {
  return run.traces.t.map((t) => {
    const stage = run.stages.find((s) => t < s.end) || run.stages[run.stages.length - 1];
    return stage.truth[term] || 0;
  });
}

const section = (id) => { const element = document.getElementById(id); element.replaceChildren(); return element; };
const mapped = (values, f) => values.map(f);

function showState(run, view) {
  const parent = section("state"), t = run.traces, marks = marksOf(run, ["default"]);
  const add = (title, values, color) => new TimeChart(parent, view, { title, height: 120, marks, series: [{ name: "observed", values, color, width: 1.2, thin: true }] });
  add("excitation <i>F</i>", t.F, "#475467");
  add("displacement <i>q</i>", t.q, "#0f766e");
  add("velocity <i>q̇</i>", t.qd, "#7c3aed");
}

function showPrediction(run, view) {
  const parent = section("prediction"), t = run.traces;
  for (const [name, title] of [["q", "displacement <i>q</i>"], ["qd", "velocity <i>q̇</i>"]]) {
    const [lo, hi] = padded(...extent([t[name]], 0, run.points), 0.15);
    const series = [{ name: "observed", values: t[name], color: OBSERVED, width: 4 }];
    for (const [id, label, color] of [...METHODS].reverse()) series.push({ name: label, values: t[`${id}.prediction.${name}`], color, width: 1.4 });
    new TimeChart(parent, view, { title, height: 150, limits: [lo, hi], marks: marksOf(run, ["default", "publication"]), series });
  }
  const difference = METHODS.map(([id, label, color]) => ({ name: label, color, width: 1.2,
    values: mapped(t.q, (q, i) => Math.abs(t[`${id}.prediction.q`][i] - q) + Math.abs(t[`${id}.prediction.qd`][i] - t.qd[i])) }));
  new TimeChart(parent, view, { title: "|predicted − observed|, <i>q</i> and <i>q̇</i> together", height: 140, log: true, limits: [1e-12, 1e3], series: difference });
}

function showPortraits(run) {
  const parent = section("portraits"), t = run.traces;
  const ranges = [padded(...extent([t.q], 0, run.points), 0.06), padded(...extent([t.qd], 0, run.points), 0.06)];
  run.stages.forEach((stage, k) => {
    const from = lowerBound(t.t, stage.start), to = lowerBound(t.t, stage.end);
    const curve = (x, y, color, width) => ({ x: x.subarray(from, to), y: y.subarray(from, to), color, width });
    const curves = [curve(t.q, t.qd, stageColor(k) + "99", 3), curve(t["default.prediction.q"], t["default.prediction.qd"], TRUTH, 0.8)];
    new PlaneChart(parent, { title: `Stage ${k + 1}`, curves, ranges, labels: ["q", "q̇"] });
  });
}

function showCoefficients(run, view) {
  const parent = section("coefficients"), t = run.traces, marks = marksOf(run, ["default"]);
  for (const term of run.terms) {
    const truth = truthTrace(run, term);
    const values = run.stages.map((s) => s.truth[term] || 0);
    const lo = Math.min(...values), hi = Math.max(...values), span = Math.max(hi - lo, 0.15 * Math.max(Math.abs(lo), Math.abs(hi)), 0.1);
    const series = [{ name: "published", values: t[`publication.coef.${term}`], color: PUBLISHED, width: 1.2 },
      { name: "ours", values: t[`default.coef.${term}`], color: OURS, width: 1.8, band: mapped(t[`default.std.${term}`], (s) => 2 * s) },
      { name: "truth", values: truth, color: TRUTH, width: 1.3, dash: [5, 4] }];
    new TimeChart(parent, view, { title: termMarkup(term), height: 170, range: [lo - 0.6 * span, hi + 0.6 * span], marks, series });
  }
}

function showError(run, view) {
  const parent = section("error"), t = run.traces;
  const series = METHODS.map(([id, label, color]) => ({ name: label, values: t[`${id}.e`], color, width: 1.7 })).reverse();
  series.push({ name: "0.05²", values: t.t.map(() => run.level), color: TRUTH, width: 1.2, dash: [5, 4] });
  new TimeChart(parent, view, { title: "<i>e</i>; ▼ detected, × false alarm", height: 220, log: true, limits: [1e-16, 1e3], marks: marksOf(run, ["default", "publication"]), series });
  const rows = METHODS.map(([id, label]) => ({ name: label, spans: run.status[id].map(([a, b, s]) => [a, b, (STATUS[s] || ["", "#fff"])[1]]) }));
  const strip = new StripChart(parent, view, { title: "what the identifier is doing", height: 52, rows });
  const header = strip.element.querySelector("header");
  STATUS.slice(1).forEach(([name, color]) => header.insertAdjacentHTML("beforeend", `<span><i class="key block" style="background:${color}"></i>${name}</span>`));
}

function showDeviation(run, view) {
  const parent = section("deviation"), t = run.traces;
  for (const [id, label, color] of METHODS) {
    const series = [{ name: "deviation", values: t[`${id}.deviation`], color, width: 1.6 },
      { name: "threshold", values: t[`${id}.threshold`], color: "#c4322b", width: 1.4, dash: [5, 4] }];
    new TimeChart(parent, view, { title: label, height: 170, log: true, limits: [1e-12, 1e3], marks: marksOf(run, [id]), series });
  }
}
