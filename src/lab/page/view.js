"use strict";
// What a run's frame asks the lab: other cycles than it holds, moments, rays.

let asked = "";

// Tells which run is shown, by its query.
function openDoors(query) {
  asked = query;
}

// What the lab says. Where it refuses, or does not answer, this fails in words that can be told; where the answer is wanted no more,
// as fetch does.
async function ask(path, signal) {
  const response = await fetch(`${path}?${asked}`, { signal }).catch(unanswered);
  const text = await response.text().catch(unanswered);
  if (!response.ok) throw new Error(text.trimEnd());
  return JSON.parse(text);
}

function unanswered(error) {
  throw error.name === "AbortError" ? error : new Error(`error: the lab does not answer: ${error.message}`);
}

// A moment's name, as the lab takes it.
function nameOfMoment({ fifo, what, station, ray, cell }) {
  if (ray !== undefined) return cell === undefined ? `ray/${ray}` : cell === null ? `ray/${ray}/back` : `ray/${ray}/cell/${cell}`;
  if (fifo !== undefined) return `${fifo}/${what}`;
  return `${station === null ? "host" : `cell/${station}`}/${what}`;
}

Object.assign(doors, {
  window: (from, until, signal) => ask(`window/${from}/${until}`, signal),
  find: (moment, cycle, signal) => moment.cycle === undefined ? ask(`find/${cycle}/${nameOfMoment(moment)}`, signal) : null,
  ray: ([x, y], signal) => ask(`ray/${x}/${y}`, signal),
  look: (ray, signal) => ask(`look/${ray}`, signal),
  instructions: (cell, ray, signal) => ask(`instructions/${cell}/${ray}`, signal),
});

// What the run's rays come to, which is told behind all else.
function showLooks(looks) {
  run.looks = looks;
  stepper?.learn();
}
