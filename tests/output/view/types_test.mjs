// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the types of the page's code. Usage: types_test.mjs TSCONFIG NODE_MODULES
// Exit status: 0 no error, 1 errors, 77 left out because typescript is not installed.
import {spawnSync} from "node:child_process";
import fs from "node:fs";
import path from "node:path";

const [config, nodeModules] = process.argv.slice(2);
const compiler = path.join(nodeModules, "typescript", "lib", "tsc.js");
if (!fs.existsSync(compiler)) {
  console.log("left out: typescript is not installed (tools/setup test installs it where npm is)");
  process.exit(77);
}
const outcome = spawnSync(process.execPath, [compiler, "-p", config], {encoding: "utf8"});
console.log(outcome.stdout || "no type errors");
process.exitCode = outcome.status === 0 ? 0 : 1;
