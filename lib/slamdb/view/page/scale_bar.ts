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
    if (label.textContent !== text) label.textContent = text;
    place.title = stage.camera.pose.plan ? "The same everywhere in the plan view" : "In the middle of the view: what is nearer looks longer. In the plan view (P) it is the same everywhere.";
    bar.style.width = `${pixels}px`;
  };
}
