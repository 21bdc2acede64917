"use strict";
// Charts of cells, FIFOs and rays on one axis of time, which they show the same part of.

const decode = (text, Type) => new Type(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
// Shares of each bin in percent, from hundredths; null stands for none.
const shares = (text) => text === null ? new Float32Array(run.bins) : Float32Array.from(decode(text, Uint16Array), (part) => part / 100);
const memo = (make) => { let made; return () => made ??= make(); };

const times = Array.from({ length: run.bins }, (_, bin) => bin * run.bin).concat([run.end]);
// A curve holds its value to the end of its bin; so does the last one.
const held = (values) => [...values, values[values.length - 1]];
const stepped = uPlot.paths.stepped({ align: 1 });
const binAt = (chart) => chart.cursor.idx == null ? null : Math.min(chart.cursor.idx, run.bins - 1);
const figure = (value) => `${+value.toPrecision(4)}`;

run.cells.forEach((cell) => { cell.shares = memo(() => cell.states.map(shares)); });
run.fifos.forEach((fifo) => {
  fifo.levels = memo(() => ({
    min: decode(fifo.min, Float32Array), mean: decode(fifo.mean, Float32Array), max: decode(fifo.max, Float32Array),
    full: shares(fifo.full),
  }));
});

const charts = [];
let view = { min: 0, max: run.end };
let moving = false;

// Shows a part of the run in all charts.
function zoom(min, max) {
  const length = Math.min(Math.max(max - min, run.end * 1e-9), run.end);
  const start = Math.max(0, Math.min(min, run.end - length));
  view = { min: start, max: start + length };
  moving = true;
  for (const { chart } of charts) chart.setScale("x", view);
  moving = false;
}

const chartWidth = () => document.getElementById("charts").clientWidth;

// A chart in a place of its own. `describe` tells what there is in a bin.
function addChart(title, station, data, series, options, describe) {
  const place = document.createElement("div"), name = document.createElement("b");
  const values = document.createElement("output");
  place.className = "chart";
  if (station !== null) {
    place.dataset.station = station;
    place.addEventListener("mouseenter", () => point(station));
    place.addEventListener("mouseleave", () => point(null));
  }
  name.textContent = title;
  place.append(name, values);
  document.getElementById(options.into ?? "charts").append(place);
  const axis = { font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif" };
  const chart = new uPlot({
    width: chartWidth(),
    height: options.height,
    padding: [20, 14, 0, 0],
    cursor: { sync: { key: "run", setSeries: false }, drag: { x: true, y: false }, points: { show: false } },
    legend: { show: false },
    scales: { x: { time: false, range: (chart, min, max) => [min, max] }, y: options.scale },
    axes: [
      { ...axis, size: 24, values: (chart, ticks) => ticks.map((tick) => `${+tick.toPrecision(8)} ${run.unit}`) },
      { ...axis, size: 58, label: options.label, labelSize: 18, ...options.axis },
    ],
    series: [{}, ...series.map((one) => ({ ...one, points: { show: false } }))],
    bands: options.bands,
    hooks: {
      setScale: [(chart, key) => {
        if (key === "x" && !moving) zoom(chart.scales.x.min, chart.scales.x.max);
      }],
      setCursor: [(chart) => {
        const bin = binAt(chart), text = bin === null ? null : describe(bin, chart);
        values.textContent = text === null ? "" : `${+times[bin].toPrecision(6)} ${run.unit}: ${text}`;
      }],
      draw: options.draw ? [options.draw] : [],
    },
  }, [times, ...data], place);
  addMoves(chart);
  charts.push({ chart, place, station });
  return chart;
}

// Wheel: zoom about the pointer. Shift and drag: move.
function addMoves(chart) {
  chart.over.addEventListener("wheel", (event) => {
    event.preventDefault();
    const at = chart.posToVal(event.offsetX, "x");
    const factor = event.deltaY < 0 ? 0.75 : 1 / 0.75;
    zoom(at - (at - view.min) * factor, at + (view.max - at) * factor);
  }, { passive: false });
  chart.over.addEventListener("mousedown", (event) => {
    if (!event.shiftKey || event.button !== 0) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    const start = event.clientX, { min, max } = view;
    const perPixel = (max - min) / chart.over.clientWidth;
    const move = (event) => zoom(min - (event.clientX - start) * perPixel, max - (event.clientX - start) * perPixel);
    const stop = () => { removeEventListener("mousemove", move); removeEventListener("mouseup", stop); };
    addEventListener("mousemove", move);
    addEventListener("mouseup", stop);
  }, true);
}

const describeCell = (cell, bin) => run.states.map((state, at) => [state.name, cell.shares()[at][bin]])
  .filter(([, share]) => share > 0).map(([name, share]) => `${name} ${share.toFixed(1)} %`).join(", ");

function describeFifo(fifo, bin) {
  const { min, mean, max, full } = fifo.levels();
  return `${min[bin]} to ${max[bin]} words, mean ${figure(mean[bin])}, full ${full[bin].toFixed(1)} %`;
}

// For each cell, and the host behind them, the critical path's share of each bin by state.
const path = run.path?.map((place) => memo(() => place.map(shares)));
const onPath = (place, bin) => path[place]().reduce((sum, part) => sum + part[bin], 0);

function describePath(place, bin) {
  const parts = run.states.map((state, at) => [state.name, path[place]()[at][bin]]).filter(([, share]) => share > 0);
  return parts.length === 0 ? null : `critical path ${parts.map(([name, share]) => `${name} ${share.toFixed(1)} %`).join(", ")}`;
}

// Marks the bins in which something is, the stronger the larger its share.
function mark(chart, color, strength) {
  const { ctx, bbox } = chart;
  ctx.save();
  ctx.fillStyle = color;
  for (let bin = 0; bin < run.bins; bin++) {
    const from = Math.max(chart.valToPos(times[bin], "x", true), bbox.left);
    const to = Math.min(chart.valToPos(times[bin + 1], "x", true), bbox.left + bbox.width);
    ctx.globalAlpha = to > from ? strength(bin) : 0;
    if (ctx.globalAlpha > 0) ctx.fillRect(from, bbox.top, Math.max(to - from, 1), 6 * devicePixelRatio);
  }
  ctx.restore();
}

function addCell(cell, index) {
  // From the highest band down, each over the one before it.
  const sums = [];
  cell.shares().forEach((part, state) => sums.push(part.map((share, bin) => share + (state ? sums[state - 1][bin] : 0))));
  const order = run.states.map((_, state) => state).reverse();
  const series = order.map((state) => ({ fill: run.states[state].color, stroke: "transparent", width: 0, paths: stepped }));
  addChart(`{% if is_line %}cell ${index} {% endif %}${cell.name}`, index, order.map((state) => held(sums[state])), series,
    { height: 130, scale: { range: [0, path ? 110 : 100] }, label: "% of time",
      draw: path && ((chart) => mark(chart, "#000", (bin) => Math.min(onPath(index, bin) / 100, 1))) },
    (bin) => [describeCell(cell, bin), path && describePath(index, bin)].filter(Boolean).join("; "));
}

// The level that fills a chart: the capacity belongs into it unless it would press the curve to the ground.
const levelShown = (most, capacity) => 3 * most >= capacity ? capacity : Math.max(most, 1);

function addFifo(fifo, station, reader) {
  const { min, mean, max, full } = fifo.levels();
  const series = [
    { stroke: run.colors.range, width: 1, paths: stepped }, { stroke: run.colors.range, width: 1, paths: stepped },
    { stroke: run.colors.amount, width: 1.5, paths: stepped }];
  const draw = (chart) => {
    mark(chart, run.colors.full, (bin) => full[bin] > 0 ? 1 : 0);
    const { ctx, bbox } = chart;
    ctx.save();
    const capacity = chart.valToPos(fifo.capacity, "y", true);
    if (capacity >= bbox.top) {
      ctx.setLineDash([6, 4]);
      ctx.beginPath();
      ctx.moveTo(bbox.left, capacity);
      ctx.lineTo(bbox.left + bbox.width, capacity);
      ctx.stroke();
    }
    ctx.restore();
  };
  addChart(`FIFO ${fifo.name} into ${reader}, holds ${fifo.capacity}`, station, [held(max), held(min), held(mean)], series,
    { height: 116, scale: { range: [0, levelShown(fifo.most, fifo.capacity) * 1.12] }, label: "words", draw,
      bands: [{ series: [1, 2], fill: run.colors.range }] }, (bin) => describeFifo(fifo, bin));
}

function addRays() {
  const rays = decode(run.rays, Float32Array);
  addChart("{{ job }}s done", null, [held(rays)],
    [{ stroke: run.colors.amount, fill: run.colors.range, width: 1, paths: stepped }],
    { height: 130, scale: { range: (chart, min, max) => [0, max * 1.1 || 1] }, label: `per ${run.unit}`, into: "overview" },
    (bin) => `${figure(rays[bin])} {{ job }}s per ${run.unit}`);
}
