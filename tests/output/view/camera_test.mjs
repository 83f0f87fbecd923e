// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the cameras and colours of the page without a browser. Usage: camera_test.mjs FOLDER_OF_THE_PAGE
import assert from "node:assert/strict";
import path from "node:path";
import {pathToFileURL} from "node:url";

const load = (name) => import(pathToFileURL(path.resolve(process.argv[2], name)).href);
const {bestDirection, hitOf, OrbitCamera} = await load("camera.js");
const {heatColor, LINES, PALETTE, scale} = await load("colors.js");

/** Places and normals on parts of simple shapes, mm. */
function sphere(at) {
  const points = [], normals = [];
  for (let k = 0; k < 400; ++k) {
    const z = 1 - 2 * (k + 0.5) / 400, a = 2.399963 * k, r = Math.sqrt(1 - z * z), n = [r * Math.cos(a), r * Math.sin(a), z];
    points.push(...at(n));
    normals.push(...n);
  }
  return {points, normals};
}
function tube(axis) {
  const points = [], normals = [];
  for (let k = 0; k < 720; ++k) {
    const a = k, n = [Math.cos(a), Math.sin(a), 0], p = [80 * n[0], 80 * n[1], 300 * (k / 719)], turned = (v) => [0, 1, 2].map((x) => v[(x + 5 - axis) % 3]);
    points.push(...turned(p));
    normals.push(...turned(n));
  }
  return {points, normals};
}
function box(size) {
  const points = [], normals = [];
  for (let axis = 0; axis < 3; ++axis) for (const side of [0, 1]) {
    if (axis === 2 && side === 0) continue; // open below
    for (const u of [0, 0.5, 1]) for (const v of [0, 0.5, 1]) {
      const p = [0, 0, 0], n = [0, 0, 0];
      p[axis] = side * size[axis]; p[(axis + 1) % 3] = u * size[(axis + 1) % 3]; p[(axis + 2) % 3] = v * size[(axis + 2) % 3];
      n[axis] = 2 * side - 1;
      points.push(...p);
      normals.push(...n);
    }
  }
  return {points, normals};
}
const SHAPES = {ball: sphere((n) => n.map((v) => 120 * v)), egg: sphere((n) => [400 + 60 * n[0], 40 * n[1], 200 * n[2]]),
                tube_x: tube(0), tube_y: tube(1), tube_z: tube(2), box: box([220, 160, 120]), bar: box([900, 40, 40]), plate: box([300, 200, 1])};

let passed = 0;
const check = (name, test) => { test(); ++passed; console.log(`passed: ${name}`); };

for (const [name, {points, normals}] of Object.entries(SHAPES)) {
  for (const [wide, high] of [[600, 800], [320, 500], [390, 330], [1000, 300]]) {
    check(`${name} fits a pane of ${wide} × ${high}, from any side`, () => {
      const camera = new OrbitCamera(Float32Array.from(points), bestDirection(Float32Array.from(normals)));
      for (const toward of [null, [1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [1, -1, 1]]) {
        if (toward) camera.look(toward, toward.filter((v) => v).length === 1);
        camera.resize(wide, high);
        let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
        for (let k = 0; k < points.length; k += 3) {
          const [x, y, , w] = camera.project(points, k);
          assert(w > 0, "no point lies behind the camera");
          [left, right, top, bottom] = [Math.min(left, x), Math.max(right, x), Math.min(top, y), Math.max(bottom, y)];
        }
        assert(left >= 0 && right <= wide && top >= 0 && bottom <= high, `cut off: ${[left, right, top, bottom]}`);
        assert(Math.max((right - left) / wide, (bottom - top) / high) > 0.6, `too small: ${[left, right, top, bottom]} of ${wide} × ${high}`);
      }
    });
  }
}

check("a tube is seen from outside, not along its bore", () => {
  for (const axis of [0, 1, 2]) {
    const d = bestDirection(Float32Array.from(SHAPES[["tube_x", "tube_y", "tube_z"][axis]].normals));
    assert(Math.abs(d[axis]) < 0.75, `axis ${axis}: ${d}`);
  }
});
check("a box is seen over a corner, from above where it is open below", () => {
  const d = bestDirection(Float32Array.from(SHAPES.box.normals));
  assert(d.every((v) => Math.abs(v) > 0.5) && d[2] > 0, String(d));
});
check("the ray of a pixel meets what is drawn there, in perspective and along an axis; a hidden module is looked through", () => {
  const corners = Float32Array.from([0, 0, 50, 30, 0, 50, 0, 26, 50, 0, 0, 0, 30, 0, 0, 0, 26, 0]), normals = Float32Array.from([0, 0, 1, 0, 0, 1]);
  const camera = new OrbitCamera(corners, [0, 0, 1]), place = [8, 8, 50];
  for (const parallel of [false, true]) {
    camera.look([0, 0, 1], parallel);
    camera.resize(500, 400);
    const [x, y] = camera.project(place), hit = hitOf(corners, normals, camera.ray(x, y));
    assert.equal(hit.module, 0);
    hit.at.forEach((v, k) => assert(Math.abs(v - place[k]) < 1e-3, `${hit.at}`));
    assert.equal(hitOf(corners, normals, camera.ray(...camera.project([8, 8, 0])), Uint8Array.from([0, 1])).module, 1);
  }
});
check("no two entries of the table look alike, nor one like a pressed taxel", () => {
  const entries = Object.entries(PALETTE).map(([name, {color}]) => [name, color]);
  for (let k = 0; k <= 8; ++k) entries.push([`pressed ${k}/8`, heatColor(k / 8)]);
  for (const [a, ca] of entries) for (const [b, cb] of entries) {
    if (a === b || (a.startsWith("pressed") && b.startsWith("pressed"))) continue;
    assert(Math.hypot(...ca.map((v, x) => v - cb[x])) > 0.12, `${a} and ${b}`);
  }
});
check("no line, and no value on the scale, looks like a pressed taxel or a limit that is passed", () => {
  const colors = [...LINES.map((c, n) => [`L${n}`, c]), ...Array.from({length: 21}, (_, k) => [`value ${k}/20`, scale(k / 20)])];
  const others = [["over the limit", PALETTE.over.color], ...Array.from({length: 21}, (_, k) => [`pressed ${k}/20`, heatColor(k / 20)])];
  for (const [a, ca] of colors) for (const [b, cb] of others) assert(Math.hypot(...ca.map((v, x) => v - cb[x])) > 0.2, `${a} and ${b}`);
});
check("below the buttons: the body leaves the upper 30 pixels free", () => {
  for (const {points, normals} of Object.values(SHAPES)) {
    const camera = new OrbitCamera(Float32Array.from(points), bestDirection(Float32Array.from(normals)));
    camera.resize(390, 330);
    for (let k = 0; k < points.length; k += 3) assert(camera.project(points, k)[1] >= 30);
  }
});
check("stronger is lighter", () => {
  const lightness = (x) => { const [r, g, b] = heatColor(x); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  for (let k = 0; k < 20; ++k) assert(lightness((k + 1) / 20) > lightness(k / 20));
});
console.log(`${passed} passed, 0 failed`);
