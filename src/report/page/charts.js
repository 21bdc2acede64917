"use strict";
// Charts of cells, FIFOs and rays on one axis of time, which they show the same part of.

const decode = (text, Type) => new Type(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
// Shares of each bin in percent, from hundredths; null stands for none.
const shares = (text) => text === null ? new Float32Array(run.bins) : Float32Array.from(decode(text, Uint16Array), (part) => part / 100);

// Where the bins begin, and the end of the last.
let times = [];
// A curve holds its value to the end of its bin; so does the last one.
const held = (values) => [...values, values[values.length - 1]];
const stepped = uPlot.paths.stepped({ align: 1 });
// The cycle under a chart's cursor, and its bin; null where there is none.
const cycleAt = (chart) => {
  if (chart.cursor.left == null || chart.cursor.left < 0) return null;
  return Math.max(0, Math.min(Math.floor(chart.posToVal(chart.cursor.left, "x") / run.cycle), run.cycles - 1));
};
const binAt = (chart) => {
  const cycle = cycleAt(chart);
  return cycle === null ? null : Math.max(0, Math.min(Math.floor(cycle * run.cycle / run.bin + 1e-9), run.bins - 1));
};

const charts = [];
// What is shown of the run.
let view = { min: 0, max: 0 };

// Makes the run's figures ready to be drawn.
function loadCharts() {
  times = Array.from({ length: run.bins }, (_, bin) => bin * run.bin).concat([run.end]);
  axisEnd = run.end;
  view = { min: 0, max: axisEnd };
  run.cells.forEach((cell) => { cell.shares = memo(() => cell.states.map(shares)); });
  run.fifos.forEach((fifo) => {
    fifo.levels = memo(() => ({
      min: decode(fifo.min, Float32Array), mean: decode(fifo.mean, Float32Array), max: decode(fifo.max, Float32Array),
      full: shares(fifo.full),
    }));
  });
  path = run.path?.map((place) => memo(() => place.map(shares)));
  deepest = Math.max(1, ...run.fifos.map(({ capacity, most }) => capacity ?? most));
}

// How far the axis of time goes: to the end of the run, or beyond, beside one that takes longer.
let axisEnd = 0;

// Shows a part of the run in all charts, and where another run is beside it, there too.
function zoom(min, max) {
  zoomHere(min, max);
  if (globalThis.onZoom) onZoom(seconds(view.min), seconds(view.max));
}

function zoomHere(min, max) {
  const length = Math.min(Math.max(max - min, run.end * 1e-9, run.cycle), axisEnd);
  const start = Math.max(0, Math.min(min, axisEnd - length));
  view = { min: start, max: start + length };
  for (const { chart, range } of charts) chart.setScale("x", range(view));
  if (stepper) markMoment(stepper.cycle);
  tellWindow();
}

// The same in seconds, for those who show another run.
function zoomSeconds(min, max) {
  zoomHere(min / secondsOfUnit(), max / secondsOfUnit());
}

function zoomedTo() {
  return [seconds(view.min), seconds(view.max)];
}

// How long the run is, in seconds; nothing where none is shown.
function secondsShown() {
  return run && seconds(run.end);
}

// Lets the axis go on to a time in seconds, if the run ends before.
function extend(end) {
  const isWhole = view.max - view.min > 0.999 * axisEnd;
  axisEnd = Math.max(run.end, end / secondsOfUnit());
  if (isWhole) zoomHere(0, axisEnd);
}

// Zooms about a place, which stays where it is.
const zoomAbout = (at, factor) => zoom(at - (at - view.min) * factor, at + (view.max - at) * factor);

// Which part of the run is on screen, and what makes a page of just that.
function tellWindow() {
  const from = Math.max(0, Math.floor(view.min / run.cycle + 1e-6));
  const until = Math.min(run.cycles, Math.ceil(view.max / run.cycle - 1e-6));
  document.getElementById("from").textContent = grouped(from);
  document.getElementById("until").textContent = grouped(until);
  document.getElementById("window").textContent = `--trace-window ${from}..${until}`;
}

// A time as the axis tells it: in a unit that suits what is on screen, and in cycles.
const UNITS = [["s", 1], ["ms", 1e-3], ["µs", 1e-6], ["ns", 1e-9]];
const secondsOfUnit = () => Object.fromEntries(UNITS)[run.unit];
const seconds = (time) => time * secondsOfUnit();
function inBoth(tick, { min, max }) {
  const [name, unit] = UNITS.find(([, unit]) => seconds(max - min) >= 0.5 * unit) ?? UNITS[3];
  return `${+(seconds(tick) / unit).toPrecision(8)} ${name}\n${grouped(tick / run.cycle)} cycles`;
}

// Pixels that such a text takes at the most, so that none runs into the next.
const labelWidth = () => Math.max(104, 7 * `${grouped(run.cycles)} cycles`.length);

let paperWidth = null;
const chartWidth = () => paperWidth ?? document.getElementById("charts").clientWidth;

// Height of all that is not the drawing itself: the title above, two lines of axis below.
const AROUND = 20 + 40;

// A chart in a place of its own. `describe` tells what there is in a bin; `stationAt` whose moment is under the cursor.
function addChart(title, station, data, series, options, describe) {
  const stationAt = options.stationAt ?? (() => station === null ? undefined : station < count ? station : null);
  const range = options.range ?? ((view) => view);
  const values = element("output", { "aria-live": "off" });
  const place = element("div", { class: "chart", tabindex: 0, role: "group", "aria-label": title }, element("b", {}, title), values);
  if (station !== null) {
    place.dataset.station = station;
    place.addEventListener("mouseenter", () => point(station));
    place.addEventListener("mouseleave", () => point(null));
  }
  document.getElementById(options.into ?? "charts").append(place);
  const axis = {
    font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif", stroke: () => ground("ink"),
    grid: { stroke: () => ground("grid"), width: 1 }, ticks: { stroke: () => ground("grid"), width: 1, size: 5 },
  };
  const chart = new uPlot({
    width: chartWidth(),
    height: options.height,
    padding: [20, 40, 0, 0],
    cursor: { sync: { key: "run", setSeries: false }, drag: { x: true, y: false }, points: { show: false } },
    legend: { show: false },
    scales: { x: { time: false, range: (chart, min, max) => [min, max] }, y: options.scale },
    axes: [
      { ...axis, size: 40, space: labelWidth, values: (chart, ticks) => ticks.map((tick) => inBoth(tick, chart.scales.x)) },
      { ...axis, size: 58, label: options.label, labelSize: 18, ...options.axis },
    ],
    series: [{}, ...series.map((one) => ({ ...one, points: { show: false } }))],
    bands: options.bands,
    hooks: {
      // A stretch that was dragged over: no other chart shows it yet.
      setScale: [(chart, key) => {
        const { min, max } = chart.scales.x, told = range(view), near = (a, b) => Math.abs(a - b) <= 1e-9 * run.end;
        if (key === "x" && charts.some((other) => other.chart === chart) && !(near(min, told.min) && near(max, told.max))) zoom(min, max);
      }],
      setCursor: [(chart) => {
        const bin = binAt(chart), text = bin === null ? null : describe(bin, chart);
        const time = bin === null ? "" : `${+times[bin].toPrecision(6)} ${run.unit}`;
        values.textContent = text ? `${time}: ${text}` : text === null ? "" : time;
        if (pointed === chart) tell(bin === null ? undefined : stationAt(chart), cycleAt(chart));
      }],
      draw: options.draw ? [options.draw] : [],
    },
  }, [times, ...data], place);
  addMoves(chart);
  addKeys(chart, place, options.rows ?? 1);
  charts.push({ chart, place, station, range, describe: () => values.textContent });
  return chart;
}

// The chart that the pointer is in, or the keyboard.
let pointed = null;

// Wheel with Ctrl: zoom about the pointer; without, the page scrolls. Shift and drag: move.
function addMoves(chart) {
  chart.over.addEventListener("mouseenter", () => { pointed = chart; });
  chart.over.addEventListener("mouseleave", () => { pointed = null; hush(); });
  chart.over.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    zoomAbout(chart.posToVal(event.offsetX, "x"), event.deltaY < 0 ? 0.75 : 1 / 0.75);
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
  chart.over.addEventListener("dblclick", () => zoom(0, axisEnd));
  // A click that is no drag chooses the moment.
  let down = null;
  chart.over.addEventListener("mousedown", ({ clientX }) => { down = clientX; });
  chart.over.addEventListener("click", ({ clientX }) => { if (Math.abs(clientX - down) < 4) chooseMoment(chart); });
}

// Takes the stepper to the cycle under a chart's cursor.
function chooseMoment(chart) {
  const cycle = cycleAt(chart);
  if (stepper && cycle !== null) stepper.seek(`${cycle}`);
}

// A chart that has the focus: arrows move its cursor, with Shift by one pixel; + and - zoom about it; A and D move along the
// run; 0 shows all of it.
function addKeys(chart, place, rows) {
  const width = () => chart.over.clientWidth, height = () => chart.over.clientHeight;
  const at = () => ({ left: chart.cursor.left >= 0 ? chart.cursor.left : width() / 2, top: chart.cursor.top >= 0 ? chart.cursor.top : height() / rows / 2 });
  const go = (across, down) => {
    pointed = chart;
    const { left, top } = at();
    const row = Math.max(0, Math.min(rows - 1, Math.floor(top / (height() / rows)) + down));
    chart.setCursor({ left: Math.max(0, Math.min(left + across, width() - 1)), top: (row + 0.5) * height() / rows });
  };
  const middle = () => chart.posToVal(at().left, "x");
  const along = (share) => zoom(view.min + share * (view.max - view.min), view.max + share * (view.max - view.min));
  place.addEventListener("focus", () => { pointed = chart; });
  place.addEventListener("blur", () => { pointed = null; chart.setCursor({ left: -10, top: -10 }); hush(); });
  place.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target !== place) return;
    const step = event.shiftKey ? 1 : 16;
    const action = {
      ArrowLeft: () => go(-step, 0), ArrowRight: () => go(step, 0),
      ArrowUp: rows > 1 && (() => go(0, -1)), ArrowDown: rows > 1 && (() => go(0, 1)),
      Enter: () => chooseMoment(chart),
      "+": () => zoomAbout(middle(), 0.75), "=": () => zoomAbout(middle(), 0.75), "-": () => zoomAbout(middle(), 1 / 0.75),
      a: () => along(-0.25), d: () => along(0.25), 0: () => zoom(0, axisEnd),
    }[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}

const describeCell = (cell, bin) => run.states.map((state, at) => [state.name, cell.shares()[at][bin]])
  .filter(([, share]) => share > 0).map(([name, share]) => `${name} ${share.toFixed(1)} %`).join(", ");

function describeFifo(fifo, bin) {
  const { min, mean, max, full } = fifo.levels();
  return `${min[bin]} to ${max[bin]} {{ word }}s, mean ${figure(mean[bin])}, full ${full[bin].toFixed(1)} %`;
}

// For each cell, and the host behind them, the critical path's share of each bin by state.
let path;
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
  const series = order.map((state) => ({ fill: () => seen(run.states[state].color), stroke: "transparent", width: 0, paths: stepped }));
  addChart(`{% if is_line %}cell ${index} {% endif %}${cell.name}`, index, order.map((state) => held(sums[state])), series,
    { height: 146, scale: { range: [0, path ? 110 : 100] }, label: "% of time",
      draw: path && ((chart) => mark(chart, ground("ink"), (bin) => Math.min(onPath(index, bin) / 100, 1))) },
    (bin) => [describeCell(cell, bin), path && describePath(index, bin)].filter(Boolean).join("; "));
}

// All FIFOs have one scale, so that they compare: from 0 to what the deepest holds, or held if it takes all.
let deepest = 1;

function addFifo(fifo, station, reader) {
  const { min, mean, max, full } = fifo.levels();
  const [amount, range] = [run.colors.amount, run.colors.range].map((color) => () => seen(color));
  const series = [
    { stroke: range, width: 1, paths: stepped }, { stroke: range, width: 1, paths: stepped },
    { stroke: amount, width: 1.5, paths: stepped }];
  const draw = (chart) => {
    mark(chart, seen(run.colors.full), (bin) => full[bin] > 0 ? 1 : 0);
    if (fifo.capacity === null) return;
    const { ctx, bbox } = chart;
    ctx.save();
    const capacity = chart.valToPos(fifo.capacity, "y", true);
    ctx.strokeStyle = ground("line");
    ctx.setLineDash([6, 4]);
    ctx.beginPath();
    ctx.moveTo(bbox.left, capacity);
    ctx.lineTo(bbox.left + bbox.width, capacity);
    ctx.stroke();
    ctx.restore();
  };
  addChart({% if is_line %}`FIFO ${fifo.name} into ${reader}, holds ${fifo.capacity}`{% else %}`${fifo.name}${fifo.capacity === null ? "" : `, holds ${fifo.capacity}`}`{% endif %}, station, [held(max), held(min), held(mean)], series,
    { height: 132, scale: { range: [0, deepest * 1.12] }, label: "{{ word }}s", draw,
      bands: [{ series: [1, 2], fill: range }] }, (bin) => describeFifo(fifo, bin));
}

function addRays() {
  const rays = decode(run.rays, Float32Array);
  addChart("{{ job }}s done", null, [held(rays)],
    [{ stroke: () => seen(run.colors.amount), fill: () => seen(run.colors.range), width: 1, paths: stepped }],
    { height: 146, scale: { range: (chart, min, max) => [0, max * 1.1 || 1] }, label: `per ${run.unit}`, into: "overview" },
    (bin) => `${figure(rays[bin])} {{ job }}s per ${run.unit}`);
}
