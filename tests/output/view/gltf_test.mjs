// SPDX-License-Identifier: GPL-3.0-or-later
// Checks an exported glTF file with the validator of the Khronos group. Usage: gltf_test.mjs TRISKIN WRITE_STRIP NODE_MODULES
// Exit status: 0 passed, 1 failed, 77 left out because gltf-validator is not installed.
import {execFileSync} from "node:child_process";
import fs from "node:fs";
import {createRequire} from "node:module";
import os from "node:os";
import path from "node:path";

const [triskin, writeStrip, nodeModules] = process.argv.slice(2);
let validator;
try {
  validator = createRequire(path.resolve(nodeModules, "x.js"))("gltf-validator");
} catch {
  console.log("left out: gltf-validator is not installed (tools/setup test installs it where npm is)");
  process.exit(77);
}
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "gltf_test."));
const design = path.join(folder, "strip.json"), file = path.join(folder, "strip.gltf");
execFileSync(writeStrip, [design, "40"]);
// The design has cut corners and a jumper, so that the validator checks their shapes too.
const made = JSON.parse(fs.readFileSync(design, "utf8"));
Object.assign(made, {version: 2, corner_cut_mm: 4, jumpers: [{kind: "cable", modules: [0, 5], sides: [0, 1], length_mm: 60, fold_rad: 0}]});
made.limits.jumper_mm = 60;
made.report.jumpers_lower_bound = 1;
fs.writeFileSync(design, JSON.stringify(made));
execFileSync(triskin, ["export", design, "-o", file], {stdio: "ignore"});
const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {uri: "strip.gltf"});
fs.rmSync(folder, {recursive: true, force: true});
console.log(JSON.stringify(report.issues, null, 1));
process.exitCode = report.issues.numErrors + report.issues.numWarnings === 0 && report.info.totalTriangleCount > 0 ? 0 : 1;
