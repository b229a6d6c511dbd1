// The card of what is selected: its fields, who it is joined to, ids to copy.

import { nameOf, placeOf, recordedTime, shortly, sinceBegin, visit } from "./describe";
import { type Partner, childrenOf, partnersOf } from "./edges";
import { announce, button, byId, copyText, h, iconButton, refill, rows } from "./dom";
import { counted, grouped, measured, rounded } from "./format";
import { buildImagePlane } from "./imageplane";
import type { Vec3 } from "./maths";
import type { Model, Selection } from "./model";
import { type Scene, type SceneMap, KeyframeFlag, errorOf, errorStep, idText, isHiddenPoint, kStatusNames, keyframeCentre, mapOfKeyframe, mapOfPoint, mapTitle, originLabel, pointPosition, pointStep, pointsSeenBy } from "./scene";
import type { Stage } from "./stage";

const kListed = 48;
type Entries = [string, Node | string][];

export function buildInspector(model: Model, stage: Stage): void {
  const card = byId("inspector");
  const refresh = (): void => {
    const { selection } = model;
    card.hidden = selection === null;
    if (!selection) return;
    refill(card, heading(model, stage, selection), ...(selection.kind === "keyframe" ? keyframeParts(model, stage, selection.row) : pointParts(model, stage, selection.row)));
    card.scrollTop = 0;
    announce(shortly(model.scene, selection));
  };
  model.on(["selection", "theme"], refresh);
  refresh();
}

function heading(model: Model, stage: Stage, selection: NonNullable<Selection>): HTMLElement {
  const { scene } = model;
  const title = selection.kind === "keyframe" ? `Keyframe ${idText(scene.keyframes.ids[selection.row])}` : `Map point ${idText(scene.points.ids[selection.row])}`;
  const name = nameOf(scene, selection);
  return h("header", {}, h("h2", {}, title),
    iconButton("copy", `Copy ${name.replace(" ", "/")}`, () => void copyText(name.replace(" ", "/")), { class: "icon small" }),
    iconButton("fly", "Fly there", () => visit(model, stage, selection), { class: "icon small", "aria-keyshortcuts": "Enter", disabled: placeOf(model, selection) === null }),
    iconButton("close", "Close", () => {
      model.select(null);
      stage.canvas.focus();
    }, { class: "icon small", "aria-keyshortcuts": "Escape" }));
}

/** Where a point is, in the digits that the page has of it. */
export function pointText(scene: Scene, map: SceneMap, row: number): string {
  const step = pointStep(scene, map, row);
  return vectorText(pointPosition(scene, map, row).map((value, axis) => measured(value, step[axis])) as Vec3);
}

const vectorText = (v: Vec3): string => v.map((value) => rounded(value)).join("  ");

function chips(model: Model, stage: Stage, kind: "keyframe" | "point", list: Partner[]): HTMLElement {
  const { scene } = model;
  const ids = kind === "keyframe" ? scene.keyframes.ids : scene.points.ids;
  const shown = list.slice(0, kListed).map(({ row, weight }) =>
    button(idText(ids[row]), () => visit(model, stage, { kind, row }), { "aria-label": `${nameOf(scene, { kind, row })}${weight ? `, ${counted(weight, "shared point")}` : ""}`, title: weight ? counted(weight, "shared point") : undefined }));
  const rest = list.length - shown.length;
  const copy = iconButton("copy", "Copy these ids", () => void copyText(list.map(({ row }) => ids[row]).join(" ")), { class: "icon small" });
  return h("div", { class: "chips" }, ...shown, rest > 0 ? h("span", { class: "quiet" }, `and ${grouped(rest)} more`) : null, list.length > 1 ? copy : null);
}

const plainly = (list: ArrayLike<number>): Partner[] => Array.from(list, (row) => ({ row, weight: 0 }));

function pointParts(model: Model, stage: Stage, row: number): Node[] {
  const { scene } = model;
  const { points } = scene;
  const map = mapOfPoint(scene, row);
  const observers = points.seen.of(row);
  const error = errorOf(scene, row);
  const reference = points.reference[row];
  const entries: Entries = [["map", mapTitle(scene, map)]];
  entries.push(["position", isHiddenPoint(scene, row) ? "not drawn: bad, or not finite" : `${pointText(scene, map, row)} ${model.unit}`]);
  entries.push(["reprojection", error === null ? "unknown" : `${rounded(measured(error, errorStep(scene, row)), 3)} px`]);
  if (reference >= 0) {
    entries.push(["reference", chips(model, stage, "keyframe", plainly([reference]))]);
    entries.push(["first seen", sinceBegin(scene, reference)], ["origin map", originLabel(scene, scene.keyframes.origin[reference])]);
  }
  if (points.normal) entries.push(["normal", vectorText(octahedral(points.normal[2 * row], points.normal[2 * row + 1]))]);
  if (points.status) entries.push(["difference", kStatusNames[points.status[row]] ?? "unknown"]);
  return [rows(entries), h("h3", {}, counted(observers.length, "observer")), chips(model, stage, "keyframe", plainly(observers))];
}

/** A direction from its two octahedral bytes. */
export function octahedral(x: number, y: number): Vec3 {
  let u = x / 127, v = y / 127;
  const w = 1 - Math.abs(u) - Math.abs(v);
  if (w < 0) [u, v] = [(1 - Math.abs(v)) * (u >= 0 ? 1 : -1), (1 - Math.abs(u)) * (v >= 0 ? 1 : -1)];
  const size = Math.hypot(u, v, w) || 1;
  return [u / size, v / size, w / size];
}

function keyframeParts(model: Model, stage: Stage, row: number): Node[] {
  const { scene } = model;
  const { keyframes } = scene;
  const seen = pointsSeenBy(scene, row);
  const image = buildImagePlane(model, row, stage.theme, (point) => model.select({ kind: "point", row: point }));
  const entries: Entries = [["map", mapTitle(scene, mapOfKeyframe(scene, row))], ["time", recordedTime(scene, row)], ["since begin", sinceBegin(scene, row)]];
  const flags = keyframes.flags[row];
  entries.push(["centre", flags & KeyframeFlag.noPose ? "not finite: not drawn" : `${vectorText(keyframeCentre(scene, row))} ${model.unit}`]);
  const camera = scene.header.cameras[keyframes.camera[row]];
  entries.push(["camera", camera ? camera.text : "none"]);
  entries.push(["seen by it", counted(seen.length, "point")], ["origin map", originLabel(scene, keyframes.origin[row])]);
  if (flags & KeyframeFlag.bad) entries.push(["state", "bad"]);
  if (keyframes.status) entries.push(["difference", kStatusNames[keyframes.status[row]] ?? "unknown"]);
  const parent = keyframes.parent[row];
  if (parent >= 0) entries.push(["parent", chips(model, stage, "keyframe", plainly([parent]))]);
  const joined = (label: string, list: Partner[]): void => {
    if (list.length > 0) entries.push([label, chips(model, stage, "keyframe", list)]);
  };
  joined("children", plainly(childrenOf(scene, row)));
  joined("loops", partnersOf(scene.loops, row));
  joined("merges", partnersOf(scene.merges, row));
  const parts: Node[] = [rows(entries)];
  if (image) parts.push(h("h3", {}, counted(image.total, "keypoint")), image.element);
  // Observations that a point holds and the keyframe has lost, or that are of its right image.
  if (image && image.matched !== seen.length) {
    parts.push(h("p", { class: "quiet" }, `${counted(seen.length, "point")} say that this keyframe sees them; ${grouped(image.matched)} are at a keypoint shown here.`));
  }
  const covisible = partnersOf(scene.covisibility, row);
  if (covisible.length > 0) parts.push(h("h3", {}, counted(covisible.length, "covisible keyframe")), chips(model, stage, "keyframe", covisible));
  return parts;
}
