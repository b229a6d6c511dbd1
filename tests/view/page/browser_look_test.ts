// What is seen in a real browser: picture, layers, picking, plan and scale.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { noChromium as skip, near, quietly, viewerForTests } from "./browser";
import { difference, isColoured, readPng, share } from "./png";
import { hall } from "./scenes";

const viewer = viewerForTests();

test("opens, is not blank, and complains of nothing", { skip }, async () => {
  for (const scheme of ["dark", "light"] as const) {
    const opened = await viewer.open(viewer.write(hall()), { scheme });
    const picture = await opened.picture();
    const coloured = share(picture, isColoured);
    assert.ok(coloured > 0.01 && coloured < 0.6, `${coloured} of the picture is coloured`);
    assert.equal(await opened.page.title(), "hall");
    assert.match(await opened.page.locator("#summary").innerText(), /1 map, 40 keyframes, 4,000 points/);
    await quietly(opened);
  }
});

test("layers and colours change the picture", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall()));
  let last = await opened.picture();
  for (const layer of ["trajectory", "frusta", "covisibility", "tree", "loops", "grid", "points"]) {
    await opened.page.locator(`input[data-layer=${layer}]`).click();
    const now = await opened.picture();
    assert.ok(difference(last, now) > (layer === "loops" ? 0.00002 : 0.0004), `${layer}: ${difference(last, now)}`);
    last = now;
  }
  await opened.page.locator("input[data-layer=points]").click();
  last = await opened.picture();
  for (const colour of ["map", "observers", "error", "age", "origin", "plain"]) {
    await opened.page.selectOption("#colour", colour);
    const now = await opened.picture();
    if (colour !== "origin") assert.ok(difference(last, now) > 0.004, `${colour}: ${difference(last, now)}`);
    last = now;
  }
  await quietly(opened);
});

test("a click picks what is there", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall({ points: 60, keyframes: 8 })));
  await opened.page.locator("input[data-layer=frusta]").click();
  let picked = 0;
  for (let row = 0; row < 60; row += 4) {
    const { x, y } = await opened.place("point", row);
    const covered = await opened.page.evaluate(([x, y]) => document.elementFromPoint(x, y)?.id !== "view", [x, y]);
    if (covered) continue;
    // Others may lie in front of it: what is picked is as near to the pixel, or the very point.
    await opened.page.mouse.click(x, y);
    const selection = await opened.selection();
    assert.ok(selection, `nothing at point ${row}`);
    const other = await opened.place(selection.kind as "point", selection.row);
    assert.ok(Math.hypot(other.x - x, other.y - y) < 4, `${JSON.stringify(selection)} instead of point ${row}`);
    if (selection.kind === "point" && selection.row === row) ++picked;
    await opened.page.keyboard.press("Escape");
  }
  assert.ok(picked >= 8, `${picked} points were picked`);
  const keyframe = await opened.place("keyframe", 3);
  await opened.page.mouse.click(keyframe.x, keyframe.y);
  assert.deepEqual(await opened.selection(), { kind: "keyframe", row: 3 });
  assert.equal(await opened.page.locator("#inspector h2").first().innerText(), "Keyframe 9");
  await quietly(opened);
});

test("plan, scale and tape agree with the map", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall({ points: 40, keyframes: 8 })), { reducedMotion: true });
  await opened.page.keyboard.press("p");
  await opened.rest();
  assert.equal((await opened.pose()).plan, true);
  assert.equal(await opened.page.getByRole("button", { name: "Plan view" }).getAttribute("aria-pressed"), "true");
  const label = await opened.page.locator("#scale span").innerText();
  const bar = (await opened.page.locator("#scale .bar").boundingBox())!.width;
  const [a, b] = [await opened.place("keyframe", 0), await opened.place("keyframe", 4)];
  // Keyframes 0 and 4 stand opposite on an ellipse of 14 m by 7 m.
  near((Math.hypot(a.x - b.x, a.y - b.y) / bar) * parseFloat(label), 14, 0.25);
  await opened.page.keyboard.press("m");
  await opened.page.mouse.click(a.x, a.y);
  await opened.page.mouse.click(b.x, b.y);
  assert.equal(await opened.page.locator("#labels span").innerText(), "14 m");
  assert.match(await opened.page.locator("#notice").innerText(), /^14 m: 14 m level, .* height$/);
  await opened.screenshot("plan");
  await opened.page.keyboard.press("Escape");
  assert.equal(await opened.page.locator("#labels span").count(), 0);
  await quietly(opened);
});

test("a picture is saved", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall()));
  const [download] = await Promise.all([opened.page.waitForEvent("download"), opened.page.keyboard.press("s")]);
  assert.equal(download.suggestedFilename(), "hall.png");
  const picture = readPng(readFileSync(await download.path()));
  assert.deepEqual([picture.width, picture.height], [1000, 700]);
  assert.ok(share(picture, isColoured) > 0.01);
  await quietly(opened);
});

test("in small windows nothing lies over anything else", { skip }, async () => {
  const scene = hall({ title: Array.from({ length: 8 }, (_, i) => `session_small_${i}.osa`).join(", "), maps: 2 });
  const file = viewer.write(scene);
  for (const [width, height] of [[1024, 600], [800, 500], [420, 760]]) {
    const opened = await viewer.open(file, { width, height });
    if (width < 720) await opened.page.keyboard.press("h");
    const cards = ["#panel", "#toolbar", "#timeline", "#scale"];
    const boxes = await Promise.all(cards.map(async (card) => (await opened.page.locator(card).boundingBox())!));
    boxes.forEach((a, i) => boxes.slice(0, i).forEach((b, j) => {
      const apart = a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
      assert.ok(apart, `${width} x ${height}: ${cards[i]} lies over ${cards[j]}: ${JSON.stringify([a, b])}`);
    }));
    const title = (await opened.page.locator("#panel h1").boundingBox())!;
    assert.ok(title.height < 60, `the title is ${title.height} px high`);
    await opened.screenshot(`small ${width}`);
    await quietly(opened);
  }
});

test("without motion, views jump", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall()), { reducedMotion: true });
  await opened.page.keyboard.press("p");
  assert.equal((await opened.pose()).plan, true);
  await quietly(opened);
});
