/* Hidden effects: both models beside the plant on the fresh record. */

const MODELS = [["refitted", "without the effect", PUBLISHED], ["improved", "with what was added", OURS]];
const STRETCH = 8;
const effectViews = [];

function showMotion(parent, run, view) {
  const t = run.traces;
  for (const [name, title] of [["q", "displacement <i>q</i>"], ["qd", "velocity <i>q̇</i>"]]) {
    const series = [{ name: "measured", values: t[name], color: OBSERVED, width: 4 }];
    for (const [id, label, color] of MODELS) series.push({ name: label, values: t[`${id}.${name}`], color, width: 1.5 });
    new TimeChart(parent, view, { title: `${title}, measured and predicted`, height: 150, series });
    const differences = MODELS.map(([id, label, color]) => ({ name: label, color, width: 1.2, values: mapped(t[name], (v, i) => v - t[`${id}.${name}`][i]) }));
    new TimeChart(parent, view, { title: `${title}, measured − predicted`, height: 120, series: differences });
  }
}

function showFreeRunError(parent, run, view) {
  const series = MODELS.map(([id, label, color]) => ({ name: label, values: run.traces[`${id}.error`], color, width: 1.7 }));
  new TimeChart(parent, view, { title: "free-run error in <i>q</i> over the last second ÷ std of <i>q</i>", height: 190, log: true, limits: [1e-9, 1e3], series });
}

async function showEffect(article) {
  const run = await loadRun(article.dataset.effect);
  const stretch = new View(run), whole = new View(run);
  stretch.range = [Math.max(0, run.end / 2 - STRETCH / 2), Math.min(run.end, run.end / 2 + STRETCH / 2)];
  showMotion(article.querySelector(".motion"), run, stretch);
  showFreeRunError(article.querySelector(".error"), run, whole);
  for (const view of [stretch, whole]) { effectViews.push(view); view.redraw(); }
}

document.querySelectorAll("[data-effect]").forEach(showEffect);
