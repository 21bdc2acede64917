"use strict";
{% if is_line %}// The rays on their way: time across, the array down, a stair for each ray. It shows what of the view the page holds cycle by
// cycle; if the view is of something else, its first rays.

const FIRST_RAYS = 64;

function addSpaceTime() {
  // From the host as it sends, over the cells, to the host as it reads.
  const lanes = count + 2;
  const pixels = Math.max(3, Math.min(40, Math.floor(720 / lanes)));
  // Low lanes are all station's: there is no room for what is in between.
  const station = pixels < 6 ? 1 : Math.floor(0.4 * pixels) / pixels;
  const nameOfLane = (lane) => lane === 0 ? "host" : lane <= count ? `${lane - 1}` : "host";
  const stationOf = (lane) => lane === 0 || lane > count ? null : lane - 1;
  const { until: back } = tape.answers();
  const firstRays = { min: tape.from * run.cycle, max: (back[FIRST_RAYS - 1] ?? tape.until) * run.cycle };
  const held = { min: tape.from * run.cycle, max: tape.until * run.cycle };
  const range = (view) => {
    const part = { min: Math.max(view.min, held.min), max: Math.min(view.max, held.max) };
    const isIn = part.max > part.min && view.max - view.min <= 1.000001 * (held.max - held.min);
    return isIn ? part : firstRays;
  };
  const draw = (chart) => {
    const { ctx, bbox } = chart, { min, max } = chart.scales.x;
    const from = min / run.cycle, until = max / run.cycle;
    const x = (cycle) => bbox.left + (cycle - from) / (until - from) * bbox.width;
    const lane = bbox.height / lanes;
    const y = (depth) => bbox.top + depth * lane;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    const colors = { works: seen(run.colors.range), moves: seen(run.colors.range), waits: seen(run.colors.waits), blocked: seen(run.colors.full) };
    const bar = (index, start, end, color) => {
      const left = Math.round(x(start)), right = Math.max(Math.round(x(end)), left);
      const top = Math.round(y(index));
      ctx.fillStyle = color;
      if (right > left) ctx.fillRect(left, top, right - left, Math.max(Math.round(station * lane), 1));
    };
    for (let index = 0; index <= count + 1; index++) {
      if (index > count) {
        const { from: starts, until: ends } = tape.answers();
        for (let at = Math.max(0, lastUpTo(starts, from)); at < starts.length && starts[at] < until; at++) bar(index, starts[at], ends[at], colors.works);
        continue;
      }
      const record = recordOf(stationOf(index));
      if (record) drawStation(index, record, [from, until], (state) => colors[state.kind], bar);
    }
    ctx.lineWidth = Math.min(devicePixelRatio, 1.25);
    for (const [group, color] of [["X", seen(run.colors.amount)], ["Y", seen(run.colors.answer)]]) {
      ctx.strokeStyle = color;
      ctx.beginPath();
      for (let index = 0; index <= count; index++) {
        const reader = stationOf(index + 1);
        const fifo = tape.fifos.find((fifo) => fifo.group === group && fifo.to === reader);
        if (fifo) drawPassages(ctx, { fifo, index, reader, view: [from, until], x, y });
      }
      ctx.stroke();
    }
    ctx.restore();
  };
  // What it is at while it has a ray. Neighbours that look alike are one bar.
  const drawStation = (index, record, [from, until], colorOf, bar) => {
    const { state, from: starts } = record.states(), jobs = record.jobs();
    let job = Math.max(0, lastUpTo(jobs.from, from)), open = null;
    const close = () => { if (open) bar(index, open.from, open.until, open.color); };
    for (let at = Math.max(0, lastUpTo(starts, from)); at < starts.length && starts[at] < until; at++) {
      while (job < jobs.from.length && jobs.until[job] <= starts[at]) job++;
      const color = job < jobs.from.length && jobs.from[job] <= starts[at] && colorOf(tape.states[state[at]]);
      const end = at + 1 < starts.length ? starts[at + 1] : tape.until;
      if (open && open.color === color && open.until === starts[at]) {
        open.until = end;
      } else {
        close();
        open = color ? { from: starts[at], until: end, color } : null;
      }
    }
    close();
  };
  // A ray's words go into a FIFO as its first one is written, and out of it as the reader begins with the ray, or, where it has
  // begun before, with the last. In the lane of the writer they come from where they went in.
  const passages = tape.fifos.map((fifo) => memo(() => {
    const jobs = fifo.jobs(), begun = new Map();
    const reader = fifo.to === null ? tape.answers() : recordOf(fifo.to).jobs();
    reader.job.forEach((job, at) => begun.set(job, reader.from[at]));
    const out = jobs.job.map((job, at) => {
      const start = begun.get(job);
      return start !== undefined && start >= jobs.from[at] ? start : jobs.until[at] - 1;
    });
    return { job: jobs.job, in: jobs.from, out };
  }));
  const next = (index, group) => {
    const reader = stationOf(index + 2);
    const at = index < count ? tape.fifos.findIndex((fifo) => fifo.group === group && fifo.to === reader) : -1;
    return at < 0 ? null : memo(() => new Map(passages[at]().job.map((job, place) => [job, passages[at]().in[place]])));
  };
  const onward = new Map(["X", "Y"].map((group) => [group, Array.from({ length: count + 1 }, (_, index) => next(index, group))]));
  const drawPassages = (ctx, { fifo, index, view: [from, until], x, y }) => {
    const found = passages[tape.fifos.indexOf(fifo)](), after = onward.get(fifo.group)[index]?.();
    for (let at = 0; at < found.job.length && found.in[at] < until; at++) {
      const leaves = after?.get(found.job[at]) ?? found.out[at];
      if (Math.max(found.out[at], leaves) < from) continue;
      ctx.moveTo(x(found.in[at]), y(index + station));
      ctx.lineTo(x(found.out[at]), y(index + 1));
      if (after?.has(found.job[at]) || index === count) ctx.lineTo(x(leaves), y(index + 1 + station));
    }
  };
  addRows("the rays on their way", { rows: lanes, pixels, draw, range, name: nameOfLane, into: "space-time", station: stationOf });
}

{% endif %}
