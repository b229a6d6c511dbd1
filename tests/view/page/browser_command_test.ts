// Large pages, and those that the command writes. Chromium draws by software here (SwiftShader): times are upper bounds.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { noChromium as skip, type PageGlobals, quietly, viewerForTests } from "./browser";
import { blocksOf, kRoot } from "./page_file";
import { isColoured, share } from "./png";
import { hall } from "./scenes";

const viewer = viewerForTests();

/** Opens, turns the view by hand for two seconds, and prints times. */
async function measure(file: string, print: (text: string) => void): Promise<{ openMs: number; frameMs: number }> {
  const opened = await viewer.open(file, { width: 1280, height: 800 });
  const openMs = Number(await opened.page.evaluate(() => document.documentElement.dataset.openMs));
  const restMs = await opened.page.evaluate(() => (globalThis as PageGlobals).slamdbView.stage.frameMs);
  const frames = await opened.page.evaluate(async () => {
    const { stage } = (globalThis as PageGlobals).slamdbView;
    const times: number[] = [];
    const begin = performance.now();
    let last = stage.frames;
    while (performance.now() - begin < 2500) {
      stage.camera.orbit(6, 0);
      stage.moved();
      await new Promise((resolve) => requestAnimationFrame(resolve));
      if (stage.frames !== last) times.push(performance.now());
      last = stage.frames;
    }
    const gaps = times.slice(1).map((time, i) => time - times[i]).slice(3).sort((a, b) => a - b);
    return { median: gaps[gaps.length >> 1], worst: gaps[Math.floor(gaps.length * 0.95)], share: stage.drawnShare, software: stage.software };
  });
  print(`open ${openMs} ms; frame while turning ${frames.median.toFixed(1)} ms, 95 % within ${frames.worst.toFixed(1)} ms, ${(frames.share * 100).toFixed(0)} % of points; whole frame at rest ${restMs.toFixed(0)} ms; drawn by ${frames.software ? "software (SwiftShader)" : "a graphics card"}`);
  await quietly(opened);
  return { openMs, frameMs: frames.median };
}

test("a million points open and move", { skip }, async (context) => {
  const times = await measure(viewer.write(hall({ points: 1_000_000, keyframes: 1000 })), (text) => context.diagnostic(text));
  // Far above what a quiet machine needs: a fall from linear to worse is what is to be seen here.
  assert.ok(times.openMs < 20000 && times.frameMs < 2000, JSON.stringify(times));
});

const kTenMillion = process.env.SLAMDB_VIEW_TEN_MILLION ? skip : "SLAMDB_VIEW_TEN_MILLION is not set";
test("ten million points open", { skip: kTenMillion }, async (context) => {
  await measure(viewer.write(hall({ points: 10_000_000, keyframes: 5000, observers: 3 })), (text) => context.diagnostic(text));
});

/** Atlases of the fixtures, and of SLAMDB_ATLASES. */
function atlases(): string[] {
  const folders = [join(kRoot, "fixtures/session_small_a"), join(kRoot, "fixtures/session_small_b"), process.env.SLAMDB_ATLASES ?? ""];
  return folders.filter((folder) => folder && existsSync(folder)).flatMap((folder) => readdirSync(folder).filter((name) => name.endsWith(".osa")).map((name) => join(folder, name)));
}

const command = process.env.SLAMDB;
const noCommand = command ? skip : "SLAMDB does not name the command";
test("pages of the command: every atlas opens, is seen, and is picked in", { skip: noCommand }, async (context) => {
  for (const atlas of atlases()) {
    const file = join(viewer.folder, "atlas.html");
    execFileSync(command!, ["view", atlas, "-O", "-q", "-o", file]);
    const opened = await viewer.open(file);
    const coloured = share(await opened.picture(), isColoured);
    assert.ok(coloured > 0.002, `${atlas}: ${coloured} of the picture is coloured`);
    const counts = await opened.page.evaluate(() => {
      const { scene } = (globalThis as PageGlobals).slamdbView.model;
      return { points: scene.points.count, keyframes: scene.keyframes.count, id: scene.keyframes.ids[0] };
    });
    assert.ok(counts.points > 0 && counts.keyframes > 0);
    await opened.find(`kf ${counts.id}`);
    assert.deepEqual(await opened.selection(), { kind: "keyframe", row: 0 });
    await opened.screenshot(atlas.split("/").pop()!.replace(".osa", ""));
    context.diagnostic(`${atlas.split("/").pop()}: ${counts.keyframes} keyframes, ${counts.points} points`);
    await quietly(opened);
  }
});

test("pages of the command: two atlases, and a comparison of one with itself", { skip: noCommand }, async () => {
  const [a, b] = atlases();
  for (const [options, text] of [[[a, b, "--side-by-side"], /2 atlases/], [["--diff", a, a], /Differences/]] as const) {
    const file = join(viewer.folder, "two.html");
    execFileSync(command!, ["view", ...options, "-O", "-q", "-o", file]);
    const opened = await viewer.open(file);
    assert.match(await opened.page.locator("#panel").innerText(), text);
    await quietly(opened);
  }
});

test("the command embeds this very page", { skip: noCommand }, async () => {
  const [atlas] = atlases();
  const file = join(viewer.folder, "own.html");
  execFileSync(command!, ["view", atlas, "-O", "-q", "-o", file]);
  const page = readFileSync(file, "utf8");
  const mine = viewer.writeBlocks("x", blocksOf(page));
  const script = (text: string): string => text.slice(text.lastIndexOf("<script>"));
  assert.equal(script(page).trimEnd(), script(readFileSync(mine, "utf8")).trimEnd());
  writeFileSync(mine, "");
});
