"use strict";
// Many cells or FIFOs in one chart, a row each.

// A chart of rows, which are all as high: whole pixels, so that none looks unlike the others.
function addRows(title, { rows, pixels, draw, range, name, station, into, describe }) {
  let inside = false;
  const rowAt = (chart) => Math.max(0, Math.min(rows - 1, Math.floor(chart.posToVal(chart.cursor.top, "y"))));
  const chart = addChart(title, null, [times.map(() => null)], [{ show: false }], {
    height: rows * pixels + AROUND, scale: { range: [0, rows], dir: -1 }, label: "{{ station }}", draw, range, rows,
    into: into ?? "overview",
    stationAt: (chart) => station(rowAt(chart)),
    axis: {
      values: (chart, ticks) => ticks.map((tick) => tick < rows ? name(tick) : ""), incrs: [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024],
      grid: { show: false }, space: 18,
    },
  }, (bin, chart) => inside || pointed === chart ? describe?.(rowAt(chart), bin) ?? "" : null);
  let down = null;
  chart.over.addEventListener("mouseenter", () => { inside = true; });
  chart.over.addEventListener("mouseleave", () => { inside = false; });
  chart.over.addEventListener("mousedown", (event) => { down = event.clientX; });
  chart.over.addEventListener("click", (event) => {
    if (Math.abs(event.clientX - down) >= 4) return;
    const clicked = station(rowAt(chart));
    if (clicked === undefined) return;
    // Where the steps are at hand a click is about the moment.
    if (into === "space-time" && stepper) stepper.choose(clicked ?? stepper.station);
    else toggle(clicked === null ? count : clicked);
  });
}

// Rows lower than this are of one colour at a time: of what takes most of it.
const LOWEST_BARS = 8;

// `thin` says what these colours tell. `paint(row, from, until)` gives what is in some bins of a row: [share of the height, colour], from the ground up; the colours
// are the legend's, and none is mixed.
function addOverview(title, rows, paint, options) {
  const pixels = rows * LOWEST_BARS <= 420 ? Math.min(14, Math.floor(420 / rows)) : Math.max(1, Math.min(LOWEST_BARS - 1, Math.floor(768 / rows)));
  const isThin = pixels < LOWEST_BARS;
  const gap = isThin ? 0 : 1;
  const pictures = new Map();
  // A picture with a pixel for so many bins: never more than there are on the screen, of which then none would be left out.
  const pictureOf = (step) => {
    const key = `${step} ${isDark()}`;
    if (!pictures.has(key)) pictures.set(key, painted(step));
    return pictures.get(key);
  };
  const painted = (step) => {
    const columns = Math.ceil(run.bins / step), picture = new OffscreenCanvas(columns, rows * pixels);
    const context = picture.getContext("2d"), image = context.createImageData(columns, rows * pixels);
    const fill = (row, column, from, until, color) => {
      for (let level = from; level < until; level++) {
        const at = 4 * (((row + 1) * pixels - gap - 1 - level) * columns + column);
        image.data.set(color, at);
        image.data[at + 3] = 255;
      }
    };
    const height = pixels - gap;
    for (let row = 0; row < rows; row++) {
      for (let column = 0; column < columns; column++) {
        const parts = paint(row, column * step, Math.min((column + 1) * step, run.bins), isThin);
        if (isThin) {
          const most = parts.reduce((best, part) => part[0] > best[0] ? part : best, [0, null]);
          if (most[1]) fill(row, column, 0, height, most[1]);
          continue;
        }
        let level = 0, sum = 0;
        for (const [share, color] of parts) {
          sum += share;
          const end = Math.round(Math.min(sum, 1) * height);
          if (end > level) fill(row, column, level, end, color);
          level = Math.max(level, end);
        }
      }
    }
    context.putImageData(image, 0, 0);
    return picture;
  };
  const draw = ({ ctx, bbox }) => {
    const from = view.min / run.bin, length = (view.max - view.min) / run.bin;
    const step = 2 ** Math.max(0, Math.ceil(Math.log2(length / bbox.width)));
    ctx.save();
    // Nothing shows through where a row is empty.
    ctx.fillStyle = ground("ground");
    ctx.fillRect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.imageSmoothingEnabled = false;
    // The last bin may be shorter than the others, and is drawn past the end of the run.
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    const scale = bbox.width / length, picture = pictureOf(step);
    ctx.drawImage(picture, bbox.left - from * scale, bbox.top, picture.width * step * scale, bbox.height);
    ctx.restore();
  };
  addRows(title + (isThin ? `, ${options.thin}` : ""), { rows, pixels, draw, ...options });
}

// The mean of some bins.
function mean(values, from, until) {
  let sum = 0;
  for (let bin = from; bin < until; bin++) sum += values[bin];
  return sum / (until - from);
}

const stateColors = () => run.states.map((state) => rgb(seen(state.color)));
const statesOf = (shares, from, until, colors) => shares.map((share, at) => [mean(share, from, until) / 100, colors[at]]);

function addPath() {
  const where = (row) => row < count ? fullName(row) : "the host";
  addOverview("where the critical path is, and why", path.length, (row, from, until) => statesOf(path[row](), from, until, stateColors()), {
    thin: "each in the colour of what takes most of it",
    name: (row) => row < count ? shortName(row) : "host",
    station: (row) => row < count ? row : null,
    describe: (row, bin) => `${where(row)}: ${describePath(row, bin) ?? "not on the critical path"}`,
  });
}

// How full a thin row's FIFOs are, in steps.
const SHADES = [["empty", 0], ["to ¼", 0.25], ["to ½", 0.5], ["to ¾", 0.75], ["more", 1]];
const shadeOf = (at) => mixed(ground("ground"), seen(run.colors.amount), at / 4);

function addOverviews() {
  addOverview("all {{ station }}s: a click on one shows or hides its charts", count, (row, from, until) => statesOf(run.cells[row].shares(), from, until, stateColors()), {
    thin: "each in the colour of what takes most of the time",
    name: shortName,
    station: (row) => row,
    describe: (row, bin) => `${fullName(row)}: ${describeCell(run.cells[row], bin)}`,
  });
{% if is_line %}  for (const [channel, fifos, first] of [["X", run.fifos.slice(0, count), 0], ["Y", run.fifos.slice(count, 2 * count), 1]]) {
    const reader = (row) => first + row < count ? first + row : null;
    addLevels(`all FIFOs on ${channel}`, fifos, (row) => `${reader(row) ?? "host"}`, reader);
  }
{% else %}  if (run.fifos.length) addLevels("all {{ fifo }}s", run.fifos, shortName, (row) => row);
{% endif %}}

// What FIFOs hold, a row for each.
function addLevels(title, fifos, name, station) {
  const inRgb = (color) => color.match(/\d+/g).map(Number);
  addOverview(`${title}, each from 0 to ${deepest} {{ word }}s`, fifos.length, (row, from, until, isThin) => {
    const [amount, range, full] = [run.colors.amount, run.colors.range, run.colors.full].map((color) => rgb(seen(color)));
    const levels = fifos[row].levels();
    const held = mean(levels.mean, from, until) / deepest, isFull = mean(levels.full, from, until) > 0;
    if (isThin) return [[1, isFull ? full : inRgb(shadeOf(SHADES.findIndex(([, most]) => held <= most + 1e-9)))]];
    let most = 0;
    for (let bin = from; bin < until; bin++) most = Math.max(most, levels.max[bin]);
    if (isFull) return [[Math.min(held, 0.8), amount], [0.8 - Math.min(held, 0.8), range], [0.2, full]];
    return [[held, amount], [Math.max(most / deepest - held, 0), range]];
  }, {
    thin: "each in the colour of its mean, or of one that was full",
    name,
    station,
    describe: (row, bin) => `${fifos[row].name}: ${describeFifo(fifos[row], bin)}`,
  });
}
