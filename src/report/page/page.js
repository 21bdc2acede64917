"use strict";
// Draws `run`: the array, and charts of cells, FIFOs and rays on one axis of time.

const svg = (name, attributes, text) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
};

// White to the palette's blue.
const shade = (percent) => {
  const mix = (from, to) => Math.round(from + (to - from) * percent / 100);
  return `rgb(${mix(255, 0)},${mix(255, 114)},${mix(255, 178)})`;
};

function drawArray() {
  // Words that go to the left have a row of their own.
  const zs = run.fifos.filter((fifo) => fifo.name.startsWith("Z"));
  const step = 168, box = 84, top = 14, height = zs.length ? 140 : 96;
  const count = run.cells.length;
  const width = (count + 1) * step + box + 20;
  const drawing = svg("svg", { width, height: height + 28, viewBox: `0 0 ${width} ${height + 28}` });
  const x = (index) => 10 + (index + 1) * step;
  const drawBox = (left, fill, ink, lines, hint) => {
    const group = svg("g", {});
    group.append(svg("title", {}, hint));
    group.append(svg("rect", { x: left, y: top, width: box, height, rx: 8, fill, stroke: "#333" }));
    lines.forEach((line, row) => group.append(
      svg("text", { x: left + box / 2, y: top + 36 + 20 * row, "text-anchor": "middle", fill: ink }, line)));
    drawing.append(group);
  };
  const drawFifo = (fifo, link, y) => {
    const left = x(link) - (step - box) + 12, length = step - box - 24;
    const filled = (words) => length * words / fifo.capacity;
    const group = svg("g", {});
    group.append(svg("title", {}, `${fifo.name}: mean ${fifo.average.toFixed(2)}, at most ${fifo.most} of ` +
      `${fifo.capacity} words, full ${fifo.full_share.toFixed(1)} % of the time`));
    group.append(svg("line", { x1: left - 12, x2: left + length + 12, y1: y + 8, y2: y + 8, stroke: "#333" }));
    group.append(svg("rect", { x: left, y, width: length, height: 16, fill: "#fff", stroke: "#333" }));
    group.append(svg("rect", { x: left, y, width: filled(fifo.average), height: 16, fill: run.colors.range }));
    const peak = left + filled(fifo.most);
    group.append(svg("line", { x1: peak, x2: peak, y1: y - 3, y2: y + 19, stroke: run.colors.level, "stroke-width": 2 }));
    group.append(svg("text", { x: left, y: y - 6 }, fifo.name));
    if (fifo.full_share >= 0.05) {
      const share = `${fifo.full_share.toFixed(1)} %`;
      group.append(svg("text", { x: left + length, y: y - 6, "text-anchor": "end", fill: run.colors.full }, share));
    }
    drawing.append(group);
  };
  drawBox(10, "#fff", "#000", ["host", "rays"], "The host sends the rays");
  run.cells.forEach((cell, index) => {
    const ink = cell.works > 55 ? "#fff" : "#000";
    const name = cell.name === "intersection" ? "inters." : cell.name;
    drawBox(x(index), shade(cell.works), ink, [`cell ${index}`, name, `${cell.works.toFixed(1)} %`],
      `Cell ${index} ${cell.name} works ${cell.works.toFixed(1)} % of the time`);
  });
  drawBox(x(count), "#fff", "#000", ["host", "hits"], "The host reads the hits");
  const xs = run.fifos.slice(0, count), ys = run.fifos.slice(count, 2 * count);
  xs.forEach((fifo, index) => drawFifo(fifo, index, top + 22));
  ys.forEach((fifo, index) => drawFifo(fifo, index + 1, top + 66));
  zs.forEach((fifo) => drawFifo(fifo, Number(fifo.name.slice(1)) + 1, top + 110));
  document.getElementById("array").append(drawing);
}

function drawLegend() {
  const entries = run.states.map((state) => [state.name, state.color]).concat([
    ["FIFO: mean", run.colors.level], ["lowest to highest", run.colors.range], ["full", run.colors.full],
    ["rays done", run.colors.rays]]);
  for (const [name, color] of entries) {
    const entry = document.createElement("span"), square = document.createElement("i");
    square.style.background = color;
    entry.append(square, name);
    document.getElementById("legend").append(entry);
  }
}

const charts = [];
const times = run.times.concat([run.end]);
// A curve holds its value to the end of its bin; so does the last one.
const held = (values) => values.concat(values.slice(-1));
const stepped = uPlot.paths.stepped({ align: 1 });
const whole = { min: 0, max: run.end };
let moving = false;

function zoom(min, max) {
  const length = Math.min(max - min, run.end);
  const start = Math.max(0, Math.min(min, run.end - length));
  moving = true;
  for (const chart of charts) chart.setScale("x", { min: start, max: start + length });
  moving = false;
}

function addChart(title, data, series, options, describe) {
  const place = document.createElement("div"), name = document.createElement("b");
  const values = document.createElement("output");
  place.className = "chart";
  name.textContent = title;
  place.append(name, values);
  document.getElementById("charts").append(place);
  const axis = { font: "12px system-ui, sans-serif" };
  const chart = new uPlot({
    width: Math.min(1280, document.body.clientWidth) - 10,
    height: options.height + 16,
    padding: [18, 12, 0, 0],
    cursor: { sync: { key: "run", setSeries: false }, drag: { x: true, y: false }, points: { show: false } },
    legend: { show: false },
    scales: { x: { time: false }, y: { range: options.range } },
    axes: [
      { ...axis, label: options.last ? `simulated time (${run.unit})` : undefined, size: options.last ? 30 : 24,
        labelSize: 20, values: (chart, ticks) => ticks.map((tick) => `${+tick.toPrecision(8)}`) },
      { ...axis, size: 62, label: options.label, labelSize: 18 },
    ],
    series: [{}, ...series],
    bands: options.bands,
    hooks: {
      setScale: [(chart, key) => {
        if (key === "x" && !moving) zoom(chart.scales.x.min, chart.scales.x.max);
      }],
      setCursor: [(chart) => {
        const index = chart.cursor.idx;
        values.textContent = index == null ? "" :
          `${+times[index].toPrecision(6)} ${run.unit}: ${describe(Math.min(index, run.times.length - 1))}`;
      }],
      draw: options.draw ? [options.draw] : [],
    },
  }, [times, ...data], place);
  addMoves(chart);
  charts.push(chart);
}

// Wheel: zoom about the pointer. Shift and drag: move.
function addMoves(chart) {
  chart.over.addEventListener("wheel", (event) => {
    event.preventDefault();
    const at = chart.posToVal(event.offsetX, "x");
    const factor = event.deltaY < 0 ? 0.75 : 1 / 0.75;
    const { min, max } = chart.scales.x;
    zoom(at - (at - min) * factor, at + (max - at) * factor);
  }, { passive: false });
  chart.over.addEventListener("mousedown", (event) => {
    if (!event.shiftKey || event.button !== 0) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    const start = event.clientX, { min, max } = chart.scales.x;
    const perPixel = (max - min) / chart.over.clientWidth;
    const move = (event) => zoom(min - (event.clientX - start) * perPixel, max - (event.clientX - start) * perPixel);
    const stop = () => { removeEventListener("mousemove", move); removeEventListener("mouseup", stop); };
    addEventListener("mousemove", move);
    addEventListener("mouseup", stop);
  }, true);
}

function addCell(cell, index) {
  // From the highest band down, each over the one before it.
  const sums = [];
  cell.states.forEach((shares, state) => sums.push(shares.map((share, bin) => share + (state ? sums[state - 1][bin] : 0))));
  const order = run.states.map((_, state) => state).reverse();
  const series = order.map((state) => ({ fill: run.states[state].color, stroke: "transparent", width: 0, paths: stepped }));
  addChart(`cell ${index} ${cell.name}`, order.map((state) => held(sums[state])), series,
    { height: 120, range: [0, 100], label: "% of time" },
    (bin) => run.states.map((state, at) => [state.name, cell.states[at][bin]]).filter(([, share]) => share > 0)
      .map(([name, share]) => `${name} ${share.toFixed(1)} %`).join(", "));
}

function addFifo(fifo, last) {
  const shown = 3 * fifo.most >= fifo.capacity ? fifo.capacity : Math.max(fifo.most, 1);
  const series = [
    { stroke: run.colors.range, width: 1, paths: stepped }, { stroke: run.colors.range, width: 1, paths: stepped },
    { stroke: run.colors.level, width: 1.5, paths: stepped }];
  const markFull = (chart) => {
    const { ctx, bbox } = chart;
    ctx.save();
    ctx.fillStyle = run.colors.full;
    fifo.full.forEach((share, bin) => {
      if (share === 0) return;
      const from = Math.max(chart.valToPos(times[bin], "x", true), bbox.left);
      const to = Math.min(chart.valToPos(times[bin + 1], "x", true), bbox.left + bbox.width);
      if (to > from) ctx.fillRect(from, bbox.top, Math.max(to - from, 1), 6);
    });
    ctx.restore();
  };
  addChart(`FIFO ${fifo.name}, holds ${fifo.capacity}`, [held(fifo.max), held(fifo.min), held(fifo.mean)], series,
    { height: 110, range: [0, shown * 1.1], label: "words", last, draw: markFull,
      bands: [{ series: [1, 2], fill: run.colors.range }] },
    (bin) => `${fifo.min[bin]} to ${fifo.max[bin]} words, mean ${fifo.mean[bin]}, full ${fifo.full[bin]} %`);
}

drawArray();
drawLegend();
if (run.times.length > 0) {
  run.cells.forEach(addCell);
  addChart("rays done", [held(run.rays)], [{ stroke: run.colors.rays, fill: `${run.colors.rays}55`, width: 1, paths: stepped }],
    { height: 110, range: (chart, min, max) => [0, max * 1.1 || 1], label: `per ${run.unit}` }, (bin) => `${run.rays[bin]} rays per ${run.unit}`);
  run.fifos.forEach((fifo, index) => addFifo(fifo, index + 1 === run.fifos.length));
  zoom(whole.min, whole.max);
}
document.body.dataset.charts = charts.length;
