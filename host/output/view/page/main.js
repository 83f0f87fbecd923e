// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Puts the page together: model, cameras, drawing, live skin, keys.
import {CanvasDrawing} from "./canvas_drawing.js";
import {bestDirection, hitOf, OrbitCamera, PlaneCamera, boxOf} from "./camera.js";
import {contactsIn, contactTold} from "./contacts.js";
import {CHANGES, colorOf, FULL_KPA, heatOf, modesOf} from "./colors.js";
import {GlDrawing} from "./gl_drawing.js";
import {History} from "./history.js";
import {Labels} from "./labels.js";
import {fillLegend} from "./legend.js";
import {FIRST_FAULT, LiveLink, LiveSkin} from "./live.js";
import {faultMarks, findingMarks, islandPoints, jumperMarks, seamMarks, selectionMarks, treeMarks} from "./marks.js";
import {Model, TAXELS} from "./model.js";
import {Player} from "./player.js";
import {byId, fillButtons, fillContacts, fillDesign, fillFaults, fillFindings, fillList, fillModule, foldParts, openPart, pressedOf, restRemark} from "./panel.js";

const PRESSURE = 1; // the mode that shows the skin
const SIDES = /** @type {[string, number[]][]} */ ([["+x", [1, 0, 0]], ["−x", [-1, 0, 0]], ["+y", [0, 1, 0]], ["−y", [0, -1, 0]], ["+z", [0, 0, 1]], ["−z", [0, 0, -1]]]);

class Page {
  link = /** @type {LiveLink | null} */ (null);
  player = /** @type {Player | null} */ (null);
  health = /** @type {any} */ (null);
  healthAt = 0;
  contactsAt = 0;
  contacts = /** @type {import("./contacts.js").Contact[]} */ ([]);
  told = /** @type {import("./contacts.js").Contact[]} */ ([]); // the newest of the server or the recording; `contacts` are those that are shown
  lastFrame = 0;
  fresh = false;         // a frame of the skin came since the last drawing
  faultsChanged = false;

  /** @param {Model} model @param {boolean} online the page comes from a server with a live skin @param {ArrayBuffer | null} track of a recording */
  constructor(model, online, track) {
    this.model = model;
    this.live = new LiveSkin(model.count);
    this.modes = modesOf(model);
    this.mode = 0;
    this.selected = -1;
    this.shown = /** @type {Record<string, boolean>} */ ({});
    this.heat = new Float32Array(TAXELS * model.count);
    this.latencies = /** @type {number[]} */ ([]);
    this.intervals = /** @type {number[]} */ ([]);
    this.history = new History();
    this.measured = /** @type {{view: string, points: number[][]} | null} */ (null); // being measured
    this.dirty = true;
    this.views = this.makeViews();
    this.drawing = this.makeDrawing(byId("drawing"));
    this.labels = new Labels(byId("labels").getContext("2d"), model);
    foldParts();
    this.fillControls();
    this.paintMarks();
    fillDesign(model);
    fillFindings(model, (k) => this.select(k, true));
    this.resetHeat();
    if (online && !track) this.goOnline();
    for (const id of online && !track ? [] : ["live-part"]) byId(id).hidden = true;
    for (const id of online || track ? [] : ["contact-part", "fault-part"]) byId(id).hidden = true;
    this.hasSkin = online || Boolean(track);
    this.restTold = "";
    new ResizeObserver(() => this.resize()).observe(byId("stage"));
    this.setMode(this.link ? PRESSURE : Math.max(0, this.modes.findIndex((mode) => mode.name === CHANGES)));
    for (const part of this.hasSkin ? ["trees", "seams"] : []) byId(`show-${part}`).click(); // whoever looks at pressure does not look at wires
    this.resize();
    openPart(this.hasSkin ? "contact-part" : "design-part");
    const place = /^#module-(\d+)$/.exec(location.hash); // view begins at the module that its argument named
    if (place) this.select(this.model.moduleOf(place[1]), true);
    if (track) this.openRecording(track);
    requestAnimationFrame((at) => this.frame(at));
  }

  makeViews() {
    const {cover, data} = this.model, points = new Float32Array(cover.corners.length + data.surface.vertices.length);
    points.set(cover.corners);
    points.set(data.surface.vertices, cover.corners.length);
    return [{name: "cover", camera: new OrbitCamera(points, bestDirection(cover.normals)), left: 0, top: 0},
            {name: "flat", camera: new PlaneCamera(boxOf(islandPoints(this.model))), left: 0, top: 0}];
  }

  makeDrawing(canvas) {
    try {
      return new GlDrawing(canvas, this.model);
    } catch (e) {
      console.info(`drawn without WebGL: ${e}`);
      return new CanvasDrawing(canvas, this.model);
    }
  }

  fillControls() {
    byId("mode").replaceChildren(...this.modes.map((m, k) => new Option(m.name, String(k))));
    byId("mode").onchange = () => this.setMode(Number(byId("mode").value));
    for (const part of ["surface", "trees", "seams", "jumpers", "taxels", "numbers"]) {
      const box = byId(`show-${part}`);
      box.onchange = () => { this.shown[part] = box.checked; this.showLegend(); this.dirty = true; };
      this.shown[part] = box.checked;
    }
    byId("joint-fails").onchange = () => { this.paintColors(); this.paintSelection(); };
    byId("find").onchange = () => this.select(this.model.moduleOf(byId("find").value), true);
    byId("theme").onclick = () => this.setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
    byId("help").onclick = () => { byId("keys").hidden = !byId("keys").hidden; byId("help").setAttribute("aria-expanded", String(!byId("keys").hidden)); };
    this.setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    fillButtons("sides", [["3-D", () => this.look(null)], ...SIDES.map(([name, toward]) => /** @type {[string, () => void]} */ ([name, () => this.look(toward)]))]);
    byId("measure").onclick = () => this.measure(!this.measured);
    byId("show-all").onclick = () => this.showOnly(() => true);
    this.views.forEach((view) => this.listen(view, byId(`pane-${view.name}`)));
  }

  setTheme(name) { document.documentElement.dataset.theme = name; this.dirty = true; this.paintSelection(); }

  listen(view, pane) {
    let drag = /** @type {{x: number, y: number, moved: boolean} | null} */ (null);
    pane.onpointerdown = (e) => { drag = {x: e.clientX, y: e.clientY, moved: false}; pane.setPointerCapture(e.pointerId); };
    pane.onpointermove = (e) => {
      if (!drag) return;
      const dx = e.clientX - drag.x, dy = e.clientY - drag.y;
      if (!drag.moved && Math.hypot(dx, dy) < 4) return;
      Object.assign(drag, {x: e.clientX, y: e.clientY, moved: true});
      e.shiftKey || e.buttons & 6 ? view.camera.move(dx, dy) : view.camera.turn(dx, dy);
      this.dirty = true;
    };
    pane.onpointerup = (e) => {
      if (drag && !drag.moved) this.click(view, e.offsetX, e.offsetY);
      drag = null;
    };
    pane.oncontextmenu = (e) => e.preventDefault();
    pane.addEventListener("wheel", (e) => { e.preventDefault(); view.camera.zoom(Math.exp(e.deltaY * 0.0012)); this.dirty = true; }, {passive: false});
    pane.onkeydown = (e) => { if (this.key(view.camera, e)) e.preventDefault(); };
  }

  key(camera, e) {
    if (e.ctrlKey || e.altKey || e.metaKey) return false;
    const toggle = (part) => byId(`show-${part}`).click();
    const choose = (step) => this.select((Math.max(this.selected, step > 0 ? -1 : 0) + step + this.model.count) % this.model.count, false);
    const actions = {
      ArrowLeft: () => camera.turn(-40, 0), ArrowRight: () => camera.turn(40, 0), ArrowUp: () => camera.turn(0, -40), ArrowDown: () => camera.turn(0, 40),
      "+": () => camera.zoom(0.85), "=": () => camera.zoom(0.85), "-": () => camera.zoom(1 / 0.85), 0: () => camera.reset(), "[": () => choose(-1), "]": () => choose(1),
      Escape: () => this.select(-1, false), c: () => toggle("surface"), t: () => toggle("trees"), s: () => toggle("seams"), j: () => toggle("jumpers"), x: () => toggle("taxels"),
      n: () => toggle("numbers"), m: () => this.setMode((this.mode + 1) % this.modes.length), f: () => this.focus(),
      i: () => this.isolate("patch"), a: () => this.showOnly(() => true), d: () => this.measure(!this.measured),
      p: () => this.player?.toggle(), l: () => byId("joint-fails").click(),
    };
    SIDES.forEach(([, toward], n) => { actions[n + 1] = () => this.look(toward); });
    const action = actions[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (action) { action(); this.dirty = true; }
    return Boolean(action);
  }

  /** Looks along an axis; null: as at first. @param {number[] | null} toward */
  look(toward) {
    const camera = /** @type {OrbitCamera} */ (this.views[0].camera);
    if (toward) camera.look(toward, true); else camera.reset();
    this.dirty = true;
  }

  /** @param {boolean} on */
  measure(on) {
    this.measured = on ? {view: "", points: []} : null;
    byId("measure").setAttribute("aria-pressed", String(on));
    this.dirty = true;
  }

  /** Shows the modules for which `wanted` holds. @param {(k: number) => boolean} wanted */
  showOnly(wanted) {
    this.model.show(wanted);
    const hidden = this.model.shown.reduce((n, shown) => n + 1 - shown, 0);
    byId("show-all").hidden = hidden === 0;
    byId("show-all").textContent = `show all (${hidden} hidden)`;
    this.drawing.showModules();
    this.paintMarks();
    this.paintColors();
    this.paintSelection();
    this.resetHeat(false);
  }
  /** Shows only the controller ("patch") or the island of the chosen module. @param {string} row */
  isolate(row) {
    if (this.selected < 0) return;
    const value = this.model.modules[this.selected][row];
    this.showOnly((k) => this.model.modules[k][row] === value);
  }
  /** Hides them. @param {string} row */
  hide(row) {
    const value = this.model.modules[this.selected][row], before = this.model.shown.slice();
    this.showOnly((k) => before[k] === 1 && this.model.modules[k][row] !== value);
  }

  // Marks that stay until other modules are shown.
  paintMarks() {
    const {model} = this;
    for (const {name} of this.views) {
      this.drawing.setMarks(name, "trees", treeMarks(model, model[name]));
      this.drawing.setMarks(name, "seams", seamMarks(model, model[name]));
      this.drawing.setMarks(name, "jumpers", jumperMarks(model, model[name]));
      this.drawing.setMarks(name, "findings", model.findings.size ? findingMarks(model, model[name]) : null);
    }
  }

  isFaulty(k) { return this.live.heard[k] === 1 && this.live.state[k] >= FIRST_FAULT; }
  hasFaults() { return this.live.state.some((_, k) => this.isFaulty(k)); }
  showLegend() { fillLegend(this.modes[this.mode], this.model, this.shown, {faults: this.hasFaults(), findings: this.model.findings.size > 0, skin: this.hasSkin}); }

  click(view, x, y) {
    const shape = this.model[view.name], hit = hitOf(shape.corners, shape.normals, view.camera.ray(x, y), this.model.shown), {module} = hit;
    if (this.measured) {
      if (module < 0) return;
      if (this.measured.view !== view.name || this.measured.points.length === 2) this.measured = {view: view.name, points: []};
      this.measured.points.push(hit.at);
      this.dirty = true;
      return;
    }
    this.select(module, false);
    if (this.link && byId("finger").checked) this.link.send(module < 0 ? {do: "lift"} : {do: "press", module, taxel: -1});
  }

  /** Chooses a module in both views; −1: none. @param {number} module @param {boolean} focus bring it to the middle */
  select(module, focus) {
    this.selected = Number.isInteger(module) && module >= 0 && module < this.model.count ? module : -1;
    byId("find").value = this.selected < 0 ? "" : this.model.nameOf(this.selected);
    if (this.selected < 0) byId("module").textContent = "Click a module, or choose it by number.";
    if (this.selected >= 0) { fillModule(this.model, this.live, this.selected); openPart("module-part"); }
    this.fillModuleButtons();
    if (focus) this.focus();
    this.paintColors();
    this.paintSelection();
  }

  fillModuleButtons() {
    const k = this.selected;
    byId("filters").hidden = k < 0;
    fillButtons("filters", [["only its controller", () => this.isolate("patch")], ["only its island", () => this.isolate("island")],
                            ["hide controller", () => this.hide("patch")], ["hide island", () => this.hide("island")]]);
    fillButtons("taxels", k < 0 || !this.hasSkin ? [] : Array.from({length: TAXELS}, (_, t) => t).filter((t) => this.model.pressure[t]).map(
      (t) => [String(t), () => { this.history.toggle(k, t); this.fillModuleButtons(); this.history.draw(this.live.newest_ms, this.model); }, this.history.has(k, t)]));
  }

  focus() {
    if (this.selected < 0) return;
    for (const {name, camera} of this.views) {
      const shape = this.model[name];
      camera.focus(Model.centre(shape.corners, this.selected), Array.from(shape.normals.subarray(3 * this.selected, 3 * this.selected + 3)));
    }
    this.dirty = true;
  }

  setMode(mode) {
    this.mode = mode;
    byId("mode").value = String(mode);
    this.showLegend();
    this.paintColors();
    this.paintSelection();
  }

  /** The failure that is shown: of the chosen module, or of its joint to the parent. */
  failure() {
    const parent = this.model.modules[this.selected].parent;
    return this.model.failureOf(this.selected, byId("joint-fails").checked ? parent : -1);
  }

  showsFailure() { return this.selected >= 0 && this.modes[this.mode].name === "loss when it fails"; }

  paintColors() {
    const colors = new Float32Array(3 * this.model.count);
    for (let k = 0; k < this.model.count; ++k)
      colors.set(this.isFaulty(k) ? colorOf("fault") : this.modes[this.mode].color(k), 3 * k);
    if (this.showsFailure()) {
      const failure = this.failure();
      for (const k of failure.cut) colors.set(colorOf(failure.lost.includes(k) ? "lost" : "rerouted"), 3 * k);
    }
    this.drawing.setColors(colors);
    this.dirty = true;
  }

  paintSelection() {
    if (!this.drawing) return;
    const pickColor = document.documentElement.dataset.theme === "dark" ? [1, 0.37, 0.9] : [0.72, 0, 0.61];
    const failure = this.showsFailure() ? this.failure() : null;
    byId("joint-part").hidden = !failure || this.model.modules[this.selected].parent < 0;
    for (const {name} of this.views)
      this.drawing.setMarks(name, "selection", this.selected < 0 ? null : selectionMarks(this.model, this.model[name], this.selected, failure, pickColor));
    this.dirty = true;
  }

  // −1: no valid value, −2: of a hidden module.
  heatAt(k, t, valid) {
    if (!this.model.shows(k)) return -2;
    return this.model.pressure[t] && valid ? this.heatOf(TAXELS * k + t) : -1;
  }
  /** @param {number} n 12 · module + taxel */
  heatOf(n) {
    const counts = this.live.pressureOf(n);
    return this.model.isCalibrated ? heatOf(counts, this.model.pressureIn(n, counts) / FULL_KPA) : heatOf(counts);
  }
  /** @param {boolean} atRest as if nothing had been heard; otherwise as the skin is */
  resetHeat(atRest = true) {
    for (let k = 0; k < this.model.count; ++k) {
      for (let t = 0; t < TAXELS; ++t) this.heat[TAXELS * k + t] = this.heatAt(k, t, atRest || !this.live.heard[k] || (this.live.valid[k] >> t & 1));
    }
    this.drawing.setHeat(this.heat);
    this.dirty = true;
  }

  openRecording(track) {
    byId("recording-part").hidden = false;
    this.setMode(PRESSURE);
    this.player = new Player(track, (entry) => this.takeEntry(entry), () => {
      this.live = new LiveSkin(this.model.count);
      this.contacts = this.told = [];
      this.resetHeat();
      this.paintColors();
    });
    this.player.toggle();
  }

  goOnline() {
    const link = new LiveLink((bytes) => this.takeFrame(bytes), (health) => this.takeHealth(health), (contacts) => { this.told = contacts.map(contactTold); });
    this.link = link;
    byId("rest").onclick = () => link.send({do: "rest"});
    byId("finger").onchange = () => { if (!byId("finger").checked) link.send({do: "lift"}); };
  }

  takeEntry(bytes) {
    const contacts = contactsIn(bytes);
    if (!contacts) return this.takeFrame(bytes);
    this.told = contacts;
    this.fresh = this.dirty = true;
  }

  takeFrame(bytes) {
    const before = this.live.state.slice(), heard = this.live.heard.slice();
    const changed = this.live.take(bytes);
    for (const k of changed) {
      for (let t = 0; t < TAXELS; ++t) this.heat[TAXELS * k + t] = this.heatAt(k, t, this.live.valid[k] >> t & 1);
    }
    if (changed.some((k) => before[k] !== this.live.state[k] || !heard[k])) { this.faultsChanged = true; this.paintColors(); this.paintFaults(); }
    this.history.remember(this.live, changed, this.model);
    this.drawing.setHeat(this.heat);
    this.fresh = true;
    this.dirty = true;
  }

  paintFaults() {
    const some = this.hasFaults();
    for (const {name} of this.views) this.drawing.setMarks(name, "faults", some ? faultMarks(this.model, this.model[name], (k) => this.isFaulty(k)) : null);
    this.showLegend();
  }

  takeHealth(health) {
    const now = performance.now(), seconds = this.healthAt ? (now - this.healthAt) / 1000 : 0;
    const rate = this.health && seconds > 0 ? (health.frames - this.health.frames) / seconds / Math.max(1, this.model.count) : 0;
    this.healthAt = now;
    this.health = health;
    const middleOf = (list) => list.length ? list.slice().sort((a, b) => a - b)[list.length >> 1].toFixed(0) : "–";
    const rows = /** @type {[string, string|number][]} */ ([["link", health.link || "–"], ["state", health.live ? "live" : health.link === "none" ? "none" : "no samples"]]);
    if (health.live) rows.push(["samples a second", rate.toFixed(1)], ["received", health.frames], ["lost", health.lost], ["sample to screen", `${middleOf(this.latencies)} ms`],
                               ["frame time", `${middleOf(this.intervals)} ms`]);
    fillList(byId("link"), rows);
    this.showTrouble();
    if (health.live || this.faultsChanged) fillFaults(this.model, this.live, (k) => this.select(k, true));
    this.faultsChanged = false;
    if (this.selected >= 0) fillModule(this.model, this.live, this.selected);
    this.history.draw(this.live.newest_ms, this.model);
  }

  // What is wrong with the link, else that taxels do not rest where they should.
  showTrouble() { byId("trouble").textContent = this.health?.trouble || this.restTold; }

  /** Contacts are listed ten times a second at most: a person reads no faster. */
  showContacts() {
    const now = performance.now();
    if (now - this.contactsAt < 100) return;
    this.contactsAt = now;
    this.contacts = this.told;
    this.restTold = restRemark(this.model, this.live);
    this.showTrouble();
    fillContacts(this.model, this.contacts, (k) => this.select(k, true));
  }

  resize() {
    const stage = byId("stage"), labels = byId("labels"), ratio = window.devicePixelRatio || 1;
    const wide = stage.clientWidth, high = stage.clientHeight, stacked = wide < 1.1 * high;
    const half = Math.floor((stacked ? high : wide) / 2), rest = (stacked ? high : wide) - half;
    stage.classList.toggle("stacked", stacked);
    this.drawing.resize(wide, high);
    labels.width = wide * ratio;
    labels.height = high * ratio;
    this.labels.paint.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.views.forEach((view, k) => {
      view.left = stacked ? 0 : k * half;
      view.top = stacked ? k * half : 0;
      if (stacked) view.camera.resize(wide, k ? rest : half); else view.camera.resize(k ? rest : half, high);
    });
    this.dirty = true;
  }

  frame(at) {
    requestAnimationFrame((next) => this.frame(next));
    if (this.player) this.player.step(at);
    if (this.player && this.fresh) this.history.draw(this.live.newest_ms, this.model);
    if (this.player && this.faultsChanged) { fillFaults(this.model, this.live, (k) => this.select(k, true)); this.faultsChanged = false; }
    if (!this.dirty) { this.lastFrame = 0; return; }
    this.dirty = false;
    if (this.fresh) this.showContacts(); // before the labels, which draw them: a recording may stand still after this frame
    this.drawing.draw(this.views, this.shown);
    this.drawLabels();
    if (this.lastFrame) keep(this.intervals, at - this.lastFrame);
    this.lastFrame = at;
    if (this.fresh) keep(this.latencies, Date.now() - this.live.newest_ms);
    this.fresh = false;
    document.documentElement.dataset.ready = "yes";
  }

  drawLabels() { this.labels.draw(this.views, /** @type {any} */ (this.shown), this); }

  /** Where a taxel is drawn, in pixels of the window; for tests. */
  placeOf(viewName, module, taxel) {
    const view = viewName === "cover" ? this.views[0] : this.views[1], stage = byId("stage").getBoundingClientRect();
    const shape = this.model[viewName];
    const [x, y] = taxel < 0 ? view.camera.project(Model.centre(shape.corners, module)) : view.camera.project(shape.taxels, 36 * module + 3 * taxel);
    return [stage.left + view.left + x, stage.top + view.top + y];
  }
  pressed(module) { return pressedOf(this.model, this.live, module); }
}

function keep(list, value) {
  list.push(value);
  if (list.length > 600) list.shift();
}

async function load() {
  const inside = document.getElementById("model"), recorded = document.getElementById("recording");
  if (inside) return {data: JSON.parse(inside.textContent || ""), online: false, track: recorded ? bytesOf(recorded.textContent || "") : null};
  const answer = await fetch("model.json");
  if (!answer.ok) throw new Error(`the design cannot be read (${answer.status}); open the address that triskin view printed`);
  const data = await answer.json();
  return {data, online: data.live, track: data.recording ? await (await fetch("recording.bin")).arrayBuffer() : null};
}

/** @param {string} text base64 */
function bytesOf(text) {
  const characters = atob(text), bytes = new Uint8Array(characters.length);
  for (let k = 0; k < bytes.length; ++k) bytes[k] = characters.charCodeAt(k);
  return bytes.buffer;
}

load().then(({data, online, track}) => { /** @type {any} */ (window).triskin = new Page(new Model(data), online, track); },
            (e) => { document.body.textContent = String(e); });
