"use strict";
{% if is_line %}// Draws the array as it is: the host, the cells, the FIFOs between them. A click on a cell shows or hides its charts.
{% else %}// Draws the {{ station }}s{% if has_buses %}, and the buses that join them{% elif is_cube %}, and the links between them{% endif %}. A click on a {{ station }} shows or hides its chart.
{% endif %}
const svg = (name, attributes, text) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
};

// From the page's ground to the colour of amounts, and what is written on it.
const shade = (percent) => mixed(ground("ground"), seen(run.colors.amount), percent / 100);
const inkOn = (percent) => percent > (isDark() ? 65 : 50) ? ground("ground") : ground("ink");

// A key that presses a button.
function onPress(event, action) {
  if (event.key !== "Enter" && event.key !== " ") return;
  event.preventDefault();
  action();
}

// Sizes in pixels: for a few cells, and for many.
const LARGE = { box: 76, height: 92, link: 72, row: 122, bar: 15, x: 30, y: 72, z: 108, font: 13 };
const SMALL = { box: 32, height: 36, link: 26, row: 50, bar: 8, x: 8, y: 24, z: 38, font: 11 };

{% if is_line %}// What stands in the row: the host as sender, the cells, the host as receiver. FIFOs lead into each but the first.
function drawArray() {
  const place = document.getElementById("array");
  const count = run.cells.length;
  // Words that go to the left have a row of their own.
  const zs = run.fifos.slice(2 * count);
  const plain = count <= 24 ? LARGE : SMALL, more = zs.length ? plain.z - plain.y : 0;
  const size = { ...plain, height: plain.height + more, row: plain.row + more };
  const step = size.box + size.link;
  const across = Math.max(2, Math.min(Math.floor(((paperWidth ?? place.clientWidth) - 8) / step), count + 2));
  const lines = Math.ceil((count + 2) / across);
  const drawing = svg("svg", { width: across * step + 4, height: lines * size.row + 4 });
  const left = (at) => (at % across) * step + size.link;
  const top = (at) => Math.floor(at / across) * size.row + (size.row - size.height) / 2;
  const drawFifo = (fifo, at, y) => {
    const from = left(at) - size.link + 4, length = size.link - 8, middle = top(at) + y;
    const filled = (words) => length * Math.min(words / fifo.capacity, 1);
    const group = svg("g", {});
    group.append(svg("title", {}, `${fifo.name}: mean ${fifo.average.toFixed(2)}, at most ${fifo.most} of ` +
      `${fifo.capacity} words, full ${fifo.full_share.toFixed(1)} % of the time`));
    group.append(svg("line", { x1: from - 4, x2: from + length + 4, y1: middle, y2: middle, stroke: ground("line") }));
    const bar = { y: middle - size.bar / 2, height: size.bar };
    group.append(svg("rect", { ...bar, x: from, width: length, fill: ground("ground"), stroke: ground("line") }));
    group.append(svg("rect", { ...bar, x: from, width: filled(fifo.most), fill: seen(run.colors.range) }));
    group.append(svg("rect", { ...bar, x: from, width: filled(fifo.average), fill: seen(run.colors.amount) }));
    const isFull = fifo.full_share >= 0.05;
    if (isFull) group.append(svg("rect", { ...bar, x: from + length - 3, width: 3, fill: seen(run.colors.full) }));
    if (plain === LARGE) {
      group.append(svg("text", { x: from, y: middle - size.bar / 2 - 4, fill: ground("ink") }, fifo.name));
      if (isFull) group.append(svg("text", { x: from + length, y: middle - size.bar / 2 - 4, "text-anchor": "end",
        fill: seen(run.colors.full) }, fifo.full_share < 1 ? "< 1 %" : `${Math.round(fifo.full_share)} %`));
    }
    drawing.append(group);
  };
  const drawBox = (at, fill, ink, lines, hint, station) => {
    const group = svg("g", station === null ? {} : { class: "station", "data-station": station, tabindex: 0, role: "button", "aria-label": hint });
    group.append(svg("title", {}, hint));
    group.append(svg("rect", { x: left(at), y: top(at), width: size.box, height: size.height, rx: 5, fill, stroke: ground("line") }));
    const spacing = size.font + 6;
    const first = top(at) + size.height / 2 - spacing * (lines.length - 1) / 2 + size.font / 3;
    lines.forEach((line, row) => group.append(
      svg("text", { x: left(at) + size.box / 2, y: first + spacing * row, "text-anchor": "middle", fill: ink }, line)));
    if (station !== null) {
      group.addEventListener("click", () => toggle(station));
      group.addEventListener("keydown", (event) => { onPress(event, () => toggle(station)); });
      group.addEventListener("mouseenter", () => point(station));
      group.addEventListener("mouseleave", () => point(null));
    }
    drawing.append(group);
  };
  for (let at = 1; at <= count + 1; at++) {
    if (at <= count) drawFifo(run.fifos[at - 1], at, size.x);
    if (at > 1) drawFifo(run.fifos[count + at - 2], at, size.y);
  }
  zs.forEach((fifo) => drawFifo(fifo, Number(fifo.name.slice(1)) + 2, size.z));
  const host = (what) => plain === LARGE ? ["host", what] : ["host"];
  drawBox(0, ground("ground"), ground("ink"), host("rays"), "The host sends the rays", null);
  run.cells.forEach((cell, index) => {
    const name = cell.name === "intersection" ? "inters." : cell.name;
    const lines = plain === LARGE ? [`cell ${index}`, name, `${cell.works.toFixed(1)} %`] : [`${index}`];
    drawBox(index + 1, shade(cell.works), inkOn(cell.works), lines.filter((line) => line !== ""),
      `Cell ${index} ${cell.name} works ${cell.works.toFixed(1)} % of the time`, index);
  });
  drawBox(count + 1, ground("ground"), ground("ink"), host("hits"), "The host reads the hits", count);
  place.replaceChildren(drawing);
  markSelected();
}

{% else %}// A station's box.
function stationBox(index, left, top, size) {
  const cell = run.cells[index];
  const group = svg("g", { class: "station", "data-station": index, tabindex: 0, role: "button", "aria-label": `${cell.name} works ${cell.works.toFixed(1)} % of the time` });
  group.append(svg("title", {}, `${cell.name} works ${cell.works.toFixed(1)} % of the time`));
  const box = { width: size.box, height: size.height, rx: 5, fill: shade(cell.works), stroke: ground("line") };
  group.append(svg("rect", { x: left, y: top, ...box }));
  const lines = size.font === LARGE.font ? [cell.name, `${cell.works.toFixed(1)} %`] : [shortName(index)];
  const middle = top + size.height / 2 + size.font / 3, ink = inkOn(cell.works);
  lines.forEach((line, row) => group.append(svg("text", { x: left + size.box / 2, "text-anchor": "middle", fill: ink,
    y: middle + (size.font + 6) * (row - (lines.length - 1) / 2) }, line)));
  group.addEventListener("click", () => toggle(index));
  group.addEventListener("keydown", (event) => { onPress(event, () => toggle(index)); });
  group.addEventListener("mouseenter", () => point(index));
  group.addEventListener("mouseleave", () => point(null));
  return group;
}

{% if is_cube %}// Places of nodes, in units of a node: of its bits each second one leads to the right, the others down, each past all that those
// before it span, and a gap more. The host is to the left of node 0.
const GAP = 0.6;
// How far links are drawn aside, as a part of their length; they get half as far.
const BEND = 0.24;
const PLACE_OF_HOST = [-1.4, 0];
function placeOf(node) {
  const along = (first) => {
    let at = 0, span = 1;
    for (let bit = first, step = 0; node >> bit > 0; bit += 2, step++) {
      const over = span + GAP * step;
      if (node >> bit & 1) at += over;
      span += over;
    }
    return at;
  };
  return [along(0), along(1)];
}

// The nodes as nested squares, and their links, the stronger the more of the time they are busy, by the root.
function drawArray() {
  const place = document.getElementById("array");
  const nodes = count - 1, isLarge = nodes <= 16;
  const size = isLarge ? LARGE : { ...SMALL, box: 30, height: 30 };
  const unit = (isLarge ? 1.55 : 1.7) * size.box;
  const ends = Array.from({ length: nodes }, (_, node) => placeOf(node));
  // Places without a node pass messages on.
  const routers = [...new Set(run.links.flatMap(({ from, to }) => [from, to]).filter((end) => end >= nodes))];
  const far = [0, 1].map((axis) => Math.max(...ends.concat(routers.map(placeOf)).map((end) => end[axis])));
  // Room for the links that bend out farthest.
  const longest = Math.max(0, ...run.links.filter(({ from, to }) => from !== null && to !== null).map(({ from, to }) => {
    const [[x, y], [toX, toY]] = [placeOf(from), placeOf(to)];
    return Math.hypot(toX - x, toY - y);
  }));
  const edge = Math.max(0.2, BEND / 2 * longest - 0.2) * unit;
  const left = ([x]) => (x - PLACE_OF_HOST[0]) * unit + 4, top = ([, y]) => y * unit + edge;
  const middle = (end) => {
    const corner = end === null ? PLACE_OF_HOST : placeOf(end);
    return [left(corner) + size.box / 2, top(corner) + size.height / 2];
  };
  const drawing = svg("svg", { width: left([far[0]]) + size.box + edge, height: top([0, far[1]]) + size.height + edge });
  const most = Math.max(...run.links.map(({ busy }) => busy), 1e-9);
  const nameOfEnd = (end) => end === null ? "the host" : end < nodes ? `node ${end}` : `place ${end}`;
  for (const { from, to, busy, messages, bytes, waited } of [...run.links].sort((a, b) => a.busy - b.busy)) {
    const [[x, y], [toX, toY]] = [middle(from), middle(to)];
    // Bent to the left, so that both directions lie side by side.
    const bent = [(x + toX) / 2 + BEND * (toY - y), (y + toY) / 2 - BEND * (toX - x)];
    const line = svg("path", { class: "link", d: `M ${x} ${y} Q ${bent[0]} ${bent[1]} ${toX} ${toY}`, fill: "none",
      stroke: mixed(ground("ground"), seen(run.colors.answer), Math.sqrt(busy / most)), "stroke-width": isLarge ? 3 : 2 });
    line.append(svg("title", {}, `${nameOfEnd(from)} to ${nameOfEnd(to)}: ${grouped(messages)} messages, ${grouped(bytes)} bytes, ` +
      `busy ${busy.toPrecision(3)} % of the time, waited for ${figure(waited)} ${run.unit}`));
    drawing.append(line);
  }
  for (const router of routers) {
    const [x, y] = middle(router);
    drawing.append(svg("circle", { cx: x, cy: y, r: 4, fill: ground("ground"), stroke: ground("line") }));
  }
  run.cells.forEach((_, index) => {
    const corner = index === nodes ? PLACE_OF_HOST : ends[index];
    drawing.append(stationBox(index, left(corner), top(corner), size));
  });
  place.replaceChildren(drawing);
  markSelected();
}

{% else %}// The {{ station }}s in rows{% if has_buses %}, each on the buses below it{% endif %}.
function drawArray() {
  const place = document.getElementById("array");
  const count = run.cells.length;
  const size = count <= 24 ? LARGE : SMALL;
  const step = size.box + 12, buses = {% if has_buses %}3 * run.buses.length{% else %}-12{% endif %};
  const across = Math.max(1, Math.min(Math.floor(((paperWidth ?? place.clientWidth) - 8) / step), count));
  const height = size.height + 16 + buses;
  const drawing = svg("svg", { width: across * step + 4, height: Math.ceil(count / across) * height + 4 });
  run.cells.forEach((cell, index) => {
    const left = (index % across) * step + 2, top = Math.floor(index / across) * height + 2;
    const group = stationBox(index, left, top, size);
{% if has_buses %}    const stem = left + size.box / 2, foot = top + size.height;
    drawing.append(svg("line", { x1: stem, x2: stem, y1: foot, y2: foot + 4 + buses, stroke: ground("line") }), group);
    run.buses.forEach((busy, bus) => {
      const y = foot + 6 + 3 * bus;
      const line = svg("line", { x1: left, x2: left + step, y1: y, y2: y, stroke: seen(run.colors.amount), "stroke-width": 2 });
      line.append(svg("title", {}, `bus ${bus + 1} carries messages for ${busy.toFixed(1)} % of the time`));
      drawing.append(line);
    });
{% else %}    drawing.append(group);
{% endif %}  });
  place.replaceChildren(drawing);
  markSelected();
}

{% endif %}{% endif %}function markSelected() {
  for (const group of document.querySelectorAll(".station")) {
    const isSelected = selected.has(Number(group.dataset.station));
    group.classList.toggle("selected", isSelected);
    group.setAttribute("aria-pressed", isSelected);
  }
}

// Marks a cell, and the charts of it.
function point(station) {
  for (const element of document.querySelectorAll("[data-station]")) {
    element.classList.toggle("pointed", element.dataset.station === String(station));
  }
}
