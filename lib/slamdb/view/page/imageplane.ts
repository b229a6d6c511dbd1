// The image of a keyframe as far as a map knows it: its keypoints, those with a map point filled.

import { h } from "./dom";
import { counted, grouped } from "./format";
import type { Model } from "./model";
import { kPaint } from "./theme";
import type { Theme } from "./colours";

export interface ImagePlaneView {
  element: HTMLElement;
  matched: number;
  total: number;
}

/** null where the page holds no keypoints of it. `chosen` is told the row of a point that is clicked. */
export function buildImagePlane(model: Model, row: number, theme: Theme, chosen: (point: number) => void): ImagePlaneView | null {
  const { keypoints, keyframes, header } = model.scene;
  const begin = keypoints.begin[row], end = keypoints.begin[row + 1];
  if (begin === end) return null;
  const camera = header.cameras[keyframes.camera[row]];
  let width = camera?.width ?? 0, height = camera?.height ?? 0;
  let matched = 0;
  for (let i = begin; i < end; ++i) {
    width = Math.max(width, keypoints.x[i] / 8);
    height = Math.max(height, keypoints.y[i] / 8);
    if (keypoints.point[i] >= 0) ++matched;
  }
  const shown = 528; // pixels of the picture: twice what it is wide on the page
  const factor = shown / Math.max(width, 1);
  const canvas = h("canvas", {
    class: "image-plane", width: shown, height: Math.max(1, Math.round(height * factor)), role: "img",
    "aria-label": `Image plane: ${matched} of ${counted(end - begin, "keypoint")} have a map point`,
  });
  const context = canvas.getContext("2d")!;
  const paint = kPaint[theme];
  // Those without a point first, so that they cover none.
  for (const wanted of [false, true]) {
    context.fillStyle = context.strokeStyle = `rgb(${(wanted ? paint.selection : paint.grid).join(",")})`;
    context.lineWidth = 1.5;
    for (let i = begin; i < end; ++i) {
      if (keypoints.point[i] >= 0 !== wanted) continue;
      context.beginPath();
      context.arc((keypoints.x[i] / 8) * factor, (keypoints.y[i] / 8) * factor, wanted ? 3.4 : 2.6, 0, 2 * Math.PI);
      if (wanted) context.fill();
      else context.stroke();
    }
  }
  canvas.addEventListener("click", (event) => {
    const box = canvas.getBoundingClientRect();
    const scale = width / box.width;
    const i = nearestMatched(model, row, (event.clientX - box.left) * scale * 8, (event.clientY - box.top) * scale * 8, 12 * scale * 8);
    if (i >= 0) chosen(keypoints.point[i]);
  });
  const key = h("p", { class: "key" }, h("span", {}, h("i", { class: "dot" }), `${grouped(matched)} with a point`), h("span", {}, h("i", { class: "dot hollow" }), `${grouped(end - begin - matched)} without`));
  return { element: h("div", {}, canvas, key), matched, total: end - begin };
}

/** x, y and reach in eighths of a pixel. */
function nearestMatched(model: Model, row: number, x: number, y: number, reach: number): number {
  const { keypoints } = model.scene;
  let best = -1;
  let nearest = reach * reach;
  for (let i = keypoints.begin[row]; i < keypoints.begin[row + 1]; ++i) {
    const d = (keypoints.x[i] - x) ** 2 + (keypoints.y[i] - y) ** 2;
    if (keypoints.point[i] >= 0 && d < nearest) [best, nearest] = [i, d];
  }
  return best;
}
