"use strict";
{% if is_line %}// What single rays come to: the walk through the scene, seen from the side, and the instructions that cells execute for a ray.

// What becomes of a candidate, in the order of its codes: in words, and the colour's name.
const SAID = [["had before", "line"], ["stopped", "line"], ["dropped by its slabs", "slabs"], ["missed", "missed"], ["hit behind", "behind"], ["nearest by then", "hit"]];
const SAID_COLORS = { voxel: ["#4477aa", "#7aa6d8"], slabs: ["#0072b2", "#56b4e9"], missed: ["#777777", "#a0a0a8"], behind: ["#e69f00", "#e69f00"], hit: ["#d55e00", "#ff8a3d"], line: ["#bbbbbb", "#555560"] };

const bits = new DataView(new ArrayBuffer(4));
const floatOf = (word) => { bits.setUint32(0, word); return bits.getFloat32(0); };

// A ray's way as the run holds it: for each group the voxels, and in each the candidates.
function lookOf({ look, polygons }) {
  const groups = look.groups.map((text, group) => {
    const numbers = unpack(text), size = run.looks.volumes[group].size, voxels = [];
    for (let at = 0, number = 0; at < numbers.length;) {
      number += unfolded(numbers[at++]);
      const place = [number % size[0], Math.floor(number / size[0]) % size[1], Math.floor(number / (size[0] * size[1]))];
      const tests = Array.from({ length: numbers[at++] }, () => {
        const polygon = numbers[at++], said = numbers[at++];
        return { polygon, said, t: said > 3 ? floatOf(numbers[at++]) : null };
      });
      voxels.push({ place, tests });
    }
    return voxels;
  });
  return { ...look, groups, corners: (polygon) => polygons[polygon] && decode(polygons[polygon], Float32Array) };
}

// The instructions that a cell executes for a ray: address, and the register that changes.
function stepsOf(text) {
  const numbers = unpack(text), steps = [];
  for (let at = 0, next = 0; at < numbers.length;) {
    const head = numbers[at++], address = next + unfolded(Math.floor(head / 2));
    next = address + 1;
    steps.push(head % 2 ? { address, register: numbers[at++], word: numbers[at++] } : { address });
  }
  return steps;
}

// When a cell is at each instruction that it executes for a ray: its words are the cell's moves, and it computes in between. Behind the
// last one the cycle in which the cell is done. null if the tape does not have all of it.
function instructionTimes(cell, ray, steps) {
  const { rows } = run.looks.listings[run.looks.programs[cell]], { job, from, until, code } = recordOf(cell).ops();
  const first = job.indexOf(ray), last = job.lastIndexOf(ray);
  if (first < 0 || from[first] < tape.from) return null;
  const moves = [];
  for (let at = first; at <= last; at++) {
    if (code[at] >= MOVES.length) continue;
    const { states } = recordOf(cell), { state, from: starts } = states();
    for (let part = lastUpTo(starts, from[at]); part < starts.length && starts[part] < until[at]; part++) {
      if (tape.states[state[part]].kind !== "moves") continue;
      const end = Math.min(starts[part + 1] ?? tape.until, until[at]);
      for (let cycle = Math.max(starts[part], from[at]); cycle < end; cycle++) moves.push(cycle);
    }
  }
  const times = [];
  let now = from[first], next = 0;
  for (const { address } of steps) {
    const [, , , cycles, reads, writes] = rows[address];
    times.push(now);
    for (let word = 0; word < reads; word++) now = moves[next++] + 1;
    now += cycles;
    for (let word = 0; word < writes; word++) now = moves[next++] + 1;
    if (Number.isNaN(now)) break;
  }
  times.push(now);
  return times;
}

// A word as it is most likely meant.
function likely(word) {
  const integer = word | 0, float = floatOf(word);
  if (Math.abs(integer) < 1 << 22) return `${integer}`;
  if (!Number.isFinite(float) || (Math.abs(float) > 1e-9 && Math.abs(float) < 1e9)) return `${+float.toPrecision(7)}`;
  return `0x${word.toString(16).padStart(8, "0")}`;
}

// The side from which most of a ray is seen: along the axis that it moves least along.
const bestSide = ({ direction }) => direction.map(Math.abs).reduce((best, part, axis, all) => part < all[best] ? axis : best, 0);

// A ray's walk through the scene, seen along an axis. `at` tells which voxel and which polygon the cell is at.
function drawWalk(look, side, at) {
  const { axes: [across, up], low, high, png } = run.looks.sides[side];
  const extent = [high[0] - low[0] || 1, high[1] - low[1] || 1], scale = 340 / Math.max(...extent);
  const width = extent[0] * scale, height = extent[1] * scale, margin = 10;
  const x = (point) => margin + (point[across] - low[0]) * scale, y = (point) => margin + (high[1] - point[up]) * scale;
  const drawing = svg("svg", { viewBox: `0 0 ${width + 2 * margin} ${height + 2 * margin}`, role: "img", class: "walk" });
  const color = (name) => seen(SAID_COLORS[name]);
  drawing.append(svg("image", { href: `data:image/png;base64,${png}`, x: margin, y: margin, width, height, preserveAspectRatio: "none", opacity: 0.55 }));
  // Of the outcomes of one polygon the one that matters most is the last in order.
  const outcomes = new Map();
  for (const voxels of look.groups) for (const { tests } of voxels) for (const { polygon, said } of tests) {
    outcomes.set(polygon, Math.max(said, outcomes.get(polygon) ?? 0));
  }
  for (const [polygon, said] of [...outcomes].sort((a, b) => a[1] - b[1])) {
    const corners = look.corners(polygon);
    if (!corners) continue;
    const points = Array.from({ length: corners.length / 3 }, (_, n) => corners.slice(3 * n, 3 * n + 3)).map((point) => `${x(point)},${y(point)}`);
    drawing.append(svg("polygon", { points: points.join(" "), fill: color(SAID[said][1]), "fill-opacity": said === 5 ? 0.3 : 0.1,
      stroke: color(SAID[said][1]), "stroke-width": at?.polygon === polygon ? 3 : 1 }));
  }
  look.groups.forEach((voxels, group) => {
    const volume = run.looks.volumes[group], corner = (place) => volume.low.map((least, axis) => least + (volume.high[axis] - least) * place[axis] / volume.size[axis]);
    const box = (from, to, more) => svg("rect", { x: x(from), y: y(to), width: Math.max(x(to) - x(from), 0.5), height: Math.max(y(from) - y(to), 0.5), ...more });
    if (look.groups.length > 1) drawing.append(box(volume.low, volume.high, { fill: "none", stroke: ground("line"), "stroke-width": 0.6, opacity: 0.6 }));
    voxels.forEach(({ place, tests }, number) => {
      const isHere = at?.group === group && at.voxel === number;
      const fill = { fill: color("voxel"), "fill-opacity": tests.length ? 0.8 : 0.4 };
      const rim = isHere ? { stroke: color("hit"), "stroke-width": 2.5 } : { stroke: ground("ground"), "stroke-width": 0.3 };
      drawing.append(box(corner(place), corner(place.map((n) => n + 1)), { ...fill, ...rim }));
    });
  });
  const { origin, direction, hit } = look;
  const point = (t) => origin.map((part, axis) => part + t * direction[axis]);
  // As far as the picture goes.
  const enters = [], leaves = [];
  for (const [axis, place] of [[across, 0], [up, 1]]) {
    if (Math.abs(direction[axis]) < 1e-12) continue;
    const ends = [low[place], high[place]].map((end) => (end - origin[axis]) / direction[axis]).sort((a, b) => a - b);
    enters.push(ends[0]);
    leaves.push(ends[1]);
  }
  const from = Math.max(0, ...enters), to = hit ? hit[1] : Math.min(...leaves);
  if (Number.isFinite(to) && to > from) {
    const [start, end] = [point(from), point(to)];
    drawing.append(svg("line", { x1: x(start), y1: y(start), x2: x(end), y2: y(end), stroke: ground("ink"), "stroke-width": 1 }));
  }
  if (hit) drawing.append(svg("circle", { cx: x(point(hit[1])), cy: y(point(hit[1])), r: 4, fill: color("hit"), stroke: ground("ground") }));
  return drawing;
}

// Which voxel and which candidate of a ray a cell is at in a cycle, told by the units of work that it has done for it.
function placeOf(look, cell, ray, cycle) {
  const stages = tape.stations.length / look.groups.length, group = Math.floor(cell / stages);
  const { code, job, count } = recordOf(cell).ops(), now = opAt(cell, cycle);
  if (!now || now.job !== ray || !now.unit) return null;
  let done = Math.floor((now.done - 1) / now.unit.cycles);
  for (let at = now.at - 1; at >= 0 && job[at] === ray; at--) if (code[at] === now.code) done += count[at];
  if (now.unit.name === "grid_voxel") return { group, voxel: done };
  const tested = { slabs_polygon: 2, intersection_polygon: 3 }[now.unit.name];
  if (tested === undefined) return null;
  for (const [voxel, { tests }] of look.groups[group].entries()) {
    for (const { polygon, said } of tests) if (said >= tested && done-- === 0) return { group, voxel, polygon };
  }
  return null;
}

{% endif %}
