// Writes the columns of schema/view.md, from that page alone: the reader is tested against it.

import { deflateSync } from "node:zlib";

export interface PlainMap {
  id: number;
  keyframes: number;
  points: number;
  upright?: [number, number, number, number];
  sensor?: string;
  metric?: boolean;
  name?: string;
}

/** A scene before it is packed: rows over all maps, in their order. */
export interface PlainScene {
  title: string;
  atlases: { name: string; sensor: string; maps: PlainMap[]; info?: { label: string; value: string }[] }[];
  cameras: { id: number; model: string; width: number; height: number; fx: number; fy: number; cx: number; cy: number; text?: string }[];
  header?: Record<string, unknown>;
  points: {
    positions: Float32Array;
    ids: ArrayLike<number>;
    error: Uint8Array;
    seen: (row: number) => number[]; // keyframe rows, ascending
    reference: ArrayLike<number>;
    status?: Uint8Array;
    moved?: Map<number, number>; // right row -> left row
    hidden?: Uint8Array;
    far?: Map<number, [number, number, number]>;
  };
  keyframes: {
    ids: ArrayLike<number>;
    time: Float64Array;
    pose: Float32Array;
    camera: ArrayLike<number>; // row or -1
    origin: ArrayLike<number>;
    parent: ArrayLike<number>; // row or -1
    flags: Uint8Array;
    status?: Uint8Array;
    moved?: Map<number, number>;
  };
  covisibility?: [number, number, number][]; // first < second, ascending; weight
  loops?: [number, number][];
  merges?: [number, number][];
  keypoints?: { x: number[]; y: number[]; point: number[] }[]; // pixels; per keyframe
}

export class Bytes {
  private bytes = new Uint8Array(1024);
  size = 0;

  byte(value: number): void {
    if (this.size === this.bytes.length) {
      const larger = new Uint8Array(this.bytes.length * 2);
      larger.set(this.bytes);
      this.bytes = larger;
    }
    this.bytes[this.size++] = value;
  }

  varint(value: number): void {
    while (value >= 128) {
      this.byte(128 + (value % 128));
      value = Math.floor(value / 128);
    }
    this.byte(value);
  }

  zigzag(value: number): void {
    this.varint(value >= 0 ? value * 2 : -value * 2 - 1);
  }

  done(): Uint8Array {
    return this.bytes.subarray(0, this.size);
  }
}

const kBlock = 4096;
const bytesOf = (array: ArrayBufferView): Uint8Array => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);

function differences(values: ArrayLike<number>): Uint8Array {
  const out = new Bytes();
  for (let i = 0, last = 0; i < values.length; last = values[i++]) out.zigzag(values[i] - last);
  return out.done();
}

function plainVarints(values: number[]): Uint8Array {
  const out = new Bytes();
  values.forEach((value) => out.varint(value));
  return out.done();
}

/** Boxes of blocks, and the columns of x, y and z. */
function quantise(scene: PlainScene): { frame: Float32Array; axes: Uint8Array[] } {
  const { positions, far } = scene.points;
  const frames: number[] = [];
  const axes = [0, 1, 2].map(() => new Uint8Array((positions.length / 3) * 2));
  let first = 0;
  for (const map of scene.atlases.flatMap((atlas) => atlas.maps)) {
    for (let begin = 0; begin < map.points; begin += kBlock) {
      const size = Math.min(kBlock, map.points - begin);
      const origin: number[] = [];
      const step: number[] = [];
      for (let axis = 0; axis < 3; ++axis) {
        let low = Infinity, high = -Infinity;
        const at = (i: number): number => positions[3 * (first + begin + i) + axis];
        for (let i = 0; i < size; ++i) {
          if (!Number.isFinite(at(i)) || far?.has(first + begin + i)) continue;
          [low, high] = [Math.min(low, at(i)), Math.max(high, at(i))];
        }
        const [o, s] = low <= high ? [Math.fround(low), Math.fround(Math.max((high - low) / 65535, 1e-9))] : [0, 1];
        origin.push(o);
        step.push(s);
        for (let i = 0, last = 0; i < size; ++i) {
          const value = at(i);
          const q = Number.isFinite(value) && !far?.has(first + begin + i) ? Math.min(65535, Math.max(0, Math.round((value - o) / s))) : 0;
          const difference = (q - last + 65536) & 0xffff;
          last = q;
          axes[axis][2 * (first + begin) + i] = difference & 255;
          axes[axis][2 * (first + begin) + size + i] = difference >> 8;
        }
      }
      frames.push(...origin, ...step);
    }
    first += map.points;
  }
  return { frame: Float32Array.from(frames), axes };
}

function seenColumn(scene: PlainScene): Uint8Array {
  const out = new Bytes();
  let base = 0;
  for (let row = 0; row < scene.points.positions.length / 3; ++row) {
    const seen = scene.points.seen(row);
    out.varint(seen.length);
    seen.forEach((keyframe, i) => (i === 0 ? out.zigzag(keyframe - base) : out.varint(keyframe - seen[i - 1])));
    if (seen.length > 0) base = seen[0];
  }
  return out.done();
}

const kFromYDown = [-Math.SQRT1_2, 0, 0, Math.SQRT1_2];
const kNoStatistics = { trajectory_length: null, duration: null, mean_error: null, mean_observers: null, components: null };

function headerOf(scene: PlainScene): Uint8Array {
  let point = 0;
  let keyframe = 0;
  const atlases = scene.atlases.map((atlas) => ({
    info: [], format: "ORB-SLAM3 atlas", ...atlas,
    maps: atlas.maps.map((map) => {
      const placed = { name: `map ${map.id}`, sensor: atlas.sensor, metric: true, upright: kFromYDown, statistics: kNoStatistics, ...map, first_point: point, first_keyframe: keyframe };
      point += map.points;
      keyframe += map.keyframes;
      return placed;
    }),
  }));
  const findings = (scene.header?.findings ?? []) as { rule: string; severity: string }[];
  const rules = [...new Set(findings.map(({ rule }) => rule))].map((id) => {
    const found = findings.filter(({ rule }) => rule === id);
    return { id, severity: found[0].severity, title: "all is well", consequence: "stumbles", count: found.length };
  });
  const header = {
    version: 1, generator: "slamdb test", title: scene.title, fixed_part: 0, layout: "overlay", atlases, cameras: scene.cameras.map((camera) => ({ text: camera.model, ...camera })), error_max: 8, merged_from: [], rules, findings: [],
    findings_left_out: 0, diff: null, origin_of_time: "1403640000.000000001", left_out: [], ...scene.header,
  };
  return new TextEncoder().encode(JSON.stringify(header));
}

/** All columns by name, before they are packed. */
export function columnsOf(scene: PlainScene): Map<string, Uint8Array> {
  const { points, keyframes } = scene;
  const columns = new Map<string, Uint8Array>([["header", headerOf(scene)]]);
  const { frame, axes } = quantise(scene);
  columns.set("points/frame", bytesOf(frame));
  ["x", "y", "z"].forEach((axis, i) => columns.set(`points/${axis}`, axes[i]));
  columns.set("points/id", differences(points.ids));
  columns.set("points/error", points.error);
  columns.set("points/seen", seenColumn(scene));
  columns.set("points/reference", differences(points.reference));
  if (points.far) {
    columns.set("points/far_row", differences([...points.far.keys()]));
    columns.set("points/far", bytesOf(Float32Array.from([...points.far.values()].flat())));
  }
  if (points.status) columns.set("points/status", points.status);
  if (points.moved) columns.set("points/moved", differences([...points.moved.values()]));
  if (points.hidden) columns.set("points/hidden", points.hidden);
  columns.set("keyframes/id", differences(keyframes.ids));
  columns.set("keyframes/time", bytesOf(keyframes.time));
  columns.set("keyframes/pose", bytesOf(keyframes.pose));
  columns.set("keyframes/camera", plainVarints(Array.from(keyframes.camera, (row) => row + 1)));
  columns.set("keyframes/origin", plainVarints(Array.from(keyframes.origin)));
  const parent = new Bytes();
  Array.from(keyframes.parent).forEach((row, own) => parent.zigzag(row - own));
  columns.set("keyframes/parent", parent.done());
  columns.set("keyframes/flags", keyframes.flags);
  if (keyframes.status) columns.set("keyframes/status", keyframes.status);
  if (keyframes.moved) columns.set("keyframes/moved", differences([...keyframes.moved.values()]));
  for (const [name, bytes] of edgeColumns(scene)) columns.set(name, bytes);
  if (scene.keypoints) for (const [name, bytes] of keypointColumns(scene.keypoints)) columns.set(name, bytes);
  return columns;
}

function edgeColumns(scene: PlainScene): [string, Uint8Array][] {
  const covisibility = new Bytes();
  const byFirst = new Map<number, [number, number][]>();
  for (const [a, b, weight] of scene.covisibility ?? []) byFirst.set(a, [...(byFirst.get(a) ?? []), [b, weight]]);
  for (let row = 0; row < scene.keyframes.ids.length; ++row) {
    const partners = byFirst.get(row) ?? [];
    covisibility.varint(partners.length);
    partners.forEach(([partner, weight], i) => {
      covisibility.varint(partner - (i === 0 ? row : partners[i - 1][0]));
      covisibility.varint(weight);
    });
  }
  const pairs = (list: [number, number][]): Uint8Array => {
    const out = new Bytes();
    list.forEach(([a, b], i) => {
      out.zigzag(a - (i === 0 ? 0 : list[i - 1][0]));
      out.zigzag(b - a);
    });
    return out.done();
  };
  return [["edges/covisibility", covisibility.done()], ["edges/loop", pairs(scene.loops ?? [])], ["edges/merge", pairs(scene.merges ?? [])]];
}

function keypointColumns(keypoints: NonNullable<PlainScene["keypoints"]>): [string, Uint8Array][] {
  const eighths = (values: number[]): Uint8Array => bytesOf(Uint16Array.from(values, (value) => Math.round(value * 8)));
  const point = new Bytes();
  for (const { point: rows } of keypoints) rows.forEach((row, i) => point.zigzag(row - (i === 0 ? 0 : rows[i - 1])));
  return [
    ["keypoints/count", plainVarints(keypoints.map(({ point: rows }) => rows.length))],
    ["keypoints/x", eighths(keypoints.flatMap(({ x }) => x))],
    ["keypoints/y", eighths(keypoints.flatMap(({ y }) => y))],
    ["keypoints/point", point.done()],
  ];
}

export interface PackedPart {
  name: string;
  part: number;
  text: string;
}

/** Columns without bytes have no block. */
export function pack(columns: Map<string, Uint8Array>, partBytes = 4 << 20): PackedPart[] {
  const parts: PackedPart[] = [];
  for (const [name, bytes] of columns) {
    for (let begin = 0, part = 0; begin < bytes.length; begin += partBytes, ++part) {
      parts.push({ name, part, text: deflateSync(bytes.subarray(begin, begin + partBytes), { level: 1 }).toString("base64") });
    }
  }
  return parts;
}

export const blocksOfParts = (parts: PackedPart[]): string =>
  parts.map(({ name, part, text }) => `<script type="text/plain" data-name="${name}" data-part="${part}">${text}</script>`).join("\n");
