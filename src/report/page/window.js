"use strict";
// The cycles that the page holds one by one: who does what in each, and who waits for whom.
// A station is its number, and null is the host.

// Whole numbers, seven bits a byte, the lowest first.
function unpack(text) {
  const numbers = [];
  let number = 0, scale = 1;
  for (const letter of atob(text)) {
    const byte = letter.charCodeAt(0);
    number += (byte & 0x7f) * scale;
    scale *= 128;
    if (byte < 0x80) { numbers.push(number); number = 0; scale = 1; }
  }
  return numbers;
}

// 0, 1, 2, 3, ... stand for 0, -1, 1, -2, ...
const unfolded = (number) => number % 2 ? -(number + 1) / 2 : number / 2;

// The place of the last of some rising numbers that is `most` or less; -1 if none is.
function lastUpTo(numbers, most) {
  let low = 0, high = numbers.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= most) low = middle + 1; else high = middle;
  }
  return low - 1;
}

// What the page holds of the run, if it holds any.
let tape = null;

function loadTape() {
  tape = run.window && unrolled(run.window);
}

function unrolled(window) {
  const { from, until, states } = window;
  const stretches = (text) => {
    const numbers = unpack(text), found = { state: [], from: [] };
    for (let at = 0, next = from; at < numbers.length; at += 2) {
      found.state.push(numbers[at]);
      found.from.push(next);
      next += numbers[at + 1];
    }
    return found;
  };
  const jobs = (text) => {
    const numbers = unpack(text), found = { job: [], from: [], until: [] };
    for (let at = 0, job = 0, start = from; at < numbers.length; at += 3) {
      found.job.push(job += unfolded(numbers[at]));
      found.from.push(start += numbers[at + 1]);
      found.until.push(start + numbers[at + 2]);
    }
    return found;
  };
  // Of each op what it is, whose, how much of it there is, and its time; the first may have begun before.
  const ops = ({ ops, early: [cycles, words] }) => {
    const numbers = unpack(ops), found = { code: [], job: [], count: [], from: [], until: [], before: words };
    for (let at = 0, job = 0, next = from; at < numbers.length;) {
      const head = numbers[at++];
      if (head % 2) job += unfolded(numbers[at++]);
      found.code.push(head >> 1);
      found.job.push(job === 0 ? null : job - 1);
      found.count.push(numbers[at++]);
      found.from.push(next);
      found.until.push(next += numbers[at++]);
    }
    if (found.from.length) found.from[0] -= cycles;
    return found;
  };
  // Rows of cycles, and how many there are before each row.
  const times = (text) => {
    const numbers = unpack(text), found = { from: [], count: [], before: [] };
    for (let at = 0, next = from, before = 0; at < numbers.length; at += 2) {
      found.from.push(next += numbers[at]);
      found.count.push(numbers[at + 1]);
      found.before.push(before);
      next += numbers[at + 1];
      before += numbers[at + 1];
    }
    return found;
  };
  // Whose words are, and the number of the first of each.
  const owners = (text) => {
    const numbers = unpack(text), found = { job: [], first: [] };
    for (let at = 0, job = 0, first = 0; at < numbers.length; at += 2) {
      job += unfolded(numbers[at]);
      found.job.push(job === 0 ? null : job - 1);
      found.first.push(first);
      first += numbers[at + 1];
    }
    return found;
  };
  const station = (packed) => packed && {
    states: memo(() => stretches(packed.states)), jobs: memo(() => jobs(packed.jobs)), ops: memo(() => ops(packed)),
  };
  return {
    from, until, states, units: window.units,
    host: station(window.host),
    answers: memo(() => jobs(window.answers)),
    stations: window.stations.map(station),
    fifos: window.fifos.map((packed) => {
      const { name, capacity, from, to, group, inside } = packed;
      const fifo = { name, capacity, from, to, group, inside, writes: memo(() => times(packed.writes)), reads: memo(() => times(packed.reads)) };
      fifo.levels = memo(() => levelsOf(fifo, window.from));
      fifo.owners = memo(() => owners(packed.words));
      fifo.jobs = memo(() => jobs(packed.jobs));
      return fifo;
    }),
  };
}

// What a FIFO held at the start, and at the end of each cycle in which that changes.
function levelsOf(fifo, start) {
  const expanded = ({ from, count }) => from.flatMap((first, row) => Array.from({ length: count[row] }, (_, at) => first + at));
  const writes = expanded(fifo.writes()), reads = expanded(fifo.reads());
  const found = { from: [start], words: [fifo.inside] };
  for (let write = 0, read = 0; write < writes.length || read < reads.length;) {
    const now = Math.min(writes[write] ?? Infinity, reads[read] ?? Infinity);
    const change = (writes[write] === now) - (reads[read] === now);
    if (writes[write] === now) write++;
    if (reads[read] === now) read++;
    const last = found.words.length - 1, level = found.words[last] + change;
    if (change && found.from[last] === now) found.words[last] = level;
    else if (change) { found.from.push(now); found.words.push(level); }
  }
  return found;
}

const isOnTape = (cycle) => tape && tape.from <= cycle && cycle < tape.until;
const recordOf = (station) => station === null ? tape.host : tape.stations[station];
const nameOf = (station) => station === null ? "the host" : `cell ${station}`;

// What a FIFO holds at the end of a cycle of the tape.
function levelAt(fifo, cycle) {
  const { from, words } = fifo.levels();
  const at = lastUpTo(from, cycle);
  return at < 0 ? 0 : words[at];
}

// What somebody does in a cycle of the tape: the state, from when until when (so far as the tape goes), and its ray.
function doing(station, cycle) {
  const { states, jobs } = recordOf(station), { state, from } = states();
  const here = lastUpTo(from, cycle);
  let first = here, next = here + 1;
  while (first > 0 && state[first - 1] === state[here]) first--;
  while (next < state.length && state[next] === state[here]) next++;
  const spans = jobs();
  let span = lastUpTo(spans.from, cycle);
  // Who waits for a ray's first word waits for the next ray.
  if (span < 0 || spans.until[span] <= cycle) span++;
  return {
    state: tape.states[state[here]], from: from[first], until: next < state.length ? from[next] : tape.until,
    job: span < spans.job.length ? spans.job[span] : null,
  };
}

// What somebody waits for in a cycle: a FIFO, why, and who has to do something first; null if nothing.
function waitOf(station, { state, from }, cycle) {
  if (state.kind !== "waits" && state.kind !== "blocked") return null;
  const reads = state.kind === "waits";
  const fifo = tape.fifos.find((fifo) => fifo.group === state.at && (reads ? fifo.to : fifo.from) === station);
  if (!fifo) return null;
  if (reads && station === null) return { fifo, why: "answer", on: tape.stations.length - 1 };
  if (reads) {
    const isEmpty = levelAt(fifo, cycle) === 0;
    return { fifo, why: isEmpty ? "empty" : "coming", on: isEmpty ? fifo.from : undefined };
  }
  // It found the FIFO as the cycle before had left it.
  const isFull = from > tape.from ? levelAt(fifo, from - 1) >= fifo.capacity : levelAt(fifo, from) >= fifo.capacity;
  return { fifo, why: isFull ? "full" : "wire", on: isFull && fifo.to !== null ? fifo.to : undefined };
}

// Who waits for whom in a cycle, from one of them down to one that does not wait.
function chainOf(station, cycle) {
  const chain = [];
  for (let next = station; next !== undefined && !chain.some((link) => link.station === next);) {
    const now = doing(next, cycle), wait = waitOf(next, now, cycle);
    chain.push({ station: next, ...now, wait });
    next = wait ? wait.on : undefined;
  }
  return chain;
}

// One of a chain in words.
function sentenceOf({ station, state, from, until, job, wait }) {
  const name = nameOf(station), fifo = wait?.fifo;
  const ray = job === null ? "" : `, ray ${grouped(job)}`;
  if (state.kind === "idle") return `${name} has done all that it had to`;
  if (state.kind === "moves") return `${name} moves a word${ray}`;
  const end = until === tape.until && until < run.cycles ? `to beyond the cycles held` : `to before cycle ${grouped(until)}`;
  const what = !wait ? state.kind === "works" ? `works (${state.name})` : state.name : {
    empty: () => `waits for ${nameOf(fifo.from)}: ${fifo.name} is empty (0 of ${fifo.capacity} words)`,
    coming: () => `waits for a word that is on its way into ${fifo.name}`,
    full: () => `waits for ${nameOf(fifo.to)}: ${fifo.name} is full (${fifo.capacity} of ${fifo.capacity} words)`,
    wire: () => `waits for the wire to ${fifo.name}, which carries the word before`,
    answer: () => `waits for a hit`,
  }[wait.why]();
  return `${name} ${what}, from cycle ${grouped(from)} ${end}${ray}`;
}
