"use strict";
// The runs: asked for whenever something changes, told as they go, drawn when they are done.

const sideOf = (name) => {
  const place = document.getElementById(`side-${name}`);
  const part = (selector) => place.querySelector(selector);
  return {
    name, place, frame: part("iframe"), command: part("code"), failure: part(".failure"), notes: part(".notes"), growing: part(".growing"),
    parameters: new Map(), told: null, stop: null, isDue: false,
  };
};
const sides = { a: sideOf("a"), b: sideOf("b") };
const isPair = () => !sides.b.place.hidden;
const shownSides = () => isPair() ? [sides.a, sides.b] : [sides.a];
const active = () => sides[isPair() && document.querySelector("[name=which]:checked").value === "b" ? "b" : "a"];

// The whole of what is shown: the first run's parameters as the query, the second's behind a #.
const addressOf = () => `?${queryOf(sides.a.parameters)}${isPair() ? `#${queryOf(sides.b.parameters)}` : ""}`;

// Runs what has changed: at once, and what is under way is dropped. Several changes in one go are one.
function changed(side) {
  history.replaceState(null, "", addressOf());
  if (side.isDue) return;
  side.isDue = true;
  side.since = performance.now();
  setTimeout(() => { side.isDue = false; run(side); });
}

// The events of an answer, as they come.
async function* eventsOf(response) {
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    text += value;
    for (let end = text.indexOf("\n\n"); end >= 0; end = text.indexOf("\n\n")) {
      const lines = text.slice(0, end).split("\n");
      text = text.slice(end + 2);
      const of = (field) => lines.filter((line) => line.startsWith(`${field}: `)).map((line) => line.slice(field.length + 2)).join("\n");
      yield { name: of("event"), data: of("data") };
    }
  }
}

async function run(side) {
  side.stop?.abort();
  const stop = side.stop = new AbortController();
  showBusy();
  // What takes longer than a moment is seen to be under way.
  setTimeout(() => { if (side.stop === stop) showBar(null); }, 200);
  try {
    const path = document.getElementById("why").checked ? "why" : "run";
    const response = await fetch(`${path}?${queryOf(side.parameters)}`, { signal: stop.signal });
    if (!response.ok) return fail(side, await response.text());
    const parts = {};
    for await (const { name, data } of eventsOf(response)) {
      if (stop.signal.aborted) return;
      if (name === "progress") showProgress(side, JSON.parse(data));
      else if (name === "failed") return fail(side, data);
      else if (name === "done") await finish(side, JSON.parse(data), parts);
      else if (name === "looks") side.frame.contentWindow.showLooks(JSON.parse(data));
      else parts[name] = data;
    }
  } catch (error) {
    if (!stop.signal.aborted) fail(side, unanswered(error));
  } finally {
    if (side.stop === stop) side.stop = null;
    showBusy();
  }
}

// What there is to say where no answer comes.
const unanswered = ({ message }) => `error: the lab does not answer: ${message}`;

const isBusy = () => shownSides().some(({ stop, isDue }) => stop || isDue);

function showBusy() {
  const busy = isBusy();
  document.getElementById("stop").disabled = !busy;
  document.getElementById("panel-run").setAttribute("aria-busy", busy);
  if (!busy) document.getElementById("progress").hidden = true;
}

function stopAll() {
  const stopped = shownSides().filter(({ stop }) => stop);
  stopped.forEach(({ stop, growing }) => { stop.abort(); growing.hidden = true; });
  if (stopped.length) say("stopped");
}

const say = (text) => { document.getElementById("status").textContent = text; };

// How far a run is; null where nobody knows yet.
function showBar(share) {
  const bar = document.getElementById("progress");
  if (share === null && !bar.hidden) return;
  bar.hidden = false;
  if (share === null) bar.removeAttribute("value");
  else bar.value = share;
}

function showProgress(side, { rays, of, image }) {
  showBar(rays / of);
  side.growing.hidden = false;
  side.growing.querySelector("img").src = `data:image/png;base64,${image}`;
  side.growing.querySelector("figcaption").textContent = `${grouped(rays)} of ${grouped(of)} rays traced`;
  say(`Run ${side.name.toUpperCase()}: ${Math.floor(100 * rays / of)} % of the rays`);
}

// A run that failed leaves the last one to be seen, dimmed.
function fail(side, text) {
  side.failure.textContent = text.trimEnd();
  side.failure.hidden = false;
  side.growing.hidden = true;
  side.place.classList.add("old");
  say(`Run ${side.name.toUpperCase()} is refused or failed`);
}

// A frame that is ready to draw.
const ready = (frame) => new Promise((done) => {
  const look = () => frame.contentWindow?.openDoors ? done(frame.contentWindow) : setTimeout(look, 5);
  look();
});

async function finish(side, told, { text, figures }) {
  const view = await ready(side.frame);
  view.openDoors(queryOf(side.parameters));
  view.show(JSON.parse(figures), text);
  side.told = told;
  side.failure.hidden = true;
  side.growing.hidden = true;
  side.place.classList.remove("old");
  side.command.textContent = told.command;
  side.notes.hidden = told.notes.length === 0;
  side.notes.replaceChildren(...told.notes.map((note) => element("li", {}, note)));
  side.answered = performance.now() - side.since;
  if (side === active()) showControls();
  keep(side, told);
  align();
  say(`${isPair() ? `Run ${side.name.toUpperCase()}: ` : ""}${told.speed}. ${told.bottleneck}`);
  document.body.dataset.runs = Number(document.body.dataset.runs ?? 0) + 1;
  document.body.dataset.answered = Math.round(side.answered);
  if (isPair()) await compare();
}

// Both runs on one axis of time.
function align() {
  const views = shownSides().map(({ frame }) => frame.contentWindow).filter((view) => view?.secondsShown?.());
  const end = Math.max(...views.map((view) => view.secondsShown()));
  views.forEach((view) => view.extend(isPair() ? end : 0));
  views.forEach((view) => { view.onZoom = (min, max) => views.filter((other) => other !== view).forEach((other) => other.zoomSeconds(min, max)); });
}

async function compare() {
  const { a, b } = sides;
  if (!a.told || !b.told) return;
  const body = JSON.stringify({ a: a.told.stats, b: b.told.stats });
  const response = await fetch("compare", { method: "POST", headers: { "Content-Type": "application/json" }, body });
  document.getElementById("differences").textContent = await response.text();
}

// The last runs, the newest first.
const MOST_KEPT = 100;
function keep(side, told) {
  const query = queryOf(side.parameters), rows = document.querySelector("#last tbody");
  const button = (text, action) => {
    const made = element("button", { type: "button" }, text);
    made.addEventListener("click", action);
    return made;
  };
  const show = (name) => () => {
    sides[name].parameters = parametersOf(query);
    if (name === "b") showPair(true);
    choose("run");
    showControls();
    changed(sides[name]);
  };
  const took = `${told.took_ms < 10 ? told.took_ms.toFixed(1) : Math.round(told.took_ms)} ms${told.replayed ? ", replayed" : ""}`;
  const what = element("td", {}, told.title, element("br", {}), element("code", {}, told.command));
  rows.prepend(element("tr", {}, what, element("td", {}, told.speed.replace(/^simulated time /, "").replace(/ \(.*/, "")),
    element("td", {}, grouped(told.rays_per_second)), element("td", {}, took),
    element("td", {}, button("Show", show("a")), " ", button("Beside", show("b")))));
  while (rows.children.length > MOST_KEPT) rows.lastElementChild.remove();
}
