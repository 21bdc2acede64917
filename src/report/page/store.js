"use strict";
{% if is_line %}// A FIFO, word by word.

// Pixels that a FIFO's words have.
const STORE = { width: 88, height: 30 };

// A ray's colour.
const rayColor = (job) => job === null ? ground("line") : `hsl(${(job * 137.508) % 360} ${isDark() ? "62% 64%" : "68% 42%"})`;

// A place for a FIFO's words.
function storeOf(fifo) {
  const scale = Math.max(devicePixelRatio, printing ? 3 : 1), label = element("span", {});
  const canvas = element("canvas", { width: STORE.width * scale, height: STORE.height * scale, role: "img", ...(fifo.group === "Z" ? { class: "back" } : {}) });
  return { fifo, canvas, label, place: element("div", { class: "store" }, label, canvas) };
}

// Draws a FIFO's words in a cycle, the oldest where they are read. Those of other rays than the followed one are pale.
function drawStore({ fifo, canvas, label }, cycle, followed) {
  const words = wordsIn(fifo, cycle), held = words.reduce((sum, [, count]) => sum + count, 0);
  label.textContent = `${fifo.name}  ${grouped(held)} of ${grouped(fifo.capacity)}`;
  label.classList.toggle("full", held >= fifo.capacity);
  const rays = words.map(([job, count]) => `${count} of ${job === null ? "no ray" : `ray ${job}`}`);
  canvas.setAttribute("aria-label", `${fifo.name} holds ${held} of ${fifo.capacity} words${rays.length ? `: ${rays.slice(0, 8).join(", ")}` : ""}`);
  canvas.title = rays.length ? rays.slice(0, 12).join(", ") : "empty";
  const context = canvas.getContext("2d"), { width, height } = canvas;
  context.clearRect(0, 0, width, height);
  // Places that are about square, in columns; where they would be smaller than a pixel, words stand in one row.
  const side = Math.sqrt(width * height / fifo.capacity), rows = side < 1 ? 1 : Math.max(1, Math.round(height / Math.min(side, height)));
  const columns = Math.ceil(fifo.capacity / rows), [across, down] = [width / columns, height / rows], gap = Math.min(across, down) > 4 ? 1 : 0;
  const fill = (word, count) => {
    if (rows === 1) return context.fillRect(fifo.group === "Z" ? word * across : width - (word + count) * across, 0, Math.max(count * across - gap, 0.5), height);
    for (let at = word; at < word + count; at++) {
      const column = Math.floor(at / rows), x = (fifo.group === "Z" ? column : columns - 1 - column) * across;
      context.fillRect(x, (at % rows) * down, across - gap, down - gap);
    }
  };
  let word = 0;
  for (const [job, count] of words) {
    context.fillStyle = rayColor(job);
    context.globalAlpha = followed === null || job === followed ? 1 : 0.28;
    fill(word, count);
    word += count;
  }
  context.globalAlpha = 1;
  context.fillStyle = ground("grid");
  if (gap && rows > 1) fill(word, fifo.capacity - word);
}

{% endif %}
