// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// The design as the page needs it: typed arrays for drawing, and questions about the wiring.

import {bestDirection, rightOf} from "./camera.js";

const ROW_MM = 25.980762113533160; // height of a module of side 30 mm
export const TAXELS = 12;
/** Space between islands on the plane: room for names and for stubs of jumpers, mm. */
export const ISLAND_GAP_MM = 36;
const BESIDE_MM = 25; // between two designs that are compared

/** Point of the lattice, mm. @param {number} i @param {number} j @param {number} side */
function latticePoint(i, j, side) {
  return [side * (i + j / 2), (ROW_MM / 30) * side * j];
}

/** Corners of a tile in the plane of its island. @param {number[]} tile @param {number} side */
function tileCorners([i, j, up], side) {
  const corners = up ? [[i, j], [i + 1, j], [i, j + 1]] : [[i + 1, j], [i + 1, j + 1], [i, j + 1]];
  return corners.map(([a, b]) => latticePoint(a, b, side));
}

/** A point of a list of coordinates. @param {ArrayLike<number>} p @param {number} at */
export const pointAt = (p, at) => [p[at], p[at + 1], p[at + 2]];

/** Unit normal of a triangle. @param {ArrayLike<number>} p @param {number} at */
export function normalOf(p, at) {
  const ax = p[at + 3] - p[at], ay = p[at + 4] - p[at + 1], az = p[at + 5] - p[at + 2];
  const bx = p[at + 6] - p[at], by = p[at + 7] - p[at + 1], bz = p[at + 8] - p[at + 2];
  const n = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
  const length = Math.hypot(n[0], n[1], n[2]) || 1;
  return n.map((v) => v / length);
}

/** Lays the islands out in rows of about the shape of a screen. @returns {number[][]} shift of each island, mm */
function packIslands(boxes) {
  const gap = ISLAND_GAP_MM;
  const order = boxes.map((_, k) => k).sort((a, b) => boxes[b].height - boxes[a].height);
  const area = boxes.reduce((sum, b) => sum + (b.width + gap) * (b.height + gap), 0);
  const rowWidth = Math.max(0.82 * Math.sqrt(area), // a pane is higher than wide
                             ...boxes.map((b) => b.width));
  const shift = boxes.map(() => [0, 0]);
  let x = 0, y = 0, rowHeight = 0;
  for (const k of order) {
    if (x > 0 && x + boxes[k].width > rowWidth) { x = 0; y -= rowHeight + gap; rowHeight = 0; }
    shift[k] = [x - boxes[k].left, y - boxes[k].top];
    x += boxes[k].width + gap;
    rowHeight = Math.max(rowHeight, boxes[k].height);
  }
  return shift;
}

export class Model {
  /** Upper left corner of each island on the plane, and how wide it is, mm. */
  islandCorners = /** @type {number[][]} */ ([]);
  islandWidths = /** @type {number[]} */ ([]);
  /** @param {any} data what model.json holds (model_json() in page.hpp) */
  constructor(data) {
    this.data = data;
    this.count = data.modules.length;
    /** @type {any[]} */
    this.modules = data.modules;
    this.cover = this.coverShape();
    if (data.changes?.length) this.partCovers();
    this.flat = this.flatShape();
    this.children = this.modules.map(() => /** @type {number[]} */ ([]));
    this.modules.forEach((m, k) => { if (m.parent >= 0) this.children[m.parent].push(k); });
    /** Corners of what is left of a module whose corners may be cut off. */
    this.corners = data.corner_cut_mm > 0 ? 6 : 3;
    /** Counts that a kPa is worth, by 12 · module + taxel; empty: the skin is not calibrated. @type {number[]} */
    this.countsPerKpa = data.counts_per_kpa ?? [];
    this.pressure = Array.from({length: TAXELS}, (_, t) => !data.temperature_pads.includes(t));
    /** 1: the module is shown. */
    this.shown = new Uint8Array(this.count).fill(1);
    this.shownVersion = 0; // grows when that changes
    /** What verify found, by module; what names no module stands at the entry of its controller. @type {Map<number, any[]>} */
    this.findings = new Map();
    for (const f of data.findings ?? []) {
      const at = f.module >= 0 ? f.module : f.patch >= 0 ? data.patches[f.patch]?.entry ?? -1 : -1;
      if (at >= 0 && at < this.count) this.findings.set(at, [...this.findings.get(at) ?? [], f]);
    }
  }

  /** @param {number} k */
  shows(k) { return this.shown[k] === 1; }
  /** Shows the modules for which `wanted` holds, and no others. @param {(k: number) => boolean} wanted */
  show(wanted) { for (let k = 0; k < this.count; ++k) this.shown[k] = wanted(k) ? 1 : 0; ++this.shownVersion; }
  /** The number on the label of a module, in its own design. @param {number} k */
  numberOf(k) { return this.modules[k].number; }
  /** The name of a module as all outputs say it: "upperarm 19" on a robot, else its number. @param {number} k */
  nameOf(k) { const cover = this.coverOf(k); return cover < 0 ? `${this.numberOf(k)}` : `${this.data.covers[cover].name} ${this.numberOf(k)}`; }
  /** The module of a name: "upperarm 19", or a number alone, which is that of the first cover; −1: none. @param {string} text */
  moduleOf(text) {
    const named = this.modules.findIndex((_, k) => this.nameOf(k) === text.trim());
    return named >= 0 ? named : this.modules.findIndex((_, k) => String(this.numberOf(k)) === text.trim());
  }
  /** The name of a controller: "upperarm 1". @param {number} p */
  controllerOf(p) {
    const cover = (this.data.covers ?? []).findLast((c) => c.first_patch <= p);
    return cover ? `${cover.name} ${p - cover.first_patch}` : String(p);
  }
  /** The same with its address on its bus: "upperarm 1 (node 4)". @param {number} p */
  controllerName(p) { return `${this.controllerOf(p)} (node ${this.data.patches[p].node || "not on this bus"})`; }
  /** "island 2", "upperarm: 2" on a robot. @param {number} island */
  islandName(island) {
    const cover = (this.data.covers ?? []).findLast((c) => c.first_island <= island);
    return cover ? `${cover.name}: ${island - cover.first_island}` : `island ${island}`;
  }
  /** Whether pressures are known in kPa. */
  get isCalibrated() { return this.countsPerKpa.length > 0; }
  /** A change in the unit of the page: kPa, or counts without a calibration. @param {number} n 12 · module + taxel @param {number} counts below rest */
  pressureIn(n, counts) { return !this.isCalibrated ? counts : this.countsPerKpa[n] > 0 ? counts / this.countsPerKpa[n] : 0; }
  /** The same as text. @param {number} value */
  pressureText(value) { return this.isCalibrated ? `${value.toFixed(1)} kPa` : `${Math.round(value)} counts`; }
  /** The cover of a robot that a module is on; −1: the design is of one cover. @param {number} k */
  coverOf(k) { return (this.data.covers ?? []).findLastIndex((c) => c.first_module <= k); }

  // Corners (9 numbers a module), taxels (36) and normals (3) on the body.
  coverShape() {
    const corners = new Float32Array(9 * this.count), taxels = new Float32Array(36 * this.count);
    const normals = new Float32Array(3 * this.count);
    this.modules.forEach((m, k) => {
      corners.set(m.corners, 9 * k);
      taxels.set(m.taxels, 36 * k);
      normals.set(normalOf(corners, 9 * k), 3 * k);
    });
    return {corners, taxels, normals};
  }

  // Two designs of one part lie in each other: the earlier one moves to the left of the later one, as both are seen at first.
  partCovers() {
    const {modules, vertices} = this.data.before, right = rightOf(bestDirection(this.cover.normals)), points = this.data.surface.vertices;
    const {corners, taxels} = this.cover, along = (p, at) => p[at] * right[0] + p[at + 1] * right[1] + p[at + 2] * right[2];
    let rightmost = -Infinity, leftmost = Infinity;
    for (const [list, first] of /** @type {[ArrayLike<number>, number][]} */ ([[points, 3 * vertices], [corners, 9 * modules]])) {
      for (let at = 0; at < list.length; at += 3) {
        if (at < first) rightmost = Math.max(rightmost, along(list, at)); else leftmost = Math.min(leftmost, along(list, at));
      }
    }
    const shift = right.map((v) => (leftmost - rightmost - BESIDE_MM) * v), move = (list, end) => { for (let at = 0; at < end; ++at) list[at] += shift[at % 3]; };
    move(points, 3 * vertices);
    move(corners, 9 * modules);
    move(taxels, 36 * modules);
  }

  // The same on the plane: each island as its lattice is, so 30 mm are 30 mm everywhere.
  flatShape() {
    const side = this.data.side_mm;
    const tiles = this.modules.map((m) => tileCorners(m.tile, side));
    const boxes = Array.from({length: Math.max(1, ...this.modules.map((m) => m.island + 1))},
                             () => ({left: Infinity, right: -Infinity, top: -Infinity, bottom: Infinity, width: 0, height: 0}));
    tiles.forEach((corners, k) => {
      const box = boxes[this.modules[k].island];
      for (const [x, y] of corners) {
        box.left = Math.min(box.left, x); box.right = Math.max(box.right, x);
        box.bottom = Math.min(box.bottom, y); box.top = Math.max(box.top, y);
      }
    });
    for (const b of boxes) {
      if (b.left > b.right) b.left = b.right = b.top = b.bottom = 0;
      b.width = b.right - b.left; b.height = b.top - b.bottom;
    }
    const shift = packIslands(boxes);
    this.islandWidths = boxes.map((b) => b.width);
    this.islandCorners = boxes.map((b, k) => [b.left + shift[k][0], b.top + shift[k][1], 0]);
    const corners = new Float32Array(9 * this.count), taxels = new Float32Array(36 * this.count);
    const normals = new Float32Array(3 * this.count);
    tiles.forEach((tile, k) => {
      const [dx, dy] = shift[this.modules[k].island];
      tile.forEach(([x, y], c) => corners.set([x + dx, y + dy, 0], 9 * k + 3 * c));
      normals.set([0, 0, 1], 3 * k);
    });
    for (let k = 0; k < this.count; ++k) this.carryTaxels(k, corners, taxels);
    return {corners, taxels, normals};
  }

  // A module is rigid: its taxels keep their place between the corners.
  carryTaxels(k, corners, taxels) {
    const from = this.cover.corners.subarray(9 * k, 9 * k + 9), to = corners.subarray(9 * k, 9 * k + 9);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const minus = (p, at, q, qt) => [p[at] - q[qt], p[at + 1] - q[qt + 1], p[at + 2] - q[qt + 2]];
    const e1 = minus(from, 3, from, 0), e2 = minus(from, 6, from, 0);
    const f1 = minus(to, 3, to, 0), f2 = minus(to, 6, to, 0);
    const a = dot(e1, e1), b = dot(e1, e2), c = dot(e2, e2), det = a * c - b * b;
    for (let t = 0; t < TAXELS; ++t) {
      const p = minus(this.cover.taxels, 36 * k + 3 * t, from, 0);
      const u = (c * dot(p, e1) - b * dot(p, e2)) / det, v = (a * dot(p, e2) - b * dot(p, e1)) / det;
      for (let x = 0; x < 3; ++x) taxels[36 * k + 3 * t + x] = to[x] + u * f1[x] + v * f2[x];
    }
  }

  /** Centre of a module. @param {Float32Array} corners @param {number} k */
  static centre(corners, k) {
    const p = corners.subarray(9 * k, 9 * k + 9);
    return [(p[0] + p[3] + p[6]) / 3, (p[1] + p[4] + p[7]) / 3, (p[2] + p[5] + p[8]) / 3];
  }

  /** Both ends of a side, without its cut corners, as points. @param {number} k @param {number} side */
  sideEnds(shape, k, side) {
    const from = pointAt(shape.corners, 9 * k + 3 * side), to = pointAt(shape.corners, 9 * k + 3 * ((side + 1) % 3));
    const part = this.data.corner_cut_mm / this.data.side_mm;
    if (part === 0) return [from, to];
    return [from.map((v, x) => v + part * (to[x] - v)), to.map((v, x) => v + part * (from[x] - v))];
  }

  /** The corners of a module in order: three, or six where they are cut. @returns {number[][]} */
  outline(shape, k) {
    const ends = [0, 1, 2].map((side) => this.sideEnds(shape, k, side));
    return this.corners === 3 ? ends.map(([from]) => from) : ends.flat();
  }

  /** The jumper between two modules; undefined: none. @param {number} k @param {number} other */
  jumperBetween(k, other) { return this.data.jumpers.find((j) => j.modules.includes(k) && j.modules.includes(other)); }

  /** The side at which module k is joined to another, over a jumper too; −1: nowhere. */
  sideTowards(k, other) {
    const jumper = this.jumperBetween(k, other);
    return jumper ? jumper.sides[jumper.modules.indexOf(k)] : this.modules[k].neighbours.indexOf(other);
  }

  isEntry(k) { const p = this.modules[k].patch; return p >= 0 && this.data.patches[p].entry === k; }

  /** Modules of the subtree of k: what strapped modules lose with it. */
  subtree(k) {
    const found = [k];
    for (let at = 0; at < found.length; ++at) found.push(...this.children[found[at]]);
    return found;
  }

  /** What the failure of module k, or of its joint to `parent`, costs: modules that are lost for good, and joints over which the others are read.
      @param {number} k @param {number} other −1: the module itself */
  failureOf(k, other = -1) {
    const patch = this.data.patches[this.modules[k].patch];
    const row = patch && patch.failures.find((f) => f.module === k && f.other === other);
    if (!row) return {cut: this.subtree(k), lost: this.subtree(k), backup: []};
    const parent = new Map(row.backup);
    const cut = this.subtree(k);
    const reached = (m) => {
      for (let at = m, hops = 0; hops < 32; ++hops) {
        if (at === k && (other < 0 || !parent.has(k))) return false;
        if (!parent.has(at) && this.isEntry(at)) return true;
        at = parent.has(at) ? parent.get(at) : this.modules[at].parent;
        if (at < 0) return true; // over the second entry
      }
      return false;
    };
    return {cut, lost: cut.filter((m) => !reached(m)), backup: row.backup};
  }
}
