"use strict";
// What a run's frame asks the lab: other cycles than it holds, moments, rays.

let asked = "";

// Tells which run is shown, by its query.
function openDoors(query) {
  asked = query;
}

async function ask(path) {
  const response = await fetch(`${path}?${asked}`);
  return response.ok ? response.json() : null;
}

// A moment's name, as the lab takes it.
function nameOfMoment({ fifo, what, station, ray, cell }) {
  if (ray !== undefined) return cell === undefined ? `ray/${ray}` : cell === null ? `ray/${ray}/back` : `ray/${ray}/cell/${cell}`;
  if (fifo !== undefined) return `${fifo}/${what}`;
  return `${station === null ? "host" : `cell/${station}`}/${what}`;
}

Object.assign(doors, {
  window: (from, until) => ask(`window/${from}/${until}`),
  find: (moment, cycle) => moment.cycle === undefined ? ask(`find/${cycle}/${nameOfMoment(moment)}`) : null,
  ray: ([x, y]) => ask(`ray/${x}/${y}`),
  look: (ray) => ask(`look/${ray}`),
  instructions: (cell, ray) => ask(`instructions/${cell}/${ray}`),
});

// What the run's rays come to, which is told behind all else.
function showLooks(looks) {
  run.looks = looks;
  const at = stepper?.cycle;
  startStepper();
  if (at !== undefined) stepper?.go(at);
}
