// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// The one table of colours. Drawing and legend both take a colour from here, so that the legend cannot disagree with the picture, and no two entries that
// can be seen together share a colour.
import {Model} from "./model.js";

/** @typedef {[number, number, number]} Rgb each 0 … 1 */

/** What a colour means, wherever it is drawn. `what`: text of the legend. */
export const PALETTE = /** @type {Record<string, {color: Rgb, what: string}>} */ ({
  over: {color: [0.85, 0.10, 0.10], what: "over the limit"},
  fault: {color: [0.0, 0.85, 0.90], what: "chip fault, crossed"},
  none: {color: [0.72, 0.67, 0.60], what: "in no patch"},
  lost: {color: [0.45, 0.05, 0.30], what: "lost for good"},
  rerouted: {color: [0.97, 0.72, 0.84], what: "read over the blue joints (switched modules)"},
  backup: {color: [0.10, 0.25, 0.95], what: "joint that takes over"},
  module: {color: [0.40, 0.43, 0.48], what: "module"},
  rest: {color: [0.78, 0.81, 0.85], what: "taxel at rest"},
  noValue: {color: [0.24, 0.26, 0.29], what: "temperature pad, or no valid sample"},
  tree: {color: [0.08, 0.09, 0.10], what: "line to parent; disc: cable entry"},
  seam: {color: [0.58, 0.60, 0.64], what: "between controllers"},
  cut: {color: [0.66, 0.96, 0.16], what: "cut joint"},
  jumper: {color: [0.42, 0.12, 0.78], what: "jumper"},
  finding: {color: [0.0, 0.45, 0.70], what: "finding of verify"},
  cover: {color: [0.72, 0.72, 0.72], what: "side that is covered"},
  leftOut: {color: [0.80, 0.52, 0.42], what: "inner side and rims of the part"},
  back: {color: [0.37, 0.30, 0.23], what: "back of a module"},
  kept: {color: [0.50, 0.56, 0.78], what: "stays where it is"},
  added: {color: [0.16, 0.66, 0.22], what: "added"},
  removed: {color: [0.84, 0.36, 0.48], what: "removed"},
});
/** The colour of an entry of the table. @param {string} name @returns {Rgb} */
export const colorOf = (name) => PALETTE[name].color;

/** @returns {Rgb} @param {number} h degrees @param {number} s @param {number} l */
function hsl(h, s, l) {
  const f = (n) => {
    const k = (n + h / 30) % 12;
    return l - s * Math.min(l, 1 - l) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return [f(0), f(8), f(4)];
}

/** @param {number[][]} stops @param {number} x 0 … 1 @returns {Rgb} */
function between(stops, x) {
  const at = Math.min(Math.max(x, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2);
  return /** @type {Rgb} */ (stops[k].map((v, c) => v + (at - k) * (stops[k + 1][c] - v)));
}

// A scale that grows in lightness for every kind of colour vision: four stops of viridis and a pale green, since its yellow end would look like a pressed taxel.
const SCALE = [[0.267, 0.005, 0.329], [0.230, 0.322, 0.546], [0.128, 0.567, 0.551], [0.369, 0.789, 0.383], [0.84, 0.96, 0.72]];
/** @param {number} x 0 … 1 @returns {Rgb} */
export const scale = (x) => between(SCALE, x);

/** Stops of the heat scale: brown, orange, yellow. It has neither the red of a limit nor the white of rest, and grows in lightness. */
export const HEAT = [[0.50, 0.22, 0.02], [0.85, 0.42, 0.0], [1.0, 0.68, 0.0], [1.0, 0.95, 0.30]];
/** Colour of a pressed taxel. @param {number} x 0 … 1 @returns {Rgb} */
export const heatColor = (x) => between(HEAT, x);

/** Colours of the four lines, and of the four addresses. */
export const LINES = /** @type {Rgb[]} */ ([[0.58, 0.60, 0.12], [0.34, 0.71, 0.91], [0.0, 0.62, 0.45], [0.80, 0.47, 0.65]]);
/** Colours of the curves in the history plot. */
export const CURVES = /** @type {Rgb[]} */ ([[0.90, 0.62, 0.0], ...LINES.slice(1), [0.0, 0.45, 0.70], [0.84, 0.37, 0.0]]);

export const css = (c) => `rgb(${c.map((v) => Math.round(255 * v)).join(",")})`;

/** Change at which a taxel has its full colour: in counts, or in kPa where the skin is calibrated (10 counts a kPa are usual). */
export const FULL_COUNTS = 400, FULL_KPA = 40;
/** Change in counts from which a taxel counts as pressed: layout::kPressed_counts, as tests/output/view/page_test.cpp checks. */
export const PRESSED_COUNTS = 20;
/** The same in kPa of a usual taxel, the least scale of a plot. */
export const PRESSED_KPA = 2;
/** Colour strength of a pressure: the square root shows light touches. @param {number} counts below rest @param {number} share of the full colour */
export const heatOf = (counts, share = counts / FULL_COUNTS) => counts < PRESSED_COUNTS / 2 ? 0 : Math.min(1, Math.sqrt(share));

/** Name of the mode that compares two designs. */
export const CHANGES = "changes";

/** Colour of a controller: neighbours in number are far apart in hue. @param {number} patch @returns {Rgb} */
export const controllerColor = (patch) => patch < 0 ? colorOf("none") : hsl((patch * 137.508) % 360, 0.45, 0.6);

/** @typedef {{color: Rgb, what: string, of?: (k: number) => boolean}} Swatch `of`: the modules that are drawn in this colour */
/** @typedef {{of: (x: number) => Rgb, low: string, high: string}} Bar */
/** @typedef {{name: string, color: (k: number) => Rgb, swatches: Swatch[], bar?: Bar, chips?: boolean}} Mode `chips`: swatches whose text is a number */

/** The scale of a pressed taxel, in every mode. @param {Model} model @returns {Bar} */
export const heatBar = (model) => ({of: heatColor, low: "touched", high: model.isCalibrated ? `${FULL_KPA} kPa` : `${FULL_COUNTS} counts`});

/** The solder bridges to close, and the I²C address they give: "ADD0L ADD1H (2E)". @param {number} a */
export const addressStrap = (a) => `ADD0${a & 1 ? "H" : "L"} ADD1${a & 2 ? "H" : "L"} (${(0x2c + a).toString(16).toUpperCase()})`;

/** The ways to colour modules. @param {Model} model @returns {Mode[]} */
export function modesOf(model) {
  const modules = model.modules, patch = (k) => modules[k].patch;
  const entry = (name, of) => ({...PALETTE[name], of});
  const strap = (row, names) => ({
    color: (k) => patch(k) < 0 ? colorOf("none") : LINES[modules[k][row]],
    swatches: names.map((what, n) => ({color: LINES[n], what, of: (k) => patch(k) >= 0 && modules[k][row] === n})),
  });
  const modes = /** @type {Mode[]} */ ([
    {name: "controllers", color: (k) => controllerColor(patch(k)), chips: true,
     swatches: model.data.patches.flatMap(({entry}, p) => entry < 0 ? [] : [{color: controllerColor(p), what: model.controllerOf(p), of: (k) => patch(k) === p}])},
    {name: "pressure", color: () => colorOf("module"), swatches: [entry("module", () => true)],
     bar: heatBar(model)},
    {name: "lines", ...strap("line", ["L0", "L1", "L2", "L3"])},
    {name: "addresses", ...strap("address", [0, 1, 2, 3].map(addressStrap))},
    byValue("depth in the tree", (k) => modules[k].depth, depthMax(model), "entry", `${depthMax(model)} joints`),
    byValue("loss when it fails", (k) => model.subtree(k).length, 16, "0", "16 modules"),
  ]);
  modes[5].swatches = (model.data.switched ? ["lost", "rerouted", "backup"] : ["lost"]).map((name) => ({...PALETTE[name]}));
  const kinds = [...new Set(modules.map((m) => m.kind || ""))].filter((kind) => kind).sort();
  const colorOfKind = (kind) => hsl((kinds.indexOf(kind) * 137.508 + 30) % 360, 0.5, 0.55);
  if (kinds.length > 0) {
    modes.push({name: "kinds", color: (k) => colorOfKind(modules[k].kind),
                swatches: kinds.map((kind) => ({color: colorOfKind(kind), what: kind, of: (k) => modules[k].kind === kind}))});
  }
  if (model.data.side?.wall_mm?.length) modes.push(wallMode(model));
  const {changes} = model.data;
  if (changes?.length) {
    modes.push({name: CHANGES, color: (k) => colorOf(changes[k].what),
                swatches: ["kept", "added", "removed"].map((what) => entry(what, (k) => changes[k].what === what))});
  }
  model.data.metrics.forEach((metric, row) => {
    const max = metric.limit || Math.max(0.01, ...modules.map((m) => m.metrics[row]));
    const mode = byValue(metric.name, (k) => modules[k].metrics[row], max, "0", `${+max.toFixed(2)} ${metric.unit}${metric.limit ? " (limit)" : ""}`);
    if (metric.limit) mode.swatches.push(entry("over", (k) => modules[k].metrics[row] > max * 1.0001));
    modes.push(mode);
  });
  return modes;
}

// Thickness of the wall under each module; 0: nothing of the part lies behind it.
function wallMode(model) {
  const wall = model.data.side.wall_mm, max = Math.max(0.01, ...wall);
  return {name: "wall thickness", color: (k) => wall[k] > 0 ? scale(wall[k] / max) : colorOf("none"),
          bar: {of: scale, low: "0", high: `${+max.toFixed(1)} mm`},
          swatches: [{...PALETTE.none, what: "no wall behind it", of: (k) => !(wall[k] > 0)}]};
}

function depthMax(model) { return Math.max(1, ...model.modules.map((m) => m.depth)); }
/** @returns {Mode} */
function byValue(name, value, max, low, high) {
  return {name, color: (k) => value(k) > max * 1.0001 ? colorOf("over") : scale(value(k) / max), swatches: [], bar: {of: scale, low, high}};
}
