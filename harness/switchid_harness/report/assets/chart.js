/* A chart over time. All charts of a run share `view`: the visible interval and the instant under the pointer. */

class TimeChart {
  /* options: title (markup), height, series[{name, values, color, width, dash, band, stair}], log, range, rangeOf, limits, marks */
  constructor(parent, view, options) {
    this.view = view;
    this.options = { height: 130, series: [], marks: [], ...options };
    this.element = document.createElement("div");
    this.element.className = "chart time";
    this.element.innerHTML = `<header><b>${options.title}</b></header><canvas></canvas>`;
    parent.append(this.element);
    this.canvas = this.element.querySelector("canvas");
    this.values = this.options.series.map((s) => this.legend(s));
    view.add(this);
    this.listen();
  }

  legend(series) {
    const item = document.createElement("span");
    const dashed = series.dash ? " dashed" : "";
    item.innerHTML = `<i class="key${dashed}" style="border-color:${series.color}"></i>${series.name} <output></output>`;
    this.element.querySelector("header").append(item);
    return item.querySelector("output");
  }

  listen() {
    const at = (event) => this.time(event.offsetX);
    let from = null;
    this.canvas.addEventListener("pointerdown", (e) => { from = at(e); this.canvas.setPointerCapture(e.pointerId); });
    this.canvas.addEventListener("pointermove", (e) => this.view.point(at(e), from));
    this.canvas.addEventListener("pointerup", (e) => { if (from !== null) this.view.zoom(from, at(e)); from = null; });
    this.canvas.addEventListener("pointerleave", () => { if (from === null) this.view.point(null, null); });
    this.canvas.addEventListener("dblclick", () => this.view.whole());
  }

  time(x) {
    const { x0, x1 } = this.box, [a, b] = this.view.range;
    return Math.min(b, Math.max(a, a + ((x - x0) / (x1 - x0)) * (b - a)));
  }

  /* Whether the chart stands in or near the window; others are drawn when they come into sight. */
  get near() {
    const r = this.element.getBoundingClientRect();
    return r.bottom > -300 && r.top < window.innerHeight + 300;
  }

  vertical(from, to) {
    const { log, range, rangeOf, limits } = this.options;
    if (range) return range;
    const lists = this.options.series.filter((s) => !rangeOf || rangeOf.includes(s.name)).map((s) => s.values);
    let [lo, hi] = extent(lists, from, to);
    if (log) {
      lo = Math.log10(Math.max(lo, limits ? limits[0] : 1e-16)); hi = Math.log10(Math.max(hi, 1e-15));
      if (limits) hi = Math.min(hi, Math.log10(limits[1]));
      return hi > lo ? [Math.floor(lo) - 0.05, Math.ceil(hi) + 0.05] : [lo - 1, lo + 1];
    }
    if (limits) { lo = Math.max(lo, limits[0]); hi = Math.min(hi, limits[1]); }
    return padded(lo, hi, 0.08);
  }

  draw() {
    const { height, series, log } = this.options;
    const [ctx, width] = fitCanvas(this.canvas, height);
    const box = this.box = { x0: MARGIN.left, x1: width - MARGIN.right, y0: MARGIN.top, y1: height - MARGIN.bottom };
    const [a, b] = this.view.range, t = this.view.time;
    const from = Math.max(0, lowerBound(t, a) - 1), to = Math.min(t.length, lowerBound(t, b) + 2);
    const [lo, hi] = this.vertical(from, to);
    const toX = (v) => box.x0 + ((v - a) / (b - a)) * (box.x1 - box.x0);
    const toY = (v) => box.y1 - ((v - lo) / (hi - lo)) * (box.y1 - box.y0);
    const floor = 10 ** lo;
    const scale = log ? (v) => toY(Math.log10(Math.max(v, floor))) : toY;
    this.shade(ctx, box, toX);
    drawFrame(ctx, box, this.timeTicks(a, b, width), log ? decadeTicks(lo, hi) : linearTicks(lo, hi, height > 200 ? 6 : 5), toX, toY);
    ctx.save();
    ctx.beginPath(); ctx.rect(box.x0, box.y0, box.x1 - box.x0, box.y1 - box.y0); ctx.clip();
    for (const s of series) if (s.band) this.band(ctx, s, t, from, to, toX, scale);
    for (const s of series) this.line(ctx, s, t, from, to, toX, scale);
    this.pointer(ctx, box, toX, scale);
    ctx.restore();
    this.marks(ctx, box, toX);
  }

  timeTicks(a, b, width) {
    const ticks = linearTicks(a, b, Math.max(4, width / 100));
    const last = ticks.length - 1;
    return ticks.map(([v, label], k) => [v, k === last ? label + " s" : label]);
  }

  shade(ctx, box, toX) {
    this.view.stages.forEach((stage, k) => {
      const x0 = Math.max(box.x0, toX(stage.start)), x1 = Math.min(box.x1, toX(stage.end));
      if (x1 <= x0) return;
      ctx.fillStyle = stageColor(k) + "14";
      ctx.fillRect(x0, box.y0, x1 - x0, box.y1 - box.y0);
      if (k === 0 || stage.start < this.view.range[0]) return;
      ctx.strokeStyle = stageColor(k) + "aa"; ctx.lineWidth = 1;
      ctx.beginPath(); ctx.moveTo(x0, box.y0); ctx.lineTo(x0, box.y1); ctx.stroke();
    });
  }

  line(ctx, s, t, from, to, toX, toY) {
    ctx.strokeStyle = s.color; ctx.lineWidth = s.width || 1.5; ctx.setLineDash(s.dash || []); ctx.lineJoin = "round";
    ctx.beginPath();
    let pen = false, last = 0, drawn = 0;
    for (let i = from; i < to; i++) {
      const v = s.values[i];
      if (!Number.isFinite(v)) { pen = false; continue; }
      const x = toX(t[i]);
      if (pen && s.thin && x - drawn < 0.4) continue;
      drawn = x;
      const y = Math.max(-2000, Math.min(4000, toY(v)));
      if (pen && s.stair) ctx.lineTo(x, last);
      if (pen) ctx.lineTo(x, y); else ctx.moveTo(x, y);
      pen = true; last = y;
    }
    ctx.stroke(); ctx.setLineDash([]);
  }

  band(ctx, s, t, from, to, toX, toY) {
    ctx.fillStyle = s.color + "30";
    const clamp = (y) => Math.max(-2000, Math.min(4000, y));
    let i = from;
    while (i < to) {
      while (i < to && !Number.isFinite(s.band[i])) i++;
      const begin = i;
      while (i < to && Number.isFinite(s.band[i])) i++;
      if (i - begin < 2) continue;
      ctx.beginPath();
      for (let k = begin; k < i; k++) ctx.lineTo(toX(t[k]), clamp(toY(s.values[k] + s.band[k])));
      for (let k = i - 1; k >= begin; k--) ctx.lineTo(toX(t[k]), clamp(toY(s.values[k] - s.band[k])));
      ctx.fill();
    }
  }

  pointer(ctx, box, toX, toY) {
    const { at, from } = this.view;
    this.values.forEach((output) => { output.textContent = ""; });
    if (at === null) return;
    if (from !== null) {
      ctx.fillStyle = "rgba(31,95,191,0.13)";
      ctx.fillRect(toX(Math.min(at, from)), box.y0, Math.abs(toX(at) - toX(from)), box.y1 - box.y0);
    }
    const i = Math.min(this.view.time.length - 1, lowerBound(this.view.time, at)), x = toX(this.view.time[i]);
    ctx.strokeStyle = "#475467"; ctx.lineWidth = 1;
    ctx.beginPath(); ctx.moveTo(x, box.y0); ctx.lineTo(x, box.y1); ctx.stroke();
    this.options.series.forEach((s, k) => {
      this.values[k].textContent = showNumber(s.values[i]);
      ctx.fillStyle = s.color; ctx.beginPath(); ctx.arc(x, toY(s.values[i]), 3, 0, 7); ctx.fill();
    });
  }

  /* Detections: triangles at the upper edge; false alarms: crosses at the lower one. */
  marks(ctx, box, toX) {
    const [a, b] = this.view.range;
    for (const { time, color, wrong } of this.options.marks) {
      if (time < a || time > b) continue;
      const x = toX(time);
      ctx.fillStyle = ctx.strokeStyle = color;
      ctx.lineWidth = 2; ctx.beginPath();
      if (wrong) {
        const y = box.y1 - 6;
        ctx.moveTo(x - 4, y - 4); ctx.lineTo(x + 4, y + 4); ctx.moveTo(x + 4, y - 4); ctx.lineTo(x - 4, y + 4); ctx.stroke();
      } else {
        ctx.moveTo(x - 5, box.y0 - 8); ctx.lineTo(x + 5, box.y0 - 8); ctx.lineTo(x, box.y0 + 3); ctx.fill();
      }
    }
  }
}

/* A strip of colored intervals over time. */
class StripChart extends TimeChart {
  draw() {
    const [ctx, width] = fitCanvas(this.canvas, this.options.height);
    const box = this.box = { x0: MARGIN.left, x1: width - MARGIN.right, y0: 2, y1: this.options.height - 2 };
    const [a, b] = this.view.range;
    const toX = (v) => Math.min(box.x1, Math.max(box.x0, box.x0 + ((v - a) / (b - a)) * (box.x1 - box.x0)));
    const rowHeight = (box.y1 - box.y0) / this.options.rows.length;
    this.options.rows.forEach(({ name, spans }, k) => {
      const y = box.y0 + k * rowHeight;
      for (const [from, to, color] of spans) {
        const x = toX(from);
        ctx.fillStyle = color;
        if (to > a && from < b) ctx.fillRect(x, y + 2, Math.max(toX(to) - x, 1), rowHeight - 4);
      }
      ctx.fillStyle = "#667085"; ctx.textAlign = "right"; ctx.textBaseline = "middle";
      ctx.fillText(name, box.x0 - 7, y + rowHeight / 2);
    });
  }
}

/* Curves in a plane. curves[{x, y, color, width, dash}]; equal scales are not forced. */
class PlaneChart {
  constructor(parent, { title, curves, ranges, labels }) {
    this.options = { curves, ranges, labels };
    const element = document.createElement("div");
    element.className = "chart";
    element.innerHTML = `<header><b>${title}</b></header><canvas></canvas>`;
    parent.append(element);
    this.canvas = element.querySelector("canvas");
    this.draw();
  }

  draw() {
    const { curves, ranges: [[xa, xb], [ya, yb]], labels } = this.options;
    const height = Math.round(this.canvas.clientWidth * 0.92);
    const [ctx, width] = fitCanvas(this.canvas, height);
    const box = { x0: 38, x1: width - 8, y0: 8, y1: height - 34 };
    const toX = (v) => box.x0 + ((v - xa) / (xb - xa)) * (box.x1 - box.x0);
    const toY = (v) => box.y1 - ((v - ya) / (yb - ya)) * (box.y1 - box.y0);
    drawFrame(ctx, box, linearTicks(xa, xb, 4), linearTicks(ya, yb, 5), toX, toY);
    ctx.textAlign = "right"; ctx.textBaseline = "bottom"; ctx.fillText(labels[0], box.x1, height - 1);
    ctx.textAlign = "left"; ctx.textBaseline = "top"; ctx.fillText(labels[1], box.x0 + 6, box.y0 + 4);
    ctx.save();
    ctx.beginPath(); ctx.rect(box.x0, box.y0, box.x1 - box.x0, box.y1 - box.y0); ctx.clip();
    for (const c of curves) {
      ctx.strokeStyle = c.color; ctx.lineWidth = c.width; ctx.lineJoin = "round";
      ctx.beginPath();
      let pen = false;
      for (let i = 0; i < c.x.length; i++) {
        if (!Number.isFinite(c.x[i] + c.y[i])) { pen = false; continue; }
        if (pen) ctx.lineTo(toX(c.x[i]), toY(c.y[i])); else ctx.moveTo(toX(c.x[i]), toY(c.y[i]));
        pen = true;
      }
      ctx.stroke();
    }
    ctx.restore();
  }
}
