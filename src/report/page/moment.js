"use strict";
// What is under the pointer: the moment, and who waits for whom in it.

const MOST_LINKS = 8;
const panel = document.getElementById("moment");

// Tells of a station in a cycle; of no station, only when it is.
function tell(station, cycle) {
  if (!tape || station === undefined) return hush();
  const time = `cycle ${grouped(cycle)} (${figure(cycle * run.cycle)} ${run.unit})`;
  if (!isOnTape(cycle)) {
    const others = doors.window ? "a click goes to this one" : `--trace-window ${windowAround(cycle)} holds these`;
    panel.replaceChildren(element("b", {}, `${time}: `), `the page holds the cycles ${grouped(tape.from)} to before ${grouped(tape.until)} one by one; ${others}`);
  } else if (!recordOf(station)) {
    return hush();
  } else {
    const chain = chainOf(station, cycle);
    const lines = chain.slice(0, chain.length > MOST_LINKS ? MOST_LINKS - 1 : MOST_LINKS).map(sentenceOf);
    if (chain.length > MOST_LINKS) lines.push(`… ${chain.length - MOST_LINKS} more in between`, sentenceOf(chain[chain.length - 1]));
    panel.replaceChildren(element("b", {}, `${time}:`), element("ol", {}, ...lines.map((line) => element("li", {}, line))));
  }
  panel.hidden = false;
}

function hush() {
  panel.hidden = true;
}

// A window as wide as what the page holds, with a cycle in its middle.
function windowAround(cycle) {
  const half = Math.ceil((tape.until - tape.from) / 2) || 1;
  const from = Math.max(0, cycle - half);
  return `${from}..${from + 2 * half}`;
}

// A line in all charts at the stepper's cycle.
function markMoment(cycle) {
  for (const { chart } of charts) {
    let line = chart.over.querySelector(".now-line");
    if (!line) chart.over.append(line = element("div", { class: "now-line" }));
    const left = chart.valToPos((cycle + 0.5) * run.cycle, "x");
    line.hidden = !(left >= 0 && left <= chart.over.clientWidth);
    line.style.left = `${left}px`;
  }
}

function removeMoment() {
  document.querySelectorAll(".now-line").forEach((line) => line.remove());
}

// Takes other cycles of the run in place of those that the page holds.
function replaceWindow(window) {
  tape = unrolled(window);
  const at = charts.findIndex(({ place }) => place.parentElement.id === "space-time");
  if (at >= 0) {
    const [{ chart, place }] = charts.splice(at, 1);
    chart.destroy();
    place.remove();
    addSpaceTime();
  }
}
