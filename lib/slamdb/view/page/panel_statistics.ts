// The numbers of `info`, as it prints them.

import { idText, mapTitle, unitOf } from "./scene";
import { h, rows, section } from "./dom";
import { counted, durationText, lengthText, rounded } from "./format";
import type { Model } from "./model";
import type { SceneMap } from "./scene";

export function buildStatistics(model: Model): HTMLElement {
  const { scene } = model;
  const several = scene.header.atlases.length > 1;
  const parts: HTMLElement[] = [];
  for (const atlas of scene.header.atlases) {
    if (several) parts.push(h("h3", {}, atlas.name));
    parts.push(...infoParts(atlas.info));
  }
  for (const map of scene.maps) {
    if (scene.maps.length > 1) parts.push(h("h3", {}, mapTitle(scene, map)));
    parts.push(rows(mapRows(model, map)));
  }
  for (const camera of scene.header.cameras) {
    parts.push(h("h3", {}, `Camera ${idText(camera.id)}`), h("p", {}, camera.text));
  }
  return section("Statistics", false, ...parts);
}

/** A row that names a map begins the rows of that map. */
function infoParts(info: { label: string; value: string }[]): HTMLElement[] {
  const parts: HTMLElement[] = [];
  let part: [string, string][] = [];
  const flush = (): void => {
    if (part.length > 0) parts.push(rows(part));
    part = [];
  };
  for (const { label, value } of info) {
    if (/^map (\d+|none)$/.test(label)) {
      flush();
      parts.push(h("h3", {}, value ? `${label}: ${value}` : label));
    } else {
      part.push([label, value]);
    }
  }
  flush();
  return parts;
}

function mapRows(model: Model, map: SceneMap): [string, string][] {
  const found: [string, string][] = [];
  if (model.scene.header.atlases[map.atlas].info.length === 0) found.push(["sensor", map.sensor]);
  found.push(["keyframes", counted(map.keyframes, "keyframe")], ["points", counted(map.points, "point")]);
  const { trajectory_length, duration, mean_error, mean_observers, components } = map.statistics;
  const add = (label: string, value: number | null, text: (value: number) => string): void => {
    if (value !== null) found.push([label, text(value)]);
  };
  add("trajectory", trajectory_length, (value) => lengthText(value, unitOf([map])));
  add("duration", duration, durationText);
  add("reprojection", mean_error, (value) => `${rounded(value, 3)} px on average`);
  add("observers", mean_observers, (value) => `${rounded(value, 3)} a point`);
  add("components", components, (value) => counted(value, "component"));
  return found;
}
