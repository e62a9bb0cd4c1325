/* Scales and ticks. */

const STAGE_COLORS = ["#3b6fb6", "#c26a1b", "#2f8f6b", "#8a5bb0", "#b5475f", "#5c7a29"];
const stageColor = (k) => STAGE_COLORS[k % STAGE_COLORS.length];
const MARGIN = { left: 68, right: 24, top: 10, bottom: 24 };
const FONT = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';

function niceStep(span, count) {
  const raw = span / count, power = 10 ** Math.floor(Math.log10(raw));
  const factor = [1, 2, 5, 10].find((f) => f * power >= raw * 0.999);
  return factor * power;
}

function linearTicks(lo, hi, count) {
  const step = niceStep(hi - lo, count), decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks = [];
  for (let k = Math.ceil(lo / step - 1e-9); k * step <= hi + 1e-9 * step; k++) {
    const v = k * step;
    ticks.push([v, (Math.abs(v) < step / 2 ? 0 : v).toFixed(decimals).replace("-", "−")]);
  }
  return ticks;
}

const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const superscript = (n) => (n < 0 ? "⁻" : "") + [...String(Math.abs(n))].map((d) => SUPERSCRIPT[d]).join("");

function decadeTicks(lo, hi) {
  const first = Math.ceil(lo - 1e-9), last = Math.floor(hi + 1e-9), every = Math.max(1, Math.ceil((last - first + 1) / 5));
  const ticks = [];
  for (let e = first; e <= last; e++) if (e % every === 0) ticks.push([e, "10" + superscript(e)]);
  return ticks;
}

/* Lowest and highest finite value of the traces between two indices. */
function extent(list, from, to) {
  let lo = Infinity, hi = -Infinity;
  for (const values of list) {
    for (let i = from; i < to; i++) {
      const v = values[i];
      if (v < lo) lo = v;
      if (v > hi) hi = v;
    }
  }
  return [lo, hi];
}

function padded(lo, hi, share) {
  if (!(hi >= lo)) return [-1, 1];
  const span = Math.max(hi - lo, 1e-9 + 1e-3 * Math.abs(hi));
  return [lo - share * span, hi + share * span];
}

function lowerBound(sorted, value) {
  let lo = 0, hi = sorted.length;
  while (lo < hi) { const mid = (lo + hi) >> 1; if (sorted[mid] < value) lo = mid + 1; else hi = mid; }
  return lo;
}

function showNumber(v) {
  if (!Number.isFinite(v)) return "–";
  const size = Math.abs(v);
  const text = size !== 0 && (size < 1e-3 || size >= 1e5) ? v.toExponential(2) : v.toPrecision(4);
  return text.replace(/-/g, "−");
}

/* A canvas of that height that follows the width of its parent and the screen's resolution. */
function fitCanvas(canvas, height) {
  const width = canvas.clientWidth, ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.height = height + "px";
  const ctx = canvas.getContext("2d");
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, width, height);
  ctx.font = FONT;
  return [ctx, width];
}

function drawFrame(ctx, box, xTicks, yTicks, toX, toY) {
  ctx.lineWidth = 1;
  ctx.fillStyle = "#667085";
  ctx.strokeStyle = "rgba(102,112,133,0.16)";
  ctx.textAlign = "right"; ctx.textBaseline = "middle";
  for (const [v, label] of yTicks) {
    const y = Math.round(toY(v)) + 0.5;
    ctx.beginPath(); ctx.moveTo(box.x0, y); ctx.lineTo(box.x1, y); ctx.stroke();
    ctx.fillText(label, box.x0 - 7, y);
  }
  ctx.textAlign = "center"; ctx.textBaseline = "top";
  for (const [v, label] of xTicks) {
    const x = Math.round(toX(v)) + 0.5;
    ctx.beginPath(); ctx.moveTo(x, box.y0); ctx.lineTo(x, box.y1); ctx.stroke();
    if (label) ctx.fillText(label, x, box.y1 + 6);
  }
  ctx.strokeStyle = "#98a2b3";
  ctx.strokeRect(box.x0 + 0.5, box.y0 + 0.5, box.x1 - box.x0 - 1, box.y1 - box.y0 - 1);
}
