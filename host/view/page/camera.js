// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Two cameras with the same questions: the matrix of a view, where a point is drawn, which ray a pixel sees.
// Matrices are 16 numbers by column, as WebGL takes them. Pixels count from the upper left of the pane.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const add = (a, b, f) => [a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]];
const unit = (a) => { const l = Math.hypot(a[0], a[1], a[2]) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

/** Smallest box around points. @param {ArrayLike<number>} points @returns {{low: number[], high: number[]}} */
export function boxOf(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < points.length; ++k) {
    low[k % 3] = Math.min(low[k % 3], points[k]);
    high[k % 3] = Math.max(high[k % 3], points[k]);
  }
  return points.length ? {low, high} : {low: [0, 0, 0], high: [1, 1, 1]};
}

class Camera {
  width = 1;
  height = 1;
  matrix = new Float32Array(16);
  mm_per_pixel = 1;
  target = [0, 0, 0];
  light = [0, 0, 1];
  back = [0, 0, 1]; // toward the eye
  numbersOf = "";   // what `numbers` was computed for
  numbers = /** @type {{k: number, x: number, y: number}[]} */ ([]);
  /** @param {number} width @param {number} height pixels of the pane */
  resize(width, height) { this.width = Math.max(1, width); this.height = Math.max(1, height); this.update(); }
  update() {}
  /** Where a point is drawn: x and y in pixels, depth that grows away from the eye. @param {ArrayLike<number>} p */
  project(p, at = 0) {
    const m = this.matrix, x = p[at], y = p[at + 1], z = p[at + 2];
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    return [(0.5 + 0.5 * (m[0] * x + m[4] * y + m[8] * z + m[12]) / w) * this.width,
            (0.5 - 0.5 * (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) * this.height,
            (m[2] * x + m[6] * y + m[10] * z + m[14]) / w, w];
  }
}

/** Turns around a point of the body; z points up. */
export class OrbitCamera extends Camera {
  radius = 1;
  distance = 1;
  yaw = 0;
  pitch = 0;
  /** @param {{low: number[], high: number[]}} box @param {number[]} toward where most modules face */
  constructor(box, toward) { super(); this.box = box; this.toward = toward; this.reset(); }
  reset() {
    this.target = this.box.low.map((v, k) => (v + this.box.high[k]) / 2);
    this.radius = Math.max(1, Math.hypot(...this.box.high.map((v, k) => v - this.box.low[k])) / 2);
    this.distance = 0.85 * this.radius / Math.sin(0.3);
    const n = unit(this.toward);
    this.yaw = Math.hypot(n[0], n[1]) > 1e-3 ? Math.atan2(n[1], n[0]) : -Math.PI / 2;
    this.pitch = clamp(Math.asin(clamp(n[2], -1, 1)), -1.5, 1.5);
    this.update();
  }
  axes() {
    const back = [Math.cos(this.pitch) * Math.cos(this.yaw), Math.cos(this.pitch) * Math.sin(this.yaw), Math.sin(this.pitch)];
    const right = [-Math.sin(this.yaw), Math.cos(this.yaw), 0];
    return {back, right, up: cross(back, right)};
  }
  eye() { return add(this.target, this.axes().back, this.distance); }
  update() {
    const {back, right, up} = this.axes(), eye = add(this.target, back, this.distance);
    const fit = Math.min(1, this.width / this.height); // a narrow pane sees the whole body too
    const f = fit / Math.tan(0.3), near = Math.max(this.distance * 0.01, this.distance - 4 * this.radius), far = this.distance + 4 * this.radius;
    const a = (far + near) / (near - far), b = 2 * far * near / (near - far), aspect = this.width / this.height;
    const rows = [right.map((v) => v * f / aspect), up.map((v) => v * f), back];
    const shift = rows.map((row) => -dot(row, eye));
    this.matrix.set([rows[0][0], rows[1][0], a * back[0], -back[0], rows[0][1], rows[1][1], a * back[1], -back[1],
                     rows[0][2], rows[1][2], a * back[2], -back[2], shift[0], shift[1], a * shift[2] + b, -shift[2]]);
    this.mm_per_pixel = 2 * this.distance / (f * this.height);
    this.back = back;
    this.light = unit(add(add(back, up, 0.35), right, 0.25));
  }
  turn(dx, dy) { this.yaw -= dx * 0.006; this.pitch = clamp(this.pitch + dy * 0.006, -1.55, 1.55); this.update(); }
  move(dx, dy) {
    const {right, up} = this.axes();
    this.target = add(add(this.target, right, -dx * this.mm_per_pixel), up, dy * this.mm_per_pixel);
    this.update();
  }
  zoom(factor) { this.distance = clamp(this.distance * factor, this.radius * 0.05, this.radius * 20); this.update(); }
  focus(point, normal) {
    this.target = point.slice();
    this.yaw = Math.atan2(normal[1], normal[0]);
    this.pitch = clamp(Math.asin(clamp(normal[2], -1, 1)), -1.55, 1.55);
    this.update();
  }
  /** @returns {{from: number[], along: number[]}} */
  ray(x, y) {
    const {back, right, up} = this.axes(), from = this.eye();
    const dx = (x - this.width / 2) * this.mm_per_pixel, dy = (this.height / 2 - y) * this.mm_per_pixel;
    return {from, along: unit(add(add(back.map((v) => -v * this.distance), right, dx), up, dy))};
  }
}

/** Looks straight down on the plane of the islands. */
export class PlaneCamera extends Camera {
  constructor(box) { super(); this.box = box; this.fitted = true; this.reset(); }
  reset() { this.fitted = true; this.update(); }
  update() {
    if (this.fitted) {
      this.target = this.box.low.map((v, k) => (v + this.box.high[k]) / 2);
      this.mm_per_pixel = 1.14 * Math.max((this.box.high[0] - this.box.low[0]) / this.width,
                                          (this.box.high[1] - this.box.low[1]) / this.height, 0.01);
    }
    const sx = 2 / (this.width * this.mm_per_pixel), sy = 2 / (this.height * this.mm_per_pixel);
    this.matrix.set([sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, -0.01, 0, -sx * this.target[0], -sy * this.target[1], 0, 1]);
  }
  turn(dx, dy) { this.move(dx, dy); }
  move(dx, dy) {
    this.fitted = false;
    this.target = [this.target[0] - dx * this.mm_per_pixel, this.target[1] + dy * this.mm_per_pixel, 0];
    this.update();
  }
  zoom(factor) { this.fitted = false; this.mm_per_pixel = clamp(this.mm_per_pixel * factor, 0.01, 50); this.update(); }
  focus(point) { this.fitted = false; this.target = point.slice(); this.update(); }
  ray(x, y) {
    return {from: [this.target[0] + (x - this.width / 2) * this.mm_per_pixel,
                   this.target[1] + (this.height / 2 - y) * this.mm_per_pixel, 1000], along: [0, 0, -1]};
  }
}

/** The nearest module that shows its front to the ray; −1: none. @param {Float32Array} corners @param {Float32Array} normals */
export function pick(corners, normals, ray) {
  let nearest = Infinity, found = -1;
  for (let k = 0; k < normals.length / 3; ++k) {
    const n = normals.subarray(3 * k, 3 * k + 3), slope = dot(n, ray.along);
    if (slope > -1e-6) continue;
    const p = corners.subarray(9 * k, 9 * k + 9);
    const t = dot(n, [p[0] - ray.from[0], p[1] - ray.from[1], p[2] - ray.from[2]]) / slope;
    if (t <= 0 || t >= nearest) continue;
    const q = add(ray.from, ray.along, t);
    if (inside(p, q, n)) { nearest = t; found = k; }
  }
  return found;
}

function inside(p, q, n) {
  for (let s = 0; s < 3; ++s) {
    const a = 3 * s, b = 3 * ((s + 1) % 3);
    const side = cross([p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]], [q[0] - p[a], q[1] - p[a + 1], q[2] - p[a + 2]]);
    if (dot(side, n) < 0) return false;
  }
  return true;
}
