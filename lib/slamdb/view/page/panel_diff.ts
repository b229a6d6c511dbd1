// A comparison of two atlases: what was added, removed, moved, changed, with counts, each on and off.

import { css, statusColour } from "./colours";
import { checkbox, h, section, swatch } from "./dom";
import { grouped } from "./format";
import type { Model } from "./model";
import { type Scene, Status, kStatusNames } from "./scene";
import { isLeftOfDiff } from "./frames";
import type { Stage } from "./stage";

export interface StatusCounts {
  points: number[];
  keyframes: number[];
}

/** By Status. The left atlas counts for what was removed, the right one for all else. */
export function countStatuses(scene: Scene): StatusCounts {
  const counts: StatusCounts = { points: [0, 0, 0, 0, 0], keyframes: [0, 0, 0, 0, 0] };
  const { points, keyframes } = scene;
  for (const map of scene.maps) {
    const left = isLeftOfDiff(scene, map);
    const count = (list: number[], status: Uint8Array | null, first: number, size: number): void => {
      for (let row = first; row < first + size; ++row) {
        const value = status?.[row] ?? 0;
        if (left === (value === Status.removed) && value < list.length) ++list[value];
      }
    };
    count(counts.points, points.status, map.first_point, map.points);
    count(counts.keyframes, keyframes.status, map.first_keyframe, map.keyframes);
  }
  return counts;
}

export function buildDifferences(model: Model, stage: Stage): HTMLElement | null {
  const { scene, settings } = model;
  const { diff } = scene.header;
  if (!diff) return null;
  const counts = countStatuses(scene);
  const boxes = kStatusNames.map((name, status) => {
    const mark = swatch("");
    const recolour = (): void => {
      mark.style.background = css(statusColour(status, stage.theme));
    };
    recolour();
    model.on(["theme"], recolour);
    const box = checkbox(name[0].toUpperCase() + name.slice(1), (settings.statuses & (1 << status)) !== 0, (shown) => {
      settings.statuses = shown ? settings.statuses | (1 << status) : settings.statuses & ~(1 << status);
      stage.statusesChanged();
      model.changed("layers");
    }, h("span", { class: "count" }, `${grouped(counts.keyframes[status])} kf, ${grouped(counts.points[status])} mp`));
    box.querySelector("input")!.dataset.status = name;
    box.prepend(mark);
    return box;
  });
  const names = [diff.left, diff.right].map((atlas) => scene.header.atlases[atlas]?.name ?? "?");
  return section("Differences", true, h("p", { class: "quiet" }, `From ${names[0]} to ${names[1]}`), ...boxes);
}

