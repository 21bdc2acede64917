"use strict";
{% if is_line %}// The array in one cycle of the tape: the op that each station is at, whose words each FIFO holds, and when something comes next.

// The letters of ops that move words or wait, in the order of their codes; behind them come the units of work.
const MOVES = "xiorwabz";

// How many words have passed at the end of a cycle.
function passed({ from, count, before }, cycle) {
  const row = lastUpTo(from, cycle);
  return row < 0 ? 0 : before[row] + Math.min(count[row], cycle + 1 - from[row]);
}

// Whose words a FIFO holds at the end of a cycle: how many of which ray, the oldest first.
function wordsIn(fifo, cycle) {
  const first = passed(fifo.reads(), cycle), last = fifo.inside + passed(fifo.writes(), cycle);
  const { job, first: firsts } = fifo.owners(), found = [];
  for (let at = Math.max(0, lastUpTo(firsts, first)); at < job.length && firsts[at] < last; at++) {
    const end = Math.min(last, firsts[at + 1] ?? Infinity), count = end - Math.max(first, firsts[at]);
    if (count > 0) found.push([job[at], count]);
  }
  return found;
}

// In how many cycles of some a station moves a word.
function movesIn(station, from, until) {
  const { state, from: starts } = recordOf(station).states();
  let moves = 0;
  for (let at = Math.max(0, lastUpTo(starts, from)); at < starts.length && starts[at] < until; at++) {
    if (tape.states[state[at]].kind !== "moves") continue;
    moves += Math.min(starts[at + 1] ?? tape.until, until) - Math.max(starts[at], from);
  }
  return moves;
}

// The op that a station is at in a cycle: what it is, for which ray, from when until when, and how much of it is done then.
function opAt(station, cycle) {
  const { code, job, count, from, until, before } = recordOf(station).ops();
  const at = lastUpTo(from, cycle);
  if (at < 0 || until[at] <= cycle) return null;
  const found = { at, code: code[at], job: job[at], count: count[at], from: from[at], until: until[at] };
  if (found.code >= MOVES.length) {
    const unit = tape.units[found.code - MOVES.length];
    return { ...found, unit, done: cycle + 1 - found.from, of: found.count * unit.cycles };
  }
  if (MOVES[found.code] === "a") return { ...found, done: 0, of: 0 };
  const done = (at === 0 ? before : 0) + movesIn(station, Math.max(found.from, tape.from), cycle + 1);
  return { ...found, done, of: found.count };
}

// All of the array in a cycle, as plain data. Stations are in the order of the array, the host first.
function stateAt(cycle) {
  const station = (which) => {
    const op = opAt(which, cycle), { states } = recordOf(which), { state, from } = states();
    return {
      state: tape.states[state[lastUpTo(from, cycle)]].name,
      op: op && { what: op.unit?.name ?? MOVES[op.code], count: op.count, job: op.job, from: op.from, until: op.until, done: op.done, of: op.of },
    };
  };
  return {
    cycle,
    stations: [null, ...tape.stations.keys()].map(station),
    fifos: Object.fromEntries(tape.fifos.map((fifo) => [fifo.name, wordsIn(fifo, cycle)])),
  };
}

// The nearest of some rising numbers before or behind one; undefined if there is none.
const nearest = (numbers, cycle, direction) => numbers[direction > 0 ? lastUpTo(numbers, cycle) + 1 : lastUpTo(numbers, cycle - 1)];

// The next cycle, or the last one before, in which anything is different from the cycle before: null if the tape ends first.
function changeBeside(cycle, direction) {
  const answers = tape.answers();
  const lists = [null, ...tape.stations.keys()].map((station) => recordOf(station).states().from)
    .concat(tape.fifos.map((fifo) => fifo.levels().from), [answers.from, answers.until]);
  const found = lists.map((list) => nearest(list, cycle, direction)).filter((time) => time > tape.from && time < tape.until);
  return found.length ? (direction > 0 ? Math.min(...found) : Math.max(...found)) : null;
}

// The next cycle, or the last one before, in which a station comes to an op.
function opBeside(station, cycle, direction) {
  const found = nearest(recordOf(station).ops().from, cycle, direction);
  return found !== undefined && found >= tape.from && found < tape.until ? found : null;
}

// Where a ray is, one place after the other: the host that sends it, FIFOs and cells, the host that reads its answer.
function wayOf(ray) {
  const span = ({ job, from, until }) => {
    const at = job.indexOf(ray);
    return at < 0 ? null : { from: from[at], until: until[at] };
  };
  const stops = [{ name: "the host sends it", station: null, ...span(tape.host.jobs()) }];
  for (const fifo of tape.fifos) stops.push({ name: fifo.name, fifo, ...span(fifo.jobs()) });
  tape.stations.forEach((record, cell) => stops.push({ name: `cell ${cell}`, station: cell, ...span(record.jobs()) }));
  stops.push({ name: "the host reads its hit", station: null, ...span(tape.answers()) });
  return stops.filter(({ from }) => from !== undefined).sort((a, b) => a.from - b.from || a.until - b.until);
}

// A question of a moment, as people put it; null if it is none. `of` what it is about, `first` whether it is the only one.
function question(text) {
  const words = text.trim().toLowerCase().replace(/^(the )?next time /, "").replace(/\s+/g, " ");
  const forms = [
    [/^(?:cycle )?([\d ]+)$/, ([cycle]) => ({ cycle: +cycle.replaceAll(" ", "") })],
    [/^(\d+(?:\.\d+)?) ?(s|ms|us|µs|ns)$/, ([time, unit]) => ({ cycle: Math.floor(time * { s: 1, ms: 1e-3, us: 1e-6, "µs": 1e-6, ns: 1e-9 }[unit] / seconds(run.cycle) + 1e-6) })],
    [/^([xyz](?:\d+|host)) (?:is )?(full|empty)$/, ([fifo, what]) => ({ fifo, what })],
    [/^(?:(the )?host|cell (\d+)) (waits|is blocked|works|moves)$/, ([, cell, what]) => ({ station: cell === undefined ? null : +cell, what: what === "is blocked" ? "blocked" : what })],
    [/^ray (\d+) (?:comes|is) (?:to|in|at) (?:cell )?(\d+)$/, ([ray, cell]) => ({ ray: +ray, cell: +cell })],
    [/^ray (\d+) comes back$/, ([ray]) => ({ ray: +ray, cell: null })],
    [/^ray (\d+)$/, ([ray]) => ({ ray: +ray })],
    [/^pixel (\d+)[ ,]+(\d+)$/, ([x, y]) => ({ pixel: [+x, +y] })],
  ];
  for (const [form, read] of forms) {
    const found = words.match(form);
    if (found) return read(found.slice(1));
  }
  return null;
}

// What a question is about that there is not; null if there is all.
function missingOf({ fifo, station, cell }) {
  if (fifo !== undefined && !tape.fifos.some(({ name }) => name.toLowerCase() === fifo)) return `FIFO ${fifo.toUpperCase()}`;
  const asked = [station, cell].find((which) => which != null && which >= tape.stations.length);
  return asked === undefined ? null : `cell ${asked}`;
}

// The first cycle behind one of which a question holds; of a ray's, the one at which it holds. null if the tape has none.
function find(asked, cycle) {
  if (asked.cycle !== undefined) return isOnTape(asked.cycle) ? asked.cycle : null;
  if (asked.ray !== undefined) {
    const spans = asked.cell === undefined ? tape.host.jobs() : asked.cell === null ? tape.answers() : recordOf(asked.cell)?.jobs();
    const at = spans ? spans.job.indexOf(asked.ray) : -1;
    return at < 0 ? null : Math.max(spans.from[at], tape.from);
  }
  if (asked.fifo !== undefined) {
    const fifo = tape.fifos.find(({ name }) => name.toLowerCase() === asked.fifo);
    const level = asked.what === "full" ? fifo?.capacity : 0;
    return fifo ? firstBehind(fifo.levels(), cycle, (at) => fifo.levels().words[at] === level) : null;
  }
  const record = recordOf(asked.station);
  return record ? firstBehind(record.states(), cycle, (at) => tape.states[record.states().state[at]].kind === asked.what) : null;
}

// The first time behind a cycle at which something that did not hold before begins to.
function firstBehind({ from }, cycle, holds) {
  for (let at = lastUpTo(from, cycle) + 1; at < from.length; at++) {
    if (holds(at) && !(at > 0 && holds(at - 1))) return from[at];
  }
  return null;
}

// What an op is, in words.
function opText(op, station) {
  if (op.unit) return `${op.unit.name.replaceAll("_", " ")}${op.count > 1 ? ` ${Math.min(op.count, Math.floor((op.done - 1) / op.unit.cycles) + 1)} of ${grouped(op.count)}` : ""}`;
  const isLast = station === tape.stations.length - 1;
  return {
    x: isLast ? "reads X" : "passes X on", r: "reads X", w: station === null ? "sends a ray" : "writes X", i: "reads Y", o: "writes Y",
    b: "reads Z", z: "writes Z", a: `waits for answer ${grouped(op.count)}`,
  }[MOVES[op.code]];
}

// Questions to choose from.
function examples() {
  const fifos = tape.fifos.slice(0, 24).flatMap(({ name }) => [`${name} is full`, `${name} is empty`]);
  const cells = tape.stations.slice(0, 16).flatMap((_, cell) => [`cell ${cell} waits`, `cell ${cell} is blocked`]);
  const ray = tape.host.jobs().job[0] ?? 0;
  return [...fifos.slice(0, 8), ...cells.slice(0, 8), `ray ${ray}`, `ray ${ray} comes to cell ${tape.stations.length - 1}`, `ray ${ray} comes back`, "pixel 0 0", ...fifos.slice(8), ...cells.slice(8)];
}

{% endif %}
