// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// The last ten seconds of chosen taxels as curves. Times are those of the samples, so that a recording plots as it went.
import {css, CURVES, PRESSED_COUNTS, PRESSED_KPA} from "./colors.js";
import {TAXELS} from "./model.js";
import {byId} from "./panel.js";

const SPAN_MS = 10000;

export class History {
  /** Chosen taxels. @type {{module: number, taxel: number, color: number[], samples: {at: number, value: number}[]}[]} */
  traces = [];

  has(module, taxel) { return this.traces.some((t) => t.module === module && t.taxel === taxel); }
  /** Adds a taxel or takes it away; the oldest goes where there is no further colour. @param {number} module @param {number} taxel */
  toggle(module, taxel) {
    if (this.has(module, taxel)) { this.traces = this.traces.filter((t) => t.module !== module || t.taxel !== taxel); return; }
    if (this.traces.length === CURVES.length) this.traces.shift();
    const color = CURVES.find((c) => !this.traces.some((t) => t.color === c)) || CURVES[0];
    this.traces.push({module, taxel, color, samples: []});
  }

  /** Keeps what the skin shows now. @param {import("./live.js").LiveSkin} live @param {number[]} changed modules @param {import("./model.js").Model} model */
  remember(live, changed, model) {
    for (const trace of this.traces) {
      if (!changed.includes(trace.module)) continue;
      const at = live.newest_ms, {samples} = trace;
      if (samples.length && at < samples[samples.length - 1].at) samples.length = 0; // a recording was sent back
      samples.push({at, value: model.pressureIn(TAXELS * trace.module + trace.taxel, live.pressureOf(TAXELS * trace.module + trace.taxel))});
      while (samples[0].at < at - SPAN_MS) samples.shift();
    }
  }

  /** @param {number} now ms, time of the newest sample @param {import("./model.js").Model} model */
  draw(now, model) {
    const canvas = byId("history"), paint = canvas.getContext("2d"), {width, height} = canvas;
    canvas.hidden = this.traces.length === 0;
    paint.clearRect(0, 0, width, height);
    paint.font = "22px system-ui, sans-serif";
    const max = Math.max(model.isCalibrated ? PRESSED_KPA : PRESSED_COUNTS, ...this.traces.flatMap((t) => t.samples.map((s) => s.value)));
    this.traces.forEach((trace, n) => {
      paint.strokeStyle = paint.fillStyle = css(trace.color);
      paint.lineWidth = 4;
      paint.beginPath();
      for (const s of trace.samples) paint.lineTo(width * (1 - (now - s.at) / SPAN_MS), height - 4 - (height - 60) * s.value / max);
      paint.stroke();
      paint.fillText(`${model.numberOf(trace.module)}.${trace.taxel}`, 4 + n * 92, 50);
    });
    paint.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--soft");
    paint.fillText(`module.taxel, 10 s, up to ${model.pressureText(max)}`, 4, 24);
  }
}
