// Where maps stand in the scene: upright (z is up), side by side where asked, and moved by the offsets that people give.

import { type Rigid, type Vec3, add, compose, isFinitePoint, quantile, rotate, transform, turnAboutZ } from "./maths";
import {
  type Scene, type SceneMap, Status, hasPose, isHiddenPoint, keyframeCentre, keyframeRotation, mapOfKeyframe, mapOfPoint, pointPosition,
} from "./scene";

export type Arrangement = "own" | "atlases" | "maps";
/** Metres, and degrees about up. */
export type Offset = [x: number, y: number, z: number, heading: number];

export interface Bounds {
  low: Vec3;
  high: Vec3;
}

const kSamples = 12000;

export class Frames {
  readonly own: Rigid[]; // upright, each map where its own coordinates say
  readonly offsets: Offset[];
  readonly visible: boolean[];
  arrangement: Arrangement = "own";
  now: Rigid[]; // with arrangement and offsets
  private readonly samples: Vec3[][]; // of each map, upright

  constructor(readonly scene: Scene) {
    this.own = scene.maps.map((map) => ({ rotation: map.upright, translation: [0, 0, 0] }));
    this.offsets = scene.maps.map(() => [0, 0, 0, 0]);
    this.visible = scene.maps.map(() => true);
    this.samples = scene.maps.map((map) => this.sample(map));
    this.now = this.own;
    this.update();
  }

  /** After a change of arrangement, offsets or visible. */
  update(): void {
    const moved = this.own.map((own, index): Rigid => {
      const [x, y, z, heading] = this.offsets[index];
      const turn = turnAboutZ((heading * Math.PI) / 180);
      return { rotation: compose(turn, own.rotation), translation: add(rotate(turn, own.translation), [x, y, z]) };
    });
    this.now = moved;
    if (this.arrangement === "own") return;
    const group = (map: SceneMap): number => (this.arrangement === "maps" ? map.index : map.atlas);
    const groups = [...new Set(this.scene.maps.map(group))];
    let right = 0;
    for (const number of groups) {
      const members = this.scene.maps.filter((map) => group(map) === number);
      const { low, high } = this.bounds(members.map((map) => map.index));
      const shift: Vec3 = [right - low[0], -(low[1] + high[1]) / 2, -low[2]];
      for (const map of members) {
        const { rotation, translation } = moved[map.index];
        moved[map.index] = { rotation, translation: add(translation, shift) };
      }
      right += (high[0] - low[0]) * 1.12;
    }
  }

  point(row: number): Vec3 {
    const map = mapOfPoint(this.scene, row);
    return transform(this.now[map.index], pointPosition(this.scene, map, row));
  }

  pointHeight(row: number): number {
    const map = mapOfPoint(this.scene, row);
    return transform(this.own[map.index], pointPosition(this.scene, map, row))[2];
  }

  keyframe(row: number): Vec3 {
    return transform(this.now[mapOfKeyframe(this.scene, row).index], keyframeCentre(this.scene, row));
  }

  /** A direction of a keyframe's camera in the scene. */
  direction(row: number, inCamera: Vec3): Vec3 {
    const turn = this.now[mapOfKeyframe(this.scene, row).index].rotation;
    return rotate(turn, rotate(keyframeRotation(this.scene, row), inCamera));
  }

  shown(map: SceneMap): boolean {
    return this.visible[map.index];
  }

  /** Some points and keyframes of maps that are shown, without strangers: for framing. */
  landmarks(maps: number[] = this.scene.maps.map((map) => map.index)): Vec3[] {
    const asked = maps.filter((index) => this.visible[index]);
    return (asked.length > 0 ? asked : maps).flatMap((index) => {
      const fromOwn: Rigid = this.fromOwn(index);
      return this.samples[index].map((p) => transform(fromOwn, p));
    });
  }

  /** Of what most of the points are in: strangers far out do not count. */
  bounds(maps?: number[]): Bounds {
    const points = this.landmarks(maps);
    if (points.length === 0) return { low: [-1, -1, -1], high: [1, 1, 1] };
    const low: Vec3 = [0, 0, 0];
    const high: Vec3 = [0, 0, 0];
    for (let axis = 0; axis < 3; ++axis) {
      const sorted = Float64Array.from(points, (p) => p[axis]).sort();
      low[axis] = quantile(sorted, 0.02);
      high[axis] = quantile(sorted, 0.98);
      if (high[axis] - low[axis] < 1e-6) high[axis] = low[axis] + 1e-6;
    }
    return { low, high };
  }

  private fromOwn(index: number): Rigid {
    const own = this.own[index].rotation;
    const back: Rigid["rotation"] = [-own[0], -own[1], -own[2], own[3]];
    return { rotation: compose(this.now[index].rotation, back), translation: this.now[index].translation };
  }

  private sample(map: SceneMap): Vec3[] {
    const { scene } = this;
    const points: Vec3[] = [];
    const centres: Vec3[] = [];
    const take = (list: Vec3[], p: Vec3): void => {
      const upright = transform(this.own[map.index], p);
      if (isFinitePoint(upright)) list.push(upright);
    };
    const share = Math.max(1, Math.ceil(scene.points.count / kSamples));
    for (let row = map.first_point; row < map.first_point + map.points; row += share) {
      if (!isHiddenPoint(scene, row)) take(points, pointPosition(scene, map, row));
    }
    const step = Math.max(1, Math.ceil(scene.keyframes.count / kSamples));
    for (let row = map.first_keyframe; row < map.first_keyframe + map.keyframes; row += step) {
      if (hasPose(scene, row)) take(centres, keyframeCentre(scene, row));
    }
    return [...withoutStrangers(points), ...withoutStrangers(centres)];
  }
}

/** Without those far out of the box of the most: a picture of all would show the others small. */
export function withoutStrangers(points: Vec3[]): Vec3[] {
  const ends = [0, 1, 2].map((axis) => {
    const sorted = Float64Array.from(points, (p) => p[axis]).sort();
    return [quantile(sorted, 0.05), quantile(sorted, 0.95)];
  });
  const margin = 0.3 * Math.max(...ends.map(([low, high]) => high - low));
  return points.filter((p) => ends.every(([low, high], axis) => p[axis] >= low - margin && p[axis] <= high + margin));
}

/** The left atlas of a comparison is there for what the right one lacks. */
export const isLeftOfDiff = (scene: Scene, map: SceneMap): boolean => scene.header.diff?.left === map.atlas;

/** Statuses of a map's rows that are drawn: a bit each. */
export function drawnStatuses(scene: Scene, map: SceneMap, asked: number): number {
  if (!scene.header.diff) return ~0;
  return isLeftOfDiff(scene, map) ? asked & (1 << Status.removed) : asked;
}
