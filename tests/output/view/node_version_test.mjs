// SPDX-License-Identifier: GPL-3.0-or-later
// Every npm package of the tests must be the listed one and run with the Node of Debian 12, whatever runs here.
// Usage: node_version_test.mjs LIST NODE_MODULES
// Exit status: 0 they do, 1 one does not, 77 left out because none is installed.
import fs from "node:fs";
import path from "node:path";

const kDebianNode = 18;

const [list, nodeModules] = process.argv.slice(2);
const wanted = fs.readFileSync(list, "utf8").split("\n")
  .filter((line) => line.trim() && !line.startsWith("#")).map((line) => line.trim().split(/\s+/));
if (!fs.existsSync(nodeModules)) {
  console.log("left out: no npm package is installed (tools/setup test installs them where npm is)");
  process.exit(77);
}
let failures = 0;
for (const [name, version] of wanted) {
  const described = JSON.parse(fs.readFileSync(path.join(nodeModules, name, "package.json"), "utf8"));
  const least = Number(/^>=\s*(\d+)/.exec(described.engines?.node ?? ">=0")?.[1] ?? Infinity);
  const fits = described.version === version && least <= kDebianNode;
  console.log(`${name} ${described.version} (listed ${version}), Node ${described.engines?.node ?? "any"}${fits ? "" : ": does not fit"}`);
  if (!fits) ++failures;
}
process.exitCode = failures === 0 ? 0 : 1;
