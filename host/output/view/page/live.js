// SPDX-License-Identifier: GPL-3.0-or-later
// @ts-check
// The live skin: binary frames from the server into typed arrays (docs/view.md has the layout).
import {TAXELS} from "./model.js";

/** Bytes before the records of a frame, and before the text of contacts. */
export const HEADER = 16;
const RECORD = 32;
export const STATES = ["unknown", "in order", "absent", "wrong id", "lost its configuration", "saturated", "frozen", "line stuck", "two chips at its address"];
export const FIRST_FAULT = 2;

export class LiveSkin {
  /** @param {number} count modules */
  constructor(count) {
    this.change = new Int16Array(TAXELS * count);
    this.valid = new Uint16Array(count);
    this.state = new Uint8Array(count);
    this.heard = new Uint8Array(count);
    this.newest_ms = 0; // of the newest sample, ms since 1970
    this.frames = 0;
  }

  /** By how many counts a taxel reads below its rest value; above it there is no pressure. @param {number} n 12 · module + taxel */
  pressureOf(n) { return Math.max(0, -this.change[n]); }

  /** Takes one frame. @param {ArrayBuffer} bytes @returns {number[]} modules that changed; none for a frame of another version */
  take(bytes) {
    const view = new DataView(bytes), changed = [];
    if (bytes.byteLength < HEADER || view.getUint8(0) !== 1 || view.getUint8(1) !== 1) return changed;
    const count = view.getUint16(2, true);
    if (bytes.byteLength !== HEADER + count * RECORD) return changed;
    this.newest_ms = view.getFloat64(8, true);
    for (let at = HEADER; at < bytes.byteLength; at += RECORD) {
      const module = view.getUint16(at, true);
      if (module >= this.valid.length) continue;
      this.valid[module] = view.getUint16(at + 2, true);
      this.state[module] = view.getUint8(at + 4);
      this.heard[module] = 1;
      for (let t = 0; t < TAXELS; ++t) this.change[TAXELS * module + t] = view.getInt16(at + 8 + 2 * t, true);
      changed.push(module);
    }
    ++this.frames;
    return changed;
  }
}

/** Keeps a connection to the server and opens it again when it breaks. */
export class LiveLink {
  /** @param {(frame: ArrayBuffer) => void} onFrame @param {(health: any) => void} onHealth
   * @param {(contacts: any[]) => void} onContacts none while the server is away */
  constructor(onFrame, onHealth, onContacts) {
    this.onFrame = onFrame;
    this.onContacts = onContacts;
    this.onHealth = onHealth;
    this.socket = this.open();
  }
  /** @returns {WebSocket} */
  open() {
    const address = new URL("live", location.href);
    address.protocol = "ws:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({data}) => typeof data === "string" ? this.takeText(JSON.parse(data)) : this.onFrame(data);
    socket.onclose = () => {
      this.onContacts([]);
      this.onHealth({link: "", live: false, trouble: "no connection to triskin view, tried again each second; start it again if it has ended", frames: 0, lost: 0});
      setTimeout(() => { this.socket = this.open(); }, 1000);
    };
    return socket;
  }
  takeText(message) {
    if (message.contacts) this.onContacts(message.contacts);
    else this.onHealth(message);
  }
  /** @param {object} command */
  send(command) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(command));
  }
}
