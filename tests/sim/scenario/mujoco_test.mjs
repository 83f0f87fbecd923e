#!/usr/bin/env node
// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo loads exported models: beside the model of a robot, after a change of it, and a ball that drops on the skin while the
// simulated controllers of `triskin simulate --contacts` report it. Usage: mujoco_test.mjs TRISKIN WRITE_STRIP NODE_MODULES
// Exit status: 0 passed, 1 failed, 77 left out because mujoco-js is not installed.
import assert from "node:assert/strict";
import {execFileSync, spawn} from "node:child_process";
import fs from "node:fs";
import net from "node:net";
import os from "node:os";
import path from "node:path";
import readline from "node:readline";

import {loadMujoco} from "../../support/mujoco.mjs";

const [triskin, writeStrip, nodeModules] = process.argv.slice(2);
const mujoco = await loadMujoco(nodeModules);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "mujoco_test."));
process.on("exit", () => fs.rmSync(folder, {recursive: true, force: true}));

const modules = 6, design = path.join(folder, "strip.json");
execFileSync(writeStrip, [design, String(modules)]);
const put = (name, text) => mujoco.FS.writeFile(`/models/${name}`, text);
const load = name => mujoco.MjModel.loadFromXML(`/models/${name}`);
const exported = (format, ...more) => {
  const file = path.join(folder, "skin.xml");
  execFileSync(triskin, ["export", design, "--format", format, "-o", file, ...more], {stdio: "ignore"});
  return fs.readFileSync(file, "utf8");
};
put("tactile.xml", exported("mjcf"));
put("touch.xml", exported("mjcf-touch"));
put("worn.xml", exported("mjcf", "--body", "r_forearm"));

// The model is loaded beside that of a robot, whose file stays unchanged, and after an update of that model.
const robot = more => `<mujoco model="robot"><worldbody>${more}<body name="r_upper_arm" pos="0 0 1"><joint name="shoulder" axis="0 1 0"/>
  <geom type="capsule" size="0.03 0.1"/><body name="r_forearm" pos="0 0 0.3"><joint name="elbow" axis="1 0 0"/>
  <geom type="capsule" size="0.03 0.1"/></body></body></worldbody></mujoco>`;
put("all.xml", `<mujoco><include file="robot.xml"/><include file="worn.xml"/></mujoco>`);
for (const more of ["", `<body name="head" pos="0 0 2"><joint name="neck"/><geom type="sphere" size="0.1"/></body>`]) {
  put("robot.xml", robot(more));
  const model = load("all.xml");
  assert.equal(model.nsensordata, 3 * 10 * modules);
  assert.equal(model.nbody, 1 + 2 + (more ? 1 : 0) + 1 + modules);
  const data = new mujoco.MjData(model);
  for (let k = 0; k < 200; ++k) mujoco.mj_step(model, data);
  assert.ok(Array.from(data.qpos).every(Number.isFinite));
  assert.ok(data.time > 0.39, "MuJoCo begins anew where a model is unstable");
  data.delete(), model.delete();
}

// Taxels under a ball: the tactile sensor sees those that are inside it, where the list of taxels has them.
const listFile = path.join(folder, "t.json");
execFileSync(triskin, ["export", design, "--format", "taxel-list", "-o", listFile], {stdio: "ignore"});
const taxels = JSON.parse(fs.readFileSync(listFile, "utf8")).taxels;
const middle = taxels.filter(t => t.module === 2 || t.module === 3).reduce((sum, t) => sum.map((v, k) => v + t.position_m[k] / 20), [0, 0, 0]);
const radius = 0.05, mass = 2;
const ball = (z, aside = 0) => `<body name="ball" pos="${middle[0] + aside} ${middle[1]} ${z}"><joint type="slide" axis="0 0 1"/><geom name="ball" type="sphere" size="${radius}"
  mass="${mass}"/></body>`;
put("ball.xml", `<mujoco><include file="tactile.xml"/><worldbody>${ball(middle[2] + radius - 0.0015)}</worldbody></mujoco>`);
{
  const model = load("ball.xml"), data = new mujoco.MjData(model);
  mujoco.mj_forward(model, data);
  const pressure = Array.from(data.sensordata).slice(0, taxels.length);
  let inside = 0;
  taxels.forEach((t, k) => {
    const depth = radius - Math.hypot(t.position_m[0] - middle[0], t.position_m[1] - middle[1],
                                      t.position_m[2] - (middle[2] + radius - 0.0015));
    if (depth > 1e-6) ++inside;
    if (Math.abs(depth) > 1e-6) assert.equal(pressure[k] !== 0, depth > 0, `taxel ${k}: ${pressure[k]} at depth ${depth}`);
  });
  assert.ok(inside >= 3, `${inside} taxels are inside the ball`);
  console.log(`${inside} of ${taxels.length} taxels are under the ball`);
  data.delete(), model.delete();
}

// A ball of 2 kg drops 5 mm. Its momentum tells the impulse of the skin, the samples of the controllers tell the force. Taxels take
// samples of the pressure, so the force depends on the place by some percent: the ball drops at seven places of a pitch of the strip. The
// skin has a layer, which spreads the pressure as a real one does; taxels that felt it at points would be wrong by up to 11 %
// (docs/simulation.md). The ball slides up and down only, so that it does not roll off.
/** Simulates a skin that is touched over a socket. @param {string} scene @returns {Promise<any>} its first line, and how to step and end it */
const touched = async scene => {
  const server = spawn(triskin, ["simulate", scene, "--contacts", "127.0.0.1:0"], {env: {...process.env, XDG_STATE_HOME: folder}});
  process.on("exit", () => server.kill());
  const port = await new Promise(resolve => readline.createInterface({input: server.stdout}).on("line", line => {
    const found = /127\.0\.0\.1:(\d+)/.exec(line);
    if (found) resolve(Number(found[1]));
  }));
  const socket = net.connect(port, "127.0.0.1");
  const answers = readline.createInterface({input: socket})[Symbol.asyncIterator]();
  const answer = async () => JSON.parse((await answers.next()).value);
  const step = async (time_s, contacts) => {
    socket.write(JSON.stringify({time_s, contacts}) + "\n");
    const told = await answer();
    assert.equal(told.error, undefined, told.error);
    return told;
  };
  return {head: await answer(), step, end: () => { socket.end(); server.kill("SIGINT"); }};
};
const soft = path.join(folder, "soft.json");
fs.writeFileSync(soft, JSON.stringify({format: "triskin-scene", version: 1, design: "strip.json", seed: 1, converters: "ideal",
                                          effects: {noise_counts: 3, layer: {}}}));  // Drawn chips differ in gain, and nobody calibrates here.
const {head, step: step_skin, end} = await touched(soft);

// Returns the radius of the contact of the ball with an elastic foundation of 2 mm with a confined modulus of 134.6 kPa (docs/mechanics.md).
const contact_radius_m = force_n => {
  const depth_m = Math.sqrt(force_n * 0.002 / (Math.PI * radius * 134.6e3));
  return Math.max(1e-3, Math.sqrt(2 * radius * depth_m));
};
const steps = 400, step_s = 0.002, gravity = 9.81;
const latest = new Map();
let time_s = head.time_s;
const step = async contacts => {
  time_s += step_s;
  const told = await step_skin(time_s, contacts);
  for (const s of told.samples)
    latest.set(s.module, s.change_counts.reduce((a, b) => a + b, 0) / head.counts_per_kpa * head.taxel_area_mm2 * 1e-3);
  return told;
};
const drop = async aside => {
  put("drop.xml", `<mujoco><option timestep="${step_s}"/><include file="touch.xml"/><worldbody>${ball(middle[2] + radius + 0.005, aside)}
    </worldbody></mujoco>`);
  const model = load("drop.xml"), data = new mujoco.MjData(model);
  let felt = 0, applied = 0;
  for (let k = 0; k < steps; ++k) {
    mujoco.mj_step(model, data);
    const force = Array.from(data.sensordata).reduce((a, b) => a + b, 0);
    applied += force * step_s;
    const point = [middle[0] + aside, middle[1], middle[2] + 0.005 + data.qpos[0]];
    const told = await step(force > 0 ? [{body: "cover", point_m: point, normal: [0, 0, 1], force_n: force, radius_m: contact_radius_m(force)}] : []);
    if (force > 1) assert.equal(told.unfelt, 0);  // The first touch may be smaller than the gap between two taxels.
    felt += [...latest.values()].reduce((a, b) => a + b, 0) * step_s;
  }
  const momentum = mass * (data.qvel[0] + gravity * steps * step_s);
  data.delete(), model.delete();
  for (let k = 0; k < 50; ++k) await step([]);
  assert.ok(Math.abs(applied / momentum - 1) < 0.02, `touch sensors: ${applied} of ${momentum} N s`);
  return {momentum, felt};
};
const drops = [];
for (const aside of [-15, -10, -5, 0, 5, 10, 15]) drops.push(await drop(aside * 1e-3));
end();
const ratios = drops.map(d => d.felt / d.momentum), mean = ratios.reduce((a, b) => a + b, 0) / ratios.length;
console.log(`force of the taxels over impulse of the ball: ${ratios.map(r => r.toFixed(3)).join(" ")}; mean ${mean.toFixed(3)}`);
assert.ok(Math.abs(mean - 1) < 0.05);
assert.ok(ratios.every(r => Math.abs(r - 1) < 0.1));

// The pattern of the taxels under a resting ball: MuJoCo's tactile sensor knows how deep each taxel lies in the ball, the simulated skin
// has a layer that the ball sinks into.
const correlation = (a, b) => {
  const mean = list => list.reduce((sum, v) => sum + v, 0) / list.length, ma = mean(a), mb = mean(b);
  const sum = of => a.reduce((total, _, k) => total + of(a[k] - ma, b[k] - mb), 0);
  return sum((x, y) => x * y) / Math.sqrt(sum(x => x * x) * sum((_, y) => y * y));
};
const skin = await touched(soft);
const sunk_m = 0.0015, alike = [];
let at_s = skin.head.time_s;
for (const [x, y] of [[0, 0], [7, 3], [-9, -2], [13, 4], [-4, -5]]) {
  const centre = [middle[0] + x * 1e-3, middle[1] + y * 1e-3, middle[2] + radius - sunk_m];
  put("pose.xml", `<mujoco><include file="tactile.xml"/><worldbody><body name="ball" pos="${centre.join(" ")}"><joint type="slide" axis="0 0 1"/>
    <geom name="ball" type="sphere" size="${radius}" mass="${mass}"/></body></worldbody></mujoco>`);
  const model = load("pose.xml"), data = new mujoco.MjData(model);
  mujoco.mj_forward(model, data);
  const tactile = Array.from(data.sensordata).slice(0, taxels.length).map(Math.abs);
  data.delete(), model.delete();
  const felt = new Map(), ball_touches = [{point_m: [centre[0], centre[1], middle[2]], normal: [0, 0, 1], depth_m: sunk_m, tip_radius_m: radius}];
  for (let k = 0; k < 10; ++k) for (const s of (await skin.step(at_s += 0.02, ball_touches)).samples) felt.set(s.module, s.change_counts);
  alike.push(correlation(tactile, taxels.map(t => felt.get(t.module)[t.taxel])));
  await skin.step(at_s += 0.2, []);
}
skin.end();
console.log(`pattern of MuJoCo's tactile sensor and of the samples, correlation at five poses: ${alike.map(c => c.toFixed(3)).join(" ")}`);
assert.ok(Math.min(...alike) >= 0.95);
process.exit(0);
