// How the page is worked in a real browser: timeline, maps, mouse, fingers, keys, address.

import assert from "node:assert/strict";
import { test } from "node:test";
import { noChromium as skip, type PageGlobals, near, quietly, viewerForTests } from "./browser";
import { difference, isColoured, share } from "./png";
import { hall } from "./scenes";

const viewer = viewerForTests();

test("the timeline replays the growth", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall()));
  const all = share(await opened.picture(), isColoured);
  await opened.page.locator("#time").focus();
  await opened.page.keyboard.press("Home");
  const none = share(await opened.picture(), isColoured);
  assert.ok(none < all * 0.05, `${none} of ${all}`);
  for (let i = 0; i < 20; ++i) await opened.page.keyboard.press("ArrowRight");
  const half = share(await opened.picture(), isColoured);
  assert.ok(half > all * 0.2 && half < all * 0.9, `${half} of ${all}`);
  assert.match(await opened.page.locator("#timeline output").innerText(), /kf 57 .* 4.75 s/);
  await opened.page.getByRole("button", { name: "Play" }).click();
  await opened.page.waitForFunction(() => (globalThis as PageGlobals).slamdbView.model.settings.time > 24);
  await opened.page.getByRole("button", { name: "Pause" }).click();
  assert.ok(await opened.page.evaluate(() => (globalThis as PageGlobals).slamdbView.model.settings.time < 40));
  await quietly(opened);
});

test("maps go off and on, apart, and are nudged", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall({ maps: 2, points: 1500 })));
  const own = await opened.picture();
  await opened.page.locator("[data-arrangement=maps]").click();
  await opened.rest();
  assert.deepEqual(await opened.outside(), [], "all of both is in the free part of the view");
  assert.ok(difference(own, await opened.picture()) > 0.01);
  await opened.page.locator("[data-arrangement=own]").click();
  const boxes = opened.page.locator(".map input[type=checkbox]");
  await boxes.nth(1).click();
  const one = await opened.picture();
  assert.ok(difference(own, one) > 0.003);
  await boxes.nth(1).click();
  await opened.page.getByRole("button", { name: "Move map 1" }).click();
  await opened.page.getByLabel("Offset x of map 1").fill("2.5");
  await opened.page.getByRole("button", { name: "Nudge along y map 1" }).click();
  const [x, y] = await opened.page.evaluate(() => (globalThis as PageGlobals).slamdbView.model.frames.offsets[1]);
  assert.equal(x, 2.5);
  assert.ok(y > 0);
  assert.ok(difference(own, await opened.picture()) > 0.003);
  await quietly(opened);
});

test("mouse: turns, moves, zooms, flies", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall()));
  const { mouse } = opened.page;
  const drag = async (button: "left" | "right"): Promise<void> => {
    await mouse.move(600, 400);
    await mouse.down({ button });
    await mouse.move(680, 430, { steps: 4 });
    await mouse.up({ button });
    await opened.rest();
  };
  const begin = await opened.pose();
  await drag("left");
  const turned = await opened.pose();
  assert.ok(turned.azimuth !== begin.azimuth && turned.elevation > begin.elevation);
  assert.deepEqual(turned.target, begin.target);
  await drag("right");
  const moved = await opened.pose();
  assert.notDeepEqual(moved.target, begin.target);
  await mouse.wheel(0, -300);
  await opened.rest();
  assert.ok((await opened.pose()).distance < moved.distance);
  await opened.page.keyboard.press("f");
  await opened.rest();
  near((await opened.pose()).distance, begin.distance, begin.distance * 0.02);
  const { x, y } = await opened.place("keyframe", 20);
  await mouse.dblclick(x, y);
  await opened.rest();
  const flown = await opened.pose();
  assert.ok(flown.distance < begin.distance);
  const there = await opened.page.evaluate(() => (globalThis as PageGlobals).slamdbView.model.frames.keyframe(20));
  there.forEach((value: number, axis: number) => near(flown.target[axis], value, 1e-3));
  await quietly(opened);
});

test("fingers: one turns, two move and zoom", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall()), { touch: true, width: 420, height: 760 });
  const client = await opened.page.context().newCDPSession(opened.page);
  const touch = (type: string, points: [number, number][]): Promise<unknown> =>
    client.send("Input.dispatchTouchEvent", { type: type as "touchStart", touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const begin = await opened.pose();
  await touch("touchStart", [[200, 400]]);
  for (let i = 1; i <= 5; ++i) await touch("touchMove", [[200 + 12 * i, 400]]);
  await touch("touchEnd", []);
  await opened.rest();
  const turned = await opened.pose();
  assert.ok(turned.azimuth < begin.azimuth - 0.2);
  await touch("touchStart", [[180, 400], [240, 400]]);
  for (let i = 1; i <= 5; ++i) await touch("touchMove", [[180 - 10 * i, 400], [240 + 10 * i, 400]]);
  await touch("touchEnd", []);
  await opened.rest();
  near((await opened.pose()).distance, turned.distance * (60 / 160), turned.distance * 0.05);
  await opened.screenshot("phone");
  await quietly(opened);
});

test("everything is reached and worked by keys alone", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall({ maps: 2 })), { reducedMotion: true });
  const { keyboard } = opened.page;
  const names: string[] = [];
  for (let i = 0; i < 80; ++i) {
    await keyboard.press("Tab");
    const name = await opened.page.evaluate(() => {
      const focused = document.activeElement as HTMLElement | null;
      if (!focused || focused === document.body) return "";
      const box = focused.getBoundingClientRect();
      const seen = box.width > 0 && box.height > 0 && getComputedStyle(focused).visibility !== "hidden";
      const outline = getComputedStyle(focused).outlineStyle !== "none";
      return `${focused.getAttribute("aria-label") ?? focused.closest("label")?.textContent ?? focused.textContent}${seen ? "" : " HIDDEN"}${outline ? "" : " UNMARKED"}`;
    });
    if (name === "" || (i > 0 && name === names[0])) break;
    names.push(name);
  }
  for (const wanted of ["Map in 3D", "Controls", "Find a keyframe", "Colour points by", "Covisibility", "Maps apart", "Move map 1", "Show all", "Plan view", "Measuring tape", "Save a picture", "Keys and gestures", "Play", "Keyframes that are there yet"]) {
    assert.ok(names.some((name) => name.includes(wanted)), `${wanted} is not reached: ${names.join(" | ")}`);
  }
  assert.deepEqual(names.filter((name) => / HIDDEN| UNMARKED/.test(name)), []);
  await opened.page.locator("#view").focus();
  const begin = await opened.pose();
  await keyboard.press("ArrowLeft");
  await keyboard.press("+");
  assert.ok((await opened.pose()).azimuth !== begin.azimuth && (await opened.pose()).distance < begin.distance);
  await keyboard.press("]");
  assert.deepEqual(await opened.selection(), { kind: "keyframe", row: 0 });
  await keyboard.press("]");
  assert.deepEqual(await opened.selection(), { kind: "keyframe", row: 1 });
  await keyboard.press("Escape");
  await keyboard.press("?");
  assert.equal(await opened.page.locator("#help").isVisible(), true);
  await keyboard.press("Escape");
  assert.equal(await opened.page.locator("#help").isVisible(), false);
  await keyboard.press("/");
  await keyboard.type("kf 6");
  await keyboard.press("Enter");
  assert.deepEqual(await opened.selection(), { kind: "keyframe", row: 2 });
  await keyboard.press("Escape");
  await keyboard.press("2");
  assert.equal(await opened.page.locator("input[data-layer=trajectory]").isChecked(), false);
  await keyboard.press("t");
  assert.equal(await opened.page.evaluate(() => document.documentElement.dataset.theme), "light");
  await keyboard.press("h");
  assert.equal(await opened.page.locator("#panel .scroll").isVisible(), false);
  await quietly(opened);
});

test("the address brings back what was seen", { skip }, async () => {
  const file = viewer.write(hall({ maps: 2 }));
  const opened = await viewer.open(file);
  await opened.page.selectOption("#colour", "age");
  await opened.page.locator("input[data-layer=covisibility]").click();
  await opened.find("kf 30");
  await opened.page.waitForTimeout(600);
  const hash = await opened.page.evaluate(() => location.hash.slice(1));
  const pose = await opened.pose();
  assert.match(hash, /m=age/);
  await quietly(opened);
  const again = await viewer.open(file, { hash });
  assert.deepEqual(await again.selection(), { kind: "keyframe", row: 10 });
  assert.equal(await again.page.locator("#colour").inputValue(), "age");
  assert.equal(await again.page.locator("input[data-layer=covisibility]").isChecked(), true);
  near((await again.pose()).distance, pose.distance, 1e-3);
  await quietly(again);
});
