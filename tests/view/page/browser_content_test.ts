// What the page tells in a real browser: card, ids, findings, comparison, failures; all of it accessible.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import { noChromium as skip, type PageGlobals, type Viewer, isPink, isRed, quietly, viewerForTests } from "./browser";
import { difference, share } from "./png";
import { comparison, hall, withKeypoints } from "./scenes";

const viewer = viewerForTests();

test("the inspector shows fields, observers and ids; lit things are seen", { skip }, async () => {
  const opened = await viewer.open(viewer.write(withKeypoints(hall({ points: 400, keyframes: 20 }))));
  const before = share(await opened.picture(), isPink);
  await opened.find("mp 25");
  assert.deepEqual(await opened.selection(), { kind: "point", row: 10 });
  const card = opened.page.locator("#inspector");
  assert.match(await card.innerText(), /Map point 25[\s\S]*position[\s\S]*5 observers/);
  assert.ok(share(await opened.picture(), isPink) > before + 0.001);
  await card.getByRole("button", { name: "kf 3", exact: true }).click();
  await opened.rest();
  assert.deepEqual(await opened.selection(), { kind: "keyframe", row: 1 });
  assert.match(await card.innerText(), /Keyframe 3[\s\S]*1403640000.25 s[\s\S]*seen by it\s+\d+ points[\s\S]*60 keypoints[\s\S]*40 with a point[\s\S]*2 covisible keyframes/);
  await opened.screenshot("inspector");
  // A click on a filled keypoint selects its point.
  const plane = card.locator("canvas.image-plane");
  const at = await opened.page.evaluate(() => {
    const { keypoints } = (globalThis as PageGlobals).slamdbView.model.scene;
    const i = keypoints.begin[1] + 1;
    return { x: keypoints.x[i] / 8, y: keypoints.y[i] / 8, point: keypoints.point[i] };
  });
  const box = (await plane.boundingBox())!;
  await plane.click({ position: { x: (at.x / 640) * box.width, y: (at.y / 480) * box.height } });
  assert.equal((await opened.selection())?.kind, "point");
  await opened.find("kf 0");
  assert.match(await card.innerText(), /20 points say that this keyframe sees them; 40 are at a keypoint shown here/);
  await opened.page.keyboard.press("Escape");
  assert.equal(await opened.selection(), null);
  assert.equal(await card.isHidden(), true);
  await quietly(opened);
});

test("ids are copied", { skip }, async () => {
  const opened = await viewer.open(viewer.write(hall()), { before: "globalThis.copied = []; Object.defineProperty(navigator, 'clipboard', { value: { writeText: async (text) => copied.push(text) } });" });
  await opened.find("kf 12");
  await opened.page.getByRole("button", { name: "Copy kf/12" }).click();
  assert.deepEqual(await opened.page.evaluate(() => (globalThis as unknown as { copied: string[] }).copied), ["kf/12"]);
  await quietly(opened);
});

test("names of maps are text, never markup", { skip }, async () => {
  const evil = "<img src=x onerror=\"document.title='taken'\"></script><b>&amp;";
  const scene = hall({ title: evil });
  scene.atlases[0].name = evil;
  scene.atlases[0].maps[0].name = evil;
  scene.atlases[0].info = [{ label: evil, value: evil }];
  scene.header = { findings: [{ rule: evil, severity: "error", place: evil, text: evil, atlas: 0, map: 0, kind: "point", row: 3, id: "11" }], left_out: [evil] };
  const opened = await viewer.open(viewer.write(scene));
  assert.equal(await opened.page.title(), evil);
  assert.equal(await opened.page.locator("main img, main b").count(), 0);
  assert.equal(await opened.page.locator("#panel h1").innerText(), evil);
  assert.ok((await opened.page.locator(".findings").innerText()).includes(evil));
  await opened.page.keyboard.press("n");
  await opened.find("mp 11");
  assert.ok((await opened.page.locator("#inspector").innerText()).includes(evil));
  assert.equal(await opened.page.title(), evil);
  await quietly(opened);
});

test("a comparison: statuses, counts, arrows", { skip }, async () => {
  const opened = await viewer.open(viewer.write(comparison()));
  const section = opened.page.locator("details", { hasText: "From before.osa to after.osa" });
  assert.match((await section.innerText()).replace(/\s+/g, " "), /Added 0 kf, 150 mp Removed 0 kf, 100 mp Moved 0 kf, 80 mp/);
  await opened.screenshot("comparison");
  let last = await opened.picture();
  for (const status of ["unchanged", "added", "removed", "moved"]) {
    await opened.page.locator(`input[data-status=${status}]`).click();
    const now = await opened.picture();
    assert.ok(difference(last, now) > 0.0005, `${status}: ${difference(last, now)}`);
    last = now;
  }
  await quietly(opened);
});

test("findings are red, and stepped through", { skip }, async () => {
  const scene = hall({ points: 500, keyframes: 12 });
  const finding = { rule: "point-observed", severity: "error", place: "map 0, mp 25", text: "is seen by nobody", atlas: 0, map: 0 };
  scene.header = { findings: [{ ...finding, kind: "point", row: 10, id: "25" }, { ...finding, kind: "keyframe", row: 4, id: "12" }, { ...finding, rule: "map-known", place: "map 0", kind: "map", row: -1, id: "0" }], findings_left_out: 1000 };
  const opened = await viewer.open(viewer.write(scene));
  const red = share(await opened.picture(), isRed);
  assert.ok(red > 0.00005, String(red));
  await opened.page.keyboard.press("n");
  await opened.rest();
  assert.deepEqual(await opened.selection(), { kind: "point", row: 10 });
  assert.ok(share(await opened.picture(), isRed) > red);
  await opened.page.getByRole("button", { name: "Next finding" }).click();
  assert.deepEqual(await opened.selection(), { kind: "keyframe", row: 4 });
  assert.equal(await opened.page.locator(".steps .at").innerText(), "2 of 3");
  const words = (await opened.page.locator("#panel").innerText()).replace(/\s+/g, " ");
  assert.match(words, /2 of 3 have a place in the picture. 1,000 more are not in the page/);
  assert.match(words, /point-observed 2 errors In a sound atlas all is well. Here ORB-SLAM3 stumbles. map 0, mp 25: is seen by nobody/);
  assert.equal(await opened.page.locator('#panel label:has([data-layer="findings"]) .count').innerText(), "2");
  assert.equal(await opened.page.locator(".findings details").nth(1).getAttribute("open"), null, "the others are folded");
  await opened.page.keyboard.press("n");
  assert.equal(await opened.page.locator('.findings [aria-pressed="true"]').innerText(), "map 0: is seen by nobody", "and unfold as they are stepped to");
  await quietly(opened);
});

test("axe finds nothing, in dark and light, wide and narrow, with card and help", { skip }, async () => {
  const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
  const scene = withKeypoints(comparison());
  scene.header = { ...scene.header, findings: ["error", "warning", "note"].map((severity) => ({ rule: `rule-${severity}`, severity, place: "map 0, mp 3", text: "text", atlas: 0, map: 0, kind: "point", row: 3, id: "3" })), left_out: ["Something is left out."] };
  const file = viewer.write(scene);
  for (const look of [{ scheme: "dark" }, { scheme: "light" }, { scheme: "dark", width: 420, height: 760 }] as const) {
    const opened = await viewer.open(file, look);
    const run = async (what: string): Promise<void> => {
      const found = await opened.page.evaluate(async () => {
        const { axe } = globalThis as unknown as { axe: { run: (context: unknown, options: unknown) => Promise<{ violations: { id: string; nodes: { html: string; failureSummary: string }[] }[] }> } };
        const { violations } = await axe.run(document, { resultTypes: ["violations"] });
        return violations.map(({ id, nodes }) => `${id}: ${nodes[0].html.slice(0, 160)} ${nodes[0].failureSummary}`);
      });
      assert.deepEqual(found, [], `${look.scheme}, ${what}`);
    };
    await opened.page.evaluate(axe);
    await opened.page.evaluate(() => document.querySelectorAll("details").forEach((details) => (details.open = true)));
    await run("controls");
    if ("width" in look) await opened.page.keyboard.press("h");
    await run("controls, unfolded or wide");
    await opened.find("kf 6");
    await run("selection");
    await opened.page.keyboard.press("?");
    await run("help");
    await opened.end();
  }
});

test("what hinders is said in words", { skip }, async () => {
  const scene = hall();
  const damaged = viewer.write(scene, (blocks) => blocks.replace(/(data-name="points\/x"[^>]*>.{80})..../, "$1AAAA"));
  const failing: [string, Parameters<Viewer["open"]>[1], RegExp][] = [
    [damaged, {}, /column points\/x[\s\S]*slamdb view/],
    [viewer.writeBlocks("nothing", ""), {}, /no column header/],
    [viewer.write(scene), { before: "HTMLCanvasElement.prototype.getContext = () => null;" }, /WebGL2 is missing/],
    [viewer.write(scene), { before: "delete globalThis.DecompressionStream;" }, /too old/],
  ];
  for (const [file, look, text] of failing) {
    const opened = await viewer.open(file, { ...look, state: "failed" });
    assert.match(await opened.page.locator("#failure").innerText(), text);
    assert.equal(await opened.page.locator("#loading").isHidden(), true);
    await quietly(opened);
  }
});

test("statistics say the sensor once, and cameras by their ids", { skip }, async () => {
  const scene = hall({ sensor: "stereo-or-rgbd" });
  scene.atlases[0].info = [{ label: "map 0", value: "stereo or RGB-D with IMU" }, { label: "features", value: "12" }];
  const opened = await viewer.open(viewer.write(scene));
  const text = (await opened.page.locator("#panel").textContent()) ?? "";
  assert.ok(text.includes("map 0: stereo or RGB-D with IMU") && !text.includes("stereo-or-rgbd"), text);
  assert.ok(text.includes("Camera 2") && !text.includes("Camera 0"), text);
  await quietly(opened);
});
