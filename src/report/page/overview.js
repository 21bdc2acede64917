"use strict";
// Many cells or FIFOs in one chart, a thin row each, drawn from a picture with a pixel for each bin.

const rgb = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));

// `paint(row, bin)` gives what fills the row there, from the ground up: [share of the height up to which, colour].
// `first` is the station of the first row.
function addOverview(title, rows, first, paint, describe) {
  const pixels = Math.max(2, Math.min(14, Math.floor(420 / rows)));
  // The lowest pixel of a row stays white, to keep rows apart that are high enough.
  const gap = pixels > 3 ? 1 : 0;
  const picture = new OffscreenCanvas(run.bins, rows * pixels);
  const context = picture.getContext("2d");
  const image = context.createImageData(run.bins, rows * pixels);
  for (let row = 0; row < rows; row++) {
    for (let bin = 0; bin < run.bins; bin++) {
      let level = 0;
      for (const [share, color] of paint(row, bin)) {
        const end = Math.round(Math.min(share, 1) * (pixels - gap));
        for (; level < end; level++) {
          const at = 4 * (((row + 1) * pixels - gap - 1 - level) * run.bins + bin);
          image.data.set(color, at);
          image.data[at + 3] = 255;
        }
      }
    }
  }
  context.putImageData(image, 0, 0);
  const draw = ({ ctx, bbox }) => {
    const from = view.min / run.bin, length = (view.max - view.min) / run.bin;
    ctx.save();
    ctx.imageSmoothingEnabled = false;
    // The last bin may be shorter than the others, and is drawn past the end of the run.
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    const scale = bbox.width / length;
    ctx.drawImage(picture, bbox.left - from * scale, bbox.top, run.bins * scale, bbox.height);
    ctx.restore();
  };
  let inside = false;
  const rowAt = (chart) => Math.max(0, Math.min(rows - 1, Math.floor(chart.posToVal(chart.cursor.top, "y"))));
  const chart = addChart(title, null, [times.map(() => null)], [{ show: false }],
    { height: Math.min(Math.max(rows * pixels, 160), 520) + 44, scale: { range: [0, rows], dir: -1 }, label: "{{ station }}", draw, into: "overview",
      axis: { values: (chart, ticks) => ticks.map((tick) => tick < rows ? `${first + tick < count ? first + tick : "host"}` : ""), incrs: [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024], grid: { show: false } } },
    (bin, chart) => inside ? describe(rowAt(chart), bin) : null);
  let down = null;
  chart.over.addEventListener("mouseenter", () => { inside = true; });
  chart.over.addEventListener("mouseleave", () => { inside = false; });
  chart.over.addEventListener("mousedown", (event) => { down = event.clientX; });
  chart.over.addEventListener("click", (event) => {
    if (Math.abs(event.clientX - down) < 4) toggle(first + rowAt(chart));
  });
}

function addPath() {
  const colors = run.states.map((state) => rgb(state.color));
  addOverview("where the critical path is, and why", count + 1, 0, (row, bin) => {
    let sum = 0;
    return path[row]().map((share, at) => [(sum += share[bin]) / 100, colors[at]]);
  }, (row, bin) => `${row < count ? `cell ${row}` : "the host"}: ${describePath(row, bin) ?? "not on the critical path"}`);
}

function addOverviews() {
  const count = run.cells.length;
  const colors = run.states.map((state) => rgb(state.color));
  addOverview("all {{ station }}s: a click on one shows or hides its charts", count, 0, (row, bin) => {
    let sum = 0;
    return run.cells[row].shares().map((share, at) => [(sum += share[bin]) / 100, colors[at]]);
  }, (row, bin) => `{% if is_line %}cell ${row}{% else %}${run.cells[row].name}{% endif %}: ${describeCell(run.cells[row], bin)}`);
{% if is_line %}  const [amount, range, full] = [run.colors.amount, run.colors.range, run.colors.full].map(rgb);
  for (const [channel, fifos, first] of [["X", run.fifos.slice(0, count), 0], ["Y", run.fifos.slice(count, 2 * count), 1]]) {
    const shown = levelShown(...["most", "capacity"].map((what) => Math.max(...fifos.map((fifo) => fifo[what]))));
    addOverview(`all FIFOs on ${channel}, each from 0 to ${shown} words`, count, first, (row, bin) => {
      const levels = fifos[row].levels();
      const mean = levels.mean[bin] / shown;
      if (levels.full[bin] > 0) return [[Math.min(mean, 0.8), amount], [0.8, range], [1, full]];
      return [[mean, amount], [levels.max[bin] / shown, range]];
    }, (row, bin) => `${fifos[row].name}: ${describeFifo(fifos[row], bin)}`);
  }
{% endif %}}
