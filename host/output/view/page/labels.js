// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// What is written over the drawing: numbers, names of islands and jumpers, contacts, a ruler, a measured distance. A label that would lie on another one
// is left out, so labels never pile up.
import {css, PALETTE} from "./colors.js";
import {pick} from "./camera.js";
import {stubOf} from "./marks.js";
import {ISLAND_GAP_MM, Model, TAXELS} from "./model.js";

const MAX_NUMBERS = 500, CELL = 64; // the latter in pixels

const boxAround = (x, y, wide, high) => [x - wide / 2, y - high / 2, x + wide / 2, y + high / 2];

/** Where labels lie already: rectangles, each listed with the cells that it touches. */
class Occupied {
  cells = new Map();
  /** Takes a place if it is free. @returns {boolean} */
  take(x, y, wide, high) {
    if (!this.isFree(x, y, wide, high)) return false;
    const box = boxAround(x, y, wide, high);
    for (const list of this.cellsOf(box)) list.push(box);
    return true;
  }
  isFree(x, y, wide, high) {
    const box = boxAround(x, y, wide, high);
    return !this.cellsOf(box).some((list) => list.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3]));
  }
  /** @param {number[]} box @returns {number[][][]} */
  cellsOf([left, top, right, bottom]) {
    const lists = [];
    for (let i = Math.floor(left / CELL); i <= Math.floor(right / CELL); ++i) {
      for (let j = Math.floor(top / CELL); j <= Math.floor(bottom / CELL); ++j) {
        const key = 65536 * i + j;
        if (!this.cells.has(key)) this.cells.set(key, []);
        lists.push(this.cells.get(key));
      }
    }
    return lists;
  }
}

const CAPTION_PX = 20;
const NAME_FONT = "600 12px system-ui, sans-serif", JUMPER_FONT = "600 11px system-ui, sans-serif";
/** @typedef {[number, number, number, number]} Box x and y of the middle, width, height */
/** @typedef {{text: string, x: number, y: number, box: Box}} Label */

const themeColor = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);

export class Labels {
  /** @param {CanvasRenderingContext2D} paint @param {Model} model */
  constructor(paint, model) {
    this.paint = paint;
    this.model = model;
    this.numbers = new Map(); // by view: what was computed for a camera
    this.covers = /** @type {{key: string, names: Label[]} | null} */ (null);
    this.placed = /** @type {{key: string, names: Label[], jumpers: Label[]} | null} */ (null);
  }

  /** @param {any[]} views @param {{numbers: boolean, jumpers: boolean, trees: boolean}} shown @param {{contacts: any[], selected: number, measured: any}} state */
  draw(views, shown, state) {
    const canvas = this.paint.canvas;
    this.paint.clearRect(0, 0, canvas.width, canvas.height);
    for (const view of views) {
      this.paint.save();
      this.paint.translate(view.left, view.top);
      this.paint.beginPath();
      this.paint.rect(0, 0, view.camera.width, view.camera.height);
      this.paint.clip();
      const occupied = new Occupied();
      if (view.name === "flat") this.drawNames(view, shown, occupied); else this.drawCovers(view, occupied);
      if (shown.numbers) this.drawNumbers(view, state.selected, occupied, this.busyCentres(shown.trees, state.contacts));
      if (view.name === "cover") this.drawContacts(view.camera, state.contacts);
      if (state.measured?.view === view.name) this.drawMeasured(view.camera, state.measured);
      this.drawRuler(view.camera);
      this.paint.restore();
    }
  }

  write(text, x, y) {
    this.paint.strokeText(text, x, y);
    this.paint.fillText(text, x, y);
  }

  // Islands and the stubs of jumpers: what has a name of its own comes before numbers of modules.
  drawNames(view, shown, occupied) {
    const {paint} = this, {names, jumpers} = this.namesFor(view, shown.jumpers);
    for (const {box} of [...names, ...jumpers]) occupied.take(...box);
    Object.assign(paint, {font: NAME_FONT, textAlign: "left", textBaseline: "bottom", lineWidth: 3, strokeStyle: themeColor("--back")});
    paint.fillStyle = themeColor("--front");
    for (const {text, x, y} of names) this.write(text, x, y);
    Object.assign(paint, {font: JUMPER_FONT, textBaseline: "middle", fillStyle: css(PALETTE.jumper.color), strokeStyle: "#fff"});
    for (const {text, x, y} of jumpers) this.write(text, x, y);
  }

  // Where they stand; computed anew when the camera moves or other modules are shown.
  namesFor({camera}, withJumpers) {
    const key = `${camera.matrix.join()} ${camera.width} ${this.model.shownVersion} ${withJumpers}`;
    if (this.placed?.key !== key) {
      const occupied = new Occupied(), names = this.placeNames(camera, occupied, withJumpers ? this.stubsOf(camera) : new Occupied());
      this.placed = {key, names, jumpers: withJumpers ? this.placeJumpers(camera, occupied) : []};
    }
    return this.placed;
  }

  // Where the stubs of jumpers are drawn.
  stubsOf(camera) {
    const {model} = this, stubs = new Occupied();
    model.data.jumpers.forEach((jumper) => [0, 1].forEach((end) => {
      if (!model.shows(jumper.modules[end])) return;
      const {from, to} = stubOf(model, jumper, end), [x, y] = camera.project(from), [u, v] = camera.project(to);
      for (const part of [0, 0.25, 0.5, 0.75, 1]) stubs.take(x + part * (u - x), y + part * (v - y), 4, 4);
    }));
    return stubs;
  }

  // An island has its name at its left end, or at its right one where a stub lies there; its number alone where the name has no room beside the next one.
  placeNames(camera, occupied, stubs) {
    const {paint, model} = this, placed = /** @type {Label[]} */ ([]);
    paint.font = NAME_FONT;
    model.islandCorners.forEach((corner, island) => {
      const [x, y] = camera.project(corner), across = model.islandWidths[island] / camera.mm_per_pixel, room = across + ISLAND_GAP_MM / camera.mm_per_pixel;
      const name = model.islandName(island), number = name.replace(/^.* /, ""), right = (text) => x + Math.max(0, across - paint.measureText(text).width);
      const tries = /** @type {[string, number, boolean][]} */ ([[name, x, true], [name, right(name), true], [number, x, true], [number, right(number), true], [number, x, false]]);
      for (const [text, left, isClear] of tries) {
        const wide = paint.measureText(text).width, box = /** @type {Box} */ ([left + wide / 2, y - 8, wide, 12]);
        if (wide > room || (isClear && !stubs.isFree(...box)) || !occupied.take(...box)) continue;
        placed.push({text, x: left, y: y - 2, box});
        break;
      }
    });
    return placed;
  }

  // A label does not lie on a module or reach out of the pane.
  placeJumpers(camera, occupied) {
    const {paint, model} = this, placed = /** @type {Label[]} */ ([]);
    if (camera.mm_per_pixel > 1.4) return placed;
    const reach = 14 / camera.mm_per_pixel; // pixels around the centre of a module that its triangle fills
    for (let k = 0; k < model.count; ++k) {
      const [x, y] = camera.project(Model.centre(model.flat.corners, k));
      if (model.shows(k)) occupied.take(x, y, reach, reach);
    }
    paint.font = JUMPER_FONT;
    model.data.jumpers.forEach((jumper) => [0, 1].forEach((end) => {
      if (!model.shows(jumper.modules[end])) return;
      const {to, out} = stubOf(model, jumper, end), [x, y] = camera.project(to);
      const text = jumper.name, wide = paint.measureText(text).width, left = x + (out[0] > 0.3 ? 3 : out[0] < -0.3 ? -wide - 3 : -wide / 2);
      const middle = y - 8 * Math.sign(out[1]) * (Math.abs(out[1]) > 0.3 ? 1 : 0), box = /** @type {Box} */ ([left + wide / 2, middle, wide, 10]);
      if (isInPane(box, camera) && occupied.take(...box)) placed.push({text, x: left, y: middle, box});
    }));
    return placed;
  }

  // The name of each cover stands above it.
  drawCovers({camera}, occupied) {
    const {paint, model} = this, covers = model.data.covers ?? [], key = `${camera.matrix.join()} ${camera.width} ${model.shownVersion}`;
    if (covers.length === 0) return;
    Object.assign(paint, {font: NAME_FONT, textAlign: "left", textBaseline: "bottom", lineWidth: 3, strokeStyle: themeColor("--back")});
    paint.fillStyle = themeColor("--front");
    if (this.covers?.key !== key) this.covers = {key, names: covers.map((cover) => this.placeCover(camera, cover))};
    for (const {text, x, y, box} of this.covers.names) if (occupied.take(...box)) this.write(text, x, y);
  }
  /** @returns {Label} */
  placeCover(camera, cover) {
    let [left, right, top] = [Infinity, -Infinity, Infinity];
    for (let k = cover.first_module; k < cover.first_module + cover.modules; ++k) {
      if (!this.model.shows(k)) continue;
      const [x, y] = camera.project(Model.centre(this.model.cover.corners, k));
      [left, right, top] = [Math.min(left, x), Math.max(right, x), Math.min(top, y)];
    }
    const wide = this.paint.measureText(cover.name).width, x = (left + right - wide) / 2, y = Math.max(14, top - 16);
    return {text: cover.name, x, y, box: [x + wide / 2, y - 7, wide, 14]};
  }

  // Which modules show their front unhidden changes with the camera and with what is shown.
  visible(view, size, selected) {
    const {name, camera} = view, key = `${camera.matrix.join()} ${camera.width} ${this.model.shownVersion} ${selected}`, known = this.numbers.get(name);
    if (known?.key === key) return known.list;
    const list = [], shape = this.model[name], order = selected < 0 ? [] : [selected];
    for (const p of this.model.data.patches) if (p.entry >= 0) order.push(p.entry);
    for (let k = 0; k < this.model.count; ++k) order.push(k);
    const seen = new Set();
    for (const k of order) {
      if (seen.has(k) || !this.model.shows(k)) continue;
      seen.add(k);
      const [x, y] = camera.project(Model.centre(shape.corners, k)), wide = 0.6 * size * String(this.model.numberOf(k)).length;
      if (x < 0 || y < 0 || x > camera.width || y > camera.height) continue;
      if (!(k === selected ? area(camera, shape, k) > 1 : holds(camera, shape, k, wide, size))) continue;
      if (name === "cover" && pick(shape.corners, shape.normals, camera.ray(x, y), this.model.shown) !== k) continue;
      list.push({k, x, y});
      if (list.length >= MAX_NUMBERS) break;
    }
    this.numbers.set(name, {key, list});
    return list;
  }

  // Modules whose centre has something to show: the disc of an entry, a pressed taxel. @returns {Set<number>}
  busyCentres(withTrees, contacts) {
    const busy = new Set(contacts.flatMap((c) => c.taxels.map((n) => Math.floor(n / TAXELS))));
    if (withTrees) for (const p of this.model.data.patches) busy.add(p.entry); // -1 for a gap
    return busy;
  }

  drawNumbers(view, selected, occupied, busy) {
    const {mm_per_pixel} = view.camera, size = Math.min(15, Math.max(8, 5.5 / mm_per_pixel)), paint = this.paint;
    if (mm_per_pixel > 1.4) return;
    Object.assign(paint, {font: `600 ${size.toFixed(1)}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle", lineWidth: 3,
                          strokeStyle: "rgba(255,255,255,.85)", fillStyle: "#111"});
    for (const {k, x, y} of this.visible(view, size, selected)) {
      const below = busy.has(k) ? 3.4 / mm_per_pixel + 0.5 * size : 0;
      const text = String(this.model.numberOf(k));
      if (occupied.take(x, y + below, 0.6 * size * text.length + 4, 0.8 * size + 1)) this.write(text, x, y + below);
    }
  }

  // A ring around each contact on the cover, also where the body hides it: then it is dashed.
  drawContacts(camera, contacts) {
    for (const contact of contacts.slice(0, 8)) {
      const [x, y] = camera.project(contact.centre);
      this.paint.setLineDash(area(camera, this.model.cover, contact.module) > 0 ? [] : [4, 4]);
      Object.assign(this.paint, {lineWidth: 2.5, strokeStyle: themeColor("--contact")});
      this.paint.beginPath();
      this.paint.arc(x, y, Math.max(13, 4 * Math.sqrt(contact.taxels.length) / camera.mm_per_pixel), 0, 2 * Math.PI);
      this.paint.stroke();
    }
    this.paint.setLineDash([]);
  }

  drawMeasured(camera, {points}) {
    const paint = this.paint, places = points.map((p) => camera.project(p));
    Object.assign(paint, {lineWidth: 2, strokeStyle: themeColor("--contact"), fillStyle: themeColor("--contact")});
    paint.beginPath();
    places.forEach(([x, y]) => paint.lineTo(x, y));
    paint.stroke();
    for (const [x, y] of places) { paint.beginPath(); paint.arc(x, y, 4, 0, 2 * Math.PI); paint.fill(); }
    if (places.length < 2) return;
    const [x, y] = [0, 1].map((c) => (places[0][c] + places[1][c]) / 2);
    Object.assign(paint, {font: "600 13px system-ui, sans-serif", textAlign: "center", textBaseline: "bottom", lineWidth: 4, strokeStyle: themeColor("--back")});
    paint.fillStyle = themeColor("--front");
    this.write(`${distanceOf(points).toFixed(1)} mm`, x, y - 4);
  }

  drawRuler(camera) {
    const length = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000].find((mm) => mm / camera.mm_per_pixel >= 60) || 5000;
    const wide = length / camera.mm_per_pixel, x = camera.width - wide - 14, y = camera.height - 14;
    this.paint.fillStyle = themeColor("--front");
    this.paint.fillRect(x, y, wide, 3);
    Object.assign(this.paint, {font: "12px system-ui, sans-serif", textAlign: "center", textBaseline: "bottom", lineWidth: 3, strokeStyle: themeColor("--back")});
    this.write(`${length} mm`, x + wide / 2, y - 2);
  }
}

/** Straight distance of two points, mm. */
export const distanceOf = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** Area of a module on the screen, square pixels; not above 0 where it shows its back. */
export function area(camera, shape, k) {
  const p = [0, 3, 6].map((c) => camera.project(shape.corners, 9 * k + c));
  return ((p[2][0] - p[0][0]) * (p[1][1] - p[0][1]) - (p[1][0] - p[0][0]) * (p[2][1] - p[0][1])) / 2;
}

// True when a label is seen whole: inside the pane and above what is written at its lower end.
function isInPane([x, y, wide, high], camera) {
  return x >= wide / 2 && x + wide / 2 <= camera.width && y >= high / 2 && y + high / 2 <= camera.height - CAPTION_PX;
}

// True when a label fits into the triangle of a module that shows its front.
function holds(camera, shape, k, wide, high) {
  const p = [0, 3, 6].map((c) => camera.project(shape.corners, 9 * k + c)), span = (c) => Math.max(p[0][c], p[1][c], p[2][c]) - Math.min(p[0][c], p[1][c], p[2][c]);
  return area(camera, shape, k) > 0 && span(0) >= 1.5 * wide && span(1) >= 1.6 * high;
}
