"use strict";
// Steps through the cycles that a page of a row of cells holds: draws it as it stands in one of them, and follows rays through it.

// What a page with a server behind it asks there; null where there is none.
// `window(from, until)` gives other cycles, `find(question, cycle)` a cycle, `ray([x, y])` a pixel's ray, `look(ray)` a ray's way,
// `instructions(cell, ray)` what a cell executes. The last argument of each is a signal that the answer is wanted no more. They fail
// in words that can be told.
const doors = { window: null, find: null, ray: null, look: null, instructions: null };

// As many cells are drawn at once.
const MOST_DRAWN = 16;
// As many stops of a ray.
const MOST_STOPS = 48;
const SPEEDS = [1, 5, 20, 100, 500, 2500, 12500, 62500];
let stepper = null;

{% if is_line %}function startStepper() {
  stepper?.end();
  const place = document.getElementById("stepper");
  stepper = place && tape && tape.until > tape.from && tape.stations.length ? new Stepper(place) : null;
}

class Stepper {
  constructor(place) {
    this.place = place;
    this.cycle = this.begin();
    this.station = this.worth();
    this.followed = null;
    this.speed = 3;
    this.playing = null;
    // What it has asked for and still wants.
    this.wanted = new AbortController();
    this.side = null;
    this.looks = new Map();
    this.executed = new Map();
    this.pinned = null;
    this.build();
    this.draw();
  }

  end() {
    this.pause();
    this.place.replaceChildren();
    removeMoment();
  }

  // Where there is something to see: where a FIFO first holds somebody up, else where the first answer comes back.
  begin() {
    const blocked = tape.stations.map((_, station) => find({ station, what: "blocked" }, tape.from - 1)).filter((cycle) => cycle !== null);
    return blocked.length ? Math.min(...blocked) : tape.answers().from[0] ?? tape.from;
  }

  // A cell that is worth a look there: one that is held up, else the first.
  worth() {
    const found = tape.stations.findIndex((_, station) => doing(station, this.cycle).state.kind === "blocked");
    return Math.max(0, found);
  }

  build() {
    const bar = element("div", { class: "steps", role: "group", "aria-label": "Steps" });
    const step = (text, hint, kind, direction) => bar.append(button(text, hint, () => this.step(kind, direction)));
    step("⇤ op", "Back to where the chosen cell came to its op, or the one before ([)", "op", -1);
    step("« event", "Back by an event: anything that changes (Shift and left arrow)", "event", -1);
    step("‹ cycle", "Back by a cycle (left arrow)", "cycle", -1);
    this.player = button("▶ play", "Play (space)", () => this.toggle());
    bar.append(this.player);
    step("cycle ›", "On by a cycle (right arrow)", "cycle", 1);
    step("event »", "On by an event: anything that changes (Shift and right arrow)", "event", 1);
    step("op ⇥", "On to the chosen cell's next op (])", "op", 1);
    const speeds = SPEEDS.map((speed, at) => element("option", { value: at, ...(at === this.speed ? { selected: "" } : {}) }, `${grouped(speed)} cycles a second`));
    this.speeds = element("select", { "aria-label": "Speed" }, ...speeds);
    this.speeds.addEventListener("change", () => { this.speed = +this.speeds.value; });
    bar.append(this.speeds);

    this.counter = element("input", { type: "text", inputmode: "numeric", size: 12, "aria-label": "Cycle", class: "count" });
    this.counter.addEventListener("change", () => this.seek(this.counter.value));
    this.time = element("span", { class: "time" });
    this.slider = element("input", { type: "range", min: tape.from, max: tape.until - 1, step: 1, "aria-label": "Cycle of those that the page holds" });
    this.slider.addEventListener("input", () => { this.pause(); this.go(+this.slider.value); });
    const line = element("div", { class: "moment" }, element("label", {}, "cycle ", this.counter), this.time, this.slider);

    const asks = element("form", { class: "asks" });
    this.asked = element("input", { type: "text", size: 32, list: "stepper-asks", placeholder: "X1 is full, cell 2 waits, ray 17 …", "aria-label": "Go to a moment" });
    const list = element("datalist", { id: "stepper-asks" }, ...examples().map((value) => element("option", { value })));
    asks.append(element("label", {}, "go to ", this.asked), list, element("button", {}, "find"));
    asks.addEventListener("submit", (event) => { event.preventDefault(); this.seek(this.asked.value); });
    this.follower = element("input", { type: "number", min: 0, step: 1, "aria-label": "Follow a ray", class: "count" });
    this.follower.addEventListener("change", () => this.follow(this.follower.value === "" ? null : +this.follower.value));
    this.stops = [button("‹ stop", "Back to where the followed ray was before", () => this.stop(-1)), button("stop ›", "On to where the followed ray comes next", () => this.stop(1))];
    asks.append(element("label", {}, "follow ray ", this.follower), ...this.stops);

    this.told = element("p", { role: "status", "aria-live": "polite", class: "told" });
    this.way = element("ol", { class: "way", "aria-label": "The way of the followed ray" });
    this.map = element("div", { class: "map" });
    this.row = element("div", { class: "row", role: "group", "aria-label": "The array in this cycle" });
    this.details = element("div", { class: "details" });
    const around = element("div", { class: "around", tabindex: 0, role: "group", "aria-label": "The array, step by step: left and right go by cycles, with Shift by events, up and down choose a cell, brackets go by its ops, space plays" },
      bar, line, asks, this.told, this.way, this.map, this.row, this.details);
    around.addEventListener("keydown", (event) => this.key(event));
    this.place.replaceChildren(around);
    this.offerPixels();
  }

  // Takes what rays come to, which a page may come to know later than all else.
  learn() {
    this.pixels = null;
    this.looks.clear();
    this.executed.clear();
    this.offerPixels();
    if (this.playing === null) this.drawDetails();
  }

  // The picture's pixels, as far as it is known whose they are.
  offerPixels() {
    const picture = document.querySelector("#run header img");
    if (picture && run.looks?.size) {
      picture.classList.add("pickable");
      picture.title = "A click on a pixel follows its ray";
      picture.onclick = ({ offsetX, offsetY }) => {
        const { clientWidth, clientHeight } = picture, [width, height] = run.looks.size;
        this.seek(`pixel ${Math.min(width - 1, Math.floor(offsetX / clientWidth * width))} ${Math.min(height - 1, Math.floor(offsetY / clientHeight * height))}`);
      };
    }
  }

  key(event) {
    const { target, key, shiftKey } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || target.matches("input, select, textarea")) return;
    const isButton = target.closest("button") !== null;
    const action = {
      ArrowLeft: () => this.step(shiftKey ? "event" : "cycle", -1), ArrowRight: () => this.step(shiftKey ? "event" : "cycle", 1),
      "[": () => this.step("op", -1), "]": () => this.step("op", 1), ",": () => this.step("instruction", -1), ".": () => this.step("instruction", 1),
      ArrowUp: () => this.choose(Math.max(0, this.station - 1)), ArrowDown: () => this.choose(Math.min(tape.stations.length - 1, this.station + 1)),
      "<": () => this.stop(-1), ">": () => this.stop(1),
      Home: () => this.go(tape.from), End: () => this.go(tape.until - 1), " ": !isButton && (() => this.toggle()),
    }[key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  // Shows a cycle.
  go(cycle) {
    this.began = null;
    this.cycle = Math.max(tape.from, Math.min(cycle, tape.until - 1));
    this.draw();
  }

  // Goes on or back, to where another window begins if the page can have it.
  step(kind, direction) {
    this.pause();
    return this.tried(() => {
      if (kind === "instruction") return this.instruct(direction);
      if (kind === "event") return this.stepEvent(direction);
      return this.reachOrStop(direction, { cycle: () => this.cycle + direction, op: () => opBeside(this.station, this.cycle, direction) }[kind]());
    });
  }

  // Does what may ask a server. What is asked for in vain is told; what is wanted no more ends without a word.
  async tried(work) {
    try {
      await work();
    } catch (error) {
      if (error.name === "AbortError") return;
      this.pause();
      this.say(error.message);
    }
  }

  // Events lead back the way that they led, to where the first step was taken, though nothing may have changed there.
  async stepEvent(direction) {
    const began = this.began ?? this.cycle, change = changeBeside(this.cycle, direction);
    const isBetween = direction > 0 ? began > this.cycle && began < (change ?? Infinity) : began < this.cycle && began > (change ?? -1);
    await this.reachOrStop(direction, isBetween && isOnTape(began) ? began : change);
    this.began = began;
  }

  // Goes to a cycle; if there is none on the tape, to where it ends, or goes on with another one.
  async reachOrStop(direction, next) {
    if (next !== null && isOnTape(next)) return this.go(next);
    const edge = direction > 0 ? tape.until : tape.from - 1;
    if (await this.reach(edge)) return this.go(edge);
    if (direction > 0 && this.cycle === tape.until - 1 || direction < 0 && this.cycle === tape.from) return this.say(this.edge(direction));
    this.go(direction > 0 ? tape.until - 1 : tape.from);
  }

  // Whether the tape has a cycle, or another one that there is for it.
  async reach(cycle) {
    if (isOnTape(cycle)) return true;
    if (!doors.window || cycle < 0 || cycle >= run.cycles) return false;
    const length = Math.max(tape.until - tape.from, 1), from = Math.max(0, cycle - Math.floor(length / 8));
    replaceWindow(await doors.window(from, from + length, this.wanted.signal));
    [this.slider.min, this.slider.max] = [tape.from, tape.until - 1];
    return isOnTape(cycle);
  }

  edge(direction) {
    const isEnd = direction > 0 ? tape.until >= run.cycles : tape.from === 0;
    if (isEnd) return direction > 0 ? "The run ends here." : "The run begins here.";
    if (doors.window) return "There is no more of the run to be had.";
    return `The page holds the cycles ${grouped(tape.from)} to before ${grouped(tape.until)} one by one; --trace-window ${windowAround(direction > 0 ? tape.until : tape.from)} holds others.`;
  }

  toggle() {
    if (this.playing === null) this.play(); else this.pause();
  }

  play() {
    let last = performance.now(), owed = 0;
    this.told.setAttribute("aria-live", "off");
    this.player.textContent = "❚❚ pause";
    const frame = (now) => this.tried(async () => {
      owed += (now - last) / 1000 * SPEEDS[this.speed];
      last = now;
      const whole = Math.floor(owed);
      owed -= whole;
      if (whole > 0) this.go(this.cycle + whole);
      const end = tape.until;
      if (this.cycle === end - 1) {
        if (!await this.reach(end)) {
          this.pause();
          return this.say(this.edge(1));
        }
        this.go(end);
        last = performance.now();
      }
      this.playing = requestAnimationFrame(frame);
    });
    this.playing = requestAnimationFrame(frame);
  }

  // Ends playing. What was asked for before is wanted no more.
  pause() {
    this.wanted.abort();
    this.wanted = new AbortController();
    if (this.playing === null) return;
    cancelAnimationFrame(this.playing);
    this.playing = null;
    this.player.textContent = "▶ play";
    this.told.setAttribute("aria-live", "polite");
    this.tell();
  }

  // Goes to a moment that is asked for in words.
  seek(text) {
    this.pause();
    const asked = question(text);
    if (!asked) return this.say(`“${text}” is no moment. Ask for a cycle, a time as 1.5 ms, X1 is full, cell 2 waits, ray 17, ray 17 comes to cell 3, ray 17 comes back, pixel 3 4.`);
    const missing = missingOf(asked);
    if (missing) return this.say(`“${text.trim()}” is no moment: there is no ${missing}.`);
    return this.tried(() => this.goTo(asked, text.trim()));
  }

  async goTo(asked, text) {
    if (asked.pixel) {
      const ray = this.rayOf(asked.pixel) ?? (doors.ray ? await doors.ray(asked.pixel, this.wanted.signal) : null);
      if (ray === null) return this.say(doors.ray ? `No ray is sent through pixel ${asked.pixel.join(", ")}.` : `The ray of pixel ${asked.pixel.join(", ")} is not among those of the cycles that the page holds.`);
      Object.assign(asked, { ray });
    }
    if (asked.ray !== undefined) this.follow(asked.ray);
    if (asked.station !== undefined && asked.station !== null) this.choose(asked.station);
    if (asked.cell != null && asked.cell < tape.stations.length) this.choose(asked.cell);
    if (asked.cycle !== undefined && await this.reach(asked.cycle)) return this.go(asked.cycle);
    const here = find(asked, this.cycle);
    if (here !== null) return this.go(here);
    const there = doors.find ? await doors.find(asked, this.cycle, this.wanted.signal) : null;
    if (there !== null && await this.reach(there)) return this.go(there);
    const isEvent = asked.ray === undefined && asked.cycle === undefined;
    const where = doors.find ? (isEvent ? `behind cycle ${grouped(this.cycle)}` : "in the run") : `in the cycles that the page holds, ${grouped(tape.from)} to before ${grouped(tape.until)}`;
    this.say(`“${text}” does not come${isEvent ? " again" : ""} ${where}.`);
  }

  // The ray of a pixel, if the page knows it.
  rayOf([x, y]) {
    const { size, first, pixels } = run.looks ?? {};
    this.pixels ??= size ? unpack(pixels) : [];
    const at = size && x < size[0] && y < size[1] ? this.pixels.indexOf(x + size[0] * y) : -1;
    return at < 0 ? null : first + at;
  }

  follow(ray) {
    this.followed = Number.isInteger(ray) && ray >= 0 ? ray : null;
    this.follower.value = this.followed ?? "";
    this.draw();
  }

  // Goes to where the followed ray comes next, or was before.
  stop(direction) {
    this.pause();
    if (this.followed === null) return this.say("No ray is followed: give its number.");
    const stops = wayOf(this.followed).filter(({ from }) => direction > 0 ? from > this.cycle : from < this.cycle);
    if (!stops.length) return this.say(`Ray ${grouped(this.followed)} has no other stop in the cycles that the page holds.`);
    const { from, station } = direction > 0 ? stops[0] : stops[stops.length - 1];
    if (typeof station === "number") this.station = station;
    this.go(from);
  }

  choose(station) {
    if (!recordOf(station)) return;
    this.station = station;
    this.draw();
  }

  say(text) {
    this.told.textContent = text;
  }

  // All that is drawn, as plain data.
  state() {
    return stateAt(this.cycle);
  }

  draw() {
    const { cycle } = this;
    if (document.activeElement !== this.counter) this.counter.value = grouped(cycle);
    this.time.textContent = `${(cycle * run.cycle).toPrecision(7)} ${run.unit} of ${figure(run.end)}`;
    this.slider.value = cycle;
    this.slider.setAttribute("aria-valuetext", `cycle ${grouped(cycle)}`);
    this.drawMap();
    this.drawRow();
    if (this.playing === null) {
      this.tell();
      this.drawWay();
      this.drawDetails();
    }
    for (const stop of this.stops) stop.disabled = this.followed === null;
    markMoment(cycle);
  }

  // The moment in a sentence: what the chosen cell does, and who waits for whom.
  tell() {
    const chain = chainOf(this.station, this.cycle).slice(0, 4), op = opAt(this.station, this.cycle);
    const isAt = op && op.of && !chain[0]?.wait, ray = op?.job == null ? "" : `, ray ${grouped(op.job)}`;
    const first = isAt ? `${nameOf(this.station)}: ${opText(op, this.station)}, ${op.unit ? "cycle" : "word"} ${grouped(op.done)} of ${grouped(op.of)}${ray}` : sentenceOf(chain[0]);
    this.say(`Cycle ${grouped(this.cycle)}: ${[first, ...chain.slice(1).map(sentenceOf)].join("; ")}.`);
  }

  // All cells of a large array, each in the colour of its state.
  drawMap() {
    const cells = tape.stations.length;
    if (cells <= MOST_DRAWN) return;
    if (!this.map.firstChild) {
      this.map.replaceChildren(...tape.stations.map((_, cell) => button("", `cell ${cell}`, () => this.choose(cell))));
      // By keys cells are chosen with the arrows.
      for (const square of this.map.children) square.tabIndex = -1;
    }
    [...this.map.children].forEach((square, cell) => {
      square.style.background = this.stateColor(doing(cell, this.cycle).state.name);
      square.classList.toggle("chosen", cell === this.station);
    });
  }

  stateColor(name) {
    const state = run.states.find((state) => state.name === name);
    return state ? seen(state.color) : ground("grid");
  }

  // The cells that are drawn: all, or those around the chosen one.
  drawn() {
    const cells = tape.stations.length, count = Math.min(cells, MOST_DRAWN);
    const first = Math.max(0, Math.min(this.station - Math.floor(count / 2), cells - count));
    return Array.from({ length: count }, (_, at) => first + at);
  }

  drawRow() {
    const cells = this.drawn(), last = tape.stations.length - 1;
    const key = `${cells[0]} ${cells.length} ${printing}`;
    if (this.built !== key) {
      this.built = key;
      this.stores = [];
      this.boxes = new Map();
      const parts = [];
      if (cells[0] === 0) parts.push(this.box(null, "sends"));
      for (const cell of cells) parts.push(this.link(cell), this.box(cell));
      if (cells[cells.length - 1] === last) parts.push(this.link(null), this.box(null, "reads"));
      this.row.replaceChildren(...parts);
    }
    for (const [key, box] of this.boxes) this.fillBox(key, box);
    for (const store of this.stores) drawStore(store, this.cycle, this.followed);
  }

  // The FIFOs that lead into a cell, or to the host behind the last; and that which leads out of it to the left.
  link(reader) {
    const link = element("div", { class: "link" });
    const writer = reader === null ? null : reader - 1;
    const fifos = tape.fifos.filter(({ group, from, to }) => group === "Z" ? from === reader && to === writer && reader !== null : to === reader && !(reader === null && group === "X"));
    for (const fifo of fifos) {
      const store = storeOf(fifo);
      link.append(store.place);
      this.stores.push(store);
    }
    return link;
  }

  box(station, host) {
    const name = station === null ? "host" : `cell ${station}`;
    const box = { parts: Object.fromEntries(["name", "runs", "op", "ray", "wait"].map((part) => [part, element("span", { class: part })])), bar: element("i", {}), band: element("u", {}), host };
    box.place = element(station === null ? "div" : "button", station === null ? { class: "box host" } : { class: "box", type: "button" }, box.band, ...Object.values(box.parts), element("span", { class: "bar" }, box.bar));
    box.parts.name.textContent = station === null ? `host ${host}` : name;
    box.parts.runs.textContent = station === null || run.cells[station].name === name ? "" : run.cells[station].name;
    if (station !== null) box.place.addEventListener("click", () => this.choose(station));
    this.boxes.set(station === null ? host : station, box);
    return box.place;
  }

  fillBox(station, { place, parts, bar, band, host }) {
    if (host === "reads") {
      const { job, from, until } = tape.answers(), at = lastUpTo(from, this.cycle), isReading = at >= 0 && until[at] > this.cycle;
      parts.op.textContent = isReading ? "reads a hit" : "has no word to read";
      this.fillRay(parts.ray, isReading ? job[at] : null);
      band.style.background = isReading ? this.stateColor("moving") : "none";
      bar.style.width = "0";
      return;
    }
    const which = host ? null : station, op = opAt(which, this.cycle), now = doing(which, this.cycle), wait = waitOf(which, now, this.cycle);
    parts.op.textContent = op ? opText(op, which) : "is done";
    this.fillRay(parts.ray, op?.job ?? null, op && !op.unit && op.of ? `word ${grouped(op.done)} of ${grouped(op.of)}` : op?.unit ? `${grouped(op.done)} of ${grouped(op.of)} cycles` : "");
    parts.wait.textContent = !wait ? "" : {
      empty: () => `waits: ${wait.fifo.name} is empty`, coming: () => `waits: on its way in ${wait.fifo.name}`, full: () => `blocked: ${wait.fifo.name} is full`,
      wire: () => `blocked: the wire to ${wait.fifo.name}`, answer: () => "waits for a hit",
    }[wait.why]();
    band.style.background = this.stateColor(now.state.name);
    bar.style.width = op?.of ? `${100 * op.done / op.of}%` : "0";
    place.classList.toggle("held", wait !== null);
    if (which === null) return;
    const isChosen = which === this.station;
    place.classList.toggle("chosen", isChosen);
    place.setAttribute("aria-pressed", isChosen);
  }

  fillRay(place, job, more = "") {
    place.textContent = job === null ? more : `ray ${grouped(job)}${more ? ` · ${more}` : ""}`;
    place.style.setProperty("--ray", job === null ? "transparent" : rayColor(job));
  }

  // Where the followed ray has been and comes to.
  drawWay() {
    const all = this.followed === null ? [] : wayOf(this.followed);
    // Of a long way those around the moment.
    const here = all.filter(({ from }) => from <= this.cycle).length, first = Math.max(0, Math.min(here - MOST_STOPS / 2, all.length - MOST_STOPS));
    const stops = all.slice(first, first + MOST_STOPS);
    this.way.hidden = this.followed === null;
    this.way.replaceChildren(...stops.map(({ name, from, until, station }) => {
      const isHere = from <= this.cycle && this.cycle < until;
      const go = button(`${name} ${grouped(from)}`, `${name}: cycles ${grouped(from)} to before ${grouped(until)}`, () => { if (typeof station === "number") this.station = station; this.pause(); this.go(from); });
      if (isHere) go.setAttribute("aria-current", "step");
      return element("li", {}, go);
    }));
    if (this.followed !== null && !stops.length) this.way.replaceChildren(element("li", {}, `ray ${grouped(this.followed)} is not in the cycles that the page holds`));
    if (this.followed !== null) this.way.style.setProperty("--ray", rayColor(this.followed));
  }

  // Beside the array: the chosen cell's program, and the walk of its ray, or of the followed one.
  drawDetails() {
    const op = opAt(this.station, this.cycle);
    const ray = this.followed ?? op?.job ?? null;
    this.details.replaceChildren();
    if (ray !== null && run.looks) this.drawLook(ray);
    if (op?.job != null && run.looks?.listings.length) this.drawProgram(op.job);
  }

  // What is known of something, once it is: at hand, or behind a door.
  known(all, key, held, door) {
    if (!all.has(key)) {
      all.set(key, held ?? null);
      const redraw = () => { if (stepper === this && this.playing === null) this.drawDetails(); };
      if (!held && door) door(this.wanted.signal).then((found) => { all.set(key, found); if (found) redraw(); }, (error) => {
        all.delete(key);
        // Where it is still to be seen it is asked for again.
        if (error.name === "AbortError") redraw(); else this.say(error.message);
      });
    }
    return all.get(key);
  }

  drawLook(ray) {
    const held = run.looks.visits[ray];
    const told = this.known(this.looks, ray, held && { look: held, polygons: run.looks.polygons }, doors.look && ((signal) => doors.look(ray, signal)));
    const panel = element("section", { class: "look" }, element("h3", {}, `Ray ${grouped(ray)} in the scene`));
    this.details.append(panel);
    if (!told) {
      panel.append(element("p", { class: "hint" }, doors.look ? "…" : "The page does not hold this ray's walk: it has those of its first rays."));
      return;
    }
    const look = lookOf(told), at = placeOf(look, this.station, ray, this.cycle), side = this.side ?? bestSide(look);
    const tests = look.groups.flatMap((voxels) => voxels.flatMap(({ tests }) => tests));
    const counts = SAID.map(([name], said) => [name, tests.filter((test) => test.said === said).length]).filter(([, count]) => count);
    const voxels = look.groups.reduce((sum, group) => sum + group.length, 0);
    const hit = look.hit ? `it hits polygon ${grouped(look.hit[0])} at t = ${figure(look.hit[1])}` : "it hits nothing";
    const text = voxels === 0 ? "It misses the volume." : `${grouped(voxels)} voxels, ${grouped(tests.length)} candidates${counts.length ? ` (${counts.map(([name, count]) => `${count} ${name}`).join(", ")})` : ""}: ${hit}.`;
    const sides = element("div", { class: "sides", role: "group", "aria-label": "Seen along" }, "seen along ");
    ["x", "y", "z"].forEach((name, axis) => {
      const choose = button(name, `along ${name}`, () => { this.side = axis; this.drawDetails(); });
      choose.setAttribute("aria-pressed", axis === side);
      sides.append(choose);
    });
    const drawing = drawWalk(look, side, at);
    drawing.setAttribute("aria-label", `The walk of ray ${ray} through the grid, seen along ${"xyz"[side]}: ${text}`);
    const legend = element("p", { class: "legend" }, ...counts.map(([name]) => {
      const square = element("i", {});
      square.style.background = seen(SAID_COLORS[SAID.find(([other]) => other === name)[1]]);
      return element("span", {}, square, name);
    }));
    const now = at && this.place ? element("p", {}, `Cell ${this.station} is at voxel ${at.voxel + 1}${at.polygon === undefined ? "" : `, polygon ${grouped(at.polygon)}`}.`) : "";
    panel.append(element("p", {}, text), now, drawing, legend, sides);
  }

  // The instructions that the chosen cell executes for a ray, with their times, if all of them are known.
  program(ray) {
    const key = `${this.station} ${ray}`, station = this.station;
    const text = this.known(this.executed, key, run.looks.instructions[key], doors.instructions && ((signal) => doors.instructions(station, ray, signal)));
    const steps = text && stepsOf(text), times = steps && instructionTimes(this.station, ray, steps);
    return times && { steps, times, ray };
  }

  // The one that it is at.
  instruction({ times, steps, ray }) {
    const { pinned } = this;
    if (pinned && pinned.cycle === this.cycle && pinned.station === this.station && pinned.ray === ray) return pinned.at;
    return Math.max(0, Math.min(lastUpTo(times, this.cycle), steps.length - 1));
  }

  // Goes on or back by an instruction of the chosen cell.
  instruct(direction) {
    const ray = opAt(this.station, this.cycle)?.job;
    const known = ray != null && run.looks?.listings.length ? this.program(ray) : null;
    if (!known) return this.say("The page does not hold the instructions of the chosen cell in this cycle.");
    const at = this.instruction(known) + direction, cycle = known.times[at];
    if (at < 0 || at >= known.steps.length || !isOnTape(cycle)) return this.step("op", direction);
    this.pinned = { at, cycle, station: this.station, ray };
    this.go(cycle);
  }

  drawProgram(ray) {
    const known = this.program(ray), { name, rows } = run.looks.listings[run.looks.programs[this.station]];
    const panel = element("section", { class: "program" }, element("h3", {}, `Cell ${this.station} runs ${name.replace(/^.*\//, "")} on ray ${grouped(ray)}`));
    this.details.append(panel);
    if (!known) {
      panel.append(element("p", { class: "hint" }, doors.instructions ? "…" : "The page does not hold these instructions: it has those of its first rays."));
      return;
    }
    const at = this.instruction(known), { steps } = known, registers = new Map();
    for (const { register, word } of steps.slice(0, at)) if (register !== undefined) registers.set(register, word);
    const { address } = steps[at], next = steps[at].register;
    const lines = Array.from({ length: 9 }, (_, n) => address - 4 + n).filter((row) => row >= 0 && row < rows.length);
    const body = element("tbody", {}, ...lines.map((row) => {
      const [text, line, source] = rows[row];
      const made = element("tr", row === address ? { class: "now", "aria-current": "step" } : {}, ...[row, text, line || "", source.trim().replace(/\s+/g, " ")].map((cell) => element("td", {}, `${cell}`)));
      return made;
    }));
    const head = element("thead", {}, element("tr", {}, ...["address", "instruction", "line", "source"].map((text) => element("th", {}, text))));
    const held = [...registers].filter(([, word]) => word !== 0).sort((a, b) => a[0] - b[0]);
    const chips = held.map(([register, word]) => element("span", { class: register === next ? "next" : "" }, element("b", {}, `r${register}`), ` ${likely(word)}`));
    panel.append(
      element("p", {}, `Instruction ${grouped(at + 1)} of ${grouped(steps.length)}. `, button("‹ instruction", "Back by an instruction (,)", () => this.step("instruction", -1)), button("instruction ›", "On by an instruction (.)", () => this.step("instruction", 1))),
      element("div", { class: "table" }, element("table", { class: "listing" }, head, body)),
      element("p", { class: "registers", "aria-label": "Registers that are not 0" }, ...(chips.length ? chips : ["all registers are 0"])));
  }
}

{% endif %}
