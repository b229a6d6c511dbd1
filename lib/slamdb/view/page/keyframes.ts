// Keyframes as drawn: frusta, the trajectory through their centres, and a mark at each centre to pick it by.

import { type Rgb, category, statusColour, type Theme } from "./colours";
import { drawnStatuses } from "./frames";
import { type Vec3, add, clamp, distance, length, quantile, scale, subtract } from "./maths";
import type { Model } from "./model";
import { inOrder } from "./points";
import { type HeaderCamera, type Scene, type SceneMap, KeyframeFlag, Status, birthOf, hasPose, keyframeCentre, mapOfKeyframe } from "./scene";
import { Lines, Marks } from "./shapes";
import { kPaint } from "./theme";

/** Numbers of keyframes among all that can be picked. */
export const kKeyframeBit = 0x80000000;

/** Whether it has a place, its map is shown, and its status is asked for. */
export function isDrawnKeyframe(model: Model, row: number): boolean {
  const { scene, frames, settings } = model;
  const map = mapOfKeyframe(scene, row);
  if (!frames.shown(map) || !hasPose(scene, row)) return false;
  return (drawnStatuses(scene, map, settings.statuses) & (1 << (scene.keyframes.status?.[row] ?? 0))) !== 0;
}

interface Steps {
  length: number; // from one keyframe to the next, the median
  time: number;
}

const stepsOf = new WeakMap<Scene, Steps>();

function usualSteps(scene: Scene): Steps {
  let steps = stepsOf.get(scene);
  if (!steps) {
    const lengths: number[] = [];
    const times: number[] = [];
    for (const map of scene.maps) {
      const rows = inTime(scene, map);
      for (let i = 1; i < rows.length; ++i) {
        lengths.push(distance(keyframeCentre(scene, rows[i - 1]), keyframeCentre(scene, rows[i])));
        times.push(scene.keyframes.time[rows[i]] - scene.keyframes.time[rows[i - 1]]);
      }
    }
    steps = { length: quantile(Float64Array.from(lengths).sort(), 0.5), time: quantile(Float64Array.from(times).sort(), 0.5) };
    stepsOf.set(scene, steps);
  }
  return steps;
}

/** Depth of a frustum that suits the scene: some steps from one keyframe to the next. */
export const usualFrustum = (scene: Scene, extent: number): number => clamp(usualSteps(scene).length * 2.2, extent * 0.006, extent * 0.03);

/** What plots and evaluations call a gap (GapBetween of model/detail/gaps.h), in seconds. */
const gapOf = (usual: Steps): number => Math.max(1, usual.time * 5);

/** Whether the camera did not go from one to the other: another origin map, or far away behind a gap. */
export function isBreak(scene: Scene, from: number, to: number): boolean {
  const { origin, time } = scene.keyframes;
  if (origin[from] !== origin[to]) return true;
  const usual = usualSteps(scene);
  return time[to] - time[from] > gapOf(usual) && distance(keyframeCentre(scene, from), keyframeCentre(scene, to)) > usual.length * 5;
}

/** Rows of a map's keyframes that have a place, in the order of time. */
export function inTime(scene: Scene, map: SceneMap): number[] {
  const rows: number[] = [];
  for (let row = map.first_keyframe; row < map.first_keyframe + map.keyframes; ++row) {
    if (hasPose(scene, row) && (scene.keyframes.flags[row] & KeyframeFlag.bad) === 0) rows.push(row);
  }
  return rows.sort((a, b) => scene.keyframes.rank[a] - scene.keyframes.rank[b]);
}

export interface Frustum {
  centre: Vec3;
  corners: [Vec3, Vec3, Vec3, Vec3]; // of the image: left above, right above, right below, left below
}

export interface ImagePlane {
  centre: Vec3;
  at: (x: number, y: number) => Vec3; // of a pixel
}

/** What is not known of a camera is drawn as a usual one would be. */
function lensOf(camera: HeaderCamera | undefined): { fx: number; fy: number; cx: number; cy: number } {
  const width = camera && camera.width > 0 ? camera.width : 640;
  const height = camera && camera.height > 0 ? camera.height : 480;
  const fx = camera?.fx && camera.fx > 0 ? camera.fx : width * 0.8;
  const fy = camera?.fy && camera.fy > 0 ? camera.fy : fx;
  return { fx, fy, cx: camera?.cx ?? width / 2, cy: camera?.cy ?? height / 2 };
}

/** The image of a keyframe, `depth` before its camera. */
export function imagePlane(model: Model, row: number, depth: number): ImagePlane {
  const { scene, frames } = model;
  const camera = scene.header.cameras[scene.keyframes.camera[row]];
  const { fx, fy, cx, cy } = lensOf(camera);
  // Fisheye images are wider than any plane: drawn as wide as looks like a camera.
  const wide = Math.max(1, cx / fx / 1.1, cy / fy / 1.1);
  const centre = frames.keyframe(row);
  const right = scale(frames.direction(row, [1, 0, 0]), depth / wide);
  const down = scale(frames.direction(row, [0, 1, 0]), depth / wide);
  const middle = add(centre, scale(frames.direction(row, [0, 0, 1]), depth));
  return { centre, at: (x, y) => add(middle, add(scale(right, (x - cx) / fx), scale(down, (y - cy) / fy))) };
}

export function frustum(model: Model, row: number, depth: number): Frustum {
  const camera = model.scene.header.cameras[model.scene.keyframes.camera[row]];
  const { centre, at } = imagePlane(model, row, depth);
  const width = camera && camera.width > 0 ? camera.width : 640;
  const height = camera && camera.height > 0 ? camera.height : 480;
  return { centre, corners: [at(0, 0), at(width, 0), at(width, height), at(0, height)] };
}

export function addFrustum(lines: Lines, { centre, corners }: Frustum, colour: Rgb, alpha: number, birth: number, number: number): void {
  for (let i = 0; i < 4; ++i) {
    lines.add(centre, corners[i], colour, alpha, birth, number);
    lines.add(corners[i], corners[(i + 1) % 4], colour, alpha, birth, number);
  }
  // A tick above the image tells which way is up.
  const top = subtract(corners[1], corners[0]);
  const up = subtract(corners[0], corners[3]);
  const tip = add(add(corners[0], scale(top, 0.5)), scale(up, (0.12 * length(top)) / (length(up) || 1)));
  lines.add(add(corners[0], scale(top, 0.4)), tip, colour, alpha, birth, number);
  lines.add(add(corners[0], scale(top, 0.6)), tip, colour, alpha, birth, number);
}

/** What a keyframe is drawn in: its map's colour where the cloud is coloured so, its status in a comparison. */
function keyframeColour(model: Model, map: SceneMap, row: number, theme: Theme, usual: Rgb): Rgb {
  const { scene, settings } = model;
  const status = scene.keyframes.status?.[row] ?? Status.same;
  if (scene.header.diff && status !== Status.same) return statusColour(status, theme);
  return settings.colour === "map" && scene.maps.length > 1 ? category(map.index, theme) : usual;
}

export function buildFrusta(model: Model, theme: Theme, depth: number): Lines {
  const lines = new Lines();
  const { scene } = model;
  // Where they overlap much, each is fainter.
  const alpha = 0.62 * clamp((usualSteps(scene).length * 2.5) / depth, 0.22, 1);
  inOrder(scene.keyframes.count, (row) => {
    if (!isDrawnKeyframe(model, row)) return;
    const colour = keyframeColour(model, mapOfKeyframe(scene, row), row, theme, kPaint[theme].frusta);
    const birth = birthOf(scene.keyframes.rank[row], scene.keyframes.count);
    addFrustum(lines, frustum(model, row, depth), colour, alpha, birth, kKeyframeBit + row);
  });
  return lines;
}

export function buildCentres(model: Model, theme: Theme): Marks {
  const marks = new Marks();
  const { scene, frames } = model;
  for (let row = 0; row < scene.keyframes.count; ++row) {
    if (!isDrawnKeyframe(model, row)) continue;
    const colour = keyframeColour(model, mapOfKeyframe(scene, row), row, theme, kPaint[theme].trajectory);
    marks.add(frames.keyframe(row), colour, 1, birthOf(scene.keyframes.rank[row], scene.keyframes.count), kKeyframeBit + row);
  }
  return marks;
}

export function buildTrajectory(model: Model, theme: Theme): Lines {
  const lines = new Lines();
  const { scene, frames } = model;
  for (const map of scene.maps) {
    let last = -1;
    for (const row of inTime(scene, map)) {
      if (!isDrawnKeyframe(model, row)) {
        last = -1;
        continue;
      }
      const colour = keyframeColour(model, map, row, theme, kPaint[theme].trajectory);
      const birth = birthOf(scene.keyframes.rank[row], scene.keyframes.count);
      if (last >= 0 && !isBreak(scene, last, row)) lines.add(frames.keyframe(last), frames.keyframe(row), colour, 1, birth, kKeyframeBit + row);
      last = row;
    }
  }
  return lines;
}
