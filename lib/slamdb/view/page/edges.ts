// Edges between keyframes as drawn, and looked up: covisibility, spanning tree, loops, merges.

import type { Rgb, Theme } from "./colours";
import { isDrawnKeyframe } from "./keyframes";
import type { Model } from "./model";
import { type Edges, type Scene, birthOf } from "./scene";
import { Lines } from "./shapes";
import { kPaint } from "./theme";

export type EdgeLayer = "covisibility" | "tree" | "loops" | "merges";

export function buildEdges(model: Model, layer: EdgeLayer, theme: Theme): Lines {
  const { scene, settings } = model;
  const lines = new Lines();
  const colour = kPaint[theme][layer];
  if (layer === "tree") {
    scene.keyframes.parent.forEach((parent, row) => {
      if (parent >= 0) addEdge(model, lines, parent, row, colour, 0.85);
    });
    return lines;
  }
  const edges = scene[layer];
  for (let i = 0; i < edges.count; ++i) {
    const weight = edges.weight ? edges.weight[i] : 0;
    if (edges.weight && weight < settings.minWeight) continue;
    // Many edges lie over each other: a strong one shows among weak ones.
    const alpha = edges.weight ? Math.min(0.6, 0.07 + weight / 600) : 0.95;
    addEdge(model, lines, edges.pairs[2 * i], edges.pairs[2 * i + 1], colour, alpha);
  }
  return lines;
}

function addEdge(model: Model, lines: Lines, a: number, b: number, colour: Rgb, alpha: number): void {
  if (!isDrawnKeyframe(model, a) || !isDrawnKeyframe(model, b)) return;
  const { frames, scene } = model;
  const { rank, count } = scene.keyframes;
  lines.add(frames.keyframe(a), frames.keyframe(b), colour, alpha, birthOf(Math.max(rank[a], rank[b]), count));
}

export interface Partner {
  row: number;
  weight: number;
}

/** Who is joined to a keyframe, the strongest first. */
export function partnersOf(edges: Edges, row: number): Partner[] {
  const found: Partner[] = [];
  for (let i = 0; i < edges.count; ++i) {
    const a = edges.pairs[2 * i], b = edges.pairs[2 * i + 1];
    if (a === row || b === row) found.push({ row: a === row ? b : a, weight: edges.weight ? edges.weight[i] : 0 });
  }
  return found.sort((a, b) => b.weight - a.weight || a.row - b.row);
}

export function childrenOf(scene: Scene, row: number): number[] {
  const found: number[] = [];
  scene.keyframes.parent.forEach((parent, child) => {
    if (parent === row && child !== row) found.push(child);
  });
  return found;
}

/** How many there are, for the list of layers. */
export function edgeCount(scene: Scene, layer: EdgeLayer): number {
  return layer === "tree" ? scene.keyframes.parent.reduce((sum, parent) => sum + (parent >= 0 ? 1 : 0), 0) : scene[layer].count;
}
