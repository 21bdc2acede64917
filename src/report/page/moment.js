"use strict";
// What is under the pointer: the moment, and who waits for whom in it.

const MOST_LINKS = 8;
const panel = document.getElementById("moment");

// Tells of a station in a cycle; of no station, only when it is.
function tell(station, cycle) {
  if (!tape || station === undefined) return hush();
  const time = `cycle ${grouped(cycle)} (${figure(cycle * run.cycle)} ${run.unit})`;
  if (!isOnTape(cycle)) {
    panel.replaceChildren(element("b", {}, `${time}: `), `the page holds the cycles ${grouped(tape.from)} to before ${grouped(tape.until)} ` +
      `one by one; --trace-window ${windowAround(cycle)} holds these`);
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
