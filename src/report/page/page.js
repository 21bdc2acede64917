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
    const reader = station < count ? `cell ${station}` : "the host";
    if (station < count) addCell(run.cells[station], station);
    if (station < count) addFifo(run.fifos[station], station, reader);
    if (station > 0) addFifo(run.fifos[count + station - 1], station, reader);
    const back = run.fifos.find(({ name }) => name === `Z${station}`);
    if (back) addFifo(back, station, reader);
  }
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

const all = () => Array.from({ length: count + 1 }, (_, station) => station);

// What limits the array, with its neighbours, and both ends.
function telling() {
  const busiest = run.cells.reduce((best, cell, index) => cell.works > run.cells[best].works ? index : best, 0);
  return [...new Set([0, Math.max(busiest - 1, 0), busiest, Math.min(busiest + 1, count - 1), count])].sort((a, b) => a - b);
}

function drawLegend() {
  const entries = run.states.map((state) => [state.name, state.color]).concat([
    ["mean, rays", run.colors.amount], ["lowest to highest", run.colors.range], ["FIFO full", run.colors.full]]);
  for (const [name, color] of entries) {
    const entry = document.createElement("span"), square = document.createElement("i");
    square.style.background = color;
    entry.append(square, name);
    document.getElementById("legend").append(entry);
  }
  const buttons = [["whole run", () => zoom(0, run.end)], ["busiest cells", () => select(telling())], ["no cells", () => select([])]];
  if (count <= 32) buttons.splice(1, 0, ["all cells", () => select(all())]);
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
