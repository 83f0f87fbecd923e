// SPDX-License-Identifier: GPL-3.0-or-later
// Hands exported files to readers of other makers: glTF to the validator of the Khronos group, MJCF to MuJoCo.
// Usage: foreign_test.mjs NODE_MODULES FILE.gltf|FILE.xml …   Prints for each its name and the names that the reader finds.
// Exit status: 0 all are read, 1 one is refused, 77 a reader is not installed.
import fs from "node:fs";
import {createRequire} from "node:module";
import path from "node:path";

import {loadMujoco} from "../../support/mujoco.mjs";

const [nodeModules, ...files] = process.argv.slice(2);
let validator;
try {
  validator = createRequire(path.resolve(nodeModules, "x.js"))("gltf-validator");
} catch {
  console.log("left out: gltf-validator is not installed (tools/setup test installs it where npm is)");
  process.exit(77);
}
const mujoco = await loadMujoco(nodeModules);
for (const [k, file] of files.entries()) {
  if (file.endsWith(".gltf")) {
    const {issues, info} = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {uri: "skin.gltf"});
    if (issues.numErrors + issues.numWarnings > 0 || !(info.totalTriangleCount > 0)) {
      console.log(`${file}: ${JSON.stringify(issues.messages)}`);
      process.exitCode = 1;
    }
    console.log(`${file}: ${info.totalTriangleCount} triangles`);
  } else {
    // MuJoCo throws where it refuses; the skin has to be there with its sensors.
    mujoco.FS.writeFile(`/models/${k}.xml`, fs.readFileSync(file, "utf8"));
    const model = mujoco.MjModel.loadFromXML(`/models/${k}.xml`);
    if (!(model.nbody > 1 && model.nsensordata > 0)) {
      console.log(`${file}: no skin with sensors in it`);
      process.exitCode = 1;
    }
    console.log(`${file}: ${model.nbody} bodies, ${model.nsensordata} values`);
    model.delete();
  }
}
