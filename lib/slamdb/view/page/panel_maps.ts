// Maps: on and off, how they are arranged, and offsets by numbers and nudges.

import { category, css } from "./colours";
import { mapTitle } from "./scene";
import { button, checkbox, h, iconButton, section, swatch } from "./dom";
import { grouped, roundStep } from "./format";
import type { Arrangement } from "./frames";
import type { Model } from "./model";
import type { SceneMap } from "./scene";
import { resolvedTheme } from "./theme";

export function buildMaps(model: Model): HTMLElement {
  const { scene } = model;
  const lines = scene.maps.map((map) => buildMap(model, map));
  return section(scene.maps.length > 1 ? `Maps (${scene.maps.length})` : "Map", scene.maps.length > 1, buildArrangement(model), ...lines);
}

function buildArrangement(model: Model): HTMLElement | null {
  const { scene } = model;
  const choices: [Arrangement, string][] = [["own", scene.header.atlases.length > 1 ? "Overlaid" : "As recorded"]];
  if (scene.header.atlases.length > 1) choices.push(["atlases", "Side by side"]);
  if (scene.maps.length > scene.header.atlases.length) choices.push(["maps", "Maps apart"]);
  if (choices.length < 2) return null;
  const buttons = choices.map(([arrangement, label]) => {
    const choice = button(label, () => model.setArrangement(arrangement), { "data-arrangement": arrangement });
    const refresh = (): void => choice.setAttribute("aria-pressed", String(model.frames.arrangement === arrangement));
    model.on(["frames"], refresh);
    refresh();
    return choice;
  });
  const hint = h("p", { class: "quiet" }, "Every map lies in a frame of its own: unless they were aligned, it means nothing where they overlap.");
  const explain = (): void => {
    hint.hidden = scene.header.diff !== null || model.frames.arrangement !== "own";
  };
  model.on(["frames"], explain);
  explain();
  return h("div", {}, h("div", { class: "segments", role: "group", "aria-label": "Arrangement of maps" }, ...buttons), hint);
}

function buildMap(model: Model, map: SceneMap): HTMLElement {
  const { frames, scene } = model;
  const name = mapTitle(scene, map);
  const mark = swatch("");
  const recolour = (): void => {
    mark.style.background = css(category(map.index, resolvedTheme(model.settings.theme)));
  };
  recolour();
  model.on(["theme"], recolour);
  const shown = checkbox(name, frames.visible[map.index], (visible) => model.setVisible(map.index, visible),
    h("span", { class: "count" }, `${grouped(map.keyframes)} kf, ${grouped(map.points)} mp`));
  const box = shown.querySelector("input")!;
  shown.prepend(mark);
  model.on(["frames"], () => (box.checked = frames.visible[map.index]));
  const offsets = buildOffsets(model, map, name);
  offsets.hidden = true;
  const more = iconButton("forward", `Move ${name}`, () => {
    offsets.hidden = !offsets.hidden;
    more.setAttribute("aria-expanded", String(!offsets.hidden));
  }, { class: "icon small", "aria-expanded": "false" });
  return h("div", { class: "map" }, h("div", { class: "line" }, shown, more), offsets);
}

function buildOffsets(model: Model, map: SceneMap, name: string): HTMLElement {
  const { frames } = model;
  const { low, high } = frames.bounds([map.index]);
  const step = roundStep(Math.max(high[0] - low[0], high[1] - low[1]) / 60);
  const axes = ["x", "y", "z", "turn \u00b0"];
  const inputs = axes.map((axis, i) => {
    const input = h("input", { type: "number", step: i === 3 ? 1 : step, value: frames.offsets[map.index][i], "aria-label": `Offset ${axis} of ${name}` });
    input.addEventListener("input", () => {
      frames.offsets[map.index][i] = Number.isFinite(input.valueAsNumber) ? input.valueAsNumber : 0;
      model.framesChanged();
    });
    return input;
  });
  const refresh = (): void => inputs.forEach((input, i) => {
    if (document.activeElement !== input) input.value = String(Number(frames.offsets[map.index][i].toPrecision(8)));
  });
  model.on(["frames"], refresh);
  const nudge = (axis: number, by: number, label: string, text: string): HTMLElement => button(text, () => {
    frames.offsets[map.index][axis] += by;
    model.framesChanged();
  }, { "aria-label": `${label} ${name}` });
  const reset = button("Reset", () => {
    frames.offsets[map.index].fill(0);
    model.framesChanged();
  });
  return h("div", {},
    h("div", { class: "offsets" }, ...inputs.map((input, i) => h("label", {}, axes[i], input))),
    h("div", { class: "nudges" },
      nudge(0, -step, "Nudge along minus x", "\u2190"), nudge(0, step, "Nudge along x", "\u2192"), nudge(1, step, "Nudge along y", "\u2191"),
      nudge(1, -step, "Nudge along minus y", "\u2193"), nudge(3, 1, "Turn left", "\u21ba"), nudge(3, -1, "Turn right", "\u21bb"), reset));
}
