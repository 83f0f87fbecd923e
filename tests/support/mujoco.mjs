// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo of the npm package mujoco-js, with a folder /models for its files.
import fs from "node:fs";
import path from "node:path";
import {pathToFileURL} from "node:url";

/** Ends the program with status 77 ("left out" of CTest) where the package is not installed. */
export async function loadMujoco(nodeModules) {
  const library = path.resolve(nodeModules, "mujoco-js/dist/mujoco_wasm.js");
  if (!fs.existsSync(library)) {
    console.log("left out: mujoco-js is not installed (tools/setup test installs it where npm is)");
    process.exit(77);
  }
  const mujoco = await (await import(pathToFileURL(library))).default();
  mujoco.FS.mkdir("/models");
  mujoco.FS.mount(mujoco.MEMFS, {root: "."}, "/models");
  return mujoco;
}
