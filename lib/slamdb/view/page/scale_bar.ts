// How long is what one sees: a bar of a round length, which is also the cell of the grid.

import { byId, h, refill } from "./dom";
import { stepText } from "./format";
import { gridStep } from "./grid";
import type { Model } from "./model";
import type { Stage } from "./stage";

export interface Scale {
  pixels: number;
  text: string;
}

export function scaleOf(unitsPerPixel: number, unit: string): Scale {
  const step = gridStep(unitsPerPixel);
  return { pixels: step / unitsPerPixel, text: stepText(step, unit) };
}

export function buildScaleBar(model: Model, stage: Stage): () => void {
  const place = byId("scale");
  const label = h("span");
  const bar = h("div", { class: "bar" });
  refill(place, label, bar);
  place.hidden = false;
  return () => {
    const { pixels, text } = scaleOf(stage.camera.unitsPerPixel(), model.unit);
    const shown = stage.camera.pose.plan ? text : `${text} at the middle`;
    if (label.textContent !== shown) label.textContent = shown;
    bar.style.width = `${pixels}px`;
  };
}
