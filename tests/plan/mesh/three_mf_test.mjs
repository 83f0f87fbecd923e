// SPDX-License-Identifier: GPL-3.0-or-later
// 3MF between this program and others: lib3mf of the 3MF Consortium and JSCAD write a cover in each unit, which is read here;
// lib3mf reads strictly what fabricate writes. Vertices, areas and units have to agree.
// Usage: three_mf_test.mjs TRISKIN WRITE_STRIP NODE_MODULES
// Exit status: 0 they agree, 1 they do not, 77 left out because a package is not installed.
import assert from "node:assert/strict";
import {spawnSync} from "node:child_process";
import fs from "node:fs";
import {createRequire} from "node:module";
import os from "node:os";
import path from "node:path";

const [triskin, writeStrip, nodeModules] = process.argv.slice(2);
let lib, jscad, modeling;
try {
  const require = createRequire(path.resolve(nodeModules, "x.js"));
  lib = await require("@3mfconsortium/lib3mf")();
  jscad = require("@jscad/3mf-serializer");
  modeling = require("@jscad/modeling");
} catch {
  console.log("left out: @3mfconsortium/lib3mf or @jscad/3mf-serializer is not installed (tools/setup test installs them where npm is)");
  process.exit(77);
}
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "three_mf_test."));
const at = name => path.join(folder, name);
const wrapper = new lib.CWrapper();
console.warn = () => {};  // The library warns of each object that is left to the garbage collector.

function run(...words) {
  const done = spawnSync(triskin, words, {cwd: folder, encoding: "utf8"});
  assert.equal(done.status, 0, `${words.join(" ")}: ${done.stderr}`);
  return done.stdout + done.stderr;
}

function areaOf(vertices, faces) {
  let area = 0;
  for (const [a, b, c] of faces) {
    const u = vertices[b].map((x, i) => x - vertices[a][i]), v = vertices[c].map((x, i) => x - vertices[a][i]);
    area += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
  }
  return area;
}

// What this program read: the surface that it writes again, in mm.
function readHere(file, ...more) {
  run("extract", file, "-o", "read.obj", ...more);
  const lines = fs.readFileSync(at("read.obj"), "utf8").split("\n").map(l => l.trim().split(/\s+/));
  const vertices = lines.filter(l => l[0] === "v").map(l => l.slice(1, 4).map(Number));
  const faces = lines.filter(l => l[0] === "f").map(l => l.slice(1).map(w => parseInt(w) - 1));
  return {vertices, faces};
}

const sorted = points => points.map(p => p.map(x => (Math.round(x * 1e3) / 1e3 + 0).toFixed(3)).join(" ")).sort();

// A shell on a cylinder of radius 80 mm: 9 × 7 vertices of which no two have a coordinate pattern in common.
const vertices_mm = [], faces = [];
for (let row = 0; row < 7; ++row) {
  for (let column = 0; column < 9; ++column) {
    const angle = (column - 4) * 0.17;
    vertices_mm.push([80 * Math.sin(angle), 15 * row, 80 * Math.cos(angle)]);
    if (row === 6 || column === 8) continue;
    const k = 9 * row + column;
    faces.push([k, k + 1, k + 10], [k, k + 10, k + 9]);
  }
}
const area_mm2 = areaOf(vertices_mm, faces);

function addMesh(model, name, points) {
  const mesh = model.AddMeshObject();
  mesh.SetName(name);
  for (const [x, y, z] of points) {
    const p = new lib.sPosition();
    p.set_Coordinates0(x), p.set_Coordinates1(y), p.set_Coordinates2(z);
    mesh.AddVertex(p);
  }
  for (const [a, b, c] of faces) {
    const t = new lib.sTriangle();
    t.set_Indices0(a), t.set_Indices1(b), t.set_Indices2(c);
    mesh.AddTriangle(t);
  }
  return mesh;
}

function write(model, name) {
  model.QueryWriter("3mf").WriteToFile("/out.3mf");
  fs.writeFileSync(at(name), lib.FS.readFile("/out.3mf"));
}

const kUnits_mm = {MicroMeter: 1e-3, MilliMeter: 1, CentiMeter: 10, Inch: 25.4, Foot: 304.8, Meter: 1e3};
for (const [unit, size_mm] of Object.entries(kUnits_mm)) {
  const model = wrapper.CreateModel();
  model.SetUnit(lib.eModelUnit[unit]);
  const mesh = addMesh(model, "cover 左腕", vertices_mm.map(p => p.map(x => x / size_mm)));
  model.AddBuildItem(mesh, wrapper.GetIdentityTransform());
  write(model, "cover.3mf");
  const read = readHere("cover.3mf");
  assert.equal(read.faces.length, faces.length, unit);
  // lib3mf keeps 32-bit numbers and writes six decimals: 0.5e-6 of a metre are 0.5 µm.
  const error_mm = Math.max(0.5e-6 * size_mm, 80 * 2 ** -23) * 2;
  const far = Math.max(...read.vertices.map(p => Math.min(...vertices_mm.map(q => Math.hypot(...p.map((x, i) => x - q[i]))))));
  assert(far <= Math.sqrt(3) * error_mm + 1e-6, `${unit}: a vertex lies ${far} mm beside`);
  assert.equal(read.vertices.length, vertices_mm.length, unit);
  assert(Math.abs(areaOf(read.vertices, read.faces) / area_mm2 - 1) < 1e-5, `${unit}: area`);
  // The object has its name.
  assert.equal(readHere("cover.3mf", "--object", "cover 左腕").faces.length, faces.length);
}

// A build item moves a component that moves the mesh: 10 along x, then 200 along y.
{
  const model = wrapper.CreateModel();
  const mesh = addMesh(model, "cover", vertices_mm), both = model.AddComponentsObject();
  both.AddComponent(mesh, wrapper.GetTranslationTransform(10, 0, 0));
  model.AddBuildItem(both, wrapper.GetTranslationTransform(0, 200, 0));
  write(model, "moved.3mf");
  assert.deepEqual(sorted(readHere("moved.3mf").vertices), sorted(vertices_mm.map(([x, y, z]) => [x + 10, y + 200, z])));
}

// JSCAD writes its model in no namespace. 4 × 3 × 1 inches are 2 (4·3 + 3·1 + 1·4) = 38 square inches.
fs.writeFileSync(at("jscad.3mf"), Buffer.from(jscad.serialize({unit: "inch"}, modeling.primitives.cuboid({size: [4, 3, 1]}))[0]));
{
  const said = run("extract", "jscad.3mf", "-o", "read.obj");
  assert.match(said, /part of 101\.6 × 76\.2 × 25\.4 mm: 12 faces, 245\.2 cm²/);
}

function volumeOf(vertices, faces) {
  let six = 0;
  for (const [a, b, c] of faces) {
    const [p, q, r] = [vertices[a], vertices[b], vertices[c]];
    six += p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
  }
  return six / 6;
}

// Binary STL: 80 bytes, a count, and for each facet a normal, three corners and two bytes.
function volumeOfStl(name) {
  const bytes = fs.readFileSync(at(name)), points = [], triangles = [];
  for (let f = 0; f < bytes.readUInt32LE(80); ++f) {
    for (let corner = 0; corner < 3; ++corner)
      points.push([0, 4, 8].map(o => bytes.readFloatLE(84 + 50 * f + 12 + 12 * corner + o)));
    triangles.push([3 * f, 3 * f + 1, 3 * f + 2]);
  }
  return volumeOf(points, triangles);
}

// What fabricate writes: lib3mf accepts it strictly, and its bodies have the volumes of the STL files beside it, which hold
// single precision.
spawnSync(writeStrip, [at("strip.json"), "4"]);
run("fabricate", "strip.json", "-o", "made", "--only", "solids");
{
  const model = wrapper.CreateModel(), reader = model.QueryReader("3mf");
  reader.SetStrictModeActive(true);
  lib.FS.writeFile("/in.3mf", fs.readFileSync(at("made/solids/solids.3mf")));
  reader.ReadFromFile("/in.3mf");
  assert.equal(reader.GetWarningCount(), 0);
  assert.equal(model.GetUnit().value, lib.eModelUnit.MilliMeter.value);
  const names = [], volumes_mm3 = {}, meshes = model.GetMeshObjects();
  while (meshes.MoveNext()) {
    const mesh = meshes.GetCurrentMeshObject(), name = mesh.GetName();
    assert(mesh.IsManifoldAndOriented(), name);
    const points = [], triangles = [];
    for (let k = 0; k < mesh.GetVertexCount(); ++k) {
      const p = mesh.GetVertex(k);
      points.push([p.get_Coordinates0(), p.get_Coordinates1(), p.get_Coordinates2()]);
    }
    for (let k = 0; k < mesh.GetTriangleCount(); ++k) {
      const t = mesh.GetTriangle(k);
      triangles.push([t.get_Indices0(), t.get_Indices1(), t.get_Indices2()]);
    }
    const file = /^M\d+$/.test(name) ? "modules" : name;
    volumes_mm3[file] = (volumes_mm3[file] ?? 0) + volumeOf(points, triangles);
    names.push(name);
  }
  assert.deepEqual(Object.keys(volumes_mm3).sort(), ["carrier", "modules", "mould"]);
  for (const [file, volume_mm3] of Object.entries(volumes_mm3))
    assert(Math.abs(volume_mm3 / volumeOfStl(`made/solids/${file}.stl`) - 1) < 1e-4, file);
  assert(names.length === 6 && new Set(names).size === names.length, names.join(" "));
  console.log(`${Object.keys(kUnits_mm).length} units of lib3mf, a component, a file of JSCAD; ${names.length} bodies of ours in lib3mf: they agree`);
}
fs.rmSync(folder, {recursive: true, force: true});
