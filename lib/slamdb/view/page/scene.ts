// What a page holds: the header as it lies in the file, and the columns, decoded. Strings of maps are shown as text only.

import { type Observers, kBlockRows } from "./columns";
import type { Quaternion, Vec3 } from "./maths";

export interface HeaderMap {
  id: number | null;
  name: string;
  sensor: string;
  metric: boolean; // lengths are metres
  first_keyframe: number;
  keyframes: number;
  first_point: number;
  points: number;
  upright: Quaternion; // scene_from_map: takes the map's up to z
  statistics: Record<"trajectory_length" | "duration" | "mean_error" | "mean_observers" | "components", number | null>;
}

export interface HeaderAtlas {
  name: string;
  format: string;
  sensor: string;
  info: { label: string; value: string }[];
  maps: HeaderMap[];
}

export interface HeaderCamera {
  id: number | null;
  model: string;
  width: number;
  height: number;
  fx: number | null; // px; null where the model has none
  fy: number | null;
  cx: number | null; // from the corner of the image, as keypoints are
  cy: number | null;
  text: string;
}

export type FindingKind = "keyframe" | "point" | "map" | "atlas" | "camera";

/** A rule that found something. */
export interface HeaderRule {
  id: string;
  severity: string;
  title: string; // what holds in a sound map
  consequence: string; // where it does not
  count: number; // of its findings, also of those that are not in the page
}

export interface Finding {
  rule: string; // id of a HeaderRule
  severity: string;
  place: string; // map 0, mp 13362
  text: string;
  atlas: number;
  map: number;
  kind: FindingKind;
  row: number;
  id: string;
}

export interface Header {
  version: number;
  generator: string;
  title: string;
  layout: "overlay" | "side-by-side"; // of several atlases, to begin with
  atlases: HeaderAtlas[];
  cameras: HeaderCamera[];
  error_max: number;
  merged_from: { id: number; label: string }[];
  rules: HeaderRule[];
  findings: Finding[]; // in the order of the rules
  findings_left_out: number;
  diff: { left: number; right: number } | null;
  origin_of_time: string;
  left_out: string[];
}

/** A map of the scene: its header, and where it stands in it. */
export interface SceneMap extends HeaderMap {
  index: number; // among all maps of the scene
  atlas: number;
  firstBlock: number;
}

export interface Points {
  count: number;
  frames: Float32Array; // per block: origin x y z, step x y z
  x: Uint16Array;
  y: Uint16Array;
  z: Uint16Array;
  far: Map<number, Vec3>; // places of points that lie outside of their block's box
  ids: Int32Array | Float64Array;
  error: Uint8Array;
  seen: Observers;
  observers: Uint16Array; // how many
  birth: Uint16Array; // age rank of the first keyframe that saw it, see Keyframes.rank
  reference: Int32Array;
  normal: Int8Array | null;
  hidden: Uint8Array | null;
  status: Uint8Array | null;
  moved: Int32Array | null; // per row: the row in the left atlas, or -1
}

export interface Keyframes {
  count: number;
  ids: Int32Array | Float64Array;
  time: Float64Array;
  pose: Float32Array; // 7 a row: centre x y z, world_from_camera x y z w
  camera: Int32Array; // row of header.cameras, or -1
  origin: Int32Array | Float64Array;
  parent: Int32Array;
  flags: Uint8Array;
  status: Uint8Array | null;
  moved: Int32Array | null;
  byTime: Uint32Array; // rows in the order of time
  rank: Uint32Array; // place in byTime
}

/** Pairs of keyframe rows; weight stands in covisibility alone. */
export interface Edges {
  count: number;
  pairs: Uint32Array;
  weight: Uint32Array | null;
}

export interface Keypoints {
  begin: Uint32Array; // per keyframe, and the end
  x: Uint16Array; // eighths of a pixel
  y: Uint16Array;
  point: Int32Array;
}

export interface Scene {
  header: Header;
  maps: SceneMap[];
  points: Points;
  keyframes: Keyframes;
  covisibility: Edges;
  loops: Edges;
  merges: Edges;
  keypoints: Keypoints;
}

export const enum Status {
  same = 0,
  added = 1,
  removed = 2,
  moved = 3,
  changed = 4,
}

export const kStatusNames = ["unchanged", "added", "removed", "moved", "changed"];

export const enum KeyframeFlag {
  bad = 1,
  noPose = 2,
  first = 4,
}

/** The largest value of Points.birth; ranks are scaled to it where there are more keyframes. */
export const kLastBirth = 65534;
export const birthOf = (rank: number, keyframes: number): number =>
  keyframes <= kLastBirth ? rank : Math.floor((rank * kLastBirth) / keyframes);

/** The map that holds a row: `first` and `count` tell which table. */
function mapOfRow(maps: SceneMap[], row: number, first: "first_point" | "first_keyframe", count: "points" | "keyframes"): SceneMap {
  let low = 0;
  let high = maps.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (row >= maps[middle][first] + maps[middle][count]) low = middle + 1;
    else high = middle;
  }
  return maps[low];
}

export const mapOfPoint = (scene: Scene, row: number): SceneMap => mapOfRow(scene.maps, row, "first_point", "points");
export const mapOfKeyframe = (scene: Scene, row: number): SceneMap => mapOfRow(scene.maps, row, "first_keyframe", "keyframes");

/** Writes the position of a point, in the frame of its map, into `places` from `at` on. */
export function placePoint(scene: Scene, map: SceneMap, row: number, places: Float32Array | Float64Array, at: number): void {
  const { frames, x, y, z, far } = scene.points;
  if (far.size > 0 && far.has(row)) return places.set(far.get(row)!, at);
  const f = 6 * (map.firstBlock + Math.floor((row - map.first_point) / kBlockRows));
  places[at] = frames[f] + frames[f + 3] * x[row];
  places[at + 1] = frames[f + 1] + frames[f + 4] * y[row];
  places[at + 2] = frames[f + 2] + frames[f + 5] * z[row];
}

/** In the frame of its map. */
export function pointPosition(scene: Scene, map: SceneMap, row: number): Vec3 {
  const place = new Float64Array(3);
  placePoint(scene, map, row, place, 0);
  return [place[0], place[1], place[2]];
}

let lastSeen: { scene: Scene; keyframe: number; points: number[] } | null = null;

/** Rows of the points that a keyframe sees, by the points' own word. The last answer is kept: several ask for the same. */
export function pointsSeenBy(scene: Scene, keyframe: number): number[] {
  if (lastSeen?.scene !== scene || lastSeen.keyframe !== keyframe) {
    const map = mapOfKeyframe(scene, keyframe);
    lastSeen = { scene, keyframe, points: scene.points.seen.seenBy(keyframe, map.first_point, map.first_point + map.points) };
  }
  return lastSeen.points;
}

/** How far places that differ are apart in each direction; 0 for a point that is stored as it is. */
export function pointStep(scene: Scene, map: SceneMap, row: number): Vec3 {
  const { frames, far } = scene.points;
  if (far.has(row)) return [0, 0, 0];
  const f = 6 * (map.firstBlock + Math.floor((row - map.first_point) / kBlockRows));
  return [frames[f + 3], frames[f + 4], frames[f + 5]];
}

export function keyframeCentre(scene: Scene, row: number): Vec3 {
  const { pose } = scene.keyframes;
  return [pose[7 * row], pose[7 * row + 1], pose[7 * row + 2]];
}

export function keyframeRotation(scene: Scene, row: number): Quaternion {
  const { pose } = scene.keyframes;
  return [pose[7 * row + 3], pose[7 * row + 4], pose[7 * row + 5], pose[7 * row + 6]];
}

/** Whether it can be drawn. */
export const hasPose = (scene: Scene, row: number): boolean =>
  (scene.keyframes.flags[row] & KeyframeFlag.noPose) === 0 && Number.isFinite(scene.keyframes.pose[7 * row]);

export const isHiddenPoint = (scene: Scene, row: number): boolean => (scene.points.hidden?.[row] ?? 0) !== 0;

/** px; null where unknown. */
export function errorOf(scene: Scene, row: number): number | null {
  const value = scene.points.error[row];
  return value === 0 ? null : scene.header.error_max * ((value - 1) / 254) ** 2;
}

/** px between two errors that differ, about that of a point; errors are stored by their square roots. */
export const errorStep = (scene: Scene, row: number): number =>
  scene.header.error_max * (2 * Math.max(1, scene.points.error[row]) - 1) / 254 ** 2;

/** Of lengths in all of these maps. */
export const unitOf = (maps: SceneMap[]): string => (maps.every((map) => map.metric) ? "m" : "units");

/** Ids are 64 bits; the largest is "none". */
export const idText = (id: number | null): string => (id === null || id === -1 ? "none" : id < 0 ? String(BigInt.asUintN(64, BigInt(id))) : String(id));

export function mapTitle(scene: Scene, map: SceneMap): string {
  const { atlases } = scene.header;
  const atlas = atlases[map.atlas];
  if (atlases.length < 2) return map.name;
  return atlas.maps.length > 1 ? `${atlas.name}: ${map.name}` : atlas.name;
}

export const originLabel = (scene: Scene, id: number): string =>
  scene.header.merged_from.find((from) => from.id === id)?.label ?? `map ${id}`;
