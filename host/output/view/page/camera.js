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

const DIAGONALS = [-1, 0, 1].flatMap((x) => [-1, 0, 1].flatMap((y) => [-1, 0, 1].map((z) => [x, y, z]))).filter((d) => d.some((v) => v !== 0)).map(unit);

/** The direction toward which a body shows the most of its modules: the camera stands there. Without a clear answer it is in front (−y) and above.
 * @param {Float32Array} normals three numbers a module */
export function bestDirection(normals) {
  const mean = [0, 0, 0];
  for (let k = 0; k < normals.length; ++k) mean[k % 3] += normals[k];
  const seen = (d) => {
    let sum = 0;
    for (let k = 0; k < normals.length; k += 3) sum += Math.max(0, normals[k] * d[0] + normals[k + 1] * d[1] + normals[k + 2] * d[2]);
    return sum * (1 - 0.04 * d[1] + 0.03 * d[2]);
  };
  const ways = Math.hypot(...mean) > 0.3 * normals.length / 3 ? [unit(mean), ...DIAGONALS] : DIAGONALS;
  return ways.reduce((best, d) => seen(d) > seen(best) + 1e-9 ? d : best, ways[0]);
}

/** The direction that lies to the right of a camera which stands toward `toward`. @param {number[]} toward */
export const rightOf = (toward) => Math.hypot(toward[0], toward[1]) > 1e-3 ? unit([-toward[1], toward[0], 0]) : [1, 0, 0];

const HALF_ANGLE = Math.tan(0.3);
const MARGIN = 1.1, TOOLS_PX = 34; // room around the drawing, and for the buttons over it

/** Turns around a point of the body; z points up. Views along an axis are orthographic until the view is turned. */
export class OrbitCamera extends Camera {
  radius = 1;
  distance = 1;
  yaw = 0;
  pitch = 0;
  orthographic = false;
  fitted = true; // shows the whole body at any size of the pane
  /** @param {ArrayLike<number>} points of the body, all of which are to be seen @param {number[]} toward where the camera stands at first */
  constructor(points, toward) {
    super();
    this.points = points;
    this.toward = toward;
    const box = boxOf(points);
    this.middle = box.low.map((v, k) => (v + box.high[k]) / 2);
    this.radius = Math.max(1, Math.hypot(...box.high.map((v, k) => v - box.low[k])) / 2);
    this.reset();
  }
  reset() { this.look(this.toward, false); }
  /** Looks at the whole body from a direction. @param {number[]} toward @param {boolean} orthographic */
  look(toward, orthographic) {
    const n = unit(toward);
    this.yaw = Math.hypot(n[0], n[1]) > 1e-3 ? Math.atan2(n[1], n[0]) : -Math.PI / 2;
    this.pitch = orthographic ? Math.asin(clamp(n[2], -1, 1)) : clamp(Math.asin(clamp(n[2], -1, 1)), -1.5, 1.5);
    this.orthographic = orthographic;
    this.fitted = true;
    this.update();
  }
  // The smallest distance from which every point lies in the pane, seen toward the middle of what is drawn.
  fit() {
    const {back, right, up} = this.axes(), wide = this.half_width(), high = this.half_height(), strip = Math.min(0.25, TOOLS_PX / this.height);
    this.target = this.middle.slice();
    for (let turn = 0; turn < 3; ++turn) {
      const ends = {right: [Infinity, -Infinity], up: [Infinity, -Infinity]};
      let distance = 0;
      for (let k = 0; k + 2 < this.points.length; k += 3) {
        const p = [this.points[k] - this.target[0], this.points[k + 1] - this.target[1], this.points[k + 2] - this.target[2]];
        const x = dot(p, right), y = dot(p, up), z = this.orthographic ? 0 : dot(p, back);
        ends.right = [Math.min(ends.right[0], x), Math.max(ends.right[1], x)];
        ends.up = [Math.min(ends.up[0], y), Math.max(ends.up[1], y)];
        distance = Math.max(distance, z + MARGIN * Math.max(Math.abs(x) / wide, Math.abs(y) / (high * (1 - strip))));
      }
      this.distance = Math.max(distance, this.radius * 0.05);
      if (turn < 2) this.target = add(add(this.target, right, (ends.right[0] + ends.right[1]) / 2), up, (ends.up[0] + ends.up[1]) / 2);
    }
    this.target = add(this.target, up, strip * this.distance * high); // the body lies below the buttons
  }
  // Half of what the pane shows at a distance of 1.
  half_height() { return HALF_ANGLE / Math.min(1, this.width / this.height); }
  half_width() { return this.half_height() * this.width / this.height; }
  axes() {
    const back = [Math.cos(this.pitch) * Math.cos(this.yaw), Math.cos(this.pitch) * Math.sin(this.yaw), Math.sin(this.pitch)];
    const right = [-Math.sin(this.yaw), Math.cos(this.yaw), 0];
    return {back, right, up: cross(back, right)};
  }
  eye() { return add(this.target, this.axes().back, this.distance); }
  update() {
    if (this.fitted && this.points.length > 0) this.fit();
    const {back, right, up} = this.axes(), eye = add(this.target, back, this.distance);
    this.mm_per_pixel = 2 * this.distance * this.half_height() / this.height;
    this.back = back;
    this.light = unit(add(add(back, up, 0.35), right, 0.25));
    if (this.orthographic) this.setParallel(right, up, back); else this.setPerspective(right, up, back, eye);
  }
  setPerspective(right, up, back, eye) {
    const near = Math.max(this.distance * 0.01, this.distance - 4 * this.radius), far = this.distance + 4 * this.radius;
    const a = (far + near) / (near - far), b = 2 * far * near / (near - far);
    const rows = [right.map((v) => v / this.half_width()), up.map((v) => v / this.half_height()), back];
    const shift = rows.map((row) => -dot(row, eye));
    this.matrix.set([rows[0][0], rows[1][0], a * back[0], -back[0], rows[0][1], rows[1][1], a * back[1], -back[1],
                     rows[0][2], rows[1][2], a * back[2], -back[2], shift[0], shift[1], a * shift[2] + b, -shift[2]]);
  }
  setParallel(right, up, back) {
    const rows = [right.map((v) => v / (this.distance * this.half_width())), up.map((v) => v / (this.distance * this.half_height())),
                  back.map((v) => -v / (8 * this.radius))];
    const shift = rows.map((row) => -dot(row, this.target));
    this.matrix.set([rows[0][0], rows[1][0], rows[2][0], 0, rows[0][1], rows[1][1], rows[2][1], 0, rows[0][2], rows[1][2], rows[2][2], 0,
                     shift[0], shift[1], shift[2], 1]);
  }
  turn(dx, dy) {
    this.orthographic = this.fitted = false;
    this.yaw -= dx * 0.006;
    this.pitch = clamp(this.pitch + dy * 0.006, -1.55, 1.55);
    this.update();
  }
  move(dx, dy) {
    const {right, up} = this.axes();
    this.fitted = false;
    this.target = add(add(this.target, right, -dx * this.mm_per_pixel), up, dy * this.mm_per_pixel);
    this.update();
  }
  zoom(factor) { this.fitted = false; this.distance = clamp(this.distance * factor, this.radius * 0.05, this.radius * 40); this.update(); }
  focus(point, normal) {
    this.fitted = this.orthographic = false;
    this.target = point.slice();
    this.yaw = Math.atan2(normal[1], normal[0]);
    this.pitch = clamp(Math.asin(clamp(normal[2], -1, 1)), -1.55, 1.55);
    this.update();
  }
  /** @returns {{from: number[], along: number[]}} */
  ray(x, y) {
    const {back, right, up} = this.axes(), from = this.eye();
    const dx = (x - this.width / 2) * this.mm_per_pixel, dy = (this.height / 2 - y) * this.mm_per_pixel;
    if (this.orthographic) return {from: add(add(add(from, back, 4 * this.radius), right, dx), up, dy), along: back.map((v) => -v)};
    return {from, along: unit(add(add(back.map((v) => -v * this.distance), right, dx), up, dy))};
  }
}

// Room for names above the islands, for what is written below them, and for jumpers at either side, pixels.
const ABOVE_PX = 26, BELOW_PX = 36, BESIDE_PX = 60;

/** Looks straight down on the plane of the islands. */
export class PlaneCamera extends Camera {
  constructor(box) { super(); this.box = box; this.fitted = true; this.reset(); }
  reset() { this.fitted = true; this.update(); }
  update() {
    if (this.fitted) {
      this.target = this.box.low.map((v, k) => (v + this.box.high[k]) / 2);
      const beside = Math.min(BESIDE_PX, 0.12 * this.width), above = Math.min(ABOVE_PX, 0.1 * this.height), below = Math.min(BELOW_PX, 0.1 * this.height);
      this.mm_per_pixel = Math.max((this.box.high[0] - this.box.low[0]) / (this.width - 2 * beside),
                                   (this.box.high[1] - this.box.low[1]) / (this.height - above - below), 0.01);
      this.target[1] += this.mm_per_pixel * (above - below) / 2;
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

/** @typedef {{module: number, at: number[]}} Hit module −1: none */
/** The nearest module that shows its front to the ray, and where. Hidden ones are looked through. @param {Float32Array} corners @param {Float32Array} normals
 * @param {Uint8Array} [shown] 1: the module is shown @returns {Hit} */
export function hitOf(corners, normals, ray, shown) {
  let nearest = Infinity;
  const found = {module: -1, at: [0, 0, 0]};
  for (let k = 0; k < normals.length / 3; ++k) {
    const x = normals[3 * k], y = normals[3 * k + 1], z = normals[3 * k + 2], slope = x * ray.along[0] + y * ray.along[1] + z * ray.along[2];
    if (slope > -1e-6 || (shown && !shown[k])) continue;
    const t = (x * (corners[9 * k] - ray.from[0]) + y * (corners[9 * k + 1] - ray.from[1]) + z * (corners[9 * k + 2] - ray.from[2])) / slope;
    if (t <= 0 || t >= nearest) continue;
    const q = add(ray.from, ray.along, t);
    if (inside(corners.subarray(9 * k, 9 * k + 9), q, [x, y, z])) { nearest = t; found.module = k; found.at = q; }
  }
  return found;
}
/** The module of hitOf; −1: none. */
export const pick = (corners, normals, ray, shown) => hitOf(corners, normals, ray, shown).module;

function inside(p, q, n) {
  for (let s = 0; s < 3; ++s) {
    const a = 3 * s, b = 3 * ((s + 1) % 3);
    const side = cross([p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]], [q[0] - p[a], q[1] - p[a + 1], q[2] - p[a + 2]]);
    if (dot(side, n) < 0) return false;
  }
  return true;
}
