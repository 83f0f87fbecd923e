// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// What is drawn on the modules: trees, entries, seams, faults, the outline of the selection. All of it is coloured triangles in the plane of a module, so that it
// lies right on the body and on the flat islands. Marks of hidden modules are left out.
import {colorOf} from "./colors.js";
import {Model, pointAt} from "./model.js";

/** Triangles with a colour a corner; `lift` is their height over the module, mm. A large skin has ten thousand bands, so corners go into typed arrays. */
export class Marks {
  /** @param {number} lift */
  constructor(lift) {
    this.lift = lift;
    this.used = 0; // numbers in each of the arrays
    this.places = new Float32Array(3000);
    this.shades = new Float32Array(3000);
  }
  /** Coordinates of the corners, mm, three corners a triangle. */
  get points() { return this.places.subarray(0, this.used); }
  /** Their colours. */
  get colors() { return this.shades.subarray(0, this.used); }

  // A corner that lies `far` mm from o towards s.
  corner(o, far, s, n, color) {
    if (this.used === this.places.length) [this.places, this.shades] = [this.places, this.shades].map((old) => { const longer = new Float32Array(2 * old.length); longer.set(old); return longer; });
    for (let x = 0; x < 3; ++x) {
      this.places[this.used + x] = o[x] + far * s[x] + this.lift * n[x];
      this.shades[this.used + x] = color[x];
    }
    this.used += 3;
  }
  triangle(a, b, c, n, color) { for (const p of [a, b, c]) this.corner(p, 0, n, n, color); }
  /** Band from p to q, `left` and `right` mm wide to either side of the line. */
  band(p, q, n, left, right, color) {
    const d = [q[0] - p[0], q[1] - p[1], q[2] - p[2]], l = Math.hypot(d[0], d[1], d[2]) || 1;
    const s = [(n[1] * d[2] - n[2] * d[1]) / l, (n[2] * d[0] - n[0] * d[2]) / l, (n[0] * d[1] - n[1] * d[0]) / l];
    this.corner(p, -right, s, n, color);
    this.corner(q, -right, s, n, color);
    this.corner(q, left, s, n, color);
    this.corner(p, -right, s, n, color);
    this.corner(q, left, s, n, color);
    this.corner(p, left, s, n, color);
  }
  disc(p, n, radius, color) {
    const far = Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
    const u0 = [far[1] * n[2] - far[2] * n[1], far[2] * n[0] - far[0] * n[2], far[0] * n[1] - far[1] * n[0]];
    const l = Math.hypot(u0[0], u0[1], u0[2]), u = u0.map((x) => x / l);
    const v = [n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]];
    const at = (k) => p.map((x, c) => x + radius * (Math.cos(k * Math.PI / 8) * u[c] + Math.sin(k * Math.PI / 8) * v[c]));
    for (let k = 0; k < 16; ++k) this.triangle(p, at(k), at(k + 1), n, color);
  }
}

const PAPER = [0.97, 0.97, 0.97]; // the inside of a ring
/** Length of the stub by which the flat view shows a jumper, mm. */
export const STUB_MM = 9;

const corner = (shape, k, c) => pointAt(shape.corners, 9 * k + 3 * c);
const normal = (shape, k) => pointAt(shape.normals, 3 * k);
const middle = (shape, k, side) => {
  const p = corner(shape, k, side), q = corner(shape, k, (side + 1) % 3);
  return [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2];
};

// From a module over the side that it shares with another to the other's centre.
function addJoint(marks, shape, model, child, parent, color, width) {
  for (const [from, to] of [[child, parent], [parent, child]]) {
    const side = model.sideTowards(from, to);
    const end = side < 0 ? Model.centre(shape.corners, to) : middle(shape, from, side);
    marks.band(Model.centre(shape.corners, from), end, normal(shape, from), width, width, color);
  }
}

/** Trees of all patches with their entries. @param {Model} model */
export function treeMarks(model, shape) {
  const marks = new Marks(0.9), dark = colorOf("tree");
  model.modules.forEach((m, k) => { if (m.parent >= 0 && model.shows(k) && model.shows(m.parent)) addTreeJoint(marks, shape, model, k, m.parent); });
  model.data.patches.forEach((p) => {
    if (p.entry >= 0 && model.shows(p.entry)) marks.disc(Model.centre(shape.corners, p.entry), normal(shape, p.entry), 3.4, dark);
    if (p.second_entry < 0 || !model.shows(p.second_entry)) return;
    marks.disc(Model.centre(shape.corners, p.second_entry), normal(shape, p.second_entry), 3.4, dark);
    marks.disc(Model.centre(shape.corners, p.second_entry).map((v, c) => v + 0.1 * normal(shape, p.second_entry)[c]),
               normal(shape, p.second_entry), 2.2, PAPER);
  });
  return marks;
}

// On the islands a line over a jumper would cross the whole drawing: the stub of the jumper stands for it.
function addTreeJoint(marks, shape, model, child, parent) {
  if (shape === model.flat && model.jumperBetween(child, parent)) {
    for (const [from, to] of [[child, parent], [parent, child]])
      marks.band(Model.centre(shape.corners, from), middle(shape, from, model.sideTowards(from, to)), normal(shape, from), 0.6, 0.6, colorOf("tree"));
    return;
  }
  addJoint(marks, shape, model, child, parent, colorOf("tree"), 0.6);
}

/** Seams: sides between controllers, and joints inside a patch that are cut. @param {Model} model */
export function seamMarks(model, shape) {
  const marks = new Marks(0.7);
  const cut = new Set(model.data.patches.flatMap((p) => p.cut_joints.flatMap(([a, b]) => [`${a},${b}`, `${b},${a}`])));
  model.modules.forEach((m, k) => m.neighbours.forEach((n, side) => {
    if (n < 0 || !model.shows(k)) return;
    const apart = model.modules[n].patch !== m.patch, isCut = cut.has(`${k},${n}`);
    const [from, to] = model.sideEnds(shape, k, side);
    if (apart || isCut) marks.band(from, to, normal(shape, k), apart ? 1.6 : 0.8, 0, colorOf(apart ? "seam" : "cut"));
  }));
  return marks;
}

/** The end of a jumper's stub on the islands, away from its module. @param {Model} model @param {any} jumper @param {number} end 0 or 1 */
export function stubOf(model, jumper, end) {
  const shape = model.flat, k = jumper.modules[end], from = middle(shape, k, jumper.sides[end]), centre = Model.centre(shape.corners, k);
  const out = from.map((v, c) => v - centre[c]), length = Math.hypot(...out) || 1;
  return {from, to: from.map((v, c) => v + STUB_MM * out[c] / length), out: out.map((v) => v / length)};
}

/** All points of the islands that are drawn: corners of modules and ends of stubs. @param {Model} model */
export function islandPoints(model) {
  const ends = model.data.jumpers.flatMap((jumper) => [0, 1].flatMap((end) => stubOf(model, jumper, end).to));
  return [...model.flat.corners, ...ends];
}

/** Jumpers: on the body from the middle of one side to that of the other, on the islands a stub at either side. @param {Model} model */
export function jumperMarks(model, shape) {
  const marks = new Marks(1.2), color = colorOf("jumper");
  for (const jumper of model.data.jumpers) {
    const {modules, sides} = jumper, ends = modules.map((k, e) => middle(shape, k, sides[e]));
    modules.forEach((k, e) => {
      if (!model.shows(k)) return;
      if (shape === model.flat) {
        const {from, to} = stubOf(model, jumper, e);
        marks.band(from, to, normal(shape, k), 0.9, 0.9, color);
      } else {
        marks.band(ends[0], ends[1], normal(shape, k), 0.9, 0.9, color);
      }
      marks.disc(ends[e], normal(shape, k), 1.8, color);
    });
  }
  return marks;
}

/** A cross on each module whose chip is at fault. @param {Model} model @param {(k: number) => boolean} isFaulty */
export function faultMarks(model, shape, isFaulty) {
  const marks = new Marks(1.3);
  for (let k = 0; k < model.count; ++k) {
    if (!isFaulty(k) || !model.shows(k)) continue;
    const centre = Model.centre(shape.corners, k);
    for (let c = 0; c < 3; ++c)
      marks.band(centre, corner(shape, k, c).map((v, x) => centre[x] + 0.5 * (v - centre[x])), normal(shape, k), 0.7, 0.7, colorOf("tree"));
  }
  return marks;
}

/** A diamond on each module that verify has a finding for. @param {Model} model */
export function findingMarks(model, shape) {
  const marks = new Marks(1.35);
  for (const k of model.findings.keys()) {
    if (!model.shows(k)) continue;
    marks.disc(Model.centre(shape.corners, k), normal(shape, k), 5.4, colorOf("finding"));
    marks.disc(Model.centre(shape.corners, k).map((v, c) => v + 0.05 * normal(shape, k)[c]), normal(shape, k), 3.2, PAPER);
  }
  return marks;
}

/** Outline of the selected module, and the joints over which others are read while it fails. */
export function selectionMarks(model, shape, k, failure, color) {
  const marks = new Marks(1.4);
  model.outline(shape, k).forEach((point, c, all) => marks.band(point, all[(c + 1) % all.length], normal(shape, k), 2.2, 0.8, color));
  for (const [child, parent] of failure ? failure.backup : []) {
    if (parent >= 0) addJoint(marks, shape, model, child, parent, colorOf("backup"), 1.3);
  }
  return marks;
}
