"use strict";
// The page as a whole: what it begins with, its tabs, two runs beside one another, scenes dropped on it.

function choose(name) {
  for (const tab of document.querySelectorAll("[role=tab]")) {
    const isChosen = tab.id === `tab-${name}`;
    tab.setAttribute("aria-selected", isChosen);
    tab.tabIndex = isChosen ? 0 : -1;
    document.getElementById(tab.getAttribute("aria-controls")).hidden = !isChosen;
  }
  if (name === "sweep") drawCurve();
}

// Arrows move along the tabs.
document.querySelector("[role=tablist]").addEventListener("keydown", (event) => {
  const tabs = [...document.querySelectorAll("[role=tab]:enabled")], at = tabs.indexOf(document.activeElement);
  const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: tabs.length - 1 }[event.key];
  if (to === undefined || at < 0) return;
  event.preventDefault();
  const tab = tabs[(to + tabs.length) % tabs.length];
  tab.focus();
  choose(tab.id.slice(4));
});
document.querySelectorAll("[role=tab]").forEach((tab) => tab.addEventListener("click", () => choose(tab.id.slice(4))));

function showPair(isShown) {
  document.getElementById("beside").checked = isShown;
  sides.b.place.hidden = !isShown;
  document.getElementById("which").hidden = !isShown;
  document.getElementById("tab-differences").disabled = !isShown;
  document.getElementById("panel-run").classList.toggle("pair", isShown);
  if (!isShown) {
    sides.b.stop?.abort();
    if (document.getElementById("tab-differences").getAttribute("aria-selected") === "true") choose("run");
  }
}

document.getElementById("beside").addEventListener("change", ({ target }) => {
  showPair(target.checked);
  if (target.checked) {
    sides.b.parameters = new Map(sides.a.parameters);
    document.querySelector("[name=which][value=b]").checked = true;
    changed(sides.b);
  } else {
    history.replaceState(null, "", addressOf());
    align();
  }
  showControls();
  showBusy();
});
document.querySelectorAll("[name=which]").forEach((radio) => radio.addEventListener("change", showControls));
document.getElementById("same").addEventListener("click", () => {
  sides.b.parameters = new Map(sides.a.parameters);
  showControls();
  changed(sides.b);
});
document.getElementById("why").addEventListener("change", () => shownSides().forEach(changed));
document.getElementById("stop").addEventListener("click", stopAll);
document.getElementById("controls").addEventListener("submit", (event) => event.preventDefault());
// The address is that of the runs: what leads along the page leaves it as it is.
document.querySelector(".skip").addEventListener("click", (event) => {
  event.preventDefault();
  document.getElementById("panels").focus();
});

async function copy(text, what) {
  try {
    await navigator.clipboard.writeText(text);
    say(`copied ${what}`);
  } catch {
    say(text);
  }
}
for (const side of Object.values(sides)) {
  side.place.querySelector(".copy-command").addEventListener("click", () => copy(side.command.textContent, "the command"));
  side.place.querySelector(".copy-link").addEventListener("click", () => copy(`${location.origin}/?${queryOf(side.parameters)}`, "the link"));
}

// Takes a scene's files, and those that it names, for a run.
async function take(files, side) {
  if (!files.length) return say("What was dropped is no file");
  const names = files.map(({ name }) => name).join(", ");
  say(`reading ${names}`);
  try {
    const sent = await Promise.all(files.map(async (file) => ({ name: file.name, base64: await base64Of(file) })));
    const response = await fetch("scenes", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ files: sent }) });
    if (!response.ok) return fail(side, await response.text());
    const { scene } = await response.json();
    if (!shownSides().includes(side)) return say(`Run ${side.name.toUpperCase()} is closed, and has not taken ${names}`);
    ["size_factor", "resolution"].forEach((name) => side.parameters.delete(name));
    set("scene", scene, side);
  } catch (error) {
    fail(side, `error: the scene was not taken: ${error.message}`);
  }
}

const base64Of = (file) => new Promise((done, failed) => {
  const reader = new FileReader();
  reader.onload = () => done(reader.result.slice(reader.result.indexOf(",") + 1));
  reader.onerror = () => failed(new Error(`${file.name} cannot be read: ${reader.error.message}`));
  reader.readAsDataURL(file);
});

document.getElementById("files").addEventListener("change", ({ target }) => {
  take([...target.files], active());
  // The same file can be chosen again.
  target.value = "";
});

// Listens to a window, be it the page's or that of a run's frame: Escape stops what goes on, and files that are dropped are for a run.
function listen(place, sideOf) {
  const mark = (isDropping) => document.body.classList.toggle("dropping", isDropping);
  place.addEventListener("keydown", (event) => { if (event.key === "Escape") stopAll(); });
  place.addEventListener("dragover", (event) => { event.preventDefault(); mark(true); });
  place.addEventListener("dragleave", (event) => { if (!event.relatedTarget) mark(false); });
  place.addEventListener("drop", (event) => {
    event.preventDefault();
    mark(false);
    take([...event.dataTransfer.files], sideOf());
  });
}
listen(window, active);
Object.values(sides).forEach((side) => ready(side.frame).then((view) => listen(view, () => side)));

// What the address says.
function begin() {
  sides.a.parameters = parametersOf(location.search);
  const beside = location.hash.slice(1);
  showPair(location.href.includes("#"));
  if (isPair()) sides.b.parameters = parametersOf(beside);
  showControls();
  shownSides().forEach(changed);
}

fillSweep();
begin();
addEventListener("popstate", begin);
addEventListener("resize", () => { if (!document.getElementById("panel-sweep").hidden) drawCurve(); });
darkness.addEventListener("change", drawCurve);
