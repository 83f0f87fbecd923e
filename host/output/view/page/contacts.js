// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Contacts as triskin view has fitted them to the taxels, of a live skin and of a recording.
import {HEADER} from "./live.js";
import {TAXELS} from "./model.js";

const CONTACTS_KIND = 2; // docs/view.md

/** @typedef {{taxels: number[], sum: number, force: number | null, forceSd: number | null, centre: number[], module: number}} Contact */

/** A contact that triskin view has fitted to the taxels. @param {any} c @returns {Contact} */
export function contactTold(c) {
  return {taxels: c.taxels, sum: c.change_counts, force: c.force_n, forceSd: c.force_sd_n, centre: c.position_mm, module: Math.floor(c.taxels[0] / TAXELS)};
}

/** The contacts that an entry of a recording holds; null: it holds samples. @param {ArrayBuffer} entry @returns {Contact[] | null} */
export function contactsIn(entry) {
  if (new Uint8Array(entry)[0] !== CONTACTS_KIND) return null;
  return JSON.parse(new TextDecoder().decode(entry.slice(HEADER))).contacts.map(contactTold);
}
