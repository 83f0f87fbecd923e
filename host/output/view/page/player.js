// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// Plays a recording: the frames of the live skin one after another, with a scrubber (docs/view.md has the track).
import {HEADER} from "./live.js";
import {byId} from "./panel.js";

const TIME_AT = 8; // of the newest sample in the header of a frame, ms

/** Where each frame of a track begins, and its time. A frame that is not whole ends the track. @param {ArrayBuffer} track */
export function framesOf(track) {
  const view = new DataView(track), frames = /** @type {{at: number, size: number, ms: number}[]} */ ([]);
  for (let at = 0; at + 4 <= track.byteLength;) {
    const size = view.getUint32(at, true);
    if (size < HEADER || at + 4 + size > track.byteLength) break;
    frames.push({at: at + 4, size, ms: view.getFloat64(at + 4 + TIME_AT, true)});
    at += 4 + size;
  }
  return frames;
}

export class Player {
  /** @param {ArrayBuffer} track @param {(frame: ArrayBuffer) => void} onFrame @param {() => void} onRestart before the frames are taken from the first on */
  constructor(track, onFrame, onRestart) {
    this.track = track;
    this.frames = framesOf(track);
    this.onFrame = onFrame;
    this.onRestart = onRestart;
    this.next = 0;      // index of the next frame
    this.ms = 0;        // time that is shown
    this.length_ms = this.frames.length ? this.frames[this.frames.length - 1].ms : 0;
    this.playing = false;
    this.last = 0;
    byId("scrubber").max = String(Math.ceil(this.length_ms));
    byId("scrubber").oninput = () => { this.playing = false; this.seek(Number(byId("scrubber").value)); };
    byId("play").onclick = () => this.toggle();
    this.seek(0);
  }

  toggle() {
    if (!this.playing && this.ms >= this.length_ms) this.seek(0);
    this.playing = !this.playing;
    this.last = 0;
    this.show();
  }

  /** Shows the skin as it was at a time: the frames up to then, since each holds only what changed. @param {number} ms */
  seek(ms) {
    if (ms < this.ms || this.next === 0) { this.next = 0; this.onRestart(); }
    this.ms = Math.min(Math.max(ms, 0), this.length_ms);
    while (this.next < this.frames.length && this.frames[this.next].ms <= this.ms) {
      const {at, size} = this.frames[this.next++];
      this.onFrame(this.track.slice(at, at + size));
    }
    this.show();
  }

  /** One step of the display. @param {number} now ms of the display's clock */
  step(now) {
    if (!this.playing) return;
    if (this.last) this.seek(this.ms + (now - this.last) * Number(byId("speed").value));
    this.last = now;
    if (this.ms >= this.length_ms) this.playing = false;
    this.show();
  }

  show() {
    byId("scrubber").value = String(this.ms);
    byId("time").textContent = `${(this.ms / 1000).toFixed(2)} of ${(this.length_ms / 1000).toFixed(2)} s`;
    byId("play").textContent = this.playing ? "pause" : "play";
  }
}
