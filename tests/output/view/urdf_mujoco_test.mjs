#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo loads an exported URDF with the mesh of the cover, its mass and its frames. Usage: urdf_mujoco_test.mjs TRISKIN
// NODE_MODULES. Exit status: 0 passed, 1 failed, 77 left out because mujoco-js is not installed.
import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";

import {loadMujoco} from "../../support/mujoco.mjs";

const [triskin, nodeModules] = process.argv.slice(2);
const mujoco = await loadMujoco(nodeModules);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "urdf_mujoco_test."));
process.on("exit", () => fs.rmSync(folder, {recursive: true, force: true}));
const run = (...words) => execFileSync(triskin, words, {cwd: folder, stdio: ["ignore", "ignore", "inherit"]});
run("generate", "hip", "-o", "hip.obj", "--size-mm", "110", "--faces", "300");
run("design", "hip.obj", "-o", "hip.json", "--time-limit-s", "1");
run("export", "hip.json", "-o", "hip.urdf", "--mass-kg", "0.31", "--mesh-uri", "hip.stl", "--prefix", "left_");
const design = JSON.parse(fs.readFileSync(path.join(folder, "hip.json"), "utf8"));
const urdf = fs.readFileSync(path.join(folder, "hip.urdf"), "utf8");

// By default MuJoCo joins what does not move into one body; massless links stay as frames.
mujoco.FS.writeFile("/models/hip.stl", fs.readFileSync(path.join(folder, "hip.stl")));
mujoco.FS.writeFile("/models/hip.urdf", urdf.replace(/(<robot [^>]*>)/,
  '$1<mujoco><compiler fusestatic="false" discardvisual="false" strippath="false" meshdir="."/></mujoco>'));
const model = mujoco.MjModel.loadFromXML("/models/hip.urdf");
const data = new mujoco.MjData(model);
mujoco.mj_forward(model, data);
const body = name => {
  const id = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY.value ?? mujoco.mjtObj.mjOBJ_BODY, name);
  assert.ok(id > 0, name);
  return id;
};
const near = (a, b, tolerance, what) => assert.ok(Math.abs(a - b) <= tolerance, `${what}: ${a}, not ${b}`);
const cover = body("left_cover");
near(model.body_mass[cover], 0.31, 1e-9, "mass");

// Mass and centre from the surface of the design, by sums of our own.
const {vertices, faces} = design.surface;
let area = 0, centre = [0, 0, 0];
for (const face of faces) {
  const [a, b, c] = face.map(v => vertices[v].map(x => x / 1000));
  const [u, v] = [b.map((x, k) => x - a[k]), c.map((x, k) => x - a[k])];
  const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const part = Math.hypot(...n) / 2;
  area += part;
  centre = centre.map((x, k) => x + part * (a[k] + b[k] + c[k]) / 3);
}
for (let k = 0; k < 3; ++k) near(model.body_ipos[3 * cover + k], centre[k] / area, 1e-7, "centre");  // nine digits of a metre
// A shell of this size can have no larger moments than its mass in the farthest corner.
const reach = Math.max(...vertices.map(v => Math.hypot(...v.map((x, k) => x / 1000 - centre[k] / area))));
for (let k = 0; k < 3; ++k) {
  const moment = model.body_inertia[3 * cover + k];
  assert.ok(moment > 0 && moment < 0.31 * reach * reach, `moment ${moment}`);
}
// Each module stands where the design has its corners.
for (const module of design.modules) {
  const id = body(`left_module_${module.id}`);
  for (let k = 0; k < 3; ++k) {
    const middle = module.corners.reduce((sum, corner) => sum + corner[k], 0) / 3000;
    near(data.xpos[3 * id + k], middle, 1e-6, `module ${module.id}`);
  }
}
console.log(`mass, centre and ${design.modules.length} frames`);
