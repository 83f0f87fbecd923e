// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Colours of modules for each mode, and of taxels by their change.
import {Model} from "./model.js";

/** @typedef {[number, number, number]} Rgb each 0 … 1 */

/** @returns {Rgb} @param {number} h degrees @param {number} s @param {number} l */
function hsl(h, s, l) {
  const f = (n) => {
    const k = (n + h / 30) % 12;
    return l - s * Math.min(l, 1 - l) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return [f(0), f(8), f(4)];
}

// A scale that grows in lightness for every kind of colour vision (five stops of viridis).
const SCALE = [[0.267, 0.005, 0.329], [0.230, 0.322, 0.546], [0.128, 0.567, 0.551], [0.369, 0.789, 0.383], [0.993, 0.906, 0.144]];
/** @param {number} x 0 … 1 @returns {Rgb} */
export function scale(x) {
  const at = Math.min(Math.max(x, 0), 1) * (SCALE.length - 1), k = Math.min(Math.floor(at), SCALE.length - 2);
  return /** @type {Rgb} */ (SCALE[k].map((v, c) => v + (at - k) * (SCALE[k + 1][c] - v)));
}
const LINES = [[0.90, 0.62, 0.0], [0.34, 0.71, 0.91], [0.0, 0.62, 0.45], [0.80, 0.47, 0.65]];
const NONE = /** @type {Rgb} */ ([0.55, 0.57, 0.6]);
const OVER = /** @type {Rgb} */ ([0.85, 0.1, 0.1]);
export const FAULT = /** @type {Rgb} */ ([0.75, 0.12, 0.1]);

export const css = (c) => `rgb(${c.map((v) => Math.round(255 * v)).join(",")})`;

/** Change in counts at which a taxel has its full colour. */
export const FULL_COUNTS = 6000;
/** Change in counts from which a taxel counts as pressed. */
export const PRESSED_COUNTS = 200;
/** Colour strength of a change: the square root shows light touches. @param {number} counts */
export const heatOf = (counts) => {
  const x = Math.abs(counts);
  return x < PRESSED_COUNTS / 2 ? 0 : Math.min(1, Math.sqrt(x / FULL_COUNTS));
};
/** The heat scale of the page and of its legend: dark red, orange, yellow. @param {number} x @returns {Rgb} */
export const heatColor = (x) => [Math.min(1, 0.55 + 0.9 * x), Math.max(0, Math.min(1, 1.5 * x - 0.25)), Math.max(0, 2.5 * x - 1.8)];

/** Modes: name, colours of all modules, legend. @param {Model} model */
export function modesOf(model) {
  const patch = (k) => model.modules[k].patch;
  const modes = [
    {name: "controllers", color: (k) => patch(k) < 0 ? NONE : hsl((patch(k) * 137.508) % 360, 0.45, 0.58),
     legend: `<p>One colour a controller (${model.data.patches.length}); dots are entries, grey bands joints between controllers.</p>`},
    {name: "live", color: () => /** @type {Rgb} */ ([0.42, 0.45, 0.49]),
     legend: bar(heatColor, `rest`, `${FULL_COUNTS} counts`)},
    {name: "lines", color: (k) => patch(k) < 0 ? NONE : LINES[model.modules[k].line],
     legend: LINES.map((c, k) => swatch(c, `line ${k}`)).join("")},
    {name: "addresses", color: (k) => patch(k) < 0 ? NONE : LINES[model.modules[k].address],
     legend: LINES.map((c, k) => swatch(c, `0x${(0x2c + k).toString(16).toUpperCase()}`)).join("")},
    {name: "depth in the tree", color: byValue((k) => model.modules[k].depth, depthMost(model)),
     legend: bar(scale, "entry", `${depthMost(model)} joints`)},
    {name: "loss when it fails", color: byValue((k) => model.subtree(k).length, 16), legend: bar(scale, "0", "16 modules") +
     "<p>Choose a module: red are lost for good, orange are read over the blue joints (switched modules).</p>"},
  ];
  const kinds = [...new Set(model.modules.map((m) => m.kind || ""))].filter((kind) => kind).sort();
  const colorOfKind = (kind) => hsl((kinds.indexOf(kind) * 137.508 + 30) % 360, 0.5, 0.55);
  if (kinds.length > 0) {
    modes.push({name: "kinds", color: (k) => colorOfKind(model.modules[k].kind),
                legend: kinds.map((kind) => swatch(colorOfKind(kind), asText(kind))).join("")});
  }
  model.data.metrics.forEach((metric, row) => {
    const most = metric.limit || Math.max(0.01, ...model.modules.map((m) => m.metrics[row]));
    modes.push({name: metric.name, color: byValue((k) => model.modules[k].metrics[row], most),
                legend: bar(scale, "0", `${+most.toFixed(2)} ${metric.unit}${metric.limit ? " (limit)" : ""}`) + swatch(OVER, "over the limit")});
  });
  return modes;
}

function depthMost(model) { return Math.max(1, ...model.modules.map((m) => m.depth)); }
function byValue(value, most) { return (k) => value(k) > most * 1.0001 ? OVER : scale(value(k) / most); }
// A name from a file must not become markup of the legend.
function asText(name) { return name.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`); }
function swatch(c, text) { return `<span class="swatch" data-color="${css(c)}"></span>${text}`; }
function bar(of, low, high) {
  const stops = [0, 0.25, 0.5, 0.75, 1].map((x) => css(of(x))).join(",");
  return `<div class="bar" data-scale="${stops}"></div><div class="ends"><span>${low}</span><span>${high}</span></div>`;
}
