"use strict";
// A sweep of one parameter, drawn as a curve while its points come in.

const sweep = { stop: null, chart: null, columns: [], rows: [], x: null };
const swept = document.getElementById("swept"), drawn = document.getElementById("drawn"), over = document.getElementById("over");

// What may be drawn; the first is drawn unless another is chosen.
const DRAWN = ["rays_per_second", "seconds", "us_per_ray", "mean_works", "busiest_cell_works", "waiting_us", "blocked_us", "idle_us", "fullest_fifo_words"];

function fillSweep() {
  for (const { name, label } of controls.values()) swept.add(new Option(label, name));
  swept.value = "fifo_words";
  DRAWN.forEach((name) => drawn.add(new Option(name.replaceAll("_", " "), name)));
  swept.addEventListener("change", offer);
  drawn.addEventListener("change", drawCurve);
  document.getElementById("sweep").addEventListener("submit", (event) => { event.preventDefault(); startSweep(); });
  document.getElementById("sweep-stop").addEventListener("click", () => sweep.stop?.abort());
  offer();
}

// The values that are offered for a parameter: where its slider stops, or what its list has.
function offer() {
  const { form, stops, input } = controls.get(swept.value);
  const values = form === "switch" ? ["false", "true"] : form === "list" ? [...input.options].map(({ value }) => value) : stops;
  over.value = values.filter((value) => value !== "").join(", ");
}

// A value as JSON has it.
const typed = (text) => text === "true" || text === "false" ? text === "true" : text !== "" && Number.isFinite(Number(text)) ? Number(text) : text;

async function startSweep() {
  sweep.stop?.abort();
  const stop = sweep.stop = new AbortController();
  const [failure, file] = [document.getElementById("sweep-failure"), document.getElementById("sweep-file")];
  const tell = (text) => { document.getElementById("sweep-status").textContent = text; };
  const busy = (isBusy) => { document.getElementById("sweep-stop").disabled = !isBusy; };
  failure.hidden = true;
  const values = over.value.split(",").map((value) => value.trim()).filter(Boolean);
  const asked = Object.fromEntries([...sides.a.parameters].map(([name, value]) => [name, typed(value)]));
  asked[swept.value] = values.map(typed);
  Object.assign(sweep, { name: swept.value, columns: [], rows: [] });
  busy(true);
  try {
    const response = await fetch("sweep", { method: "POST", signal: stop.signal, headers: { "Content-Type": "application/json" }, body: JSON.stringify(asked) });
    if (!response.ok) throw new Error(await response.text());
    let points = 0;
    for await (const { name, data } of eventsOf(response)) {
      const told = JSON.parse(data);
      if (name === "columns") {
        sweep.columns = told.columns.map((column) => column.name);
        points = told.points;
        file.hidden = false;
        file.querySelector("pre").textContent = `// sweep.ron\n${told.file}\n$ pcs-sim sweep sweep.ron -o table.csv --plot x=${sweep.name} y=${drawn.value}`;
      } else if (name === "point") {
        sweep.rows[told.index] = told.row;
        tell(`${sweep.rows.filter(Boolean).length} of ${points} points`);
        drawCurve();
      } else if (name === "done") {
        tell([`${points} points`, ...told.notes].join("; "));
      }
    }
  } catch (error) {
    if (stop.signal.aborted) tell("stopped");
    else [failure.hidden, failure.textContent] = [false, error instanceof TypeError ? unanswered(error) : error.message.trimEnd()];
  } finally {
    if (sweep.stop === stop) sweep.stop = null;
    busy(sweep.stop !== null);
  }
}

// The points that are there, as a curve and as a table.
function drawCurve() {
  const rows = sweep.rows.filter(Boolean), place = document.getElementById("curve");
  const at = (name) => sweep.columns.indexOf(name);
  if (!rows.length || at(drawn.value) < 0) return;
  const names = rows.map((row) => row[at(sweep.name)]);
  const isNumber = names.every((name) => Number.isFinite(Number(name)));
  const x = isNumber ? names.map(Number) : names.map((_, index) => index);
  const y = rows.map((row) => row[at(drawn.value)] === "" ? null : Number(row[at(drawn.value)]));
  const order = x.map((_, index) => index).sort((a, b) => x[a] - x[b]);
  const isLog = isNumber && Math.min(...x) > 0 && Math.max(...x) / Math.min(...x) > 20;
  const axis = { font: "12px system-ui, sans-serif", labelFont: "13px system-ui, sans-serif", labelSize: 22, stroke: () => ground("ink"), grid: { stroke: () => ground("grid"), width: 1 }, ticks: { stroke: () => ground("grid"), width: 1 } };
  const { label, unit } = controls.get(sweep.name);
  const named = unit ? `${label} (${unit})` : label;
  sweep.chart?.destroy();
  sweep.chart = new uPlot({
    width: Math.max(300, place.clientWidth), height: 340, padding: [16, 24, 0, 0], legend: { show: false }, cursor: { points: { show: false }, drag: { x: false, y: false } },
    scales: { x: { time: false, distr: isLog ? 3 : 1, log: 2, range: !isNumber ? [-0.5, x.length - 0.5] : undefined }, y: { range: (chart, min, max) => [0, max * 1.08 || 1] } },
    axes: [{ ...axis, label: named, ...(isNumber ? {} : { splits: x, values: () => names }) }, { ...axis, label: drawn.value.replaceAll("_", " "), size: 80 }],
    series: [{}, { stroke: () => element_color(), width: 2, points: { show: true, size: 7 }, spanGaps: false, ...(isNumber ? {} : { paths: () => null }) }],
  }, [order.map((index) => x[index]), order.map((index) => y[index])], place);
  place.setAttribute("aria-label", `${drawn.value.replaceAll("_", " ")} over ${named}: ${order.map((index) => `${names[index]}: ${y[index] ?? "failed"}`).join("; ")}`);
  const shown = [sweep.name, ...DRAWN.filter((name) => at(name) >= 0), "error"];
  const table = document.getElementById("points");
  table.tHead.replaceChildren(element("tr", {}, ...shown.map((name) => element("th", {}, name.replaceAll("_", " ")))));
  const cell = (row, name) => element("td", {}, Number.isFinite(Number(row[at(name)])) && row[at(name)] !== "" ? figure(Number(row[at(name)])) : row[at(name)]);
  table.tBodies[0].replaceChildren(...order.map((index) => element("tr", {}, ...shown.map((name) => cell(rows[index], name)))));
  document.body.dataset.points = rows.length;
}

const element_color = () => getComputedStyle(document.documentElement).getPropertyValue("--curve").trim();
