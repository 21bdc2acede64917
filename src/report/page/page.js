"use strict";
// Draws `run`, and keeps which cells have charts. A station is a cell, or the host behind the last one.

const MOST_ALL = 8;
const count = run.cells.length;
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
{% endif %}  }
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

// The station, the master, and the first and the last worker.
const telling = () => [...new Set([0, 1, 2, count - 1])];

{% endif %}function drawLegend() {
  const entries = run.states.map((state) => [state.name, state.color]).concat([
    {% if is_line %}["mean, rays", run.colors.amount], ["lowest to highest", run.colors.range], ["FIFO full", run.colors.full]]);{% else %}["{{ job }}s done", run.colors.amount]]);{% endif %}
  for (const [name, color] of entries) {
    const entry = document.createElement("span"), square = document.createElement("i");
    square.style.background = color;
    entry.append(square, name);
    document.getElementById("legend").append(entry);
  }
  const buttons = [["whole run", () => zoom(0, run.end)], ["{% if is_line %}busiest cells{% else %}some {{ station }}s{% endif %}", () => select(telling())], ["no {{ station }}s", () => select([])]];
  if (count <= 32) buttons.splice(1, 0, ["all {{ station }}s", () => select(all())]);
  for (const [name, action] of buttons) {
    const button = document.createElement("button");
    button.textContent = name;
    button.addEventListener("click", action);
    document.getElementById("legend").append(button);
  }
}

drawLegend();
if (run.bins > 0) {
  addRays();
  if (path) addPath();
  if (count > MOST_ALL) addOverviews();
  select(count > MOST_ALL ? telling() : all());
}
drawArray();
document.body.dataset.charts = charts.length;
let width = innerWidth;
addEventListener("resize", () => {
  if (width === innerWidth) return;
  width = innerWidth;
  drawArray();
  for (const { chart } of charts) chart.setSize({ width: chartWidth(), height: chart.height });
});
