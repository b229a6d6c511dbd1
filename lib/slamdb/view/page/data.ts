// From the data blocks of the page to a Scene: base64, zlib, columns (schema/view.md). Parts are unpacked side by side, and
// the browser is let in between, so that the bar moves.

import {
  DamagedData, Observers, Varints, expectBytes, kBlockRows, readDifferences, readQuantised, readRows,
} from "./columns";
import { type Edges, type Header, type Keyframes, type Keypoints, type Points, type Scene, type SceneMap, Status, birthOf } from "./scene";

/** A part of a column. `take` gives its base64 text, once: the page drops it there, to need its memory once only. */
export interface Block {
  name: string;
  part: number;
  size: number;
  take: () => string;
}

export type Progress = (share: number, what: string) => void;

const kVersion = 1;
const kSideBySide = 4;

export async function readScene(blocks: Block[], progress: Progress): Promise<Scene> {
  if (typeof DecompressionStream === "undefined") {
    throw new DamagedData("This browser is too old to unpack the map: it has no DecompressionStream. Firefox 113, Chrome 80, Safari 16.4 and later have it.");
  }
  const columns = await unpackAll(blocks, progress);
  progress(0.7, "Reading the map");
  await breathe();
  const header = readHeader(columns.need("header"));
  const maps = placeMaps(header);
  const keyframes = readKeyframes(columns, header, maps);
  await breathe();
  const points = await readPoints(columns, header, maps, keyframes, progress);
  const scene: Scene = {
    header, maps, points, keyframes,
    covisibility: readCovisibility(columns.maybe("edges/covisibility"), keyframes.count),
    loops: readPairs(columns.maybe("edges/loop"), keyframes.count, "edges/loop"),
    merges: readPairs(columns.maybe("edges/merge"), keyframes.count, "edges/merge"),
    keypoints: readKeypoints(columns, keyframes.count, points.count),
  };
  progress(1, "Drawing");
  await breathe();
  return scene;
}

/** Lets the browser paint and answer. */
export const breathe = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 0));

class Columns {
  private readonly bytes = new Map<string, Uint8Array>();
  set(name: string, bytes: Uint8Array): void {
    this.bytes.set(name, bytes);
  }
  /** Gives a column away: who reads it decides how long it lives. */
  maybe(name: string): Uint8Array | null {
    const bytes = this.bytes.get(name) ?? null;
    this.bytes.delete(name);
    return bytes;
  }
  need(name: string): Uint8Array {
    const bytes = this.maybe(name);
    if (!bytes) throw new DamagedData(`The page holds no column ${name}: the file is not whole.`);
    return bytes;
  }
  orEmpty(name: string): Uint8Array {
    return this.maybe(name) ?? new Uint8Array(0);
  }
}

async function unpackAll(blocks: Block[], progress: Progress): Promise<Columns> {
  const parts = new Map<string, Uint8Array[]>();
  const total = blocks.reduce((sum, block) => sum + block.size, 1);
  let done = 0;
  let next = 0;
  const work = async (): Promise<void> => {
    while (next < blocks.length) {
      const block = blocks[next++];
      const bytes = await unpack(block);
      let list = parts.get(block.name);
      if (!list) parts.set(block.name, (list = []));
      list[block.part] = bytes;
      done += block.size;
      progress((0.7 * done) / total, "Unpacking the map");
    }
  };
  await Promise.all(Array.from({ length: kSideBySide }, work));
  const columns = new Columns();
  for (const [name, list] of parts) {
    for (let part = 0; part < list.length; ++part) {
      if (!list[part]) throw new DamagedData(`Part ${part} of column ${name} is missing: the file is not whole.`);
    }
    columns.set(name, joined(list));
  }
  return columns;
}

async function unpack(block: Block): Promise<Uint8Array> {
  try {
    const packed = fromBase64(block.take());
    const stream = new Blob([packed as BlobPart]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch (error) {
    const reason = error instanceof Error ? error.message : String(error);
    throw new DamagedData(`Part ${block.part} of column ${block.name} cannot be unpacked: the file is damaged (${reason}).`);
  }
}

export function fromBase64(text: string): Uint8Array {
  const native = (Uint8Array as unknown as { fromBase64?: (text: string) => Uint8Array }).fromBase64;
  if (native) return native.call(Uint8Array, text);
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

/** In memory of its own and from its begin, so that wider views of it are aligned. */
function joined(list: Uint8Array[]): Uint8Array {
  if (list.length === 1) return list[0];
  const bytes = new Uint8Array(list.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of list) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

function readHeader(bytes: Uint8Array): Header {
  let header: Header;
  try {
    header = JSON.parse(new TextDecoder().decode(bytes)) as Header;
  } catch {
    throw new DamagedData("The header cannot be read: the file is damaged.");
  }
  if (header.version !== kVersion) {
    throw new DamagedData(`The data has version ${header.version}, the page reads version ${kVersion}: the file was put together from two.`);
  }
  return header;
}

function placeMaps(header: Header): SceneMap[] {
  const maps: SceneMap[] = [];
  let block = 0;
  let point = 0;
  let keyframe = 0;
  header.atlases.forEach((atlas, index) => {
    for (const map of atlas.maps) {
      if (map.first_point !== point || map.first_keyframe !== keyframe) {
        throw new DamagedData(`The rows of map ${map.id} do not follow those of the map before.`);
      }
      maps.push({ ...map, index: maps.length, atlas: index, firstBlock: block });
      block += Math.ceil(map.points / kBlockRows);
      point += map.points;
      keyframe += map.keyframes;
    }
  });
  return maps;
}

function rowsOf(maps: SceneMap[], which: "points" | "keyframes"): number {
  return maps.reduce((sum, map) => sum + map[which], 0);
}

function floats(bytes: Uint8Array, count: number, name: string): Float32Array {
  expectBytes(bytes, count * 4, name);
  return new Float32Array(bytes.buffer, bytes.byteOffset, count);
}

async function readPoints(columns: Columns, header: Header, maps: SceneMap[], keyframes: Keyframes, progress: Progress): Promise<Points> {
  const count = rowsOf(maps, "points");
  const rows = maps.map((map) => map.points);
  const blocks = rows.reduce((sum, n) => sum + Math.ceil(n / kBlockRows), 0);
  const frames = floats(columns.orEmpty("points/frame"), blocks * 6, "points/frame");
  const x = readQuantised(columns.orEmpty("points/x"), rows, "points/x");
  const y = readQuantised(columns.orEmpty("points/y"), rows, "points/y");
  const z = readQuantised(columns.orEmpty("points/z"), rows, "points/z");
  progress(0.8, "Reading points");
  await breathe();
  const ids = readDifferences(columns.orEmpty("points/id"), count, "points/id");
  const error = columns.maybe("points/error") ?? new Uint8Array(count);
  expectBytes(error, count, "points/error");
  const reference = readRows(columns.orEmpty("points/reference"), count, keyframes.count, "points/reference");
  progress(0.87, "Reading observations");
  await breathe();
  const observers = new Uint16Array(count);
  const birth = new Uint16Array(count);
  const seen = new Observers(columns.orEmpty("points/seen"), count, keyframes.count, (row, buffer, size) => {
    observers[row] = Math.min(size, 65535);
    let first = size > 0 ? keyframes.rank[buffer[0]] : reference[row] >= 0 ? keyframes.rank[reference[row]] : 0;
    for (let i = 1; i < size; ++i) first = Math.min(first, keyframes.rank[buffer[i]]);
    birth[row] = birthOf(first, keyframes.count);
  });
  progress(0.95, "Reading points");
  await breathe();
  const normal = columns.maybe("points/normal");
  const status = columns.maybe("points/status");
  const hidden = columns.maybe("points/hidden");
  if (normal) expectBytes(normal, count * 2, "points/normal");
  if (status) expectBytes(status, count, "points/status");
  if (hidden) expectBytes(hidden, count, "points/hidden");
  return {
    count, frames, x, y, z, far: readFar(columns, count), ids, error, seen, observers, birth, reference, hidden, status,
    normal: normal ? new Int8Array(normal.buffer, normal.byteOffset, normal.length) : null,
    moved: readMoved(columns.maybe("points/moved"), status, rightRows(header, maps, "points"), "points/moved"),
  };
}

/** Where points are that lie far out of their block's box, by row. */
function readFar(columns: Columns, points: number): Map<number, [number, number, number]> {
  const places = columns.orEmpty("points/far");
  const values = floats(places, places.length >> 2, "points/far");
  const input = new Varints(columns.orEmpty("points/far_row"), "points/far_row");
  const far = new Map<number, [number, number, number]>();
  let row = 0;
  for (let i = 0; i + 2 < values.length; i += 3) {
    row += input.signed();
    if (row < 0 || row >= points) throw new DamagedData(`column points/far_row names row ${row} of ${points}`);
    far.set(row, [values[i], values[i + 1], values[i + 2]]);
  }
  input.finish();
  return far;
}

/** Which row of the left atlas a moved row of the right one was. Rows without a partner are not in the column. */
function readMoved(bytes: Uint8Array | null, status: Uint8Array | null, right: [number, number], name: string): Int32Array | null {
  if (!bytes || !status) return null;
  const rows = status.length;
  const partners = new Int32Array(rows).fill(-1);
  const input = new Varints(bytes, name);
  let last = 0;
  for (let row = right[0]; row < right[1]; ++row) {
    if (status[row] !== Status.moved) continue;
    last += input.signed();
    if (last < 0 || last >= rows) throw new DamagedData(`column ${name} names row ${last} of ${rows}`);
    partners[row] = last;
  }
  input.finish();
  return partners;
}

/** The rows of the right atlas of a comparison: from, to. */
function rightRows(header: Header, maps: SceneMap[], which: "points" | "keyframes"): [number, number] {
  const first = which === "points" ? "first_point" : "first_keyframe";
  const right = maps.filter((map) => map.atlas === header.diff?.right);
  if (right.length === 0) return [0, 0];
  const last = right[right.length - 1];
  return [right[0][first], last[first] + last[which]];
}

function readKeyframes(columns: Columns, header: Header, maps: SceneMap[]): Keyframes {
  const count = rowsOf(maps, "keyframes");
  const ids = readDifferences(columns.orEmpty("keyframes/id"), count, "keyframes/id");
  const timeBytes = columns.orEmpty("keyframes/time");
  expectBytes(timeBytes, count * 8, "keyframes/time");
  const time = new Float64Array(timeBytes.buffer, timeBytes.byteOffset, count);
  const pose = floats(columns.orEmpty("keyframes/pose"), count * 7, "keyframes/pose");
  const camera = new Int32Array(count);
  const origin = new Float64Array(count);
  const parent = new Int32Array(count);
  const cameras = new Varints(columns.orEmpty("keyframes/camera"), "keyframes/camera");
  const origins = new Varints(columns.orEmpty("keyframes/origin"), "keyframes/origin");
  const parents = new Varints(columns.orEmpty("keyframes/parent"), "keyframes/parent");
  for (let row = 0; row < count; ++row) {
    camera[row] = cameras.next() - 1;
    origin[row] = origins.next();
    parent[row] = parents.signed() + row;
    if (camera[row] >= header.cameras.length) throw new DamagedData(`keyframe row ${row} names camera ${camera[row]}`);
    if (parent[row] < -1 || parent[row] >= count) throw new DamagedData(`keyframe row ${row} names parent row ${parent[row]}`);
  }
  for (const input of [cameras, origins, parents]) input.finish();
  const flags = columns.maybe("keyframes/flags") ?? new Uint8Array(count);
  expectBytes(flags, count, "keyframes/flags");
  const status = columns.maybe("keyframes/status");
  if (status) expectBytes(status, count, "keyframes/status");
  const moved = readMoved(columns.maybe("keyframes/moved"), status, rightRows(header, maps, "keyframes"), "keyframes/moved");
  return { count, ids, time, pose, camera, origin, parent, flags, status, moved, ...timeOrder(time) };
}

/** Ties and times that are no numbers keep the order of rows. */
function timeOrder(time: Float64Array): { byTime: Uint32Array; rank: Uint32Array } {
  const byTime = Uint32Array.from(time.keys());
  byTime.sort((a, b) => time[a] - time[b] || a - b);
  const rank = new Uint32Array(time.length);
  byTime.forEach((row, place) => (rank[row] = place));
  return { byTime, rank };
}

function readCovisibility(bytes: Uint8Array | null, keyframes: number): Edges {
  if (!bytes) return { count: 0, pairs: new Uint32Array(0), weight: null };
  const pairs: number[] = [];
  const weight: number[] = [];
  const input = new Varints(bytes, "edges/covisibility");
  for (let row = 0; row < keyframes; ++row) {
    let partner = row;
    for (let left = input.next(); left > 0; --left) {
      partner += input.next();
      if (partner >= keyframes) throw new DamagedData(`column edges/covisibility names keyframe row ${partner}`);
      pairs.push(row, partner);
      weight.push(input.next());
    }
  }
  input.finish();
  return { count: weight.length, pairs: Uint32Array.from(pairs), weight: Uint32Array.from(weight) };
}

function readPairs(bytes: Uint8Array | null, keyframes: number, name: string): Edges {
  const pairs: number[] = [];
  const input = new Varints(bytes ?? new Uint8Array(0), name);
  let first = 0;
  while (!input.atEnd) {
    first += input.signed();
    const second = first + input.signed();
    if (Math.min(first, second) < 0 || Math.max(first, second) >= keyframes) throw new DamagedData(`column ${name} names keyframe rows ${first} and ${second}`);
    pairs.push(first, second);
  }
  return { count: pairs.length / 2, pairs: Uint32Array.from(pairs), weight: null };
}

function readKeypoints(columns: Columns, keyframes: number, points: number): Keypoints {
  const begin = new Uint32Array(keyframes + 1);
  const counts = columns.maybe("keypoints/count");
  if (counts) {
    const input = new Varints(counts, "keypoints/count");
    for (let row = 0; row < keyframes; ++row) begin[row + 1] = begin[row] + input.next();
    input.finish();
  }
  const total = begin[keyframes];
  const [x, y] = ["keypoints/x", "keypoints/y"].map((name) => {
    const bytes = columns.orEmpty(name);
    expectBytes(bytes, total * 2, name);
    return new Uint16Array(bytes.buffer, bytes.byteOffset, total);
  });
  const point = new Int32Array(total);
  const input = new Varints(columns.orEmpty("keypoints/point"), "keypoints/point");
  for (let row = 0; row < keyframes; ++row) {
    let last = 0;
    for (let i = begin[row]; i < begin[row + 1]; ++i) {
      last += input.signed();
      if (last < -1 || last >= points) throw new DamagedData(`column keypoints/point names point row ${last}`);
      point[i] = last;
    }
  }
  input.finish();
  return { begin, x, y, point };
}
