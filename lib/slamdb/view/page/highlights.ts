// What is lit: the selection with its observers or its points, findings, and what a comparison says has moved.

import { type Theme, statusColour } from "./colours";
import { addFrustum, frustum, imagePlane, isDrawnKeyframe } from "./keyframes";
import { type Vec3, add, cross, length, normalized, scale, subtract } from "./maths";
import type { Model } from "./model";
import { type Finding, type Scene, Status, birthOf, hasPose, isHiddenPoint, mapOfPoint, pointsSeenBy } from "./scene";
import { Lines, Marks } from "./shapes";
import { kPaint } from "./theme";

/** The frustum of a selected keyframe is this much larger, so that its keypoints can be seen. */
const kSelectedFrustum = 2.4;
const kMostMoves = 100000;
const kMostRays = 1500;

export interface Lit {
  lines: Lines; // frusta of who is lit
  rays: Lines;
  points: Marks;
  keypoints: Marks;
  rings: Marks; // about what is selected
}

export function buildLit(model: Model, theme: Theme, depth: number): Lit {
  const lit: Lit = { lines: new Lines(), rays: new Lines(), points: new Marks(), keypoints: new Marks(), rings: new Marks() };
  const { selection } = model;
  if (selection?.kind === "point") lightPoint(model, selection.row, lit, theme, depth);
  if (selection?.kind === "keyframe") lightKeyframe(model, selection.row, lit, theme, depth);
  return lit;
}

function lightPoint(model: Model, row: number, lit: Lit, theme: Theme, depth: number): void {
  const { scene, frames } = model;
  const colour = kPaint[theme].selection;
  if (isHiddenPoint(scene, row)) return;
  const place = frames.point(row);
  lit.points.add(place, colour);
  lit.rings.add(place, colour);
  for (const observer of scene.points.seen.of(row)) {
    if (!isDrawnKeyframe(model, observer)) continue;
    addFrustum(lit.lines, frustum(model, observer, depth * 1.15), colour, 0.95, 0, 0);
    lit.rays.add(frames.keyframe(observer), place, colour, 0.5);
  }
}

function lightKeyframe(model: Model, row: number, lit: Lit, theme: Theme, depth: number): void {
  const { scene, frames } = model;
  const colour = kPaint[theme].selection;
  if (!hasPose(scene, row)) return;
  const selected = frustum(model, row, depth * kSelectedFrustum);
  addFrustum(lit.lines, selected, colour, 1, 0, 0);
  lit.rings.add(selected.centre, colour);
  const seen = pointsSeenBy(scene, row).filter((point) => !isHiddenPoint(scene, point));
  const rayStep = Math.ceil(seen.length / kMostRays);
  seen.forEach((point, i) => {
    const place = frames.point(point);
    lit.points.add(place, colour);
    if (i % rayStep === 0) lit.rays.add(selected.centre, place, colour, 0.13);
  });
  const { begin, x, y, point } = scene.keypoints;
  const image = imagePlane(model, row, depth * kSelectedFrustum);
  for (let i = begin[row]; i < begin[row + 1]; ++i) {
    lit.keypoints.add(image.at(x[i] / 8, y[i] / 8), point[i] >= 0 ? colour : kPaint[theme].grid, point[i] >= 0 ? 1 : 0.6);
  }
}

/** Rings about what findings name; the one that is looked at apart, since it is drawn larger. */
export function buildFindings(model: Model, theme: Theme): { all: Marks; current: Marks } {
  const all = new Marks();
  const current = new Marks();
  model.scene.header.findings.forEach(({ severity }, index) => {
    const place = findingPlace(model, index);
    // Notes are normal in sound maps: they are marked, but raise no alarm.
    const colour = severity === "note" ? kPaint[theme].grid : kPaint[theme].finding;
    if (place) (index === model.finding ? current : all).add(place, colour);
  });
  return { all, current };
}

/** Whether a finding is of something that is drawn where its map is shown. */
export function hasPlace(scene: Scene, { kind, row }: Finding): boolean {
  if (row < 0) return false;
  if (kind === "point") return row < scene.points.count && !isHiddenPoint(scene, row);
  return kind === "keyframe" && row < scene.keyframes.count && hasPose(scene, row);
}

/** Where a finding is; null where it has no place that is drawn. */
export function findingPlace(model: Model, index: number): Vec3 | null {
  const { scene, frames } = model;
  const finding = scene.header.findings[index];
  if (!hasPlace(scene, finding)) return null;
  const { kind, row } = finding;
  if (kind === "point") return frames.shown(mapOfPoint(scene, row)) ? frames.point(row) : null;
  return isDrawnKeyframe(model, row) ? frames.keyframe(row) : null;
}

/** Arrows from where things were, in the left atlas, to where they are. */
export function buildMoves(model: Model, theme: Theme): Lines {
  const lines = new Lines();
  const { scene, frames, settings } = model;
  const { points, keyframes } = scene;
  if (!scene.header.diff || (settings.statuses & (1 << Status.moved)) === 0) return lines;
  const colour = statusColour(Status.moved, theme);
  const step = Math.max(1, Math.ceil(points.count / kMostMoves));
  for (let row = 0; points.moved && row < points.count; row += step) {
    if (points.moved[row] < 0 || isHiddenPoint(scene, row) || !frames.shown(mapOfPoint(scene, row))) continue;
    addArrow(lines, frames.point(points.moved[row]), frames.point(row), colour, points.birth[row]);
  }
  for (let row = 0; keyframes.moved && row < keyframes.count; ++row) {
    const from = keyframes.moved[row];
    if (from < 0 || !isDrawnKeyframe(model, row) || !hasPose(scene, from)) continue;
    addArrow(lines, frames.keyframe(from), frames.keyframe(row), colour, birthOf(keyframes.rank[row], keyframes.count));
  }
  return lines;
}

function addArrow(lines: Lines, from: Vec3, to: Vec3, colour: [number, number, number], birth: number): void {
  const along = subtract(to, from);
  const size = length(along);
  if (!(size > 0)) return;
  lines.add(from, to, colour, 0.85, birth);
  const aside = scale(normalized(cross(along, Math.abs(along[2]) > 0.9 * size ? [1, 0, 0] : [0, 0, 1])), size * 0.1);
  const neck = subtract(to, scale(along, 0.28));
  lines.add(add(neck, aside), to, colour, 0.85, birth);
  lines.add(subtract(neck, aside), to, colour, 0.85, birth);
}
