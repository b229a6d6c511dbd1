// What is drawn: a box a layer, in the colours they are drawn in, with how many there are.

import { css } from "./colours";
import { edgeCount } from "./edges";
import { checkbox, h, section, slider, swatch } from "./dom";
import { grouped, rounded } from "./format";
import { hasPlace } from "./highlights";
import type { LayerName, Model } from "./model";
import { type Paint, kPaint, resolvedTheme } from "./theme";

interface Row {
  layer: LayerName;
  label: string;
  paint?: keyof Paint;
  count?: number;
}

export function layerRows(model: Model): Row[] {
  const { scene } = model;
  const edges = (["covisibility", "tree", "loops", "merges"] as const).map((layer) => edgeCount(scene, layer));
  const all: Row[] = [
    { layer: "points", label: "Points", count: scene.points.count },
    { layer: "trajectory", label: "Trajectory", paint: "trajectory" },
    { layer: "frusta", label: "Keyframes", paint: "frusta", count: scene.keyframes.count },
    { layer: "covisibility", label: "Covisibility", paint: "covisibility", count: edges[0] },
    { layer: "tree", label: "Spanning tree", paint: "tree", count: edges[1] },
    { layer: "loops", label: "Loop edges", paint: "loops", count: edges[2] },
    { layer: "merges", label: "Merge edges", paint: "merges", count: edges[3] },
    { layer: "findings", label: "Findings", paint: "finding", count: scene.header.findings.filter((finding) => hasPlace(scene, finding)).length },
    { layer: "moves", label: "Arrows of what moved" },
    { layer: "rays", label: "Lines of sight of the selection", paint: "selection" },
    { layer: "keypoints", label: "Keypoints of the selection", paint: "selection" },
    { layer: "grid", label: "Grid", paint: "grid" },
  ];
  return all.filter(({ layer, count }) => (layer === "moves" ? Boolean(scene.header.diff) : count !== 0));
}

export function buildLayers(model: Model): HTMLElement {
  const { settings } = model;
  const boxes = layerRows(model).map(({ layer, label, paint, count }) => {
    const mark = swatch("transparent");
    mark.classList.add("line");
    const recolour = (): void => {
      mark.style.background = paint ? css(kPaint[resolvedTheme(settings.theme)][paint]) : "transparent";
    };
    recolour();
    const box = checkbox(label, settings.layers[layer], (shown) => model.setLayer(layer, shown),
      count === undefined ? null : h("span", { class: "count" }, grouped(count)), mark);
    const input = box.querySelector("input")!;
    input.dataset.layer = layer;
    model.on(["layers"], () => (input.checked = settings.layers[layer]));
    model.on(["theme"], recolour);
    return box;
  });
  const size = slider("Keyframe size", { min: 0.2, max: 5, step: 0.1, value: settings.frustumSize }, (value) => `${rounded(value, 2)}\u00d7`, (value) => {
    settings.frustumSize = value;
    model.changed("size");
  });
  const hasWeights = model.scene.covisibility.count > 0;
  const weight = hasWeights ? slider("Shared points", { min: 15, max: 300, step: 5, value: settings.minWeight }, (value) => `${value}+`, (value) => {
    settings.minWeight = value;
    settings.layers.covisibility = true;
    model.changed("size", "layers");
  }) : null;
  if (weight) weight.title = "Covisibility edges are drawn between keyframes that share at least as many points";
  return section("Layers", true, ...boxes, size, weight);
}
