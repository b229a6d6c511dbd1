// Scenes for tests: a camera goes round a hall of 20 m by 12 m by 4 m, y down as cameras have it, and sees its walls.

import type { PlainScene } from "./encoder";

/** Numbers that are equal on every machine. */
export function numbers(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 4294967296;
  };
}

function wallPoint(random: () => number): [number, number, number] {
  const along = random() * 64;
  const height = random() * 4;
  const rough = (random() - 0.5) * 0.08;
  if (along < 20) return [along - 10, 1.5 - height, -6 + rough];
  if (along < 40) return [along - 30, 1.5 - height, 6 + rough];
  if (along < 52) return [-10 + rough, 1.5 - height, along - 46];
  return [10 + rough, 1.5 - height, along - 58];
}

/** Looks along `heading` in the plane of x and z, upright. */
const headingQuaternion = (heading: number): [number, number, number, number] => [0, Math.sin(heading / 2), 0, Math.cos(heading / 2)];

export interface HallOptions {
  title?: string;
  keyframes?: number;
  points?: number;
  maps?: number;
  observers?: number;
  sensor?: string;
}

export function hall({ title = "hall", keyframes = 40, points = 4000, maps = 1, observers = 5, sensor = "stereo or RGB-D" }: HallOptions = {}): PlainScene {
  const random = numbers(7);
  const K = keyframes * maps, P = points * maps;
  const positions = new Float32Array(3 * P);
  const reference = new Int32Array(P);
  const pose = new Float32Array(7 * K);
  const time = new Float64Array(K);
  for (let row = 0; row < K; ++row) {
    const turn = ((row % keyframes) / keyframes) * 2 * Math.PI;
    pose.set([7 * Math.cos(turn), 0, 3.5 * Math.sin(turn), ...headingQuaternion(Math.PI / 2 - turn)], 7 * row);
    time[row] = row * 0.25;
  }
  for (let row = 0; row < P; ++row) {
    const map = Math.floor(row / points);
    positions.set(wallPoint(random), 3 * row);
    reference[row] = map * keyframes + Math.floor(((row % points) / points) * keyframes);
  }
  const last = (row: number): number => (Math.floor(row / points) + 1) * keyframes - 1;
  return {
    title,
    atlases: [{
      name: "hall.osa", sensor, info: [{ label: "format", value: "ORB-SLAM3 atlas" }],
      maps: Array.from({ length: maps }, (_, id) => ({ id, keyframes, points })),
    }],
    cameras: [{ id: 2, model: "pinhole", width: 640, height: 480, fx: 450, fy: 450, cx: 319.5, cy: 239.5 }],
    points: {
      positions, reference, ids: Int32Array.from({ length: P }, (_, row) => row * 2 + 5), error: Uint8Array.from({ length: P }, (_, row) => 1 + (row % 200)),
      seen: (row) => Array.from({ length: observers }, (_, i) => reference[row] + i).filter((keyframe) => keyframe <= last(row)),
    },
    keyframes: {
      ids: Int32Array.from({ length: K }, (_, row) => row * 3), time, pose, camera: new Int32Array(K), origin: Int32Array.from({ length: K }, (_, row) => Math.floor(row / keyframes)),
      parent: Int32Array.from({ length: K }, (_, row) => (row % keyframes === 0 ? -1 : row - 1)), flags: new Uint8Array(K),
    },
    covisibility: Array.from({ length: K - 1 }, (_, row): [number, number, number] => [row, row + 1, 40 + row]).filter(([a]) => a % keyframes !== keyframes - 1),
    loops: [[keyframes - 1, 0]],
  };
}

/** Keypoints for a hall: some with points, some without. */
export function withKeypoints(scene: PlainScene): PlainScene {
  const random = numbers(11);
  const perKeyframe = scene.points.positions.length / 3 / scene.keyframes.ids.length;
  scene.keypoints = Array.from({ length: scene.keyframes.ids.length }, (_, row) => {
    const count = 60;
    return {
      x: Array.from({ length: count }, () => Math.floor(random() * 640)), y: Array.from({ length: count }, () => Math.floor(random() * 480)),
      point: Array.from({ length: count }, (_, i) => (i % 3 === 0 ? -1 : Math.floor(row * perKeyframe) + (i % Math.max(1, Math.floor(perKeyframe))))),
    };
  });
  return scene;
}

/** A comparison: the right atlas has lost the first 100 points of the left one, has 150 new ones, and has moved 80. */
export function comparison(): PlainScene {
  const left = hall({ points: 1000, keyframes: 20 });
  const random = numbers(3);
  const added = 150, removed = 100, moved = 80;
  const rightPoints = 1000 - removed + added;
  const P = 1000 + rightPoints;
  const positions = new Float32Array(3 * P);
  positions.set(left.points.positions);
  const status = new Uint8Array(P);
  status.fill(2, 0, removed);
  const partner = new Map<number, number>();
  const reference = new Int32Array(P);
  reference.set(left.points.reference as Int32Array);
  for (let i = 0; i < rightPoints; ++i) {
    const row = 1000 + i;
    const old = i + removed;
    if (i < 1000 - removed) {
      positions.set(left.points.positions.subarray(3 * old, 3 * old + 3), 3 * row);
      reference[row] = reference[old] + 20;
      if (i < moved) {
        positions[3 * row] += 0.8;
        status[row] = 3;
        partner.set(row, old);
      }
    } else {
      positions.set(wallPoint(random), 3 * row);
      reference[row] = 20 + (i % 20);
      status[row] = 1;
    }
  }
  const twice = (values: ArrayLike<number>): number[] => [...Array.from(values), ...Array.from(values)];
  return {
    ...left, title: "before and after",
    atlases: [
      { name: "before.osa", sensor: "stereo or RGB-D", maps: [{ id: 0, keyframes: 20, points: 1000 }] },
      { name: "after.osa", sensor: "stereo or RGB-D", maps: [{ id: 0, keyframes: 20, points: rightPoints }] },
    ],
    header: { diff: { left: 0, right: 1, points: { added, removed, moved, changed: 0 }, keyframes: { added: 0, removed: 0, moved: 0, changed: 0 } } },
    points: { positions, ids: Int32Array.from({ length: P }, (_, row) => row), error: new Uint8Array(P).fill(90), seen: (row) => [reference[row]], reference, status, moved: partner },
    keyframes: {
      ids: twice(left.keyframes.ids), time: Float64Array.from(twice(left.keyframes.time)), pose: Float32Array.from(twice(left.keyframes.pose)), camera: new Int32Array(40),
      origin: new Int32Array(40), parent: Int32Array.from({ length: 40 }, (_, row) => (row % 20 === 0 ? -1 : row - 1)), flags: new Uint8Array(40), status: new Uint8Array(40),
    },
    covisibility: [], loops: [],
  };
}
