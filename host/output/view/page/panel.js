// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// The column beside the drawing: text only, set as text, so that no name from a file is taken for markup.
import {addressStrap, PALETTE, PRESSED_COUNTS} from "./colors.js";
import {FIRST_FAULT, STATES} from "./live.js";
import {TAXELS} from "./model.js";

/** So many modules are named in a sentence. */
const MAX_NAMED = 12;

/** A number with its noun. @param {number} n @param {string} noun the singular; its plural ends in s */
const counted = (n, noun) => `${n} ${noun}${n === 1 ? "" : "s"}`;

/** @param {string} id @returns {any} */
export const byId = (id) => document.getElementById(id);

/** @param {HTMLElement} list @param {[string, string|number][]} rows */
export function fillList(list, rows) {
  list.replaceChildren(...rows.flatMap(([name, value]) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = name;
    dd.textContent = String(value);
    return [dt, dd];
  }));
}

/** @param {import("./model.js").Model} model */
export function fillDesign(model) {
  const d = model.data;
  byId("name").textContent = d.name;
  document.title = `${d.name} – triskin view`;
  const isCompared = model.data.changes?.length > 0; // sums of two designs would mean nothing
  fillList(byId("design"), [...(isCompared ? [] : sumRows(model)),
    ...(d.side ? /** @type {[string, string][]} */ ([["side of the part", d.side.taken], ["wall", `${d.side.mean_mm} mm`]]) : []),
    ...(d.covers ?? []).map((c) => /** @type {[string, string]} */ ([c.name, `${counted(c.modules, "module")}, ${Math.round(100 * c.coverage)} % of ${Math.round(c.area_cm2)} cm²`])),
    ...(isCompared ? changeRows(model.data.changes, d.before.modules) : /** @type {[string, string][]} */ ([["design", d.design_id]]))]);
}

/** How many modules stay, are added and removed. @returns {[string, number][]} */
function changeRows(changes, before) {
  const count = (what) => changes.filter((c, k) => c.what === what && (what !== "kept" || k >= before)).length;
  return ["kept", "added", "removed"].map((what) => [PALETTE[what].what, count(what)]);
}

/** Of a robot it is that of all covers. */
function coverageOf(d) {
  const covers = d.covers ?? [], area = covers.reduce((sum, c) => sum + c.area_cm2, 0);
  return area > 0 ? covers.reduce((sum, c) => sum + c.area_cm2 * c.coverage, 0) / area : d.coverage;
}

/** @returns {[string, string|number][]} */
function sumRows({count, data: d}) {
  return [["modules", count], ["controllers", d.patches.filter((p) => p.entry >= 0).length], ["islands", d.islands], ["jumpers", d.jumpers.length], ["area", `${Math.round(d.area_cm2)} cm²`],
          ["coverage", `${Math.round(100 * coverageOf(d))} %`]];
}

const entryText = (model, k) => model.isEntry(k) ? "cable (entry)" : model.modules[k].parent >= 0 ? `module ${model.nameOf(model.modules[k].parent)}` : "none";

/** One module: what a person at the skin needs, then its place and measures, folded away. @param {import("./model.js").Model} model @param {import("./live.js").LiveSkin} live */
export function fillModule(model, live, k) {
  const m = model.modules[k], list = document.createElement("dl");
  const rows = /** @type {[string, string|number][]} */ ([["module", model.nameOf(k)]]);
  if (live.heard[k]) rows.push(["chip", STATES[live.state[k]] || "?"], ["taxels pressed", pressedOf(model, live, k).map((t) => pressedText(model, live, k, t)).join(", ") || "none"]);
  const change = model.data.changes?.[k];
  if (change) rows.push([PALETTE[change.what].what, change.other < 0 ? "no module in the other design" : `module ${model.numberOf(change.other)} of the other design`]);
  rows.push(...wiringRows(model, k, m));
  fillList(list, rows);
  const more = document.createElement("details"), summary = document.createElement("summary"), measures = document.createElement("dl");
  summary.textContent = "place and measures";
  more.open = byId("module").querySelector("details")?.open ?? false;
  fillList(measures, measureRows(model, m));
  more.append(summary, measures);
  const findings = (model.findings.get(k) ?? []).map((f) => Object.assign(document.createElement("p"), {className: "finding", textContent: `${f.text}; ${f.remedy}`}));
  byId("module").replaceChildren(...findings, list, more);
}

// What is soldered, plugged and read.
function wiringRows(model, k, m) {
  const rows = /** @type {[string, string|number][]} */ ([]);
  const lost = (failure) => model.data.switched ? `${failure.cut.length}, of them for good ${failure.lost.length}` : failure.cut.length;
  if (m.kind) rows.push(["kind", m.kind]);
  if (m.patch >= 0) {
    rows.push(["controller", model.controllerName(m.patch)], ["line strap", `L${m.line}`], ["address strap", addressStrap(m.address)],
              ["port A leads to", entryText(model, k)], ["modules lost if it fails", lost(model.failureOf(k))]);
    if (m.parent >= 0) rows.push([`modules lost if its joint to ${model.numberOf(m.parent)} fails`, lost(model.failureOf(k, m.parent))]);
  }
  for (const j of model.data.jumpers) {
    if (j.modules.includes(k)) rows.push(["jumper", `${j.name}, ${j.length_mm} mm`]);
  }
  return rows;
}

// Where it lies, and each measure of its limit.
function measureRows(model, m) {
  const rows = /** @type {[string, string|number][]} */ ([["island, tile", `${model.islandName(m.island).replace(/^island /, "")}, ${m.tile[0]}/${m.tile[1]}/${m.tile[2] ? "up" : "down"}`]]);
  if (m.patch >= 0) rows.push(["port A at side", `${m.rotation} (turned ${120 * m.rotation}°)`], ["joints to the cable", m.depth]);
  model.data.metrics.forEach((metric, row) => rows.push([metric.name, `${+m.metrics[row].toFixed(2)}${metric.limit ? ` of ${+metric.limit.toFixed(2)}` : ""} ${metric.unit}`]));
  return rows;
}

/** Taxels that read above their rest values, which no touch does, and all others off rest in the same modules; "" if there are none. What was exchanged or
 * taken away since the last tare rests elsewhere. @param {import("./model.js").Model} model @param {import("./live.js").LiveSkin} live */
export function restRemark(model, live) {
  const modules = [];
  let taxels = 0;
  for (let k = 0; k < model.count; ++k) {
    const off = (/** @type {(change: number) => boolean} */ is) => {
      let n = 0;
      for (let t = 0; t < TAXELS; ++t) if (model.pressure[t] && (live.valid[k] >> t & 1) && is(live.change[TAXELS * k + t])) ++n;
      return n;
    };
    if (live.heard[k] !== 1 || live.state[k] >= FIRST_FAULT || off((c) => c >= PRESSED_COUNTS) === 0) continue;
    modules.push(k);
    taxels += off((c) => Math.abs(c) >= PRESSED_COUNTS);
  }
  if (taxels === 0) return "";
  const named = modules.slice(0, MAX_NAMED).map((k) => model.nameOf(k)).join(", ");
  return `${counted(taxels, "taxel")} ${taxels === 1 ? "does not rest: tare; its" : "do not rest: tare; their"} module${modules.length === 1 ? "" : "s"}: ${named}${modules.length > MAX_NAMED ? ` and ${modules.length - MAX_NAMED} more` : ""}`;
}

/** Taxels of a module that are under pressure. */
export function pressedOf(model, live, k) {
  const found = [];
  for (let t = 0; t < TAXELS; ++t)
    if (model.pressure[t] && (live.valid[k] >> t & 1) && live.pressureOf(TAXELS * k + t) >= PRESSED_COUNTS) found.push(t);
  return found;
}

/** "3: 12.4 kPa", and the taxel alone without a calibration. */
function pressedText(model, live, k, t) {
  const n = TAXELS * k + t;
  return model.isCalibrated ? `${t}: ${model.pressureText(model.pressureIn(n, live.pressureOf(n)))}` : `${t}`;
}

/** A row that chooses a module. @param {string} text @param {() => void} act */
function rowOf(text, act) {
  const item = document.createElement("li"), button = document.createElement("button");
  button.type = "button";
  button.textContent = text;
  button.onclick = act;
  item.append(button);
  return item;
}

/** @param {import("./model.js").Model} model @param {import("./contacts.js").Contact[]} contacts @param {(module: number) => void} choose */
export function fillContacts(model, contacts, choose) {
  const rows = contacts.slice(0, 8).map((c) => rowOf(
    `module ${model.nameOf(c.module)}: ${counted(c.taxels.length, "taxel")}, ${c.force === null ? `${Math.round(c.sum)} counts` : `${c.force.toFixed(2)}${c.forceSd === null ? "" : ` ± ${c.forceSd.toFixed(2)}`} N`} at ${c.centre.map((v) => v.toFixed(1)).join(", ")} mm`, () => choose(c.module)));
  if (rows.length === 0) { rows.push(document.createElement("li")); rows[0].textContent = "none"; }
  byId("contacts").replaceChildren(...rows);
}

/** @param {import("./model.js").Model} model @param {import("./live.js").LiveSkin} live @param {(module: number) => void} choose */
export function fillFaults(model, live, choose) {
  const most = 200, rows = [];
  for (let k = 0; k < live.state.length && rows.length < most; ++k) {
    const text = !live.heard[k] ? "never heard" : live.state[k] >= FIRST_FAULT ? STATES[live.state[k]] || "?" : "";
    if (!text) continue;
    rows.push(rowOf(`module ${model.nameOf(k)}: ${text}`, () => choose(k)));
  }
  if (rows.length === 0) { rows.push(document.createElement("li")); rows[0].textContent = "none"; }
  byId("faults").replaceChildren(...rows);
  return rows.length;
}

/** What verify found, each at its module. @param {import("./model.js").Model} model @param {(module: number) => void} choose */
export function fillFindings(model, choose) {
  const findings = model.data.findings ?? [];
  byId("finding-part").hidden = findings.length === 0;
  byId("findings").replaceChildren(...findings.map((f) => {
    const at = [...model.findings].find(([, list]) => list.includes(f))?.[0] ?? -1;
    const row = rowOf(at < 0 ? f.text : `module ${model.nameOf(at)}: ${f.text}`, () => { if (at >= 0) choose(at); });
    row.title = f.remedy;
    return row;
  }));
}

/** Buttons: one act each. @param {string} id @param {[string, () => void, boolean?][]} acts text, what it does, whether it is pressed */
export function fillButtons(id, acts) {
  byId(id).replaceChildren(...acts.map(([text, act, pressed]) => {
    const button = document.createElement("button");
    Object.assign(button, {type: "button", textContent: text, onclick: act});
    if (pressed !== undefined) button.setAttribute("aria-pressed", String(pressed));
    return button;
  }));
}

/** On a low screen one part of the column is open at a time beside the legend, so that nothing lies below the fold. */
export function foldParts() {
  const parts = /** @type {HTMLDetailsElement[]} */ ([...document.querySelectorAll("aside details[id]")]), isLow = () => innerHeight < 720 && innerWidth > 700;
  for (const part of parts)
    part.ontoggle = () => { if (part.open && isLow()) for (const other of parts) if (other !== part) other.open = false; };
  if (isLow()) parts.forEach((part) => { part.open = false; });
}
/** @param {string} id */
export const openPart = (id) => { byId(id).open = true; };
