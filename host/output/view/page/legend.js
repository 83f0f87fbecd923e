// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// The legend: made of the entries by which the picture is drawn. Texts are set as text, since names of kinds come from a file; colours are set here because
// the page allows no inline style.
import {css, heatBar, PALETTE} from "./colors.js";
import {byId} from "./panel.js";

/** @param {{color: number[], what: string}} entry @param {string} kind of CSS class */
function swatch(entry, kind) {
  const row = document.createElement("span"), spot = document.createElement("i");
  row.className = kind;
  spot.style.background = css(entry.color);
  row.dataset.color = spot.style.background;
  row.append(spot, entry.what);
  return row;
}

/** @param {import("./colors.js").Bar} bar */
function barOf(bar) {
  const stripe = document.createElement("div"), ends = document.createElement("div");
  stripe.className = "bar";
  stripe.style.background = `linear-gradient(to right, ${Array.from({length: 13}, (_, k) => css(bar.of(k / 12))).join(",")})`;
  ends.className = "ends";
  ends.append(...[bar.low, bar.high].map((text) => Object.assign(document.createElement("span"), {textContent: text})));
  return [stripe, ends];
}

/** Which marks are shown, and what of the table explains them. */
const MARKS = [["taxels", ["rest", "noValue"]], ["trees", ["tree"]], ["seams", ["seam", "cut"]], ["jumpers", ["jumper"]]];

/** @param {import("./colors.js").Mode} mode @param {import("./model.js").Model} model @param {Record<string, boolean>} shown 
 * @param {{faults: boolean, findings: boolean, skin: boolean}} has what there is to see */
export function fillLegend(mode, model, shown, has) {
  const rows = /** @type {HTMLElement[]} */ ([]);
  if (mode.bar) rows.push(...barOf(mode.bar));
  const kind = mode.chips ? "chip" : "swatch";
  rows.push(...mode.swatches.filter((s) => !s.of || mode.chips || model.modules.some((_, k) => s.of?.(k))).map((s) => swatch(s, kind)));
  const names = MARKS.filter(([part]) => shown[/** @type {string} */ (part)]).flatMap(([, entries]) => entries).filter((name) => name !== "jumper" || model.data.jumpers.length > 0);
  if (has.faults) names.unshift("fault");
  if (has.findings) names.push("finding");
  if (shown.surface && model.data.side?.left_out.faces.length) names.push("cover", "leftOut");
  names.push("back");
  const marks = document.createElement("div");
  const ring = model.data.patches.some((p) => p.second_entry >= 0) ? "; ring: second entry" : "";
  marks.append(...names.map((name) => swatch(name === "tree" ? {...PALETTE.tree, what: PALETTE.tree.what + ring} : PALETTE[name], "swatch")));
  // Whoever colours by something else sees the touched taxels too.
  const touched = has.skin && shown.taxels && mode.name !== "pressure" ? barOf(heatBar(model)) : [];
  byId("legend").replaceChildren(...rows, ...touched, marks);
}
