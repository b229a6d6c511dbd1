// What a page holds: the header as it lies in the file, and the columns, decoded. Strings of maps are shown as text only.

import { type Observers, kBlockRows } from "./columns";
import type { Quaternion, Vec3 } from "./maths";

export interface HeaderMap {
  id: number | null;
  name?: string;
  sensor?: string;
  metric: boolean; // lengths are metres
  first_keyframe: number;
  keyframes: number;
  first_point: number;
  points: number;
  up: Vec3 | null;
  statistics?: Record<string, number | null>;
}

export interface HeaderAtlas {
  name: string;
  format?: string;
  sensor?: string;
  info?: { label: string; value: string }[];
  maps: HeaderMap[];
}

export interface HeaderCamera {
  model: string;
  width: number;
  height: number;
  fx: number | null; // px; null where the model has none
  fy: number | null;
  cx: number | null; // from the corner of the image, as keypoints are
  cy: number | null;
  text?: string;
}

export type FindingKind = "keyframe" | "point" | "map" | "atlas" | "camera";

export interface Finding {
  rule: string;
  severity: string;
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
  fixed_part?: number;
  layout?: "overlay" | "side-by-side"; // of several atlases, to begin with
  atlases: HeaderAtlas[];
  cameras: HeaderCamera[];
  error_max: number;
  merged_from?: { id: number; label: string }[];
  findings?: Finding[];
  findings_left_out?: number;
  diff?: { left: number; right: number } | null;
  origin_of_time?: string;
  left_out?: string[];
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

/** In the frame of its map. */
export function pointPosition(scene: Scene, map: SceneMap, row: number): Vec3 {
  const { frames, x, y, z, far } = scene.points;
  if (far.size > 0 && far.has(row)) return [...far.get(row)!];
  const f = 6 * (map.firstBlock + Math.floor((row - map.first_point) / kBlockRows));
  return [frames[f] + frames[f + 3] * x[row], frames[f + 1] + frames[f + 4] * y[row], frames[f + 2] + frames[f + 5] * z[row]];
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

/** Of lengths in all of these maps. */
export const unitOf = (maps: SceneMap[]): string => (maps.every((map) => map.metric) ? "m" : "units");

/** Ids are 64 bits; the largest is "none". */
export const idText = (id: number | null): string => (id === null || id === -1 ? "none" : id < 0 ? String(BigInt.asUintN(64, BigInt(id))) : String(id));

export function mapTitle(scene: Scene, map: SceneMap): string {
  const name = map.name ? map.name : `map ${idText(map.id)}`;
  return scene.header.atlases.length > 1 ? `${scene.header.atlases[map.atlas].name}: ${name}` : name;
}

export const originLabel = (scene: Scene, id: number): string =>
  scene.header.merged_from?.find((from) => from.id === id)?.label ?? `map ${id}`;
