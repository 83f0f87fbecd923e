// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the look of the page by its pixels: the legend against the picture, and the controls in reach at each window size.
import assert from "node:assert/strict";

/** Ends when the page has drawn what was set before: the frame that may be under way, and one after it. */
export const drawn = (page) => page.evaluate(() => new Promise((done) => {
  requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(() => done())));
}));

/** Colours of a screenshot at places of the window. Legend and drawing are read from the same picture. @returns {Promise<number[][]>} */
async function pixelsAt(page, places) {
  const picture = (await page.screenshot()).toString("base64");
  return page.evaluate(async ([text, points]) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], {type: "image/png"})), canvas = document.createElement("canvas");
    Object.assign(canvas, {width: image.width, height: image.height});
    const paint = canvas.getContext("2d");
    paint.drawImage(image, 0, 0);
    return points.map(([x, y]) => Array.from(paint.getImageData(Math.round(x), Math.round(y), 1, 1).data.slice(0, 3)));
  }, [picture, places]);
}
const alike = (a, b, tolerance = 10) => a.every((v, c) => Math.abs(v - b[c]) <= tolerance);

/** Each entry of the legend of a mode and a module to which it applies. @param {any} page @param {number} mode @returns {Promise<number>} entries */
async function compareMode(page, mode) {
  const pairs = await page.evaluate((m) => {
    const triskin = window.triskin, {model} = triskin;
    triskin.setMode(m);
    const spots = [...document.querySelectorAll("#legend .swatch i, #legend .chip i")];
    const found = [];
    for (const swatch of triskin.modes[m].swatches) {
      const k = swatch.of ? model.modules.findIndex((_, n) => swatch.of(n)) : -1;
      if (k < 0) continue;
      const spot = spots.find((s) => s.nextSibling.textContent === swatch.what).getBoundingClientRect();
      found.push({what: `${triskin.modes[m].name}: ${swatch.what}`, spot: [spot.left + spot.width / 2, spot.top + spot.height / 2], at: triskin.placeOf("flat", k, -1)});
    }
    return found;
  }, mode);
  await drawn(page);
  const colors = await pixelsAt(page, pairs.flatMap((p) => [p.spot, p.at]));
  pairs.forEach((p, n) => assert(alike(colors[2 * n], colors[2 * n + 1]), `${p.what}: legend ${colors[2 * n]}, picture ${colors[2 * n + 1]}`));
  return pairs.length;
}

/** For every mode: each entry of the legend. */
async function compareModules(page) {
  const modes = await page.evaluate(() => window.triskin.modes.length);
  let compared = 0;
  for (let mode = 0; mode < modes; ++mode) compared += await compareMode(page, mode);
  return compared;
}

/** The mode that is shown, without marks on the modules. @param {any} page @returns {Promise<number>} entries that were compared */
export async function checkModeColors(page) {
  await page.evaluate(() => Object.assign(window.triskin.shown, {numbers: false, taxels: false, trees: false, seams: false}));
  return compareMode(page, await page.evaluate(() => window.triskin.mode));
}

async function compareBar(page) {
  const pairs = await page.evaluate(() => {
    const triskin = window.triskin, {model} = triskin, row = 0, {limit} = model.data.metrics[row];
    [0.1, 0.3, 0.5, 0.7, 0.9].forEach((x, k) => { model.modules[20 + k].metrics[row] = x * limit; });
    triskin.setMode(triskin.modes.findIndex((m) => m.name === model.data.metrics[row].name));
    const bar = document.querySelector("#legend .bar").getBoundingClientRect();
    return [0.1, 0.3, 0.5, 0.7, 0.9].map((x, k) => ({spot: [bar.left + 1 + x * (bar.width - 2), bar.top + bar.height / 2], at: triskin.placeOf("flat", 20 + k, -1)}));
  });
  await drawn(page);
  const colors = await pixelsAt(page, pairs.flatMap((p) => [p.spot, p.at]));
  pairs.forEach((_, n) => assert(alike(colors[2 * n], colors[2 * n + 1], 14), `bar: legend ${colors[2 * n]}, picture ${colors[2 * n + 1]}`));
}

/** Sends the page a frame as the server does: module 5 is pressed on taxel 3 with full strength, the chip of module 9 saturates. */
const sendFrame = (page) => page.evaluate(() => {
  const triskin = window.triskin, n = triskin.model.count, frame = new DataView(new ArrayBuffer(16 + 32 * n));
  frame.setUint8(0, 1); frame.setUint8(1, 1); frame.setUint16(2, n, true); frame.setFloat64(8, 1e12, true);
  for (let k = 0; k < n; ++k) {
    const at = 16 + 32 * k;
    frame.setUint16(at, k, true); frame.setUint16(at + 2, 0xFFF, true); frame.setUint8(at + 4, k === 9 ? 5 : 1);
    if (k === 5) frame.setInt16(at + 8 + 6, -6000, true);
  }
  triskin.takeFrame(frame.buffer);
});

async function compareMarks(page, bringNear) {
  await page.evaluate(() => { window.triskin.setMode(1); for (const part of ["taxels", "trees", "seams"]) window.triskin.shown[part] = true; window.triskin.showLegend(); });
  await sendFrame(page);
  const spotOf = (what) => page.evaluate((text) => {
    const spot = [...document.querySelectorAll("#legend .swatch i")].find((s) => s.nextSibling.textContent.startsWith(text)).getBoundingClientRect();
    return [spot.left + spot.width / 2, spot.top + spot.height / 2];
  }, what);
  const cases = [["taxel at rest", 4, "taxel", 3], ["temperature pad", 4, "taxel", 6], ["line to parent", 0, "side", 0.3], ["chip fault", 9, "side", 0.55], ["between controllers", 15, "seam", 0.95]];
  for (const [what, module, kind, place] of cases) {
    await bringNear(page, module);
    const at = await page.evaluate(([m, k, p]) => {
      const triskin = window.triskin, {model} = triskin, view = triskin.views[1], centre = triskin.placeOf("flat", m, -1);
      if (k === "taxel") return triskin.placeOf("flat", m, p);
      // Part of the way from the centre to the middle of a side: one toward another controller, or one without a joint.
      const side = k === "seam" ? model.modules[m].neighbours.findIndex((n) => n >= 0 && model.modules[n].patch !== model.modules[m].patch) : model.modules[m].neighbours.indexOf(-1);
      const [from, to] = model.sideEnds(model.flat, m, side), middle = view.camera.project(from.map((v, c) => (v + to[c]) / 2)), stage = document.getElementById("stage").getBoundingClientRect();
      return [stage.left + view.left + middle[0], stage.top + view.top + middle[1]].map((v, c) => centre[c] + p * (v - centre[c]));
    }, [module, kind, place]);
    await drawn(page);
    const [legend, picture] = await pixelsAt(page, [await spotOf(what), at]);
    assert(alike(legend, picture), `${what}: legend ${legend}, picture ${picture}`);
  }
  await bringNear(page, 5);
  const bar = await page.evaluate(() => { const box = document.querySelector("#legend .bar").getBoundingClientRect(); return [box.right - 2, box.top + box.height / 2]; });
  await drawn(page);
  const [strongest, pressed] = await pixelsAt(page, [bar, await page.evaluate(() => window.triskin.placeOf("flat", 5, 3))]);
  assert(alike(strongest, pressed, 14), `the strongest touch: legend ${strongest}, picture ${pressed}`);
}

/** The legend says what the picture shows. @param {any} page of a strip without a link @param {(page: any, module: number) => Promise<void>} bringNear */
export async function checkLegend(page, bringNear) {
  await page.evaluate(() => {
    const {model, shown} = window.triskin;
    Object.assign(shown, {numbers: false, taxels: false, trees: false, seams: false});
    model.modules[30].metrics[0] = 2 * model.data.metrics[0].limit;
  });
  const compared = await compareModules(page);
  assert(compared > 10, `${compared} entries were compared`);
  await compareBar(page);
  await compareMarks(page, bringNear);
}

/** Nothing that is needed lies below the fold. @param {any} page */
export async function checkSizes(page) {
  for (const [width, height, stacked] of [[1400, 900, false], [900, 600, false], [390, 844, true]]) {
    await page.setViewportSize({width, height});
    await drawn(page);
    assert.equal(await page.evaluate(() => document.getElementById("stage").classList.contains("stacked")), stacked, `${width} × ${height}`);
    const panes = await page.evaluate(() => ["pane-cover", "pane-flat"].map((id) => document.getElementById(id).getBoundingClientRect()).map((r) => [r.left, r.top, r.right, r.bottom]));
    for (const [left, top, right, bottom] of panes) assert(left >= 0 && top >= 0 && right <= width && bottom <= height && right - left > 200 && bottom - top > 200, `${panes}`);
    assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "nothing lies beside the window");
    if (stacked) continue;
    await page.evaluate(() => window.triskin.select(7, false));
    for (const id of ["legend", "filters", "mode", "find", "tools"]) {
      const bottom = await page.evaluate((name) => document.getElementById(name).getBoundingClientRect().bottom, id);
      assert(bottom > 0 && bottom <= height, `${id} ends at ${bottom} of ${height}`);
    }
  }
}

/** Hiding, views along an axis, measuring. @param {any} page @param {(view: string, module: number) => Promise<number>} click chooses what is there */
export async function checkTools(page, click) {
  await page.evaluate(() => { for (const {camera} of window.triskin.views) camera.reset(); window.triskin.select(20, false); });
  await page.click("#filters button:nth-child(1)");
  assert.equal(await page.evaluate(() => window.triskin.model.shown.reduce((n, v) => n + v, 0)), 16, "only the 16 modules of the controller are shown");
  assert.equal(await click("flat", 3), -1, "a hidden module cannot be chosen");
  await page.click("#show-all");
  assert.equal(await click("flat", 3), 3);
  await page.click("#sides button:nth-child(6)");
  assert.equal(await page.evaluate(() => window.triskin.views[0].camera.orthographic), true);
  await page.click("#measure");
  const places = await page.evaluate(() => [2, 12].map((k) => window.triskin.placeOf("flat", k, -1)));
  for (const [x, y] of places) await page.mouse.click(x, y);
  const measured = await page.evaluate(() => {
    const [a, b] = window.triskin.measured.points, centre = (k) => { const p = window.triskin.model.flat.corners.subarray(9 * k, 9 * k + 9); return [0, 1, 2].map((x) => (p[x] + p[3 + x] + p[6 + x]) / 3); };
    return {mm: Math.hypot(...a.map((v, x) => v - b[x])), expected: Math.hypot(...centre(2).map((v, x) => v - centre(12)[x]))};
  });
  assert(Math.abs(measured.mm - measured.expected) < 2, `${measured.mm} mm, expected ${measured.expected}`);
  await page.click("#measure");
  await page.click("#sides button:nth-child(1)");
}
