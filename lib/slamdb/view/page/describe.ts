// Keyframes and points in words: titles, places, and where they fly to.

import { counted, durationText, rounded } from "./format";
import type { Model, Selection } from "./model";
import { type Scene, errorOf, hasPose, idText, isHiddenPoint, mapOfKeyframe, mapOfPoint, pointsSeenBy } from "./scene";
import type { Stage } from "./stage";
import { type Vec3, distance, quantile } from "./maths";

export const keyframeName = (scene: Scene, row: number): string => `kf ${idText(scene.keyframes.ids[row])}`;
export const pointName = (scene: Scene, row: number): string => `mp ${idText(scene.points.ids[row])}`;

export const nameOf = (scene: Scene, selection: NonNullable<Selection>): string =>
  selection.kind === "keyframe" ? keyframeName(scene, selection.row) : pointName(scene, selection.row);

const kPause = 6 * 3600; // s without a keyframe: what follows is another recording
const beginsOf = new WeakMap<Scene, Float64Array>();

/** When the recording of each keyframe began: atlases have one each, or several that lie far apart. */
function begins(scene: Scene): Float64Array {
  let found = beginsOf.get(scene);
  if (!found) {
    const { time, byTime } = scene.keyframes;
    found = new Float64Array(time.length);
    const last = new Map<number, { begin: number; time: number }>(); // by atlas
    for (const row of byTime) {
      const { atlas } = mapOfKeyframe(scene, row);
      const before = last.get(atlas);
      found[row] = before && !(time[row] - before.time > kPause) ? before.begin : time[row];
      last.set(atlas, { begin: found[row], time: time[row] });
    }
    beginsOf.set(scene, found);
  }
  return found;
}

/** Since the first keyframe of its recording. */
export function sinceBegin(scene: Scene, row: number): string {
  return durationText(scene.keyframes.time[row] - begins(scene)[row]);
}

/** The time as it was recorded: the sum is the double that was stored, and has its shortest digits. */
export function recordedTime(scene: Scene, row: number): string {
  const seconds = Number(scene.header.origin_of_time) + scene.keyframes.time[row];
  return Number.isFinite(seconds) ? `${seconds} s` : "unknown";
}

/** One line, for the pointer that rests on it. */
export function shortly(scene: Scene, selection: NonNullable<Selection>): string {
  const { row } = selection;
  if (selection.kind === "keyframe") return `${keyframeName(scene, row)}  \u00b7  ${sinceBegin(scene, row)}`;
  const error = errorOf(scene, row);
  const seen = `seen by ${scene.points.observers[row]}`;
  return [pointName(scene, row), seen, error === null ? "" : `${rounded(error, 2)} px`].filter((text) => text).join("  \u00b7  ");
}

export function placeOf(model: Model, selection: NonNullable<Selection>): Vec3 | null {
  const { scene, frames } = model;
  if (selection.kind === "keyframe") return hasPose(scene, selection.row) ? frames.keyframe(selection.row) : null;
  return isHiddenPoint(scene, selection.row) ? null : frames.point(selection.row);
}

/** Selects, and flies there. */
export function visit(model: Model, stage: Stage, selection: NonNullable<Selection>): void {
  const map = selection.kind === "keyframe" ? mapOfKeyframe(model.scene, selection.row) : mapOfPoint(model.scene, selection.row);
  if (!model.frames.shown(map)) model.setVisible(map.index, true);
  model.select(selection);
  const place = placeOf(model, selection);
  if (!place) return;
  stage.flyNear(place, surroundings(model, stage, selection, place));
}

/** How far about a place one wants to see: a keyframe with what it looks at, a point with who sees it. */
function surroundings(model: Model, stage: Stage, selection: NonNullable<Selection>, place: Vec3): number {
  const usual = Math.max(stage.frustumDepth * 9, 1e-3);
  const { scene, frames } = model;
  const others = selection.kind === "keyframe"
    ? pointsSeenBy(scene, selection.row).filter((row) => !isHiddenPoint(scene, row)).map((row) => frames.point(row))
    : [...scene.points.seen.of(selection.row)].filter((row) => hasPose(scene, row)).map((row) => frames.keyframe(row));
  const away = others.map((other) => distance(place, other));
  return Math.max(usual, Math.min(usual * 4, quantile(Float64Array.from(away).sort(), 0.5) * 0.8));
}

export function summary(scene: Scene): string {
  const { maps, header } = scene;
  const atlases = header.atlases.length > 1 ? `${counted(header.atlases.length, "atlas", "atlases")}, ` : "";
  return `${atlases}${counted(maps.length, "map")}, ${counted(scene.keyframes.count, "keyframe")}, ${counted(scene.points.count, "point")}`;
}

