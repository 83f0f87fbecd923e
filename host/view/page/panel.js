// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// The column beside the drawing: text only, set as text, so that no name from a file is taken for markup.
import {PRESSED_COUNTS} from "./colors.js";
import {FIRST_FAULT, STATES} from "./live.js";
import {TAXELS} from "./model.js";

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

/** Legend of a mode: its markup is of this program; colours are set here because the page allows no inline style. */
export function fillLegend(html) {
  byId("legend").innerHTML = html;
  byId("legend").querySelectorAll("[data-color]").forEach((e) => { e.style.background = e.dataset.color; });
  byId("legend").querySelectorAll("[data-scale]").forEach((e) => { e.style.background = `linear-gradient(to right, ${e.dataset.scale})`; });
}

/** @param {import("./model.js").Model} model */
export function fillDesign(model) {
  const d = model.data;
  byId("name").textContent = d.name;
  document.title = `${d.name} – triskin view`;
  fillList(byId("design"), [["modules", model.count], ["controllers", d.patches.length], ["islands", d.islands], ["jumpers", d.jumpers.length], ["area", `${d.area_cm2} cm²`],
                            ["coverage", `${Math.round(100 * d.coverage)} %`], ["design", d.design_id]]);
}

const entryText = (model, k) => model.isEntry(k) ? "cable (entry)" : model.modules[k].parent >= 0 ? `module ${model.modules[k].parent}` : "none";

/** Everything on one module. @param {import("./model.js").Model} model @param {import("./live.js").LiveSkin} live */
export function fillModule(model, live, k) {
  const m = model.modules[k], failure = model.failureOf(k), joint = model.failureOf(k, m.parent), list = document.createElement("dl");
  const rows = /** @type {[string, string|number][]} */ ([["module", k], ["island, tile", `${m.island}: ${m.tile[0]}, ${m.tile[1]} ${m.tile[2] ? "up" : "down"}`]]);
  if (m.kind) rows.push(["kind", m.kind]);
  if (m.patch >= 0) {
    rows.push(["controller", `${m.patch} (node ${m.patch + 1})`], ["line strap", m.line], ["address strap", `${m.address} (0x${(0x2c + m.address).toString(16).toUpperCase()})`],
              ["port A at side", `${m.rotation} (turned ${120 * m.rotation}°)`], ["parent", entryText(model, k)], ["depth", m.depth],
              ["lost when it fails", `${failure.cut.length}, switched ${failure.lost.length}`]);
    if (m.parent >= 0) rows.push([`lost with its joint to ${m.parent}`, `${joint.cut.length}, switched ${joint.lost.length}`]);
  }
  for (const j of model.data.jumpers) {
    if (j.modules.includes(k)) rows.push(["jumper", `to module ${j.modules[0] === k ? j.modules[1] : j.modules[0]}, ${j.length_mm} mm`]);
  }
  model.data.metrics.forEach((metric, row) => rows.push([metric.name, `${m.metrics[row]} ${metric.unit}` + (metric.limit ? ` of ${metric.limit}` : "")]));
  if (live.heard[k]) rows.push(["chip", STATES[live.state[k]] || "?"], ["taxels pressed", pressedOf(model, live, k).join(" ") || "none"]);
  fillList(list, rows);
  byId("module").replaceChildren(list);
}

/** Taxels of a module that are under pressure. */
export function pressedOf(model, live, k) {
  const found = [];
  for (let t = 0; t < TAXELS; ++t)
    if (model.pressure[t] && (live.valid[k] >> t & 1) && Math.abs(live.change[TAXELS * k + t]) >= PRESSED_COUNTS) found.push(t);
  return found;
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

/** @param {import("./contacts.js").Contact[]} contacts @param {(module: number) => void} choose */
export function fillContacts(contacts, choose) {
  const rows = contacts.slice(0, 8).map((c) => rowOf(
    `module ${c.module}: ${c.taxels.length} taxels, ${c.force === null ? `${Math.round(c.sum)} counts` : `${c.force.toFixed(2)} N`} at ${c.centre.map((v) => v.toFixed(1)).join(", ")} mm`, () => choose(c.module)));
  if (rows.length === 0) { rows.push(document.createElement("li")); rows[0].textContent = "none"; }
  byId("contacts").replaceChildren(...rows);
}

/** @param {import("./live.js").LiveSkin} live @param {(module: number) => void} choose */
export function fillFaults(live, choose) {
  const most = 200, rows = [];
  for (let k = 0; k < live.state.length && rows.length < most; ++k) {
    const text = !live.heard[k] ? "never heard" : live.state[k] >= FIRST_FAULT ? STATES[live.state[k]] || "?" : "";
    if (!text) continue;
    rows.push(rowOf(`module ${k}: ${text}`, () => choose(k)));
  }
  if (rows.length === 0) { rows.push(document.createElement("li")); rows[0].textContent = "none"; }
  byId("faults").replaceChildren(...rows);
  return rows.length;
}

/** Curve of the largest change of the chosen module. @param {{at: number, value: number}[]} samples */
export function drawHistory(samples, now) {
  const canvas = byId("history"), paint = canvas.getContext("2d"), span = 10000;
  paint.clearRect(0, 0, canvas.width, canvas.height);
  paint.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue("--pick");
  const most = Math.max(PRESSED_COUNTS, ...samples.map((s) => s.value));
  paint.beginPath();
  for (const s of samples) paint.lineTo(canvas.width * (1 - (now - s.at) / span), canvas.height - 3 - (canvas.height - 16) * s.value / most);
  paint.stroke();
  paint.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--soft");
  paint.fillText(`${Math.round(most)} counts`, 4, 10);
}
