// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Puts the page together: model, cameras, drawing, live skin, keys.
import {CanvasDrawing} from "./canvas_drawing.js";
import {boxOf, OrbitCamera, pick, PlaneCamera} from "./camera.js";
import {contactsOf} from "./contacts.js";
import {FAULT, heatOf, modesOf} from "./colors.js";
import {GlDrawing} from "./gl_drawing.js";
import {FIRST_FAULT, LiveLink, LiveSkin} from "./live.js";
import {jumperMarks, seamMarks, selectionMarks, treeMarks} from "./marks.js";
import {Model, TAXELS} from "./model.js";
import {Player} from "./player.js";
import {byId, drawHistory, fillContacts, fillDesign, fillFaults, fillLegend, fillList, fillModule, pressedOf} from "./panel.js";

const LOST = [0.85, 0.1, 0.1], REROUTED = [0.95, 0.6, 0.1];

class Page {
  link = /** @type {LiveLink | null} */ (null);
  player = /** @type {Player | null} */ (null);
  health = /** @type {any} */ (null);
  healthAt = 0;
  contactsAt = 0;
  contacts = /** @type {import("./contacts.js").Contact[]} */ ([]);
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
    this.history = /** @type {{at: number, value: number}[]} */ ([]);
    this.dirty = true;
    this.views = this.makeViews();
    this.drawing = this.makeDrawing(byId("drawing"));
    this.labels = byId("labels").getContext("2d");
    for (const {name} of this.views) {
      this.drawing.setMarks(name, "trees", treeMarks(model, model[name]));
      this.drawing.setMarks(name, "seams", seamMarks(model, model[name]));
      this.drawing.setMarks(name, "jumpers", jumperMarks(model, model[name]));
    }
    this.fillControls();
    fillDesign(model);
    this.resetHeat();
    if (online && !track) this.goOnline();
    for (const id of online && !track ? [] : ["live-part"]) byId(id).hidden = true;
    for (const id of online || track ? [] : ["contact-part", "fault-part"]) byId(id).hidden = true;
    byId("history").hidden = !online || Boolean(track);
    new ResizeObserver(() => this.resize()).observe(byId("stage"));
    this.setMode(0);
    this.resize();
    const place = /^#module-(\d+)$/.exec(location.hash); // view begins at the module that its argument named
    if (place) this.select(Number(place[1]), true);
    if (track) this.openRecording(track);
    requestAnimationFrame((at) => this.frame(at));
  }

  makeViews() {
    const {cover, flat, data} = this.model, toward = [0, 0, 0];
    for (let k = 0; k < cover.normals.length; ++k) toward[k % 3] += cover.normals[k];
    const box = boxOf(data.surface.vertices.length ? data.surface.vertices : cover.corners);
    return [{name: "cover", camera: new OrbitCamera(box, Math.hypot(...toward) > 1e-3 ? toward : [0, -1, 0.3]), left: 0, top: 0},
            {name: "flat", camera: new PlaneCamera(boxOf(flat.corners)), left: 0, top: 0}];
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
      box.onchange = () => { this.shown[part] = box.checked; this.dirty = true; };
      this.shown[part] = box.checked;
    }
    byId("joint-fails").onchange = () => { this.paintColors(); this.paintSelection(); };
    byId("find").max = String(this.model.count - 1);
    byId("find").onchange = () => this.select(byId("find").value === "" ? -1 : Number(byId("find").value), true);
    byId("theme").onclick = () => this.setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
    byId("help").onclick = () => { byId("keys").hidden = !byId("keys").hidden; byId("help").setAttribute("aria-expanded", String(!byId("keys").hidden)); };
    this.setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
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
      p: () => this.player?.toggle(), l: () => byId("joint-fails").click(),
    };
    const action = actions[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (action) { action(); this.dirty = true; }
    return Boolean(action);
  }

  click(view, x, y) {
    const shape = this.model[view.name];
    const module = pick(shape.corners, shape.normals, view.camera.ray(x, y));
    this.select(module, false);
    if (this.link && byId("finger").checked) this.link.send(module < 0 ? {do: "lift"} : {do: "press", module, taxel: -1});
  }

  /** Chooses a module in both views; −1: none. @param {number} module @param {boolean} focus bring it to the middle */
  select(module, focus) {
    this.selected = Number.isInteger(module) && module >= 0 && module < this.model.count ? module : -1;
    byId("find").value = this.selected < 0 ? "" : String(this.selected);
    this.history = [];
    if (this.selected < 0) byId("module").textContent = "Click a module, or choose it by number.";
    if (this.selected >= 0) fillModule(this.model, this.live, this.selected);
    if (focus) this.focus();
    this.paintColors();
    this.paintSelection();
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
    fillLegend(this.modes[mode].legend);
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
      colors.set(this.live.heard[k] && this.live.state[k] >= FIRST_FAULT ? FAULT : this.modes[this.mode].color(k), 3 * k);
    if (this.showsFailure()) {
      const failure = this.failure();
      for (const k of failure.cut) colors.set(failure.lost.includes(k) ? LOST : REROUTED, 3 * k);
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

  resetHeat() {
    for (let k = 0; k < this.heat.length; ++k) this.heat[k] = this.model.pressure[k % TAXELS] ? 0 : -1;
    this.drawing.setHeat(this.heat);
  }

  openRecording(track) {
    byId("recording-part").hidden = false;
    this.setMode(1); // live
    this.player = new Player(track, (frame) => this.takeFrame(frame), () => {
      this.live = new LiveSkin(this.model.count);
      this.contacts = [];
      this.resetHeat();
      this.paintColors();
    });
  }

  goOnline() {
    const link = new LiveLink((bytes) => this.takeFrame(bytes), (health) => this.takeHealth(health));
    this.link = link;
    byId("rest").onclick = () => link.send({do: "rest"});
    byId("finger").onchange = () => { if (!byId("finger").checked) link.send({do: "lift"}); };
  }

  takeFrame(bytes) {
    const before = this.live.state.slice(), heard = this.live.heard.slice();
    const changed = this.live.take(bytes);
    for (const k of changed) {
      for (let t = 0; t < TAXELS; ++t) {
        const valid = this.live.valid[k] >> t & 1;
        this.heat[TAXELS * k + t] = this.model.pressure[t] && valid ? heatOf(this.live.change[TAXELS * k + t]) : -1;
      }
    }
    if (changed.some((k) => before[k] !== this.live.state[k] || !heard[k])) { this.faultsChanged = true; this.paintColors(); }
    if (changed.includes(this.selected)) this.remember();
    this.drawing.setHeat(this.heat);
    this.fresh = true;
    this.dirty = true;
  }

  remember() {
    const values = this.live.change.subarray(TAXELS * this.selected, TAXELS * (this.selected + 1));
    const now = performance.now();
    this.history.push({at: now, value: Math.max(...values.map((v, t) => this.model.pressure[t] ? Math.abs(v) : 0))});
    while (this.history[0].at < now - 10000) this.history.shift();
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
    byId("trouble").textContent = health.trouble;
    if (health.live || this.faultsChanged) fillFaults(this.live, (k) => this.select(k, true));
    this.faultsChanged = false;
    if (this.selected >= 0) fillModule(this.model, this.live, this.selected);
    if (this.selected >= 0) drawHistory(this.history, now);
  }

  /** Contacts are listed ten times a second at most: a person reads no faster. */
  showContacts() {
    const now = performance.now();
    if (now - this.contactsAt < 100) return;
    this.contactsAt = now;
    this.contacts = contactsOf(this.model, this.live);
    fillContacts(this.contacts, (k) => this.select(k, true));
  }

  resize() {
    const stage = byId("stage"), labels = byId("labels"), ratio = window.devicePixelRatio || 1;
    const wide = stage.clientWidth, high = stage.clientHeight, half = Math.floor(wide / 2);
    this.drawing.resize(wide, high);
    labels.width = wide * ratio;
    labels.height = high * ratio;
    this.labels.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.views.forEach((view, k) => { view.left = k * half; view.top = 0; view.camera.resize(k ? wide - half : half, high); });
    this.dirty = true;
  }

  frame(at) {
    requestAnimationFrame((next) => this.frame(next));
    if (this.player) this.player.step(at);
    if (this.player && this.faultsChanged) { fillFaults(this.live, (k) => this.select(k, true)); this.faultsChanged = false; }
    if (!this.dirty) { this.lastFrame = 0; return; }
    this.dirty = false;
    this.drawing.draw(this.views, this.shown);
    this.drawLabels();
    if (this.lastFrame) keep(this.intervals, at - this.lastFrame);
    this.lastFrame = at;
    if (this.fresh) this.showContacts();
    if (this.fresh) keep(this.latencies, Date.now() - this.live.newest_ms);
    this.fresh = false;
    document.documentElement.dataset.ready = "yes";
  }

  drawLabels() {
    const stage = byId("stage");
    this.labels.clearRect(0, 0, stage.clientWidth, stage.clientHeight);
    for (const view of this.views) {
      this.labels.save();
      this.labels.translate(view.left, view.top);
      this.labels.beginPath();
      this.labels.rect(0, 0, view.camera.width, view.camera.height);
      this.labels.clip();
      if (this.shown.numbers) this.drawNumbers(view);
      this.labels.restore();
    }
    this.drawRuler(this.views[1]);
    this.drawContacts(this.views[0]);
  }

  // Which modules show their front unhidden changes only with the camera.
  visibleNumbers({name, camera}) {
    const key = camera.matrix.join() + camera.width, shape = this.model[name];
    if (camera.numbersOf === key) return camera.numbers;
    camera.numbersOf = key;
    camera.numbers = [];
    for (let k = 0; k < this.model.count; ++k) {
      const [x, y] = camera.project(Model.centre(shape.corners, k));
      if (x < 0 || y < 0 || x > camera.width || y > camera.height || !this.faces(camera, shape, k)) continue;
      if (name === "flat" || pick(shape.corners, shape.normals, camera.ray(x, y)) === k) camera.numbers.push({k, x, y});
    }
    return camera.numbers;
  }

  drawNumbers(view) {
    const size = Math.min(15, 5.5 / view.camera.mm_per_pixel);
    if (size < 7) return;
    Object.assign(this.labels, {font: `600 ${size.toFixed(1)}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle", lineWidth: 3});
    this.labels.strokeStyle = "rgba(255,255,255,.85)";
    this.labels.fillStyle = "#111";
    for (const {k, x, y} of this.visibleNumbers(view)) {
      this.labels.strokeText(String(k), x, y);
      this.labels.fillText(String(k), x, y);
    }
  }

  // A ring around each contact on the cover, also where the body hides it: then it is dashed.
  drawContacts({left, camera}) {
    for (const contact of this.contacts.slice(0, 8)) {
      const [x, y] = camera.project(contact.centre);
      const hidden = !this.faces(camera, this.model.cover, contact.module);
      this.labels.setLineDash(hidden ? [4, 4] : []);
      Object.assign(this.labels, {lineWidth: 2, strokeStyle: getComputedStyle(document.documentElement).getPropertyValue("--pick")});
      this.labels.beginPath();
      this.labels.arc(left + x, y, Math.max(9, 8 * Math.sqrt(contact.taxels.length) / camera.mm_per_pixel / 2), 0, 2 * Math.PI);
      this.labels.stroke();
    }
    this.labels.setLineDash([]);
  }

  faces(camera, shape, k) {
    const p = [0, 3, 6].map((c) => camera.project(shape.corners, 9 * k + c));
    return (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) < (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
  }

  drawRuler({left, camera}) {
    const length = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000].find((mm) => mm / camera.mm_per_pixel >= 60) || 5000;
    const wide = length / camera.mm_per_pixel, x = left + camera.width - wide - 14, y = camera.height - 14;
    this.labels.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--front");
    this.labels.fillRect(x, y, wide, 3);
    Object.assign(this.labels, {font: "12px system-ui, sans-serif", textAlign: "center", textBaseline: "bottom"});
    this.labels.fillText(`${length} mm`, x + wide / 2, y - 2);
  }

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
  return {data, online: true, track: data.recording ? await (await fetch("recording.bin")).arrayBuffer() : null};
}

/** @param {string} text base64 */
function bytesOf(text) {
  const characters = atob(text), bytes = new Uint8Array(characters.length);
  for (let k = 0; k < bytes.length; ++k) bytes[k] = characters.charCodeAt(k);
  return bytes.buffer;
}

load().then(({data, online, track}) => { /** @type {any} */ (window).triskin = new Page(new Model(data), online, track); },
            (e) => { document.body.textContent = String(e); });
