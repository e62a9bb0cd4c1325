/* Traces of a run: one zlib stream of float32, bytes grouped by significance within each trace. */

async function inflate(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function ungroup(bytes, offset, points) {
  const out = new Uint8Array(points * 4);
  for (let plane = 0; plane < 4; plane++) {
    for (let i = 0; i < points; i++) out[4 * i + plane] = bytes[offset + plane * points + i];
  }
  return new Float32Array(out.buffer);
}

/* Views of the run and its traces by name. */
async function loadRun(id) {
  const meta = JSON.parse(document.getElementById("meta-" + id).textContent);
  const bytes = await inflate(document.getElementById("data-" + id).textContent.trim());
  const traces = {};
  meta.names.forEach((name, k) => { traces[name] = ungroup(bytes, 4 * k * meta.points, meta.points); });
  return { id, ...meta, traces };
}

const known = (value) => (Number.isFinite(value) ? value : null);

/* Points of a line as the description has them, where they are named traces. */
function pointsOf(points, traces) {
  if (Array.isArray(points)) return points;
  const x = traces[points.x], y = traces[points.y], all = [];
  for (let i = points.from ?? 0; i < (points.to ?? x.length); i++) all.push([x[i], known(y[i])]);
  return all;
}

function edgesOf({ x, y, half, factor }, traces) {
  const [at, middle, std] = [x, y, half].map((name) => traces[name]);
  return Array.from(at, (t, i) => [t, known(middle[i] - factor * std[i]), known(middle[i] + factor * std[i])]);
}

/* A panel with its points in place of the names of their traces. */
function resolved(panel, traces) {
  const layers = panel.layers.map((layer) => {
    const [[kind, content]] = Object.entries(layer);
    if (kind === "area") return { area: { ...content, edges: edgesOf(content.edges, traces) } };
    return content.points ? { [kind]: { ...content, points: pointsOf(content.points, traces) } } : layer;
  });
  return { ...panel, layers };
}
