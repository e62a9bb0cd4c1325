/* Choosing a run and showing it. */

const chooser = document.getElementById("chooser");
let view = null;
let shown = null;

async function show(id) {
  const run = await loadRun(id);
  shown = run;
  view = new View(run);
  const fragment = document.getElementById("fragment-" + id).content.cloneNode(true);
  section("laws").append(fragment.querySelector(".laws"));
  section("figures").append(fragment.querySelector(".figures"));
  showState(run, view);
  showPrediction(run, view);
  showPortraits(run);
  showCoefficients(run, view);
  showError(run, view);
  showDeviation(run, view);
  view.redraw();
  chooser.value = id;
  document.querySelectorAll(".overview tbody tr").forEach((row) => row.classList.toggle("chosen", row.dataset.run === id));
  document.body.dataset.shown = id;
}

function choose(id, jump) {
  history.replaceState(null, "", "#" + id);
  show(id);
  if (jump) document.getElementById("run").scrollIntoView();
}

function turn(by) {
  const ids = [...chooser.options].map((option) => option.value);
  choose(ids[(ids.indexOf(chooser.value) + by + ids.length) % ids.length], false);
}

chooser.addEventListener("change", () => choose(chooser.value, false));
document.getElementById("previous").addEventListener("click", () => turn(-1));
document.getElementById("next").addEventListener("click", () => turn(1));
document.getElementById("whole").addEventListener("click", () => view && view.whole());
document.querySelectorAll(".overview tbody tr").forEach((row) => {
  row.addEventListener("click", () => choose(row.dataset.run, true));
  row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(row.dataset.run, true); });
});
const everyView = () => (view ? [view, ...effectViews] : effectViews);
window.addEventListener("scroll", () => everyView().forEach((each) => each.schedule()), { passive: true });
window.addEventListener("resize", () => { if (shown) showPortraits(shown); everyView().forEach((each) => each.redraw()); });

const wanted = decodeURIComponent(location.hash.slice(1));
show([...chooser.options].some((option) => option.value === wanted) ? wanted : chooser.options[0].value);
window.addEventListener("beforeprint", () => everyView().forEach((each) => each.charts.forEach((chart) => chart.draw())));
