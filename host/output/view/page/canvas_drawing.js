// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Draws both views where the browser has no WebGL: the same calls as GlDrawing, painted from back to front.
import {colorOf, css, heatColor} from "./colors.js";
import {TAXELS} from "./model.js";

export class CanvasDrawing {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas, model) {
    this.canvas = canvas;
    this.paint = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this.model = model;
    this.colors = new Float32Array(3 * model.count);
    this.heat = new Float32Array(TAXELS * model.count);
    this.marks = {cover: {}, flat: {}};
    this.kind = "canvas";
  }
  setMarks(view, name, marks) { this.marks[view][name] = marks; }
  showModules() {}
  setColors(colors) { this.colors = colors; }
  setHeat(heat) { this.heat = heat; }
  resize(width, height) {
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    this.paint.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  draw(views, shown) {
    this.paint.clearRect(0, 0, this.canvas.width, this.canvas.height);
    for (const view of views) {
      this.paint.save();
      this.paint.beginPath();
      this.paint.rect(view.left, view.top, view.camera.width, view.camera.height);
      this.paint.clip();
      this.paint.translate(view.left, view.top);
      this.drawView(view, this.model[view.name], shown);
      this.paint.restore();
    }
  }

  drawView({name, camera}, shape, shown) {
    const items = [];
    for (let k = 0; k < this.model.count; ++k) {
      if (!this.model.shows(k)) continue;
      const points = [0, 3, 6].map((c) => camera.project(shape.corners, 9 * k + c));
      items.push({depth: Math.max(points[0][2], points[1][2], points[2][2]), k, points, name: "module"});
    }
    if (name === "cover" && shown.surface !== false) this.addSurfaces(items, camera);
    items.sort((a, b) => b.depth - a.depth);
    for (const item of items) this.drawItem(item, camera, shape, shown);
    for (const [part, marks] of Object.entries(this.marks[name])) {
      if (marks && shown[part] !== false) this.drawMarks(marks, camera);
    }
  }

  // All of the cover lies behind all modules: a flat module on a round cover is partly under it.
  addSurfaces(items, camera) {
    const {surface, side} = this.model.data;
    for (const [name, mesh] of Object.entries({cover: surface, leftOut: side?.left_out})) {
      for (let f = 0; f < (mesh?.faces.length || 0); f += 3) {
        const points = [0, 1, 2].map((c) => camera.project(mesh.vertices, 3 * mesh.faces[f + c]));
        items.push({depth: Math.max(points[0][2], points[1][2], points[2][2]) + 10, k: -1, points, name});
      }
    }
  }

  drawItem({k, points, name}, camera, shape, shown) {
    const front = (points[1][0] - points[0][0]) * (points[2][1] - points[0][1]) < (points[2][0] - points[0][0]) * (points[1][1] - points[0][1]);
    if (!front) return;
    const n = shape.normals, light = k < 0 ? 0.9 : 0.5 + 0.5 * Math.abs(n[3 * k] * camera.light[0] + n[3 * k + 1] * camera.light[1] + n[3 * k + 2] * camera.light[2]);
    const outline = k < 0 || this.model.corners === 3 ? points : this.model.outline(shape, k).map((p) => camera.project(p));
    this.triangle(outline, k < 0 ? css(colorOf(name)) : css([0, 1, 2].map((c) => light * this.colors[3 * k + c])));
    if (k < 0 || shown.taxels === false) return;
    const radius = 1.2 / camera.mm_per_pixel;
    for (let t = TAXELS * k; t < TAXELS * (k + 1); ++t) {
      if (this.heat[t] <= 0 && radius < 1.5) continue;
      const [x, y] = camera.project(shape.taxels, 3 * t);
      this.paint.fillStyle = css(this.heat[t] > 0 ? heatColor(this.heat[t]) : colorOf(this.heat[t] < 0 ? "noValue" : "rest"));
      this.paint.beginPath();
      this.paint.arc(x, y, Math.max(1.5, radius * (1 + 0.7 * Math.max(0, this.heat[t]))), 0, 2 * Math.PI);
      this.paint.fill();
    }
  }

  drawMarks(marks, camera) {
    for (let at = 0; at < marks.points.length; at += 9) {
      const points = [0, 3, 6].map((c) => camera.project(marks.points, at + c));
      const front = (points[1][0] - points[0][0]) * (points[2][1] - points[0][1]) < (points[2][0] - points[0][0]) * (points[1][1] - points[0][1]);
      if (front) this.triangle(points, css(marks.colors.slice(at, at + 3)));
    }
  }

  triangle(points, fill) {
    this.paint.fillStyle = fill;
    this.paint.beginPath();
    points.forEach(([x, y], k) => k ? this.paint.lineTo(x, y) : this.paint.moveTo(x, y));
    this.paint.fill();
  }
}
