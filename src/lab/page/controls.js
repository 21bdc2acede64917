"use strict";
// The sliders and lists: what is set, and what of it a run does not look at. A parameter that is not set has its default, and is
// in no address.

// What each mode makes of the number of cells.
const PROGRAMS = JSON.parse(document.getElementById("programs").textContent);

const controls = new Map([...document.querySelectorAll(".control")].map((row) => [row.dataset.name, controlOf(row)]));

function controlOf(row) {
  const { name, form, default: byDefault } = row.dataset;
  const [input, exact] = [row.querySelector("[id^=p-]"), row.querySelector(".slide .exact")];
  const stops = row.dataset.stops.split("|");
  const control = { name, form, row, input, exact, stops, byDefault, label: row.querySelector("label").textContent };
  control.unit = row.querySelector(".unit")?.textContent ?? "";
  const told = () => form === "switch" ? String(input.checked) : form === "slider" ? control.stops[Number(input.value)] : input.value.trim();
  if (form === "number") input.addEventListener("change", () => set(name, told()));
  else input.addEventListener("input", () => set(name, told()));
  if (exact && exact !== input) exact.addEventListener("change", () => set(name, exact.value.trim()));
  row.querySelector(".paper")?.addEventListener("click", (event) => set(name, event.currentTarget.dataset.value));
  row.querySelector(".reset").addEventListener("click", () => { set(name, defaultOf(control)); (exact ?? input).focus(); });
  return control;
}

// What holds where a parameter is not set.
function defaultOf({ name, byDefault }, { parameters } = active()) {
  return name === "cells" ? String(programOf(parameters).cells) : byDefault;
}

const programOf = (parameters) => PROGRAMS[parameters.get("mode") ?? "pipeline"] ?? PROGRAMS.pipeline;

// Sets a parameter of a run: the one that the controls are about, unless it is another.
function set(name, value, side = active()) {
  const { parameters } = side;
  if (value === "" || value === defaultOf(controls.get(name), side)) parameters.delete(name);
  else parameters.set(name, value);
  if (name === "mode") fitCells(parameters);
  showControls();
  changed(side);
}

// Takes back a number of cells that the mode cannot have.
function fitCells(parameters) {
  const { stages, cells, is_fixed: isFixed } = programOf(parameters);
  const asked = Number(parameters.get("cells") ?? cells);
  if (isFixed || asked % stages !== 0) parameters.delete("cells");
}

// Brings the controls up to what is set.
function showControls() {
  const { parameters, told } = active(), moot = told?.moot ?? {};
  const { stages, cells, is_fixed: isFixed } = programOf(parameters);
  const ofCells = controls.get("cells");
  ofCells.stops = isFixed ? [String(cells)] : ofCells.row.dataset.stops.split("|").filter((stop) => Number(stop) % stages === 0);
  ofCells.input.max = ofCells.stops.length - 1;
  ofCells.input.disabled = ofCells.exact.disabled = isFixed;
  for (const control of controls.values()) showControl(control, parameters.get(control.name), moot[control.name]);
}

function showControl(control, asked, moot) {
  const { name, form, row, input, exact, unit } = control;
  const value = asked ?? defaultOf(control);
  row.classList.toggle("set", asked !== undefined);
  row.querySelector(".reset").hidden = asked === undefined;
  const why = row.querySelector(".moot");
  why.hidden = !moot || asked === undefined;
  why.textContent = why.hidden ? "" : `without effect here: it ${moot.replace(/^--\S+ /, "")}`;
  if (form === "switch") {
    input.checked = value === "true";
  } else if (form === "list") {
    if (![...input.options].some((option) => option.value === value)) input.add(new Option(value.split("/").pop(), value));
    input.value = value;
  } else if (form === "slider") {
    input.value = placeOf(control, value);
    input.setAttribute("aria-valuetext", value === "" ? "not set" : `${value} ${unit}`);
    if (document.activeElement !== exact) exact.value = value;
    exact.placeholder = name === "cells" ? "" : "not set";
  } else if (document.activeElement !== input) {
    input.value = value;
    input.placeholder = "not set";
  }
}

// The place of the stop that is next to a value.
function placeOf({ stops }, value) {
  const exactly = stops.indexOf(value);
  if (exactly >= 0) return exactly;
  const far = (stop) => stop === "" ? Infinity : Math.abs(Math.log((Number(stop) + 1e-3) / (Number(value) + 1e-3)));
  return stops.reduce((best, stop, at) => far(stop) < far(stops[best]) ? at : best, 0);
}

// The parameters of a query, and the query of parameters, which come in the order of the controls.
const parametersOf = (query) => new Map(new URLSearchParams(query));
function queryOf(parameters) {
  const known = [...controls.keys()].filter((name) => parameters.has(name));
  const others = [...parameters.keys()].filter((name) => !controls.has(name));
  const pairs = [...known, ...others].map((name) => [name, parameters.get(name)]);
  return new URLSearchParams(pairs).toString().replace(/%3A/g, ":").replace(/%2F/g, "/");
}
