// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// What is written over the drawing: numbers, names of islands and jumpers, contacts, a ruler, a measured distance. A label that would lie on another one
// is left out, so labels never pile up.
import {css, PALETTE} from "./colors.js";
import {pick} from "./camera.js";
import {stubOf} from "./marks.js";
import {Model} from "./model.js";

const MAX_NUMBERS = 500, CELL = 8; // pixels

/** Where labels lie already, in cells of some pixels. */
class Occupied {
  cells = new Set();
  /** Takes a place if it is free. @returns {boolean} */
  take(x, y, wide, high) {
    const cells = [];
    for (let i = Math.floor((x - wide / 2) / CELL); i <= Math.floor((x + wide / 2) / CELL); ++i) {
      for (let j = Math.floor((y - high / 2) / CELL); j <= Math.floor((y + high / 2) / CELL); ++j) {
        const cell = 65536 * i + j;
        if (this.cells.has(cell)) return false;
        cells.push(cell);
      }
    }
    for (const cell of cells) this.cells.add(cell);
    return true;
  }
}

const themeColor = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);

export class Labels {
  /** @param {CanvasRenderingContext2D} paint @param {Model} model */
  constructor(paint, model) {
    this.paint = paint;
    this.model = model;
    this.numbers = new Map(); // by view: what was computed for a camera
  }

  /** @param {any[]} views @param {{numbers: boolean, jumpers: boolean}} shown @param {{contacts: any[], selected: number, measured: any}} state */
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
      if (view.name === "flat") this.drawNames(view.camera, shown, occupied);
      if (shown.numbers) this.drawNumbers(view, state.selected, occupied);
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
  drawNames(camera, shown, occupied) {
    const {paint, model} = this;
    Object.assign(paint, {font: "600 12px system-ui, sans-serif", textAlign: "left", textBaseline: "bottom", lineWidth: 3, strokeStyle: themeColor("--back")});
    paint.fillStyle = themeColor("--front");
    model.islandCorners.forEach((corner, island) => {
      const [x, y] = camera.project(corner), placed = (text) => occupied.take(x + paint.measureText(text).width / 2, y - 8, paint.measureText(text).width, 10);
      const text = [this.nameOf(island), String(island)].find(placed); // the number alone where the name has no room
      if (text) this.write(text, x, y - 2);
    });
    if (!shown.jumpers || camera.mm_per_pixel > 1.1) return;
    Object.assign(paint, {font: "600 11px system-ui, sans-serif", textBaseline: "middle", fillStyle: css(PALETTE.jumper.color), strokeStyle: "#fff"});
    model.data.jumpers.forEach((jumper, j) => [0, 1].forEach((end) => {
      if (!model.shows(jumper.modules[end])) return;
      const {to, out} = stubOf(model, jumper, end), [x, y] = camera.project(to), text = `J${j} → ${jumper.modules[1 - end]}`, wide = paint.measureText(text).width;
      const left = x + (out[0] > 0.3 ? 3 : out[0] < -0.3 ? -wide - 3 : -wide / 2), middle = y - 8 * Math.sign(out[1]) * (Math.abs(out[1]) > 0.3 ? 1 : 0);
      if (occupied.take(left + wide / 2, middle, wide, 8)) this.write(text, left, middle);
    }));
  }

  nameOf(island) {
    const cover = (this.model.data.covers ?? []).findLast((c) => c.first_island <= island);
    return cover ? `${cover.name}: ${island - cover.first_island}` : `island ${island}`;
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
      const [x, y] = camera.project(Model.centre(shape.corners, k)), wide = 0.6 * size * String(k).length;
      if (x < 0 || y < 0 || x > camera.width || y > camera.height || area(camera, shape, k) < (k === selected ? 1 : 1.5 * wide * size)) continue;
      if (name === "cover" && pick(shape.corners, shape.normals, camera.ray(x, y), this.model.shown) !== k) continue;
      list.push({k, x, y});
      if (list.length >= MAX_NUMBERS) break;
    }
    this.numbers.set(name, {key, list});
    return list;
  }

  drawNumbers(view, selected, occupied) {
    const size = Math.min(15, 5.5 / view.camera.mm_per_pixel), paint = this.paint;
    if (size < 7) return;
    Object.assign(paint, {font: `600 ${size.toFixed(1)}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle", lineWidth: 3,
                          strokeStyle: "rgba(255,255,255,.85)", fillStyle: "#111"});
    for (const {k, x, y} of this.visible(view, size, selected))
      if (occupied.take(x, y, 0.6 * size * String(k).length, 0.8 * size)) this.write(String(k), x, y);
  }

  // A ring around each contact on the cover, also where the body hides it: then it is dashed.
  drawContacts(camera, contacts) {
    for (const contact of contacts.slice(0, 8)) {
      const [x, y] = camera.project(contact.centre);
      this.paint.setLineDash(area(camera, this.model.cover, contact.module) > 0 ? [] : [4, 4]);
      Object.assign(this.paint, {lineWidth: 2, strokeStyle: themeColor("--contact")});
      this.paint.beginPath();
      this.paint.arc(x, y, Math.max(9, 4 * Math.sqrt(contact.taxels.length) / camera.mm_per_pixel), 0, 2 * Math.PI);
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
