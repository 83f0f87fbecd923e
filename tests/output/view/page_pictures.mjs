// SPDX-License-Identifier: GPL-3.0-or-later
// Compares what the page draws with pictures that somebody has looked at (tests/output/view/pictures, an eighth of the size, so that fonts and
// the smoothing of edges matter little). UPDATE_PICTURES=1 writes them anew; look at them before they are committed.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import {fileURLToPath, pathToFileURL} from "node:url";

import {drawn} from "./page_look.mjs";

const HERE = path.dirname(fileURLToPath(import.meta.url)), EXAMPLES = path.join(HERE, "../../../docs/examples/scenes");
const SCALE = 8;
// Of 255. A pixel stands for 64 of the window, of which the smoothing of edges changes few.
const DIFFERENT = 48;
const MAX_SHARE = 0.01;

const failureOf9 = () => { window.triskin.setMode(window.triskin.modes.findIndex((m) => m.name === "loss when it fails")); window.triskin.select(9, false); };
const pressure = () => window.triskin.setMode(window.triskin.modes.findIndex((m) => m.name === "pressure"));
/** @type {{name: string, design: string, size: [number, number], dark?: boolean, set?: () => void, switched?: boolean, scene?: string, at_ms?: number}[]} */
const SITUATIONS = [
  {name: "box", design: path.join(HERE, "designs/box.json"), size: [1400, 900]},
  {name: "box_dark", design: path.join(HERE, "designs/box.json"), size: [1400, 900], dark: true},
  {name: "box_phone", design: path.join(HERE, "designs/box.json"), size: [390, 844]},
  {name: "tube", design: path.join(HERE, "designs/tube.json"), size: [900, 600], switched: true},
  {name: "tube_failure", design: path.join(HERE, "designs/tube.json"), size: [900, 600], set: failureOf9, switched: true},
  {name: "torso", design: path.join(EXAMPLES, "torso.json"), size: [1400, 900]},
  {name: "torso_at_rest", design: path.join(EXAMPLES, "torso.json"), size: [900, 600], set: pressure},
  {name: "forearm_recording", design: path.join(EXAMPLES, "forearm.json"), size: [1400, 900], scene: path.join(EXAMPLES, "grasp_forearm.json"), at_ms: 2500},
];

/** The two drawings at an eighth of their size, as a PNG in base64. */
async function shrunk(page) {
  const box = await page.evaluate(() => { const {x, y, width, height} = document.getElementById("stage").getBoundingClientRect(); return {x, y, width, height}; });
  const picture = (await page.screenshot({clip: box})).toString("base64");
  return page.evaluate(async ([text, scale]) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], {type: "image/png"}));
    const canvas = document.createElement("canvas"), paint = canvas.getContext("2d");
    Object.assign(canvas, {width: Math.floor(image.width / scale), height: Math.floor(image.height / scale)});
    Object.assign(paint, {imageSmoothingEnabled: true, imageSmoothingQuality: "high"});
    paint.drawImage(image, 0, 0, canvas.width, canvas.height);
    return canvas.toDataURL("image/png").split(",")[1];
  }, [picture, SCALE]);
}

/** The share of pixels in which two pictures differ; 1 when their sizes do. @returns {Promise<number>} */
const shareOfDifferent = (page, a, b) => page.evaluate(async ([texts, limit]) => {
  const [one, two] = await Promise.all(texts.map(async (text) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], {type: "image/png"}));
    const canvas = document.createElement("canvas"), paint = canvas.getContext("2d");
    Object.assign(canvas, {width: image.width, height: image.height});
    paint.drawImage(image, 0, 0);
    return paint.getImageData(0, 0, image.width, image.height);
  }));
  if (one.width !== two.width || one.height !== two.height) return 1;
  let different = 0;
  for (let at = 0; at < one.data.length; at += 4)
    if ([0, 1, 2].some((c) => Math.abs(one.data[at + c] - two.data[at + c]) > limit)) ++different;
  return different / (one.data.length / 4);
}, [[a, b], DIFFERENT]);

/** Writes the page of a situation into a file. @param {(...words: string[]) => void} triskin runs the program */
function writePage(situation, folder, triskin) {
  const file = path.join(folder, `${situation.name}.html`);
  let from = situation.design;
  if (situation.scene) {
    from = path.join(folder, `${situation.name}.mcap`);
    triskin("flash", situation.design, "--link", "sim");
    triskin("record", situation.design, "--link", "sim", "--scene", situation.scene, "-o", from, "--seconds", "3");
  }
  triskin("export", from, "--format", "html", "-o", file, ...(situation.switched ? ["--switched"] : []));
  return file;
}

/** @param {any} browser @param {string} folder for files @param {(...words: string[]) => void} triskin runs the program */
export async function comparePictures(browser, folder, triskin) {
  const wrong = [];
  for (const situation of SITUATIONS) {
    const [width, height] = situation.size;
    const page = await browser.newPage({viewport: {width, height}, colorScheme: situation.dark ? "dark" : "light"});
    await page.goto(pathToFileURL(writePage(situation, folder, triskin)).href);
    await page.waitForFunction(() => document.documentElement.dataset.ready === "yes", null, {timeout: 60000});
    if (situation.set) await page.evaluate(situation.set);
    if (situation.at_ms) {
      await page.evaluate((ms) => {
        const scrubber = /** @type {HTMLInputElement} */ (document.getElementById("scrubber"));
        scrubber.value = String(ms);
        scrubber.dispatchEvent(new Event("input"));
      }, situation.at_ms);
    }
    await drawn(page);
    const seen = await shrunk(page), reference = path.join(HERE, "pictures", `${situation.name}.png`);
    if (process.env.UPDATE_PICTURES) fs.writeFileSync(reference, Buffer.from(seen, "base64"));
    const share = await shareOfDifferent(page, seen, fs.readFileSync(reference).toString("base64"));
    console.log(`${situation.name}: ${(100 * share).toFixed(2)} % of the pixels differ`);
    if (share > MAX_SHARE) {
      const kept = path.join(process.cwd(), `page_${situation.name}.png`);
      await page.screenshot({path: kept});
      wrong.push(`${situation.name}: ${(100 * share).toFixed(1)} % of the pixels differ from ${reference}; see ${kept}`);
    }
    await page.close();
  }
  assert.deepEqual(wrong, []);
}
