"use strict";
// Draws a run, and keeps which cells have charts. A station is a cell, or the host behind the last one.

const MOST_ALL = 8;
// The run that is shown, and how many cells it has.
let run = null, count = 0;
// What a {{ station }} is called in a sentence, and where there is little room.
const fullName = (index) => {% if is_line %}`cell ${index}`{% else %}run.cells[index].name{% endif %};
const shortName = (index) => {% if is_line %}`${index}`{% else %}/\d+$/.exec(run.cells[index].name)?.[0] ?? run.cells[index].name.slice(0, 4){% endif %};
const selected = new Set();

function toggle(station) {
  if (!selected.delete(station)) selected.add(station);
  showSelected();
}

// Brings the charts up to those that are selected, in the order of the array.
function showSelected() {
  for (let at = charts.length - 1; at >= 0; at--) {
    const { chart, place, station } = charts[at];
    if (station === null || selected.has(station)) continue;
    chart.destroy();
    place.remove();
    charts.splice(at, 1);
  }
  const drawn = new Set(charts.map(({ station }) => station));
  for (const station of [...selected].filter((station) => !drawn.has(station))) {
{% if is_line %}    const reader = station < count ? `cell ${station}` : "the host";
    if (station < count) addCell(run.cells[station], station);
    if (station < count) addFifo(run.fifos[station], station, reader);
    if (station > 0) addFifo(run.fifos[count + station - 1], station, reader);
    const back = run.fifos.find(({ name }) => name === `Z${station}`);
    if (back) addFifo(back, station, reader);
{% else %}    addCell(run.cells[station], station);
{% if is_cube %}    if (run.fifos[station]) addFifo(run.fifos[station], station);
{% endif %}{% endif %}  }
  const place = document.getElementById("charts");
  place.append(...[...place.children].sort((a, b) => a.dataset.station - b.dataset.station));
  markSelected();
  zoom(view.min, view.max);
  document.body.dataset.charts = charts.length;
}

function select(stations) {
  selected.clear();
  stations.forEach((station) => selected.add(station));
  showSelected();
}

{% if is_line %}const all = () => Array.from({ length: count + 1 }, (_, station) => station);

// What limits the array, with its neighbours, and both ends.
function telling() {
  const busiest = run.cells.reduce((best, cell, index) => cell.works > run.cells[best].works ? index : best, 0);
  return [...new Set([0, Math.max(busiest - 1, 0), busiest, Math.min(busiest + 1, count - 1), count])].sort((a, b) => a - b);
}

{% else %}const all = () => run.cells.map((_, task) => task);

{% if is_cube %}// The nodes that work most and least, and the one with the longest queue.
function telling() {
  const nodes = run.cells.map((_, node) => node).slice(0, -1);
  const first = (better) => nodes.reduce((best, node) => better(node, best) ? node : best, 0);
  const works = (node) => run.cells[node].works, longest = (node) => run.fifos[node]?.most ?? 0;
  return [...new Set([first((a, b) => works(a) > works(b)), first((a, b) => works(a) < works(b)), first((a, b) => longest(a) > longest(b))])];
}
{% else %}// The station, the master, and the first and the last worker.
const telling = () => [...new Set([0, 1, 2, count - 1])];
{% endif %}

{% endif %}function drawLegend() {
  const entries = run.states.map((state) => [state.name, seen(state.color)]).concat([
    {% if is_line %}["mean, rays", seen(run.colors.amount)], ["lowest to highest", seen(run.colors.range)], ["FIFO full", seen(run.colors.full)]]);{% else %}["{{ job }}s done", seen(run.colors.amount)]]);{% endif %}
{% if is_cube %}  if (run.fifos.length) entries.push(["{{ fifo }}: mean", seen(run.colors.amount)], ["lowest to highest", seen(run.colors.range)], ["full", seen(run.colors.full)]);
{% endif %}  // Many FIFOs are drawn by how full they are.
  if (run.fifos.length && count * LOWEST_BARS > 420) SHADES.forEach(([name], at) => entries.push([`{{ fifo }} ${name}`, shadeOf(at)]));
  drawEntries("legend", entries);
{% if is_line %}  drawEntries("ways", [["ray on X", seen(run.colors.amount)], ["its words on Y", seen(run.colors.answer)], ["works on a ray", seen(run.colors.range)],
    ["waits for words", seen(run.colors.waits)], ["blocked", seen(run.colors.full)]]);
{% endif %}  document.getElementById("scale").style.background = `linear-gradient(to right, ${shade(0)}, ${shade(100)})`;
}

function drawEntries(id, entries) {
  const place = document.getElementById(id);
  place?.replaceChildren(...entries.map(([name, color]) => {
    const square = element("i", {});
    square.style.background = color;
    return element("span", {}, square, name);
  }));
}

function drawButtons() {
  const buttons = [["whole run", () => zoom(0, axisEnd)], ["{% if is_line %}busiest cells{% else %}some {{ station }}s{% endif %}", () => select(telling())], ["no {{ station }}s", () => select([])]];
  if (count <= 32) buttons.splice(1, 0, ["all {{ station }}s", () => select(all())]);
  if (tape) buttons.splice(1, 0, ["cycles held one by one", () => zoom(tape.from * run.cycle, tape.until * run.cycle)]);
  for (const [name, action] of buttons) {
    const button = element("button", { type: "button" }, name);
    button.addEventListener("click", action);
    document.getElementById("buttons").append(button);
  }
}

// All in the colours of the ground that the page has now.
function repaint() {
  drawLegend();
  drawArray();
  for (const { chart } of charts) chart.redraw(true, true);
  stepper?.draw();
}

// Charts and array as wide as there is room, on the screen or on paper.
function resize() {
  drawArray();
  for (const { chart } of charts) chart.setSize({ width: chartWidth(), height: chart.height });
}

function print(isPrinting) {
  printing = isPrinting;
  paperWidth = isPrinting ? PAPER : null;
  resize();
  repaint();
}

// Width of what a sheet of A4 has room for, in CSS pixels.
const PAPER = 700;

// Shows a run; in place of another with its text too: the same stretch of it, and charts of the same cells.
function show(next, text = null) {
  const before = run && { end: seconds(run.end), cells: count, view: { min: seconds(view.min), max: seconds(view.max) }, selected: [...selected] };
  const scrolled = scrollY;
  hush();
  charts.splice(0).forEach(({ chart }) => chart.destroy());
  if (text !== null) document.getElementById("run").innerHTML = text;
  run = next;
  count = run.cells.length;
  loadTape();
  loadCharts();
  selected.clear();
  drawLegend();
  drawButtons();
  if (run.bins > 0) {
{% if is_line %}    if (tape && tape.until > tape.from) addSpaceTime();
{% endif %}    addRays();
    if (path) addPath();
    if (count > MOST_ALL) addOverviews();
    select(before?.cells === count ? before.selected : count > MOST_ALL ? telling() : all());
    const isPart = before && before.view.max - before.view.min < 0.999 * before.end;
    if (isPart) zoom(...[before.view.min, before.view.max].map((time) => time / secondsOfUnit()));
  }
  drawArray();
  tellWindow();
{% if is_line %}  startStepper();
{% endif %}  document.body.dataset.charts = charts.length;
  if (before) scrollTo(0, scrolled);
}

let width = innerWidth;
addEventListener("resize", () => {
  if (width === innerWidth || !run) return;
  width = innerWidth;
  resize();
});
darkness.addEventListener("change", () => { if (run) repaint(); });
addEventListener("beforeprint", () => { if (run) print(true); });
addEventListener("afterprint", () => { if (run) print(false); });
