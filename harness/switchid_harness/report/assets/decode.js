"use strict";
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

/* Layout of the run and its traces by name. */
async function loadRun(id) {
  const meta = JSON.parse(document.getElementById("meta-" + id).textContent);
  const bytes = await inflate(document.getElementById("data-" + id).textContent.trim());
  const traces = {};
  meta.names.forEach((name, k) => { traces[name] = ungroup(bytes, 4 * k * meta.points, meta.points); });
  return { id, ...meta, traces };
}
