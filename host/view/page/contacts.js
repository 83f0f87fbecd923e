// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Contacts that the server has fitted, and for recordings regions: taxels under pressure that lie near each other, with their centre weighted by change.
import {PRESSED_COUNTS} from "./colors.js";
import {TAXELS} from "./model.js";

const NEAR_MM = 12; // taxels of a module are 7 mm apart, those of neighbours up to 10 mm

/** @typedef {{taxels: number[], strongest: number, sum: number, force: number | null, forceSd: number | null, centre: number[], module: number}} Contact */

/** A contact that triskin view has fitted to the taxels. @param {any} c @returns {Contact} */
export function contactTold(c) {
  return {taxels: c.taxels, strongest: c.taxels[0], sum: c.change_counts, force: c.force_n, forceSd: c.force_sd_n, centre: c.position_mm, module: Math.floor(c.taxels[0] / TAXELS)};
}

/** All contact regions, strongest first; at most `most` taxels are looked at. @param {import("./model.js").Model} model
 * @param {import("./live.js").LiveSkin} live @returns {Contact[]} */
export function contactsOf(model, live, most = 300) {
  const pressed = /** @type {number[]} */ ([]), strength = (n) => live.pressureOf(n);
  for (let n = 0; n < live.change.length && pressed.length < most; ++n)
    if (strength(n) >= PRESSED_COUNTS && model.pressure[n % TAXELS] && (live.valid[Math.floor(n / TAXELS)] >> n % TAXELS & 1)) pressed.push(n);
  const left = new Set(pressed), contacts = /** @type {Contact[]} */ ([]);
  for (const first of pressed) {
    if (!left.delete(first)) continue;
    const taxels = [first];
    for (let at = 0; at < taxels.length; ++at) {
      for (const other of left)
        if (distance(model.cover.taxels, taxels[at], other) <= NEAR_MM && faceAlike(model.cover.normals, taxels[at], other)) { left.delete(other); taxels.push(other); }
    }
    contacts.push(regionOf(model, taxels, strength));
  }
  return contacts.sort((a, b) => b.sum - a.sum);
}

function distance(places, a, b) {
  return Math.hypot(places[3 * a] - places[3 * b], places[3 * a + 1] - places[3 * b + 1], places[3 * a + 2] - places[3 * b + 2]);
}

// The two sides of a thin part are two contacts.
function faceAlike(normals, a, b) {
  const i = 3 * Math.floor(a / TAXELS), j = 3 * Math.floor(b / TAXELS);
  return normals[i] * normals[j] + normals[i + 1] * normals[j + 1] + normals[i + 2] * normals[j + 2] > 0;
}

function regionOf(model, taxels, strength) {
  let sum = 0, strongest = taxels[0];
  const centre = [0, 0, 0];
  for (const n of taxels) {
    sum += strength(n);
    if (strength(n) > strength(strongest)) strongest = n;
    for (let x = 0; x < 3; ++x) centre[x] += strength(n) * model.cover.taxels[3 * n + x];
  }
  const worth = model.newtonPerCount;
  const force = worth && taxels.reduce((all, n) => all + strength(n) * worth[n], 0);
  return {taxels, strongest, sum, force, forceSd: null, centre: centre.map((v) => v / sum), module: Math.floor(strongest / TAXELS)};
}
