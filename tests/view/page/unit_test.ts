// The page without a browser: columns against an encoder of their own, camera, colours, picking, words.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Camera, widestAzimuth } from "../../../lib/slamdb/view/page/camera";
import { category, kColourModes, legend, originNumbers, palette, scaleColour, shade } from "../../../lib/slamdb/view/page/colours";
import { DamagedData, Varints } from "../../../lib/slamdb/view/page/columns";
import { fromBase64, readScene, type Block } from "../../../lib/slamdb/view/page/data";
import { recordedTime, shortly, sinceBegin, summary } from "../../../lib/slamdb/view/page/describe";
import { partnersOf } from "../../../lib/slamdb/view/page/edges";
import { durationText, grouped, measured, rounded, roundStep, stepText } from "../../../lib/slamdb/view/page/format";
import { Frames, withoutStrangers } from "../../../lib/slamdb/view/page/frames";
import { octahedral, pointText } from "../../../lib/slamdb/view/page/inspector";
import { compose, distance, rotate, turnAboutZ, type Vec3 } from "../../../lib/slamdb/view/page/maths";
import { Model } from "../../../lib/slamdb/view/page/model";
import { countStatuses } from "../../../lib/slamdb/view/page/panel_diff";
import { buildTrajectory, isBreak, kKeyframeBit, frustum, usualFrustum } from "../../../lib/slamdb/view/page/keyframes";
import { nearestNumber, selectionOf } from "../../../lib/slamdb/view/page/pick";
import { inOrder, rowOfIndex } from "../../../lib/slamdb/view/page/points";
import { scaleOf } from "../../../lib/slamdb/view/page/scale_bar";
import { errorOf, idText, mapOfKeyframe, mapOfPoint, mapTitle, pointPosition, pointsSeenBy, type Scene, unitOf } from "../../../lib/slamdb/view/page/scene";
import { findIds } from "../../../lib/slamdb/view/page/search";
import { readAddress, writeAddress } from "../../../lib/slamdb/view/page/address";
import { findingPlace } from "../../../lib/slamdb/view/page/highlights";
import { Bytes, columnsOf, pack, type PackedPart, type PlainScene } from "./encoder";
import { comparison, hall, numbers, withKeypoints } from "./scenes";

const blocksOf = (parts: PackedPart[]): Block[] => parts.map(({ name, part, text }) => ({ name, part, size: text.length, take: () => text }));
const read = (scene: PlainScene, partBytes?: number): Promise<Scene> => readScene(blocksOf(pack(columnsOf(scene), partBytes)), () => {});

/** Reads a scene one of whose columns was changed. */
function readChanged(change: (columns: Map<string, Uint8Array>) => void): Promise<Scene> {
  const columns = columnsOf(withKeypoints(hall()));
  change(columns);
  return readScene(blocksOf(pack(columns)), () => {});
}
const refuses = (change: (columns: Map<string, Uint8Array>) => void, text: RegExp): Promise<void> =>
  assert.rejects(readChanged(change), (error: Error) => error instanceof DamagedData && text.test(error.message));
const near = (a: number, b: number, by: number): void => assert.ok(Math.abs(a - b) <= by, `${a} is not within ${by} of ${b}`);
const nearPoint = (a: Vec3, b: ArrayLike<number>, by: number): void => [0, 1, 2].forEach((axis) => near(a[axis], b[axis], by));

test("variable numbers: every length, both signs", () => {
  const values = [0, 1, 127, 128, 16383, 16384, 2 ** 28 - 1, 2 ** 28, 2 ** 31, 2 ** 32 + 5, 2 ** 52];
  const out = new Bytes();
  for (const value of values) out.varint(value);
  for (const value of values) for (const signed of [value, -value]) out.zigzag(signed / 2 === Math.floor(signed / 2) ? signed / 2 : signed);
  const input = new Varints(out.done(), "numbers");
  for (const value of values) assert.equal(input.next(), value);
  for (const value of values) for (const signed of [value, -value]) assert.equal(input.signed(), (signed / 2 === Math.floor(signed / 2) ? signed / 2 : signed) + 0);
  input.finish();
});

test("variable numbers: an end within a number is damage", () => {
  assert.throws(() => new Varints(Uint8Array.from([0x80]), "x").next(), DamagedData);
  assert.throws(() => new Varints(Uint8Array.from([0xff, 0xff, 0xff, 0xff, 0xff]), "x").next(), DamagedData);
  assert.throws(() => new Varints(new Uint8Array(0), "x").next(), DamagedData);
  assert.throws(() => new Varints(new Uint8Array(20).fill(0xff), "x").next(), DamagedData);
});

test("base64, with and without the browser's own", () => {
  const bytes = Uint8Array.from({ length: 257 }, (_, i) => (i * 7) & 255);
  assert.deepEqual(fromBase64(Buffer.from(bytes).toString("base64")), bytes);
});

test("a scene comes back as it was written", async () => {
  const plain = withKeypoints(hall({ maps: 3, points: 5000, keyframes: 30 }));
  plain.points.far = new Map([[4, [900, -2, 7]], [7000, [1, 2, -5000]]]);
  const scene = await read(plain, 10000);
  assert.equal(scene.points.count, 15000);
  assert.equal(scene.keyframes.count, 90);
  for (const row of [0, 1, 4095, 4096, 4999, 5000, 9095, 9096, 14999]) {
    nearPoint(pointPosition(scene, mapOfPoint(scene, row), row), plain.points.positions.subarray(3 * row, 3 * row + 3), 3e-4);
    assert.deepEqual([...scene.points.seen.of(row)], plain.points.seen(row));
    assert.equal(scene.points.ids[row], plain.points.ids[row]);
    assert.equal(scene.points.reference[row], plain.points.reference[row]);
    assert.equal(scene.points.observers[row], plain.points.seen(row).length);
  }
  assert.deepEqual(pointPosition(scene, mapOfPoint(scene, 4), 4), [900, -2, 7]);
  assert.deepEqual(pointPosition(scene, mapOfPoint(scene, 7000), 7000), [1, 2, -5000]);
  assert.deepEqual([...scene.keyframes.pose], [...plain.keyframes.pose]);
  assert.deepEqual([...scene.keyframes.time], [...plain.keyframes.time]);
  assert.deepEqual([...scene.keyframes.parent], [...Array.from(plain.keyframes.parent)]);
  assert.deepEqual([...scene.covisibility.pairs], plain.covisibility!.flatMap(([a, b]) => [a, b]));
  assert.deepEqual([...scene.covisibility.weight!], plain.covisibility!.map(([, , weight]) => weight));
  assert.deepEqual([...scene.loops.pairs], [29, 0]);
  assert.deepEqual([...scene.keypoints.point], plain.keypoints!.flatMap(({ point }) => point));
  assert.equal(scene.keypoints.x[70] / 8, plain.keypoints![1].x[10]);
});

test("who sees what, both ways", async () => {
  const plain = hall({ maps: 2, points: 3000, keyframes: 25 });
  const model = new Model(await read(plain));
  for (const keyframe of [0, 13, 24, 25, 49]) {
    const wanted = Array.from({ length: 6000 }, (_, row) => row).filter((row) => plain.points.seen(row).includes(keyframe));
    assert.deepEqual(pointsSeenBy(model.scene, keyframe), wanted);
  }
});

test("points without observers, hidden points and maps without points", async () => {
  const plain = hall({ points: 600, keyframes: 10 });
  plain.points.seen = (row) => (row % 2 === 0 ? [] : [9]);
  plain.points.hidden = new Uint8Array(600);
  plain.points.hidden[3] = 1;
  plain.points.positions[9] = NaN;
  plain.atlases[0].maps.push({ id: 8, keyframes: 0, points: 0 });
  const scene = await read(plain);
  assert.deepEqual([...scene.points.seen.of(4)], []);
  assert.deepEqual([...scene.points.seen.of(599)], [9]);
  assert.equal(scene.points.birth[599], 9);
  assert.equal(scene.points.hidden![3], 1);
  assert.equal(new Frames(scene).bounds([1]).low.every(Number.isFinite), true);
  const empty = hall({ points: 0, keyframes: 0 });
  [empty.covisibility, empty.loops] = [[], []];
  assert.equal((await read(empty)).points.count, 0);
});

test("births follow time, not rows", async () => {
  const plain = hall({ points: 100, keyframes: 10 });
  plain.keyframes.time.set([9, 8, 7, 6, 5, 4, 3, 2, 1, 0]);
  const scene = await read(plain);
  assert.deepEqual([...scene.keyframes.byTime], [9, 8, 7, 6, 5, 4, 3, 2, 1, 0]);
  assert.equal(scene.points.birth[0], 5, "rows 0 to 4 see it; row 4 is the sixth in time");
});

test("damage is told, by column", async () => {
  await refuses((columns) => columns.delete("header"), /no column header/);
  await refuses((columns) => columns.set("header", new TextEncoder().encode("{")), /header cannot be read/);
  await refuses((columns) => columns.set("points/x", columns.get("points/x")!.subarray(2)), /points\/x holds 7998 bytes where 8000 belong/);
  await refuses((columns) => columns.delete("points/frame"), /points\/frame/);
  await refuses((columns) => columns.set("points/id", columns.get("points/id")!.subarray(0, 100)), /points\/id ends within/);
  await refuses((columns) => columns.set("points/id", Uint8Array.from([...columns.get("points/id")!, 0])), /points\/id holds/);
  await refuses((columns) => columns.set("points/seen", Uint8Array.from([200, 1])), /row 0 is seen by 200 keyframes/);
  await refuses((columns) => columns.set("points/seen", Uint8Array.from([1, 120])), /names keyframe row 60/);
  await refuses((columns) => columns.set("points/reference", new Uint8Array(4000).fill(80)), /points\/reference names row/);
  await refuses((columns) => columns.set("keyframes/camera", new Uint8Array(40).fill(9)), /names camera 8/);
  await refuses((columns) => columns.set("keyframes/parent", new Uint8Array(40).fill(100)), /names parent row/);
  await refuses((columns) => columns.set("edges/loop", Uint8Array.from([100, 0])), /edges\/loop names keyframe rows 50 and 50/);
  await refuses((columns) => columns.set("edges/covisibility", new Uint8Array(40).fill(99)), /edges\/covisibility/);
  await refuses((columns) => columns.set("keypoints/point", new Uint8Array(2400).fill(0xfe)), /keypoints\/point/);
});

test("blocks that are cut, missing or of another version are told", async () => {
  const parts = pack(columnsOf(hall()), 3000);
  const cut = parts.map((part) => (part.name === "points/x" && part.part === 1 ? { ...part, text: part.text.slice(0, 40) } : part));
  await assert.rejects(readScene(blocksOf(cut), () => {}), /Part 1 of column points\/x cannot be unpacked/);
  const missing = parts.filter((part) => part.name !== "points/x" || part.part !== 1);
  await assert.rejects(readScene(blocksOf(missing), () => {}), /Part 1 of column points\/x is missing/);
  await assert.rejects(read({ ...hall(), header: { version: 2 } }), /version 2, the page reads version 1/);
});

test("progress rises to 1", async () => {
  const shares: number[] = [];
  await readScene(blocksOf(pack(columnsOf(hall()), 2000)), (share) => shares.push(share));
  assert.deepEqual(shares, [...shares].sort((a, b) => a - b));
  assert.equal(shares.at(-1), 1);
});

test("quaternions turn as matrices do", () => {
  nearPoint(rotate([0, 0, Math.SQRT1_2, Math.SQRT1_2], [1, 0, 0]), [0, 1, 0], 1e-12);
  nearPoint(rotate(compose(turnAboutZ(Math.PI / 2), turnAboutZ(Math.PI / 2)), [1, 2, 3]), [-1, -2, 3], 1e-12);
});

function cameraAt(): Camera {
  const camera = new Camera();
  [camera.width, camera.height] = [800, 600];
  camera.pose = { target: [1, 2, 3], distance: 10, azimuth: 0, elevation: 0, plan: false, aside: 0 };
  return camera;
}

test("camera: the target is in the middle, up is up, right is right", () => {
  const camera = cameraAt();
  const middle = camera.project([1, 2, 3])!;
  near(middle.x, 400, 1e-3), near(middle.y, 300, 1e-3), near(middle.depth, 10, 1e-5);
  assert.ok(camera.project([1, 2, 4])!.y < 300, "z is up");
  assert.ok(camera.project([1, 3, 3])!.x > 400, "seen from x, y is at the right");
  assert.equal(camera.project([12, 2, 3]), null, "behind the eye");
  camera.inset = 200;
  near(camera.project([1, 2, 3])!.x, 500, 1e-3);
  camera.pose.aside = 300;
  near(camera.project([1, 2, 3])!.x, 350, 1e-3);
});

test("camera: zoom keeps what is under the pixel, in plan exactly", () => {
  const camera = cameraAt();
  camera.pose = { ...camera.pose, elevation: Math.PI / 2, plan: true };
  const before = camera.onLevel(650, 120, 0)!;
  camera.zoom(0.5, 650, 120);
  nearPoint(camera.onLevel(650, 120, 0)!, before, 1e-5);
  near(camera.pose.distance, 5, 1e-9);
  camera.pan(100, 0);
  const after = camera.onLevel(750, 120, 0)!;
  nearPoint(after, before, 1e-5);
});

test("camera: pixels and levels agree", () => {
  const camera = cameraAt();
  camera.pose = { ...camera.pose, azimuth: 0.7, elevation: 0.6 };
  const place = camera.onLevel(300, 410, 0.5)!;
  const back = camera.project(place)!;
  near(back.x, 300, 0.02), near(back.y, 410, 0.02);
  assert.equal(camera.onLevel(300, 0, 1000), null);
});

test("camera: a framed pose shows the landmarks", () => {
  const camera = cameraAt();
  const random = numbers(5);
  // Most of them at one end: the few at the other are seen as well.
  const points = Array.from({ length: 500 }, (_, i): Vec3 => [i < 400 ? random() * 15 - 9 : random() * 40 - 9, random() * 6, random() * 3]);
  for (const plan of [false, true]) {
    camera.pose = camera.framed(points, widestAzimuth(points), plan ? Math.PI / 2 : 0.6, plan);
    const shown = points.filter((p) => {
      const at = camera.project(p);
      return at && at.x >= camera.inset && at.x <= 800 && at.y >= 0 && at.y <= 600;
    });
    assert.equal(shown.length, 500);
    const xs = shown.map((p) => camera.project(p)!.x);
    assert.ok(Math.max(...xs) - Math.min(...xs) > 500, "and fills the picture with them");
  }
});

test("strangers far out do not count for what is framed", () => {
  const random = numbers(9);
  const points = Array.from({ length: 400 }, (): Vec3 => [random() * 10, random() * 4, random()]);
  assert.deepEqual(withoutStrangers([...points, [90, 0, 0]]), points);
  assert.deepEqual(withoutStrangers([[1, 2, 3]]), [[1, 2, 3]]);
});

test("camera: flights arrive, and not at all where motion is not wanted", () => {
  const camera = cameraAt();
  const to = { ...camera.pose, distance: 3, azimuth: 6 };
  camera.flyTo(to, 0, 100);
  assert.equal(camera.tick(50), true);
  assert.ok(camera.pose.distance < 10 && camera.pose.distance > 3);
  camera.tick(100);
  assert.deepEqual(camera.pose, to);
  assert.equal(camera.tick(101), false);
  camera.calm = true;
  camera.flyTo({ ...to, distance: 8 }, 0);
  assert.equal(camera.pose.distance, 8);
});

test("maps stand upright as the header says", async () => {
  const held = new Frames(await read(hall()));
  nearPoint(rotate(held.own[0].rotation, [0, -1, 0]), [0, 0, 1], 1e-6);
  const plain = hall();
  plain.atlases[0].maps[0].upright = [0, -Math.SQRT1_2, 0, Math.SQRT1_2];
  nearPoint(rotate(new Frames(await read(plain)).own[0].rotation, [1, 0, 0]), [0, 0, 1], 1e-6);
});

test("maps apart do not overlap; offsets move and turn", async () => {
  const model = new Model(await read(hall({ maps: 3, points: 500, keyframes: 10 })));
  model.setArrangement("maps");
  const boxes = [0, 1, 2].map((map) => model.frames.bounds([map]));
  assert.ok(boxes[0].high[0] < boxes[1].low[0] && boxes[1].high[0] < boxes[2].low[0]);
  model.setArrangement("own");
  const before = model.frames.point(0);
  model.frames.offsets[0].splice(0, 4, 1, 2, 3, 0);
  model.framesChanged();
  nearPoint(model.frames.point(0), [before[0] + 1, before[1] + 2, before[2] + 3], 1e-6);
  model.frames.offsets[0].splice(0, 4, 0, 0, 0, 180);
  model.framesChanged();
  nearPoint(model.frames.point(0), [-before[0], -before[1], before[2]], 1e-5);
});

test("frusta look ahead, and are of a size with the steps", async () => {
  const model = new Model(await read(hall()));
  const { centre, corners } = frustum(model, 0, 1);
  const middle = [0, 1, 2].map((axis) => corners.reduce((sum, corner) => sum + corner[axis], 0) / 4) as Vec3;
  const ahead = model.frames.direction(0, [0, 0, 1]);
  nearPoint(middle, [0, 1, 2].map((axis) => centre[axis] + ahead[axis]), 2e-3);
  assert.ok(corners[0][2] > corners[3][2], "the upper corners are up");
  near(distance(corners[0], corners[1]), 640 / 450, 1e-4);
  const depth = usualFrustum(model.scene, 25);
  assert.ok(depth >= 0.2 && depth <= 0.75, String(depth));
});

test("strides: every row once, any beginning an even sample", () => {
  for (const rows of [0, 1, 15, 16, 17, 1000]) {
    const seen: number[] = [];
    inOrder(rows, (row, index) => {
      assert.equal(rowOfIndex(index, rows), row);
      seen.push(row);
    });
    assert.deepEqual([...seen].sort((a, b) => a - b), Array.from({ length: rows }, (_, i) => i));
  }
  const first: number[] = [];
  inOrder(1600, (row, index) => index < 400 && first.push(row));
  first.sort((a, b) => a - b);
  assert.ok(first.every((row, i) => i === 0 || row - first[i - 1] === 4));
});

test("picking: numbers to rows, the nearest to the middle wins", async () => {
  const scene = await read(hall({ maps: 2, points: 1000, keyframes: 10 }));
  assert.equal(selectionOf(scene, 0), null);
  assert.deepEqual(selectionOf(scene, kKeyframeBit + 7), { kind: "keyframe", row: 7 });
  inOrder(1000, (row, index) => assert.deepEqual(selectionOf(scene, 1000 + index + 1), { kind: "point", row: 1000 + row }));
  const pixels = new Uint32Array(25);
  pixels[0] = 5, pixels[7] = 9;
  assert.equal(nearestNumber(pixels, 5), 9);
  pixels.fill(0);
  pixels[0] = 5;
  assert.equal(nearestNumber(pixels, 5), 0, "a corner is out of reach");
});

test("colours: every mode has shades and a legend; scales rise in lightness", async () => {
  const scene = await read(hall({ maps: 2 }));
  const frames = new Frames(scene);
  for (const { mode } of kColourModes) {
    const shading = shade(scene, frames, mode);
    for (const theme of ["dark", "light"] as const) {
      assert.equal(palette(shading, theme, [1, 2, 3]).length, 1024);
      assert.ok(legend(scene, shading, theme, [1, 2, 3], String));
    }
  }
  const light = ([r, g, b]: number[]): number => 0.2126 * r + 0.7152 * g + 0.0722 * b;
  for (const mode of ["height", "error"] as const) {
    for (let i = 1; i <= 20; ++i) assert.ok(light(scaleColour(mode, i / 20, "dark")) > light(scaleColour(mode, (i - 1) / 20, "dark")));
  }
});

test("colours: dozens of maps are told apart, on either background", () => {
  for (const theme of ["dark", "light"] as const) {
    const colours = Array.from({ length: 24 }, (_, index) => category(index, theme));
    colours.forEach((a, i) => colours.slice(0, i).forEach((b, j) => assert.ok(distance(a, b) > 18, `${theme}: ${i} ${a} and ${j} ${b}`)));
    for (const [r, g, b] of colours) {
      const light = (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255;
      assert.ok(theme === "dark" ? light > 0.28 : light < 0.6, `${theme}: ${[r, g, b]}`);
    }
  }
});

test("several atlases: each has a clock of its own, and anew after a pause; one map goes by the name of its atlas", async () => {
  const plain = hall({ maps: 3, keyframes: 4, points: 10 });
  const [a, b, c] = plain.atlases[0].maps;
  plain.atlases = [{ ...plain.atlases[0], name: "a.osa", maps: [a, b] }, { ...plain.atlases[0], name: "b.osa", maps: [c] }];
  const day = 86400;
  plain.keyframes.time.set([0, 1, 2, 3, 10, 11, day, day + 2, 0.5, 1.5, 2.5, 400 * day]);
  const scene = await read(plain);
  assert.deepEqual([0, 3, 5, 6, 7, 8, 10, 11].map((row) => sinceBegin(scene, row)), ["0 s", "3 s", "11 s", "0 s", "2 s", "0 s", "2 s", "0 s"]);
  assert.deepEqual(scene.maps.map((map) => mapTitle(scene, map)), ["a.osa: map 0", "a.osa: map 1", "b.osa"]);
});

test("colours: what the shades say", async () => {
  const scene = await read(hall({ maps: 2 }));
  const frames = new Frames(scene);
  const byMap = shade(scene, frames, "map").shades;
  assert.deepEqual([byMap[0], byMap[3999], byMap[4000], byMap[7999]], [0, 0, 1, 1]);
  assert.deepEqual([...originNumbers(scene)], [[0, 0], [1, 1]]);
  const height = shade(scene, frames, "height");
  const rows = Array.from({ length: 8000 }, (_, row) => row).sort((a, b) => frames.pointHeight(a) - frames.pointHeight(b));
  assert.ok(height.shades[rows[0]] < 8 && height.shades[rows[7999]] > 247);
  near(height.low, -1.42, 0.1), near(height.high, 2.42, 0.1);
  near(errorOf(scene, 100)!, 8 * (100 / 254) ** 2, 1e-9);
  const observers = shade(scene, frames, "observers").shades;
  assert.ok(observers[0] > observers[3999], "the last points are seen by one keyframe alone");
});

test("a comparison: counts, and where things moved from", async () => {
  const scene = await read(comparison());
  const { points } = countStatuses(scene);
  assert.deepEqual(points, [820, 150, 100, 80, 0]);
  assert.equal(scene.points.moved![1000], 100);
  assert.equal(scene.points.moved![1079], 179);
  assert.equal(scene.points.moved![1080], -1);
  const model = new Model(scene);
  assert.equal(model.settings.colour, "status");
  near(distance(model.frames.point(1000), model.frames.point(100)), 0.8, 1e-3);
});

test("findings have places where they are drawn", async () => {
  const finding = { rule: "r", severity: "error", place: "map 0", text: "t", atlas: 0, map: 0, id: "5" };
  const findings = [{ ...finding, kind: "point", row: 0 }, { ...finding, kind: "keyframe", row: 1 }, { ...finding, kind: "map", row: -1 }, { ...finding, kind: "point", row: 999999 }];
  const model = new Model(await read({ ...hall(), header: { findings } }));
  nearPoint(findingPlace(model, 0)!, model.frames.point(0), 0);
  nearPoint(findingPlace(model, 1)!, model.frames.keyframe(1), 0);
  assert.equal(findingPlace(model, 2), null);
  assert.equal(findingPlace(model, 3), null);
});

test("search: ids by kind, in every map", async () => {
  const plain = hall({ maps: 2, keyframes: 10, points: 100 });
  plain.keyframes.ids = Int32Array.from({ length: 20 }, (_, row) => row % 10);
  const scene = await read(plain);
  assert.deepEqual(findIds(scene, "kf 3"), [{ kind: "keyframe", row: 3 }, { kind: "keyframe", row: 13 }]);
  assert.deepEqual(findIds(scene, " KF/3 "), findIds(scene, "kf 3"));
  assert.deepEqual(findIds(scene, "mp 5"), [{ kind: "point", row: 0 }]);
  assert.deepEqual(findIds(scene, "5"), [{ kind: "keyframe", row: 5 }, { kind: "keyframe", row: 15 }, { kind: "point", row: 0 }]);
  assert.deepEqual(findIds(scene, "mp 4"), []);
  assert.equal(findIds(scene, "kf"), null);
  assert.equal(findIds(scene, "<b>1</b>"), null);
});

test("edges: partners, the strongest first", async () => {
  const scene = await read(hall({ keyframes: 10 }));
  assert.deepEqual(partnersOf(scene.covisibility, 4), [{ row: 5, weight: 44 }, { row: 3, weight: 43 }]);
  assert.deepEqual(partnersOf(scene.loops, 0), [{ row: 9, weight: 0 }]);
});

test("lengths are in metres where every map says that it is metric, whatever its sensor is called", async () => {
  const scene = await read(hall({ maps: 2, sensor: "monocular" }));
  assert.equal(new Model(scene).unit, "m");
  scene.maps[1].metric = false;
  assert.equal(new Model(scene).unit, "units");
  assert.deepEqual(scene.maps.map((map) => unitOf([map])), ["m", "units"]);
});

test("words: numbers, lengths, times, ids", async () => {
  assert.equal(grouped(14061), "14,061");
  assert.equal(grouped(-1234567), "-1,234,567");
  assert.equal(rounded(30.2345), "30.23");
  assert.equal(rounded(0.012345), "0.01235");
  assert.equal(rounded(123456), "123,456");
  assert.equal(rounded(NaN), "unknown");
  assert.deepEqual([0.9, 1, 4.9, 7, 0.03, 0].map(roundStep), [0.5, 1, 2, 5, 0.02, 1]);
  assert.deepEqual([0.002, 0.5, 2, 2000].map((step) => stepText(step, "m")), ["2 mm", "50 cm", "2 m", "2 km"]);
  assert.equal(stepText(0.5, "units"), "0.5 units");
  assert.deepEqual([3.14159, 59.96, 100, 125, 179.7].map(durationText), ["3.14 s", "1 min 0 s", "1 min 40 s", "2 min 5 s", "3 min 0 s"]);
  assert.deepEqual([3599.7, 7300, 39971, 3600 * 1234].map(durationText), ["1 h 0 min", "2 h 1 min", "11 h 6 min", "1,234 h 0 min"]);
  assert.deepEqual([7, null, -1].map(idText), ["7", "none", "none"]);
  const { pixels, text } = scaleOf(0.01, "m");
  assert.equal(text, "1 m"), near(pixels, 100, 1e-9);
  const scene = await read(hall());
  assert.equal(recordedTime(scene, 5), "1403640001.25 s");
  scene.header.origin_of_time = "1403636579.9999998";
  assert.equal(recordedTime(scene, 0), "1403636579.9999998 s");
  scene.header.origin_of_time = "0.123456789";
  assert.equal(recordedTime(scene, 0), "0.123456789 s");
  assert.deepEqual([measured(30.2345, 0.05), measured(30.2345, 0.01), measured(1234, 50), measured(0.5, 0)], [30.2, 30.23, 1200, 0.5]);
  scene.points.frames.set([0.1234, 0, 0, 0.05, 0.05, 0.05], 0);
  scene.points.x[0] = scene.points.y[0] = scene.points.z[0] = 1;
  assert.equal(pointText(scene, scene.maps[0], 0), "0.2  0.1  0.1");
  assert.equal(sinceBegin(scene, 5), "1.25 s");
  assert.equal(summary(scene), "1 map, 40 keyframes, 4,000 points");
  assert.match(shortly(scene, { kind: "point", row: 3 }), /^mp 11 .* seen by 5/);
  nearPoint(octahedral(127, 0), [1, 0, 0], 1e-9);
  nearPoint(octahedral(0, 0), [0, 0, 1], 1e-9);
});

test("the address holds what is seen, and survives nonsense", async () => {
  const model = new Model(await read(hall({ maps: 2, keyframes: 10, points: 100 })));
  model.settings.colour = "age";
  model.settings.layers.grid = false;
  model.settings.time = 7;
  model.frames.visible[1] = false;
  model.frames.offsets[0].splice(0, 4, 1.5, 0, -2, 30);
  model.selection = { kind: "point", row: 42 };
  const pose = { target: [1, 2, 3] as Vec3, distance: 5, azimuth: 0.5, elevation: 1, plan: true, aside: 290 };
  const address = writeAddress(model, pose);
  const other = new Model(model.scene);
  assert.deepEqual(readAddress(other, `#${address}`), pose);
  assert.deepEqual(other.settings, model.settings);
  assert.deepEqual(other.selection, model.selection);
  assert.deepEqual(other.frames.visible, [true, false]);
  assert.deepEqual(other.frames.offsets, model.frames.offsets);
  const usual = new Model(model.scene);
  assert.equal(readAddress(usual, "#c=1,2&m=<img>&l=2&s=kf99999&t=-4&h=77&o=9:1&d=99&ps=1e9&constructor=1"), null);
  assert.deepEqual(usual.settings, new Model(model.scene).settings);
  assert.equal(usual.selection, null);
});

test("the timeline shows nothing at 0, all at the end", async () => {
  const model = new Model(await read(hall({ keyframes: 10 })));
  const { birth } = model.scene.points;
  const shown = (time: number): number => {
    model.setTime(time);
    return birth.filter((value) => value <= model.now).length;
  };
  assert.equal(shown(0), 0);
  assert.equal(shown(10), 4000);
  assert.ok(shown(5) > shown(4) && shown(4) > 0);
  assert.ok(mapOfKeyframe(model.scene, 3).index === 0);
});

test("the trajectory breaks where the camera did not go", async () => {
  const plain = hall({ keyframes: 10, points: 10 });
  plain.keyframes.origin = Int32Array.from([0, 0, 0, 0, 0, 1, 1, 1, 1, 1]);
  const model = new Model(await read(plain));
  assert.equal(isBreak(model.scene, 3, 4), false);
  assert.equal(isBreak(model.scene, 4, 5), true);
  assert.equal(buildTrajectory(model, "dark").count, 8);
  const lost = hall({ keyframes: 100, points: 100 });
  lost.keyframes.time.set(Array.from({ length: 50 }, (_, i) => 3600 + i), 50);
  lost.keyframes.pose.set([7, 0, 0], 7 * 49);
  assert.equal(isBreak(await read(lost), 49, 50), true);
});
