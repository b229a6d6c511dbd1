// What points are coloured by, with its legend, and their size.

import { type ColourMode, type Legend, css, kColourModes, legend, scaleColour } from "./colours";
import { h, refill, section, slider, swatch } from "./dom";
import { lengthText, rounded } from "./format";
import type { Model } from "./model";
import type { Stage } from "./stage";
import { kPaint } from "./theme";

export function buildColour(model: Model, stage: Stage): HTMLElement {
  const { scene, settings } = model;
  const offered = kColourModes.filter(({ mode }) => mode !== "status" || scene.header.diff);
  const choice = h("select", { "aria-label": "Colour points by", id: "colour" }, ...offered.map(({ mode, label }) => h("option", { value: mode }, label)));
  choice.addEventListener("change", () => model.setColour(choice.value as ColourMode));
  const place = h("div", { id: "legend" });
  const refresh = (): void => {
    choice.value = settings.colour;
    drawLegend(place, stage, legend(scene, stage.shading, stage.theme, kPaint[stage.theme].plain, (value) => lengthText(Number(value.toPrecision(2)), model.unit)));
  };
  model.on(["colour", "theme"], refresh);
  refresh();
  return section("Colour", true, choice, place,
    slider("Point size", { min: 0.4, max: 3, step: 0.1, value: settings.pointSize }, (value) => `${rounded(value, 2)}\u00d7`, (value) => {
      settings.pointSize = value;
      model.changed("layers");
    }));
}

function drawLegend(place: HTMLElement, stage: Stage, shown: Legend): void {
  if (shown.kind === "names") {
    refill(place, h("ul", { class: "names" }, ...shown.entries.map(({ colour, label }) => h("li", {}, swatch(css(colour)), label))));
    return;
  }
  const bar = h("canvas", { class: "scale-bar-colours", width: 128, height: 1, role: "img", "aria-label": `Scale from ${shown.low} to ${shown.high}` });
  const context = bar.getContext("2d")!;
  for (let x = 0; x < 128; ++x) {
    context.fillStyle = css(scaleColour(stage.shading.mode, x / 127, stage.theme));
    context.fillRect(x, 0, 1, 1);
  }
  refill(place, bar, h("p", { class: "ends" }, h("span", {}, shown.low), h("span", {}, shown.middle), h("span", {}, shown.high)), h("p", { class: "quiet" }, shown.note));
}
