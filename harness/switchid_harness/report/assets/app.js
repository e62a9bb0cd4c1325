/* Choosing a run and showing it. */

const chooser = document.getElementById("chooser");
let zoom = null;

/* Every panel of a view, one below or beside the other in its place of the page. */
function fill(parent, run, panels, zoom) {
  parent.replaceChildren(...panels.map((panel) => {
    const place = document.createElement("div");
    place.className = "plot";
    show(place, () => resolved(panel, run.traces), zoom);
    return place;
  }));
}

async function showRun(id) {
  const run = await loadRun(id);
  zoom = new Zoom();
  const fragment = document.getElementById("fragment-" + id).content.cloneNode(true);
  document.getElementById("laws").replaceChildren(fragment.querySelector(".laws"));
  document.getElementById("figures").replaceChildren(fragment.querySelector(".figures"));
  for (const [name, panels] of Object.entries(run.views)) fill(document.getElementById(name), run, panels, zoom);
  chooser.value = id;
  document.querySelectorAll(".overview tbody tr").forEach((row) => row.classList.toggle("chosen", row.dataset.run === id));
  document.body.dataset.shown = id;
}

/* A hidden effect: both models beside the plant on the fresh record. */
async function showEffect(article) {
  const run = await loadRun(article.dataset.effect);
  for (const [name, panels] of Object.entries(run.views)) fill(article.querySelector("." + name), run, panels, new Zoom());
}

function choose(id, jump) {
  history.replaceState(null, "", "#" + id);
  showRun(id);
  if (jump) document.getElementById("run").scrollIntoView();
}

function turn(by) {
  const ids = [...chooser.options].map((option) => option.value);
  choose(ids[(ids.indexOf(chooser.value) + by + ids.length) % ids.length], false);
}

chooser.addEventListener("change", () => choose(chooser.value, false));
document.getElementById("previous").addEventListener("click", () => turn(-1));
document.getElementById("next").addEventListener("click", () => turn(1));
document.getElementById("whole").addEventListener("click", () => zoom && zoom.show("t, s", null, null));
document.querySelectorAll(".overview tbody tr").forEach((row) => {
  row.addEventListener("click", () => choose(row.dataset.run, true));
  row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(row.dataset.run, true); });
});
document.querySelectorAll("[data-effect]").forEach(showEffect);

const wanted = decodeURIComponent(location.hash.slice(1));
showRun([...chooser.options].some((option) => option.value === wanted) ? wanted : chooser.options[0].value);
