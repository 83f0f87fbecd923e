// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Draws both views with WebGL: one draw call for all modules, one for all taxels, a few for the rest.
import * as THREE from "./three.js";
import {colorOf, HEAT} from "./colors.js";
import {Model, normalOf, TAXELS} from "./model.js";

const SHADED = `
attribute vec3 position; attribute vec3 normal; attribute vec3 color;
uniform mat4 viewProjection; uniform vec3 light; uniform vec3 back; uniform float lift; uniform float shade; uniform float sink;
varying vec3 vColor;
void main() {
  gl_Position = viewProjection * vec4(position + lift * normal, 1.0);
  vec4 behind = viewProjection * vec4(position - sink * back, 1.0);
  if (sink > 0.0) gl_Position.z = behind.z / behind.w * gl_Position.w;
  vColor = color * mix(1.0, 0.5 + 0.5 * abs(dot(normal, light)), shade);
}`;
const PLAIN = `precision mediump float; varying vec3 vColor; void main() { gl_FragColor = vec4(vColor, 1.0); }`;
const glsl = (color) => `vec3(${color.map((v) => v.toFixed(4)).join(",")})`;
const TWO_SIDED = `precision mediump float; varying vec3 vColor;
void main() { gl_FragColor = vec4(gl_FrontFacing ? vColor : ${glsl(colorOf("back"))}, 1.0); }`;
// A taxel at rest is a small dot that is left out where modules are small; a pressed one is never smaller than three pixels and has a dark rim, so that it
// shows on modules of any colour. Heat below −1: the module is hidden.
const TAXEL = `
attribute vec3 position; attribute vec2 corner; attribute vec3 normal; attribute float heat;
uniform mat4 viewProjection; uniform float lift; uniform float pixel;
varying vec3 vColor; varying vec2 vCorner; varying float vRim;
void main() {
  vec3 far = abs(normal.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
  vec3 u = normalize(cross(far, normal)), v = cross(normal, u);
  float x = clamp(heat, 0.0, 1.0), radius = heat > 0.0 ? max(1.7 + 1.1 * x, 1.5 * pixel) : pixel < 0.8 ? 1.15 : 0.0;
  if (heat < -1.5) radius = 0.0;
  gl_Position = viewProjection * vec4(position + (lift + x) * normal + radius * (corner.x * u + corner.y * v), 1.0);
  float at = 3.0 * x;
  vec3 hot = at < 1.0 ? mix(${glsl(HEAT[0])}, ${glsl(HEAT[1])}, at)
           : at < 2.0 ? mix(${glsl(HEAT[1])}, ${glsl(HEAT[2])}, at - 1.0) : mix(${glsl(HEAT[2])}, ${glsl(HEAT[3])}, at - 2.0);
  vColor = heat > 0.0 ? hot : heat < 0.0 ? ${glsl(colorOf("noValue"))} : ${glsl(colorOf("rest"))};
  vCorner = corner;
  vRim = heat > 0.0 ? 0.86 : 2.0;
}`;
const RIMMED = `precision mediump float; varying vec3 vColor; varying vec2 vCorner; varying float vRim;
void main() {
  float away = length(vCorner);
  if (away > 1.0) discard;
  gl_FragColor = vec4(away > vRim ? vec3(0.1) : vColor, 1.0);
}`;

const uniforms = () => ({viewProjection: {value: new THREE.Matrix4()}, light: {value: new THREE.Vector3(0, 0, 1)},
                         back: {value: new THREE.Vector3(0, 0, 1)}, lift: {value: 0}, shade: {value: 1}, sink: {value: 0},
                         pixel: {value: 0}});
const material = (vertexShader, fragmentShader) =>
    new THREE.RawShaderMaterial({vertexShader, fragmentShader, uniforms: uniforms(), side: THREE.DoubleSide});
const meshOf = (geometry, look) => { const mesh = new THREE.Mesh(geometry, look); mesh.frustumCulled = false; return mesh; };
const triple = (values) => new THREE.BufferAttribute(values instanceof Float32Array ? values : new Float32Array(values), 3);

function trianglesOf(points, normals, colors) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", triple(points));
  geometry.setAttribute("normal", triple(normals));
  geometry.setAttribute("color", triple(colors));
  return geometry;
}

// Modules are drawn a little smaller than they are, so that the joints show.
/** @param {import("./model.js").Model} model */
function moduleGeometry(model, shape) {
  const each = 9 * (model.corners - 2), points = new Float32Array(each * model.count), normals = new Float32Array(points.length);
  for (let k = 0; k < model.count; ++k) {
    if (!model.shows(k)) continue; // its triangles stay in one point
    const centre = Model.centre(shape.corners, k);
    const outline = model.outline(shape, k).map((p) => p.map((v, x) => centre[x] + 0.955 * (v - centre[x])));
    for (let t = 0; t + 2 < outline.length; ++t) // a fan from the first corner
      [outline[0], outline[t + 1], outline[t + 2]].forEach((p, c) => points.set(p, each * k + 9 * t + 3 * c));
    for (let at = each * k; at < each * (k + 1); at += 3) normals.set(shape.normals.subarray(3 * k, 3 * k + 3), at);
  }
  return trianglesOf(points, normals, new Float32Array(points.length));
}

// Each taxel is a polygon of its own: software that stands for a GPU takes twenty times longer to draw instances of one polygon. It draws a square, of which
// it leaves out what is outside the disc; a GPU, which smooths the edges of polygons only, draws a polygon in the disc. These attributes have a value for
// each corner of each taxel, and both views share them.
class TaxelPolygons {
  /** @param {number} count taxels @param {number} corners */
  constructor(count, corners) {
    this.corners = corners;
    const index = new Uint32Array(3 * (corners - 2) * count), around = new Float32Array(2 * corners * count);
    for (let n = 0, at = 0; n < count; ++n)
      for (let c = 2; c < corners; ++c) { index[at++] = corners * n; index[at++] = corners * n + c - 1; index[at++] = corners * n + c; }
    const reach = corners === 4 ? Math.SQRT2 : 1;
    for (let c = 0; c < corners; ++c) {
      around[2 * c] = reach * Math.cos(2 * Math.PI * c / corners);
      around[2 * c + 1] = reach * Math.sin(2 * Math.PI * c / corners);
    }
    for (let size = 2 * corners; size < around.length; size *= 2) around.copyWithin(size, 0, Math.min(size, around.length - size));
    this.index = new THREE.BufferAttribute(index, 1);
    this.corner = new THREE.BufferAttribute(around, 2);
    this.heat = new THREE.BufferAttribute(new Float32Array(corners * count), 1);
  }

  geometryOf(shape) {
    const geometry = new THREE.BufferGeometry(), {corners} = this, places = new Float32Array(corners * shape.taxels.length), normals = new Float32Array(places.length);
    for (let from = 0, at = 0; from < shape.taxels.length; from += 3) {
      const module = 3 * Math.floor(from / (3 * TAXELS));
      for (let c = 0; c < corners; ++c) {
        for (let x = 0; x < 3; ++x, ++at) {
          places[at] = shape.taxels[from + x];
          normals[at] = shape.normals[module + x];
        }
      }
    }
    geometry.setIndex(this.index);
    geometry.setAttribute("position", triple(places));
    geometry.setAttribute("normal", triple(normals));
    geometry.setAttribute("corner", this.corner);
    geometry.setAttribute("heat", this.heat);
    return geometry;
  }

  /** @param {Float32Array} heat a value a taxel */
  setHeat(heat) {
    const to = /** @type {Float32Array} */ (this.heat.array);
    for (let n = 0, at = 0; n < heat.length; ++n)
      for (let c = 0; c < this.corners; ++c) to[at++] = heat[n];
    this.heat.needsUpdate = true;
  }
}

/** @param {{vertices: number[], faces: number[]}} surface @param {import("./colors.js").Rgb} color */
function surfaceGeometry(surface, color) {
  const points = new Float32Array(3 * surface.faces.length), normals = new Float32Array(points.length);
  surface.faces.forEach((v, k) => points.set(surface.vertices.slice(3 * v, 3 * v + 3), 3 * k));
  for (let k = 0; k < surface.faces.length / 3; ++k) {
    const n = normalOf(points, 9 * k);
    for (let c = 0; c < 3; ++c) normals.set(n, 9 * k + 3 * c);
  }
  return trianglesOf(points, normals, points.map((_, k) => color[k % 3]));
}

// A flat module on a round cover lies partly under it. The cover is therefore tested as if it were that much farther away.
const sinkOf = (model) => {
  const row = model.data.metrics.findIndex((m) => m.name === "edge depth");
  return 2.5 + Math.max(0, ...model.modules.map((m) => m.metrics[row] || 0));
};

/** @param {any} context */
function isSoftware(context) {
  const names = context.getExtension("WEBGL_debug_renderer_info");
  return /swiftshader|llvmpipe|software/i.test(names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "");
}

// Without a GPU each pixel and corner costs processor time: smooth edges are left out there. To be smooth is decided when a context is made, and
// software takes half a second to make one; so the first is one for software, and a GPU gets a second one on a canvas in its place.
/** @param {HTMLCanvasElement} canvas @returns {{canvas: HTMLCanvasElement, context: any, software: boolean}} context null: the browser has no WebGL */
function contextFor(canvas) {
  const contextOf = (on, antialias) => on.getContext("webgl2", {antialias, alpha: true}) || on.getContext("webgl", {antialias, alpha: true});
  const plain = contextOf(canvas, false);
  if (!plain || isSoftware(plain)) return {canvas, context: plain, software: true};
  plain.getExtension("WEBGL_lose_context")?.loseContext();
  const smooth = /** @type {HTMLCanvasElement} */ (canvas.cloneNode());
  canvas.replaceWith(smooth);
  return {canvas: smooth, context: contextOf(smooth, true), software: false};
}

export class GlDrawing {
  /** Throws where the browser has no WebGL. @param {HTMLCanvasElement} canvas */
  constructor(canvas, model) {
    const made = contextFor(canvas), {context, software} = made;
    if (!context) throw new Error("no WebGL");
    this.renderer = new THREE.WebGLRenderer({canvas: made.canvas, context, alpha: true});
    this.renderer.autoClear = false;
    this.renderer.debug.checkShaderErrors = false; // to ask for them waits for each program
    this.renderer.setScissorTest(true);
    this.size = ""; // of the drawing and its pixels
    this.taxels = new TaxelPolygons(TAXELS * model.count, software ? 4 : 10);
    this.model = model;
    this.scenes = {cover: this.sceneOf(model.cover, model.data.surface, sinkOf(model)), flat: this.sceneOf(model.flat, null, 0)};
    this.camera = new THREE.Camera();
    this.kind = "webgl";
  }

  sceneOf(shape, surface, sink) {
    const scene = new THREE.Scene(), parts = {};
    scene.autoUpdate = false;
    const add = (name, geometry, look, lift, shade) => {
      parts[name] = meshOf(geometry, look);
      look.uniforms.lift.value = lift;
      look.uniforms.shade.value = shade;
      scene.add(parts[name]);
    };
    if (surface) {
      add("surface", surfaceGeometry(surface, colorOf("cover")), material(SHADED, PLAIN), 0, 1);
      parts.surface.material.uniforms.sink.value = sink;
      const leftOut = this.model.data.side?.left_out;
      if (leftOut?.faces.length) {
        add("leftOut", surfaceGeometry(leftOut, colorOf("leftOut")), material(SHADED, PLAIN), 0, 1);
        parts.leftOut.material.uniforms.sink.value = sink;
      }
    }
    add("modules", moduleGeometry(this.model, shape), material(SHADED, TWO_SIDED), 0.4, surface ? 1 : 0);
    add("taxels", this.taxels.geometryOf(shape), material(TAXEL, RIMMED), 1.0, 0);
    return {scene, parts};
  }

  /** @param {string} view "cover" or "flat" @param {string} name @param {import("./marks.js").Marks|null} marks */
  setMarks(view, name, marks) {
    const {scene, parts} = this.scenes[view];
    if (parts[name]) { scene.remove(parts[name]); parts[name].geometry.dispose(); parts[name].material.dispose(); delete parts[name]; }
    if (!marks || marks.points.length === 0) return;
    parts[name] = meshOf(trianglesOf(marks.points, new Float32Array(marks.points.length), marks.colors), material(SHADED, PLAIN));
    parts[name].material.uniforms.shade.value = 0;
    scene.add(parts[name]);
  }

  /** Takes over which modules are shown. */
  showModules() {
    for (const [view, {parts}] of Object.entries(this.scenes)) {
      const geometry = moduleGeometry(this.model, view === "cover" ? this.model.cover : this.model.flat);
      parts.modules.geometry.dispose();
      parts.modules.geometry = geometry;
    }
  }

  /** @param {Float32Array} colors three numbers a module */
  setColors(colors) {
    const each = 9 * (this.model.corners - 2);
    for (const {parts} of Object.values(this.scenes)) {
      const attribute = parts.modules.geometry.attributes.color;
      for (let k = 0; k < colors.length / 3; ++k)
        for (let c = 0; c < each; ++c) attribute.array[each * k + c] = colors[3 * k + c % 3];
      attribute.needsUpdate = true;
    }
  }

  /** @param {Float32Array} heat 0 … 1 a taxel, negative: it has no valid value */
  setHeat(heat) { this.taxels.setHeat(heat); }

  resize(width, height) {
    const ratio = window.devicePixelRatio || 1, size = `${width} ${height} ${ratio}`;
    if (size === this.size) return; // each setting makes the drawing's memory anew
    this.size = size;
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  /** @param {{name: string, camera: any, left: number, top: number}[]} views @param {Record<string, boolean>} shown */
  draw(views, shown) {
    const height = this.renderer.domElement.clientHeight;
    for (const {name, camera, left, top} of views) {
      const {scene, parts} = this.scenes[name];
      for (const [part, mesh] of Object.entries(parts)) {
        mesh.visible = shown[part === "leftOut" ? "surface" : part] !== false;
        mesh.material.uniforms.viewProjection.value.fromArray(camera.matrix);
        mesh.material.uniforms.light.value.fromArray(camera.light);
        mesh.material.uniforms.back.value.fromArray(camera.back);
        mesh.material.uniforms.pixel.value = camera.mm_per_pixel;
      }
      this.renderer.setViewport(left, height - top - camera.height, camera.width, camera.height);
      this.renderer.setScissor(left, height - top - camera.height, camera.width, camera.height);
      this.renderer.setClearColor(0, 0);
      this.renderer.clear();
      this.renderer.render(scene, this.camera);
    }
  }
}
